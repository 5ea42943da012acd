"""`KinematicSimulator`: the robot moves exactly as commanded; the reference for other simulators."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from trundle import _core
from trundle.errors import InputError, SimulationError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.footprint import FootprintChecker
from trundle.sim.lidar import LidarChoice, LidarSet, SceneBeams
from trundle.sim.movers import MoverField
from trundle.sim.ramp import CommandRamp, count_steps
from trundle.sim.simulator import Simulator
from trundle.sim.state import Contact, RobotState, Substep
from trundle.worlds import World

TIMESTEP = 0.005
"""Timestep [s]: the same as the physics engine's, so that limits have the same effect."""

_NOT_PLACED = Pose2D(0.0, 0.0)
_AT_REST = (0.0,) * 6  # the ramp, the motion and the wheels' speeds, as of `drive_period`
_NUMBERS = 11


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
        self._limits = self._ramp.numbers
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
        self._steps = 0
        self._T_odom_map = _NOT_PLACED
        self._now = np.zeros(_NUMBERS)
        if self._movers is not None:
            self._movers.reset(seed, pose)
        return self._stand_at(pose, since=-1.0)

    def place(self, pose: Pose2D) -> RobotState:
        """Put the robot at rest at `pose` (map frame); time, wheels and odometry stay as they are.

        Raises:
            SimulationError: If it was closed.
        """
        self._check_open()
        pose = Pose2D.of(pose)
        x, y, yaw = self._now[:3].tolist()
        self._T_odom_map = self._T_odom_map @ Pose2D(x, y, math.remainder(yaw, math.tau)) @ pose.inverse()
        return self._stand_at(pose, since=self._steps * self._timestep)

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
        if type(command) is not Twist2D:
            command = self._ramp.clamp(command)
        steps = self._period[1]
        rows, bounds, is_cut = _core.drive_period(self._now, command.v, command.w, self._limits, steps)
        if is_cut:
            self._ramp.note_cut(command, rows[:, 5:7])
        if self.on_substep is not None:
            self._report_substeps(self.on_substep, rows)
        contacts = self._footprint.find_within(bounds, rows)
        if self._movers is not None:
            contacts += self._pass_movers(self._movers, rows)
        self._now = rows[-1]
        self._steps += steps
        return self._state(contacts, since)

    def _report_substeps(self, report: Callable[[Substep], None], rows: FloatArray) -> None:
        for number, row in enumerate(rows.tolist(), self._steps + 1):
            x, y, yaw, left, right, _, _, v, w, left_speed, right_speed = row
            pose = Pose2D(x, y, math.remainder(yaw, math.tau))
            positions, speeds = WheelSpeeds(left, right), WheelSpeeds(left_speed, right_speed)
            report(Substep(number * self._timestep, pose, Twist2D(v, w), positions, speeds))

    def close(self) -> None:
        """Close it; closing twice does nothing."""
        self._closed = True

    def _check_open(self) -> None:
        if self._closed:
            raise SimulationError("this simulator was closed; make a new one with trundle.simulate")

    def _pass_movers(self, field: MoverField, rows: FloatArray) -> tuple[Contact, ...]:
        """Move the movers along with the robot, and find the first contact with each of them."""
        touched = dict[str, Contact]()
        for number, (x, y, yaw, *_, v, _, _, _) in enumerate(rows.tolist(), self._steps + 1):
            pose = Pose2D(x, y, math.remainder(yaw, math.tau))
            field.advance(number * self._timestep, lambda at=(pose, v): at)
            for contact in field.touching(pose):
                touched.setdefault(contact.other, contact)
        return tuple(touched.values())

    def _stand_at(self, pose: Pose2D, since: float) -> RobotState:
        """Stand at a pose; the wheels stay as they are."""
        self._now = np.array([*pose.as_tuple(), *self._now[3:5], *_AT_REST])
        contacts = {} if self._movers is None else {each.other: each for each in self._movers.touching(pose)}
        x, y, yaw = pose.as_tuple()
        found = self._footprint.find_within((x, x, y, y), np.array([(x, y, yaw)]))
        return self._state((*found, *contacts.values()), since)

    def _state(self, contacts: tuple[Contact, ...], since: float) -> RobotState:
        time = self._steps * self._timestep
        x, y, yaw, left, right, _, _, v, w, left_speed, right_speed = self._now.tolist()
        pose = Pose2D(x, y, math.remainder(yaw, math.tau))
        return RobotState(
            time,
            pose,
            Twist2D(v, w),
            WheelSpeeds(left, right),
            WheelSpeeds(left_speed, right_speed),
            pose if self._T_odom_map is _NOT_PLACED else self._T_odom_map @ pose,
            contacts,
            self._lidars.scan(pose, since, time) if self._has_lidars else (),
            movers=() if self._movers is None else self._movers.states(),
        )
