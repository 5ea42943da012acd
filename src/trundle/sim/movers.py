"""`MoverField`: the movers of a world while a simulator runs: where they are, what they touch, what lidars see."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from trundle._core import cast_outline_rays
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.robots import Robot
from trundle.sim.beams import WorldOutline
from trundle.sim.footprint import FootprintChecker
from trundle.sim.mover_checks import warn_of_motions, warn_of_start
from trundle.sim.simulator import Contact, MoverState
from trundle.worlds import World
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.interaction import RobotMotion
from trundle.worlds.movers.mover import Mover, outline_of
from trundle.worlds.movers.walk import CrowdWalk

RobotPose = Callable[[], tuple[Pose2D, float]]
"""The robot's pose, map frame, and its forward speed [m/s]."""


class MoverField:
    """The movers of a world. The same seed, and the same poses of the robot, give the same motions.

    Args:
        world: The world.
        robot: The robot.

    Raises:
        WorldError: If there is no room for a crowd.

    Warns:
        WorldWarning: If a motion leaves the world or passes through a solid; the message names it, when and where.
    """

    def __init__(self, world: World, robot: Robot) -> None:
        self._robot = robot
        self._movers = [mover for mover in world.movers if isinstance(mover, Mover)]
        crowds = [crowd for crowd in world.movers if isinstance(crowd, Crowd)]
        self._walk = CrowdWalk(crowds, self._movers, world.solids) if crowds else None
        self.names = [mover.name for mover in self._movers] + (self._walk.names if self._walk else [])
        self.bodies = [mover.parts for mover in self._movers] + [crowd.body for crowd in crowds]
        """The solids of each kind of mover."""
        kinds = list(range(len(self._movers)))
        kinds += [len(kinds) + index for index, crowd in enumerate(crowds) for _ in range(crowd.count)]
        self.kinds = kinds
        """Of each mover, the index of its solids in `bodies`."""
        outlines = [outline_of(body) for body in self.bodies]
        corners = [tuple((x, y) for x, y in outline.round(6).tolist()) for outline in outlines]
        reach = [float(np.hypot(outline[:, 0], outline[:, 1]).max()) for outline in outlines]
        self._outlines, self._reach = [corners[kind] for kind in kinds], np.array([reach[kind] for kind in kinds])
        self._checkers: list[FootprintChecker | None] = [None] * len(self.bodies)
        self.state = np.zeros((len(self.names), 6))
        """(x, y, yaw, vx, vy, w) of each now, map frame, shape (M, 6)."""
        warn_of_motions(world, self._movers)

    def reset(self, seed: int, pose: Pose2D) -> None:
        """Start from a seed, with the robot at a pose.

        Raises:
            WorldError: If there is no room for a crowd beside the robot.

        Warns:
            WorldWarning: If a mover starts on the robot.
        """
        if self._walk is not None:
            self._walk.reset(seed, self._robot_at(pose, 0.0))
        self.advance(0.0, lambda: (pose, 0.0))
        warn_of_start(self._movers, self.touching(pose))

    def advance(self, time: float, robot: RobotPose) -> FloatArray:
        """Move them to a time since the reset [s], which is not before the last one, and return `state`."""
        count = len(self._movers)
        for index, mover in enumerate(self._movers):
            self.state[index] = mover.motion.at(time)
        if self._walk is not None:
            motion = self._robot_at(*robot()) if self._walk.is_due(time) else None
            self.state[count:] = self._walk.at(time, motion)
        return self.state

    def states(self) -> tuple[MoverState, ...]:
        """What a `RobotState` says of them."""
        return tuple(
            MoverState(name, Pose2D(x, y, wrap_angle(yaw)), vx, vy, w, outline)
            for name, (x, y, yaw, vx, vy, w), outline in zip(
                self.names, self.state.tolist(), self._outlines, strict=True
            )
        )

    def touching(self, pose: Pose2D) -> list[Contact]:
        """Contacts of the robot's footprint, from its clearance to its height, with movers now; one per mover."""
        offset = self.state[:, :2] - (pose.x, pose.y)
        near = np.hypot(offset[:, 0], offset[:, 1]) < self._reach + self._robot.circumscribed_radius
        contacts: list[Contact] = []
        for index in np.flatnonzero(near):
            mover_x, mover_y, yaw = self.state[index, :3].tolist()
            frame = Pose2D(mover_x, mover_y, wrap_angle(yaw))
            local = frame.inverse() @ pose
            found = self._checker(self.kinds[index]).find(np.array([local.as_tuple()]))
            if found:
                (x, y) = frame.transform_points([(found[0].x, found[0].y)])[0].tolist()
                contacts.append(Contact(found[0].part, self.names[index], x, y))
        return contacts

    def _checker(self, kind: int) -> FootprintChecker:
        checker = self._checkers[kind]
        if checker is None:
            checker = self._checkers[kind] = FootprintChecker(World("mover", self.bodies[kind]), self._robot)
        return checker

    def _robot_at(self, pose: Pose2D, speed: float) -> RobotMotion:
        across, along = speed * math.sin(pose.yaw), speed * math.cos(pose.yaw)
        return RobotMotion(pose.x, pose.y, along, across, self._robot.circumscribed_radius)


class MoverOutline:
    """Movers cut at one height.

    Args:
        field: The movers.
        height: Of the cut above the floor [m].
    """

    def __init__(self, field: MoverField, height: float) -> None:
        self._field = field
        cuts = [WorldOutline(World("mover", body), height) for body in field.bodies]
        self._segments, self._of_segment = _gather([cuts[kind].segments for kind in field.kinds], 4)
        self._discs, self._of_disc = _gather([cuts[kind].discs for kind in field.kinds], 3)

    def placed(self) -> tuple[FloatArray, FloatArray]:
        """Segments (x0, y0, x1, y1), shape (S, 4), and discs (x, y, radius), shape (D, 3) [m], map frame, now."""
        state = self._field.state
        cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
        segments, discs = np.empty_like(self._segments), self._discs.copy()
        for local, owner, out, column in (
            (self._segments, self._of_segment, segments, 0),
            (self._segments, self._of_segment, segments, 2),
            (self._discs, self._of_disc, discs, 0),
        ):
            x, y, c, s = local[:, column], local[:, column + 1], cos[owner], sin[owner]
            out[:, column] = state[owner, 0] + c * x - s * y
            out[:, column + 1] = state[owner, 1] + s * x + c * y
        return segments, discs

    def cast(self, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
        """Distances [m] from (x, y) along `angles` [rad], evenly spaced and ascending; infinity beyond `reach` [m]."""
        count = len(angles)
        step = float(angles[-1] - angles[0]) / (count - 1) if count > 1 else 1.0
        return cast_outline_rays(*self.placed(), x, y, float(angles[0]), step, count, reach)


def _gather(parts: Sequence[FloatArray], width: int) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    owners = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return np.vstack([np.empty((0, width)), *parts]), owners
