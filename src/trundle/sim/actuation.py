"""`Actuation`: how the robot's motion differs from what its software believes; and the simulator that acts so."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from pydantic import Field

from trundle.files.yaml_config import Config
from trundle.geometry import Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.robots import WheelSpeeds
from trundle.sim.simulator import Simulator
from trundle.sim.state import RobotState
from trundle.sim.wrapper import SimulatorWrapper

_Factor = Annotated[float, Field(ge=0.5, le=2.0)]


class Actuation(Config):
    """How the robot's motion differs from what its software believes: `{wheel_radius: 1.02, track_width: 0.98}`.

    Attributes:
        wheel_radius: True wheel radius over the one that the robot's software believes, 0.5 to 2: at 1.02 it drives 2 %
            faster than commanded, and its odometry counts 2 % too little.
        track_width: True distance between the wheels over the believed one, 0.5 to 2: at 1.02 it turns 2 % less than
            commanded.
    """

    wheel_radius: _Factor = 1.0
    track_width: _Factor = 1.0

    def simulate(self, sim: Simulator) -> Simulator:
        """Wrap a simulator so that its robot moves so; the simulator itself where there is no difference."""
        return sim if self == Actuation() else ActuatedSimulator(sim, self)


class ActuatedSimulator(SimulatorWrapper):
    """A simulator whose robot has other wheels than its software believes.

    The simulated robot is the true one. Commands are turned into wheel speeds with the believed radius and track, as a
    robot's firmware does, and the odometry is integrated with them.

    Args:
        sim: Moves the true robot.
        actuation: What differs.
    """

    def __init__(self, sim: Simulator, actuation: Actuation) -> None:
        super().__init__(sim)
        self._actuation = actuation
        self._odometry = Pose2D(0.0, 0.0)
        self._wheels = (0.0, 0.0)

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame)."""
        state = self._sim.reset(pose, seed=seed)
        self._odometry = state.odometry
        self._wheels = (state.wheel_positions.left, state.wheel_positions.right)
        return state

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period; see `Simulator.step`."""
        radius, track = self._actuation.wheel_radius, self._actuation.track_width
        state = self._sim.step(Twist2D(command.v * radius, command.w * radius / track), dt)
        self._count(state)
        return replace(state, odometry=self._odometry, odometry_twist=self._believed_twist(state.wheel_speeds))

    def _believed_twist(self, speeds: WheelSpeeds) -> Twist2D:
        """Return the twist of wheel speeds [rad/s], by the believed wheels."""
        true = self._sim.robot.twist(speeds)
        v, w = true.v / self._actuation.wheel_radius, true.w / self._actuation.wheel_radius
        return Twist2D(v, w * self._actuation.track_width)

    def _count(self, state: RobotState) -> None:
        """Integrate the odometry with the believed wheels."""
        drive = self._sim.robot.drive
        radius = drive.wheel_radius / self._actuation.wheel_radius
        track = drive.track_width / self._actuation.track_width
        positions = (state.wheel_positions.left, state.wheel_positions.right)
        left, right = (radius * (now - before) for now, before in zip(positions, self._wheels, strict=True))
        self._wheels = positions
        here = self._odometry
        x, y, yaw = integrate_twist(here.x, here.y, here.yaw, (left + right) / 2.0, (right - left) / track, 1.0)
        self._odometry = Pose2D(float(x), float(y), wrap_angle(float(yaw)))
