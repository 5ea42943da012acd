"""`KinematicSimulator`: the robot moves exactly as commanded; the reference for other simulators."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D, Twist2D, arc_shares
from trundle.geometry.solids import Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.footprint import FootprintChecker
from trundle.sim.lidar import LidarChoice, LidarSet, SceneBeams
from trundle.sim.movers import MoverField
from trundle.sim.ramp import CommandRamp, Motion, count_steps
from trundle.sim.simulator import Simulator
from trundle.sim.state import Contact, RobotState, Substep
from trundle.worlds import World

TIMESTEP = 0.005
"""Timestep [s]: the same as the physics engine's, so that limits have the same effect."""

_NOT_PLACED = Pose2D(0.0, 0.0)


class KinematicSimulator(Simulator):
    """Simulates an ideal robot: no slip, no lag, every arc integrated exactly.

    The robot's limits are applied at every step. If the footprint overlaps a solid, a contact is reported and the
    robot drives through it: the mission decides how to react to a contact. Solids count if they overlap
    the range between the robot's clearance and its height, meshes as their convex hulls.

    Args:
        world: The world.
        robot: The robot.
        lidar: Lidars to simulate: all of the robot's, none, or those named.
        timestep: Length of a step [s].

    Attributes:
        on_substep: Called with a `Substep` after every physics step; None by default.

    Raises:
        InputError: If the timestep is out of range.
        UnknownNameError: If the robot has no lidar of a chosen name.
    """

    def __init__(self, world: World, robot: Robot, *, lidar: LidarChoice = False, timestep: float = TIMESTEP) -> None:
        if not 0.0 < timestep <= 1.0:
            raise InputError(f"timestep {timestep} s is out of range; use more than 0 and at most 1")
        self._robot = robot
        self._world = self._first_world = world
        self._timestep = timestep
        self._period = math.nan, 0  # the last one [s], and its number of steps
        self._ramp = CommandRamp(robot, timestep)
        self._footprint = FootprintChecker(world, robot)
        self._movers = MoverField(world, robot) if world.movers else None
        self._beams = SceneBeams(world, self._movers)
        self._lidars = LidarSet(robot, lidar, self._beams.cast)
        self._has_lidars = bool(self._lidars.heights)
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
        """Put a solid into the world until the next reset.

        Raises:
            WorldError: If the world has a solid or a mover of that name.
        """
        self._check_open()
        self._change_world(replace(self._world, solids=(*self._world.solids, solid)))

    def _change_world(self, world: World) -> None:
        self._footprint = FootprintChecker(world, self._robot)
        self._beams.change_world(world)
        self._world = world

    def reset(self, pose: Pose2D, *, seed: int = 0) -> RobotState:
        """Put the robot at rest at `pose` (map frame) and set the time to 0. The same seed gives the same run."""
        self._check_open()
        pose = Pose2D.of(pose)
        if self._world is not self._first_world:
            self._change_world(self._first_world)
        self._lidars.reset(seed)
        self._ramp.reset()
        self._steps = 0
        self._pose = pose.as_tuple()
        self._T_odom_map = _NOT_PLACED
        self._wheels = (0.0, 0.0)
        if self._movers is not None:
            self._movers.reset(seed, pose)
        touched = {} if self._movers is None else {each.other: each for each in self._movers.touching(pose)}
        return self._state(Motion(0.0, 0.0, 0.0, 0.0), [self._pose], touched, since=-1.0)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot at rest at `pose` (map frame); time, wheels and odometry stay as they are.

        Raises:
            SimulationError: If it was closed.
        """
        self._check_open()
        pose = Pose2D.of(pose)
        self._T_odom_map = self._odometry @ pose.inverse()
        self._pose = pose.as_tuple()
        self._ramp.reset()
        touched = {} if self._movers is None else {each.other: each for each in self._movers.touching(pose)}
        now = self._steps * self._timestep
        return self._state(Motion(0.0, 0.0, 0.0, 0.0), [self._pose], touched, since=now)

    def step(self, command: Twist2D, dt: float) -> RobotState:
        """Drive one control period of `dt` [s], a multiple of the timestep, with a commanded twist.

        Raises:
            SimulationError: If it was closed.
            InputError: If `dt` is not a multiple of the timestep.
        """
        self._check_open()
        since = self._steps * self._timestep
        if dt != self._period[0]:
            self._period = dt, count_steps(dt, self._timestep)
        motions = self._ramp.advance(command, self._period[1])
        poses: list[tuple[float, float, float]] = []
        cosine, sine, timestep = math.cos, math.sin, self._timestep
        x, y, yaw = self._pose
        left, right = self._wheels
        last: Motion | None = None
        length = turn = along = across = by_left = by_right = 0.0
        for motion in motions:
            if motion is not last:  # a constant motion is one object, and its arcs are alike
                last = motion
                v, w, left_speed, right_speed = motion
                length, turn, by_left, by_right = (
                    v * timestep,
                    w * timestep,
                    left_speed * timestep,
                    right_speed * timestep,
                )
                along, across = arc_shares(turn)
            cos, sin = cosine(yaw), sine(yaw)
            x += length * (cos * along - sin * across)
            y += length * (sin * along + cos * across)
            yaw += turn
            left += by_left
            right += by_right
            poses.append((x, y, yaw))
        if self.on_substep is not None:
            self._report_substeps(self.on_substep, poses, motions)
        touched = {} if self._movers is None else self._pass_movers(self._movers, poses, motions)
        self._pose, self._wheels = (x, y, yaw), (left, right)
        self._steps += len(motions)
        return self._state(motions[-1], poses, touched, since)

    def _report_substeps(
        self, report: Callable[[Substep], None], poses: list[tuple[float, float, float]], motions: Sequence[Motion]
    ) -> None:
        left, right = self._wheels
        for number, ((x, y, yaw), motion) in enumerate(zip(poses, motions, strict=True), self._steps + 1):
            pose = Pose2D(x, y, math.remainder(yaw, math.tau))
            left += motion.left * self._timestep
            right += motion.right * self._timestep
            positions, speeds = WheelSpeeds(left, right), WheelSpeeds(motion.left, motion.right)
            report(Substep(number * self._timestep, pose, Twist2D(motion.v, motion.w), positions, speeds))

    def close(self) -> None:
        """Close it; closing twice does nothing."""
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise SimulationError("this simulator was closed; make a new one with trundle.simulate")

    def _pass_movers(
        self, field: MoverField, poses: list[tuple[float, float, float]], motions: Sequence[Motion]
    ) -> dict[str, Contact]:
        """Move the movers along with the robot, and find the first contact with each of them."""
        touched = dict[str, Contact]()
        for index, (place, motion) in enumerate(zip(poses, motions, strict=True)):
            pose = Pose2D(place[0], place[1], math.remainder(place[2], math.tau))
            field.advance((self._steps + index + 1) * self._timestep, lambda at=(pose, motion.v): at)
            for contact in field.touching(pose):
                touched.setdefault(contact.other, contact)
        return touched

    @property
    def _odometry(self) -> Pose2D:
        """What wheels that never slip measure: the pose, but for where the robot was placed."""
        pose = Pose2D(self._pose[0], self._pose[1], math.remainder(self._pose[2], math.tau))
        return self._odometry_at(pose)

    def _odometry_at(self, pose: Pose2D) -> Pose2D:
        return pose if self._T_odom_map is _NOT_PLACED else self._T_odom_map @ pose

    def _state(
        self, motion: Motion, poses: list[tuple[float, float, float]], touched: dict[str, Contact], since: float
    ) -> RobotState:
        time = self._steps * self._timestep
        pose = Pose2D(self._pose[0], self._pose[1], math.remainder(self._pose[2], math.tau))
        return RobotState(
            time=time,
            pose=pose,
            twist=Twist2D(motion.v, motion.w),
            wheel_positions=WheelSpeeds(*self._wheels),
            wheel_speeds=WheelSpeeds(motion.left, motion.right),
            odometry=self._odometry_at(pose),
            contacts=(*self._footprint.find(poses), *touched.values()),
            scans=self._lidars.scan(pose, since, time) if self._has_lidars else (),
            movers=() if self._movers is None else self._movers.states(),
        )
