"""`MujocoSimulator`: the robot as rigid bodies on wheels, with contacts, slip and inertia."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

import mujoco
import numpy as np

from trundle.errors import InputError, RobotError, SimulationError, WorldError
from trundle.files.model_spec import log_warnings
from trundle.geometry import FloatArray, Pose2D, Twist2D, integrate_twist, wrap_angle
from trundle.geometry.solids import Solid
from trundle.observation import Scan
from trundle.robots import Robot, WheelSpeeds
from trundle.robots.robot import describe_imbalance
from trundle.sim.lidar import LidarChoice, LidarSet, SceneBeams
from trundle.sim.movers import MoverField
from trundle.sim.mujoco.contacts import ContactReader
from trundle.sim.mujoco.model import TIMESTEP, build_spec, robot_spec, within_reach
from trundle.sim.mujoco.mover_bodies import MoverBodies
from trundle.sim.mujoco.robot_parts import FeedForward, scale_robot, traction_joints
from trundle.sim.ramp import CommandRamp, Motion, count_steps
from trundle.sim.simulator import Simulator
from trundle.sim.state import Contact, RobotState, Substep
from trundle.values import as_number, check_seed
from trundle.worlds import World

Casters = Literal["trailing", "reversed"]


_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_SETTLE_S = 2.0
"""A robot has come to rest on its wheels within this time [s], or has tipped over."""

_LARGEST_TILT = 0.05
"""Maximum tilt of a robot at rest [rad]; one that has tipped over exceeds it."""


class MujocoSimulator(Simulator):
    """Drives a robot through a world in MuJoCo.

    The limits of the robot are applied at every physics step; its wheels are velocity servos with torque
    feed-forward for acceleration. After a reset the robot is at rest on the floor, already settled.

    Args:
        world: The world.
        robot: The robot.
        lidar: Lidars to simulate: all of the robot's, none, or those named.
        timestep: Length of a physics step [s].
        casters: Direction of swivel casters after a reset: trailing for driving forward, or reversed.
        mass: True mass of the robot over the one that its servos are tuned for, 0.1 to 10.
        friction: Friction between the robot and everything else, relative to rubber on concrete, 0.05 to 5.

    Attributes:
        model: The compiled MuJoCo model, without the robot's visuals and solids out of reach. Viewers build their own.
        on_substep: Called with a `Substep` after every physics step; None by default.
        data: Its state, consistent with the result of `step`; treat it as read-only.

    Raises:
        InputError: If an option is out of range.
        RobotError: If the robot cannot be modelled, or tips over.
        WorldError: If the world cannot be modelled.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        lidar: LidarChoice = False,
        timestep: float = TIMESTEP,
        casters: Casters = "trailing",
        mass: float = 1.0,
        friction: float = 1.0,
    ) -> None:
        if not 0.0 < timestep <= 0.02:
            raise InputError(f"timestep {timestep} s is out of range; use more than 0 and at most 0.02")
        if casters not in ("trailing", "reversed"):
            raise InputError(f"casters {casters!r} is unknown; use 'trailing' or 'reversed'")
        for name, factor, least, most in (("mass", mass, 0.1, 10.0), ("friction", friction, 0.05, 5.0)):
            if not least <= as_number(factor, name) <= most:
                raise InputError(f"{name} must be a factor from {least:g} to {most:g}, got {factor}")
        log_warnings()
        self._robot = robot
        self._timestep = timestep
        self._mass, self._friction = mass, friction
        self._rest = _resting_state(robot, timestep, casters, mass=mass)
        self._ramp = CommandRamp(robot, timestep)
        self._field = MoverField(world, robot) if world.movers else None
        self._world = self._first_world = world
        self._model_world(world)
        # mj_multiRay tests every beam against every geom: with 800 solids that took 18 times as long.
        self._beams = SceneBeams(world, self._field)
        self._lidars = LidarSet(robot, lidar, self._beams.cast)
        self._beams.prepare(self._lidars.heights)
        self._closed = False
        self.on_substep: Callable[[Substep], None] | None = None
        self.reset(Pose2D(0.0, 0.0))

    @property
    def robot(self) -> Robot:
        """The simulated robot."""
        return self._robot

    @property
    def world(self) -> World:
        """The world, with what was added since the reset."""
        return self._world

    @property
    def timestep(self) -> float:
        """Length of a physics step [s]."""
        return self._timestep

    def watch_substeps(self, watch: Callable[[Substep], None] | None) -> bool:
        """Call `watch` after every physics step from now on, or no longer (None)."""
        self.on_substep = watch
        return True

    def add_solid(self, solid: Solid) -> None:
        """Put a solid into the world until the next reset: the model is built again, and its state stays.

        Raises:
            WorldError: If the world has a solid or a mover of that name, or MuJoCo cannot model it.
        """
        self._check_open()
        world = replace(self._world, solids=(*self._world.solids, solid))
        before, size = self.data, mujoco.mj_stateSize(self.model, _STATE)
        state = np.empty(size)
        mujoco.mj_getState(self.model, before, state, _STATE)
        movers = self._movers
        self._change_world(world)
        mujoco.mj_setState(self.model, self.data, state, _STATE)
        if self._movers is not None and movers is not None:
            self._movers.resume(movers)
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state, _STATE)

    def _change_world(self, world: World) -> None:
        self._model_world(world)
        self._beams.change_world(world)
        self._world = world

    def _model_world(self, world: World) -> None:
        """Build the model of a world and the robot, and what reads it."""
        robot = self._robot
        try:
            self.model = build_spec(within_reach(world, robot), robot, timestep=self._timestep, looks=False).compile()
        except InputError:
            raise
        except ValueError as error:
            raise WorldError(f"MuJoCo cannot model the world {world.name!r}: {error}") from error
        self.data = mujoco.MjData(self.model)
        self._wheel_qpos, self._wheel_qvel = _wheel_addresses(self.model, robot)
        self._feed_forward = FeedForward.of(self.model, robot)
        scale_robot(self.model, mass=self._mass, friction=self._friction)
        self._movers = None if self._field is None else MoverBodies(self.model, self.data, self._field)
        self._contacts = ContactReader(self.model, world, self._movers.names if self._movers else {})

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. The same seed gives the same run.

        A pose inside a solid is accepted; the state's contacts then name the solid.
        """
        self._check_open()
        pose, seed = Pose2D.of(pose), check_seed(seed)
        if self._world is not self._first_world:
            self._change_world(self._first_world)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._rest
        self._stand_at(pose)
        if self._movers is not None:
            self._movers.reset(seed, pose)
        mujoco.mj_forward(self.model, self.data)
        self._ramp.reset()
        self._lidars.reset(seed)
        self._steps = 0
        self._wheel_start = (float(self.data.qpos[self._wheel_qpos[0]]), float(self.data.qpos[self._wheel_qpos[1]]))
        self._odometry = (pose.x, pose.y, pose.yaw)
        self._commanded = Motion(0.0, 0.0, 0.0, 0.0)
        touched: dict[tuple[str, str], Contact] = {}
        self._contacts.read(self.data, touched)
        return self._state(tuple(touched.values()), since=-1.0)

    def _stand_at(self, pose: Pose2D) -> None:
        """Put the chassis on the floor at a pose; its joints stay as they are."""
        positions, half = self.data.qpos, pose.yaw / 2.0
        positions[0:2], positions[2] = (pose.x, pose.y), self._rest[2]
        turned = np.empty(4)
        mujoco.mju_mulQuat(turned, np.array([math.cos(half), 0.0, 0.0, math.sin(half)]), self._rest[3:7])
        positions[3:7] = turned

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot at rest at `pose` (map frame); time, wheels and odometry stay as they are.

        Raises:
            SimulationError: If it was closed.
        """
        self._check_open()
        self._stand_at(Pose2D.of(pose))
        self.data.qvel[:] = 0.0
        self.data.qacc_warmstart[:] = 0.0
        self._ramp.reset()
        self._commanded = Motion(0.0, 0.0, 0.0, 0.0)
        mujoco.mj_forward(self.model, self.data)
        touched: dict[tuple[str, str], Contact] = {}
        self._contacts.read(self.data, touched)
        return self._state(tuple(touched.values()), since=self._steps * self._timestep)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s], a multiple of the physics step, with a commanded twist.

        Raises:
            SimulationError: If it was closed, or the physics diverged.
            InputError: If `dt` is not a multiple of the physics step.
        """
        self._check_open()
        since = self._steps * self._timestep
        motions = self._ramp.advance(command, count_steps(dt, self._timestep))
        touched: dict[tuple[str, str], Contact] = {}
        model, data, control = self.model, self.data, self.data.ctrl
        qpos, qvel = data.qpos, data.qvel
        contact = data.contact  # A live view of the data; creating a new one costs as much as reading it.
        step, commanded = mujoco.mj_step, self._commanded
        left_address, right_address = self._wheel_qpos
        left_speed, right_speed = self._wheel_qvel
        drive, free = self._feed_forward, (0.0, 0.0)
        several = len(control) > 2  # passive wheels per side, which only rotate along
        angles: list[tuple[float, float]] = [(qpos[left_address], qpos[right_address])]
        steady = False
        movers, timestep, done = self._movers, self._timestep, self._steps
        if movers is not None:
            movers.set_speeds()
        for motion in motions:
            if motion is not commanded or not steady:
                free = drive.free(commanded, motion)
            if several and motion is not commanded:
                control[2::2], control[3::2] = motion.left, motion.right
            steady = motion is commanded
            control[0] = drive.held(free[0], commanded.left, qvel[left_speed])
            control[1] = drive.held(free[1], commanded.right, qvel[right_speed])
            commanded = motion
            step(model, data)
            done += 1
            if self.on_substep is not None:
                self.on_substep(self._substep(done * timestep))
            if movers is not None:
                movers.advance(done * timestep)
            angles.append((qpos[left_address], qpos[right_address]))
            # The floor is geom 0, and a plane comes first in its contacts: any other index is a collision.
            if any(contact.geom1.tolist()):
                self._contacts.read(data, touched)
                if movers is not None:
                    movers.let_pass()
        if movers is not None:
            for each in movers.passing_contacts():
                touched.setdefault((each.part, each.other), each)
        self._commanded = commanded
        self._steps += len(motions)
        self._integrate_odometry(angles)
        self._check_sound()
        return self._state(tuple(touched.values()), since)

    def _substep(self, time: float) -> Substep:
        """Return what watchers get after a physics step."""
        positions, speeds = self.data.qpos.tolist(), self.data.qvel.tolist()
        (left, right), (left_start, right_start) = self._wheel_qpos, self._wheel_start
        turned = WheelSpeeds(positions[left] - left_start, positions[right] - right_start)
        left, right = self._wheel_qvel
        return Substep(time, *_planar(positions, speeds), turned, WheelSpeeds(speeds[left], speeds[right]))

    def close(self) -> None:
        """Release the model; closing twice does nothing."""
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise SimulationError("this simulator was closed; make a new one with trundle.simulate")

    def _check_sound(self) -> None:
        # A sum that is NaN fails the comparison, too.
        if not (sum(map(abs, self.data.qvel.tolist())) < 1e4 and math.isfinite(sum(self.data.qpos.tolist()))):
            raise SimulationError(
                f"the physics diverged at {self._steps * self._timestep:.3f} s: a position is not finite or the "
                f"speeds are above 10000; use a smaller timestep than {self._timestep} s, and check the robot's masses"
            )

    def _integrate_odometry(self, angles: list[tuple[float, float]]) -> None:
        radius, track = self._robot.drive.wheel_radius, self._robot.drive.track_width
        x, y, yaw = self._odometry
        for (left, right), (next_left, next_right) in itertools.pairwise(angles):
            by_left, by_right = radius * (next_left - left), radius * (next_right - right)
            x, y, yaw = integrate_twist(x, y, yaw, (by_left + by_right) / 2.0, (by_right - by_left) / track, 1.0)
        self._odometry = (float(x), float(y), float(yaw))

    def _state(self, contacts: tuple[Contact, ...], since: float) -> RobotState:
        time = self._steps * self._timestep
        positions, speeds = self.data.qpos.tolist(), self.data.qvel.tolist()
        pose, twist = _planar(positions, speeds)
        (left, right), (left_start, right_start) = self._wheel_qpos, self._wheel_start
        left_speed, right_speed = self._wheel_qvel
        scans: tuple[Scan, ...] = self._lidars.scan(pose, since, time)
        wheel_speeds = WheelSpeeds(speeds[left_speed], speeds[right_speed])
        return RobotState(
            time=time,
            pose=pose,
            twist=twist,
            wheel_positions=WheelSpeeds(positions[left] - left_start, positions[right] - right_start),
            wheel_speeds=wheel_speeds,
            odometry=Pose2D(self._odometry[0], self._odometry[1], wrap_angle(self._odometry[2])),
            contacts=contacts,
            scans=scans,
            odometry_twist=self._robot.twist(wheel_speeds),
            movers=() if self._movers is None else self._movers.field.states(),
            tilt=_tilt(positions),
        )


def _planar(positions: list[float], speeds: list[float]) -> tuple[Pose2D, Twist2D]:
    """Return the pose and twist of the base, from the positions and speeds of all joints."""
    x, y, _, qw, qx, qy, qz = positions[:7]
    pose = Pose2D(x, y, math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz)))
    vx, vy, _, _, _, w = speeds[:6]
    return pose, Twist2D(vx * math.cos(pose.yaw) + vy * math.sin(pose.yaw), w)


def _tilt(positions: list[float]) -> float:
    """Return the angle of the base's z axis from the vertical [rad], from the positions of all joints."""
    _, qx, qy, _ = positions[3:7]
    return math.acos(max(-1.0, 1.0 - 2.0 * (qx * qx + qy * qy)))


def _wheel_addresses(model: mujoco.MjModel, robot: Robot) -> tuple[tuple[int, int], tuple[int, int]]:
    joints = [model.joint(name) for name in traction_joints(robot)]
    left, right = joints
    return (int(left.qposadr[0]), int(right.qposadr[0])), (int(left.dofadr[0]), int(right.dofadr[0]))


def check_stands(robot: Robot) -> None:
    """Check that a robot is stable on its wheels and casters.

    Raises:
        RobotError: If it tips over, or MuJoCo cannot model it.
    """
    _resting_state(robot, TIMESTEP, "trailing")


def _resting_state(robot: Robot, timestep: float, casters: Casters, *, mass: float = 1.0) -> FloatArray:
    """Return joint positions of the robot after it has settled on an empty floor, at the origin facing x.

    Raises:
        RobotError: If it cannot be modelled, or does not come to rest on its wheels.
    """
    try:
        model = robot_spec(robot, floor=True, timestep=timestep, looks=False).compile()
    except ValueError as error:
        raise RobotError(f"MuJoCo cannot model the robot {robot.name!r}: {error}") from error
    scale_robot(model, mass=mass)
    data = mujoco.MjData(model)
    if casters == "reversed":
        for caster in robot.casters:
            if caster.swivel_joint is not None:
                data.qpos[model.joint(caster.swivel_joint).qposadr[0]] = math.pi
    start = data.qpos.copy()
    for _ in range(round(_SETTLE_S / timestep)):
        mujoco.mj_step(model, data)
    rest = data.qpos.copy()
    if not (np.isfinite(rest).all() and _tilt(rest.tolist()) < _LARGEST_TILT):
        raise RobotError(describe_imbalance(robot))
    # Settling determines height, roll and pitch; everything else starts at its given value.
    height = rest[2]
    tilt = np.array([rest[3], rest[4], rest[5], 0.0])
    start[2] = height
    start[3:7] = tilt / np.linalg.norm(tilt)
    return start
