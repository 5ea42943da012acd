"""A simulator: the kinematic one, with tyres so worn that odometry overestimates the distance."""

from __future__ import annotations

from dataclasses import replace

from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim import RobotState
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World


class WornTyresSimulator(KinematicSimulator):
    """Odometry that is too long by a share of the distance."""

    def __init__(self, world: World, robot: Robot, *, wear: float = 0.02) -> None:
        self._wear = wear
        super().__init__(world, robot)

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        self._start = pose
        return self._worn(super().reset(pose, seed=seed))

    def step(self, command: Twist2D, dt: float) -> RobotState:
        return self._worn(super().step(command, dt))

    def _worn(self, state: RobotState) -> RobotState:
        odometry, start = state.odometry, self._start
        x = start.x + (odometry.x - start.x) * (1.0 + self._wear)
        y = start.y + (odometry.y - start.y) * (1.0 + self._wear)
        return replace(state, odometry=Pose2D(x, y, odometry.yaw))
