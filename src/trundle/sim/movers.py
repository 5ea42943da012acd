"""`MoverField`: the movers of a world while a simulator runs: where they are, what they touch, what lidars see.

It warns of motions that leave the world, pass through solids, or start on the robot.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from trundle._core import cast_outline_rays
from trundle.errors import WorldWarning
from trundle.geometry import FloatArray, Footprint, Pose2D, wrap_angle
from trundle.robots import Robot
from trundle.sim.beams import WorldOutline
from trundle.sim.footprint import FootprintChecker
from trundle.sim.state import Contact, MoverState
from trundle.worlds import World
from trundle.worlds.movers.crowd import Crowd
from trundle.worlds.movers.mover import Mover, outline_of, top_of
from trundle.worlds.movers.walk import CrowdWalk, RobotMotion

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
        """The index of each mover's solids in `bodies`."""
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
        """Return what a `RobotState` says of them."""
        return tuple(
            MoverState(name, Pose2D(x, y, wrap_angle(yaw)), vx, vy, w, outline)
            for name, (x, y, yaw, vx, vy, w), outline in zip(
                self.names, self.state.tolist(), self._outlines, strict=True
            )
        )

    def touching(self, pose: Pose2D) -> list[Contact]:
        """Return the contacts of the robot's footprint with movers, at most one each, at the heights of its body."""
        offset = self.state[:, :2] - (pose.x, pose.y)
        near = np.hypot(offset[:, 0], offset[:, 1]) < self._reach + self._robot.circumscribed_radius
        contacts: list[Contact] = []
        for index in np.flatnonzero(near):
            mover_x, mover_y, yaw = self.state[index, :3].tolist()
            frame = Pose2D(mover_x, mover_y, wrap_angle(yaw))
            local = frame.inverse() @ pose
            found = self._checker(self.kinds[index]).find([local.as_tuple()])
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
        height: Height of the cut above the floor [m].
    """

    def __init__(self, field: MoverField, height: float) -> None:
        self._field = field
        cuts = [WorldOutline(World("mover", body), height) for body in field.bodies]
        self._segments, self._of_segment = _gather([cuts[kind].segments for kind in field.kinds], 4)
        self._discs, self._of_disc = _gather([cuts[kind].discs for kind in field.kinds], 3)

    def placed(self) -> tuple[FloatArray, FloatArray]:
        """Return segments (x0, y0, x1, y1), shape (S, 4), and discs (x, y, r), shape (D, 3), [m], map frame, now."""
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


_STEP_S = 0.1
_MOST_STEPS = 2000
_LONGEST_S = 600.0
"""A motion is sampled in such steps, for ten minutes at most: making a simulator must not take long."""

_FLOOR_TOP = 0.05  # what is not higher is no obstacle [m]


def warn_of_motions(world: World, movers: Sequence[Mover]) -> None:
    """Warn once for every mover that leaves the world or passes through a solid, with when and where.

    Its motion is sampled ten times a second, over ten minutes at most.
    """
    if not world.solids:
        return
    low, high = world.bounds
    for mover in movers:
        if mover.may_cross:
            continue
        times = _times(mover)
        states = np.array([mover.motion.at(time) for time in times])
        text = _leaving(times, states, low, high) or _crossing(times, states, mover, world)
        if text:
            warnings.warn(f"the mover {mover.name!r} of the world {world.name!r} {text}", WorldWarning, stacklevel=4)


def warn_of_start(movers: Sequence[Mover], contacts: Sequence[Contact]) -> None:
    """Warn of movers that touch the robot at the start of a run."""
    names = {mover.name for mover in movers}
    for contact in contacts:
        if contact.other in names:
            warnings.warn(
                f"the mover {contact.other!r} is on the robot at 0 s, at ({contact.x:.2f}, {contact.y:.2f}); let it "
                "start elsewhere, or later",
                WorldWarning,
                stacklevel=4,
            )


def _times(mover: Mover) -> list[float]:
    last = min(mover.motion.duration, _LONGEST_S)
    count = min(_MOST_STEPS, max(1, math.ceil(last / _STEP_S)))
    return np.linspace(0.0, last, count + 1).tolist()


def _leaving(times: Sequence[float], states: FloatArray, low: FloatArray, high: FloatArray) -> str:
    outside = ((states[:, :2] < low[:2]) | (states[:, :2] > high[:2])).any(axis=1)
    if not outside.any():
        return ""
    first = int(np.argmax(outside))
    x, y = states[first, :2].tolist()
    does = "starts outside it" if first == 0 else "leaves it"
    return (
        f"{does} at {times[first]:.1f} s, at ({x:.2f}, {y:.2f}): its solids reach from ({low[0]:.2f}, {low[1]:.2f}) to "
        f"({high[0]:.2f}, {high[1]:.2f})"
    )


def _crossing(times: Sequence[float], states: FloatArray, mover: Mover, world: World) -> str:
    outline = outline_of(mover.parts)
    middle = outline.mean(axis=0)
    checker = FootprintChecker.of(world.solids, Footprint(outline - middle), _FLOOR_TOP, top_of(mover.parts))
    cos, sin = np.cos(states[:, 2]), np.sin(states[:, 2])
    poses = np.column_stack(
        [
            states[:, 0] + cos * middle[0] - sin * middle[1],
            states[:, 1] + sin * middle[0] + cos * middle[1],
            states[:, 2],
        ]
    )
    for time, pose in zip(times, poses, strict=True):
        found = checker.find(pose[None])
        if found:
            does = "starts in" if time == 0.0 else "passes through"
            return f"{does} {found[0].other!r} at {time:.1f} s, at ({pose[0]:.2f}, {pose[1]:.2f})"
    return ""
