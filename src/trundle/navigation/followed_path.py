"""`FollowedPath`, a path and where the robot is on it; `join_legs`, one path through several goals."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, arc_lengths, wrap_angle
from trundle.path import Path
from trundle.planning import PathCheck, PathHit

_AHEAD_M = 1.0  # length of path in which the robot's position on it is searched
_BESIDE_M = 0.5  # a robot that is so far from it has left it


class FollowedPath:
    """A path that is followed from its beginning.

    Args:
        planned: As the planner gave it.
        path: As it is driven.
        joints: Indices of the poses of `path` at the goals that it leads through.

    Attributes:
        planned: The same.
        path: The same.
        check: Of `path`.
        index: Of the checked pose at which the robot is.
        marks: How far along the path the goals are that it leads through [m], those that were not passed yet.
    """

    def __init__(self, planned: Path, path: Path, joints: Sequence[int] = ()) -> None:
        self.planned, self.path, self.check, self.index = planned, path, PathCheck(path), 0
        self.marks: list[float] = arc_lengths(path.poses)[list(joints)].tolist() if joints else []

    @property
    def left_m(self) -> float:
        """How much of it is left [m]."""
        return float(self.check.along[-1] - self.check.along[self.index])

    @property
    def rest(self) -> Path:
        """What is left of the path, from where the robot is on it."""
        poses, along = self.path.poses, arc_lengths(self.path.poses)
        begin = int(along.searchsorted(float(self.check.along[self.index]), side="right"))
        if begin == 0:
            return self.path
        begin = min(begin, len(poses) - 1)
        here = self.check.poses[self.index][None, :]
        return Path(
            np.concatenate([here, poses[begin:]]), planner=self.path.planner, backward=self.path.backward[begin - 1 :]
        )

    def advance(self, pose: Pose2D) -> None:
        """Find the robot's place on it, from the last one on."""
        along, poses = self.check.along, self.check.poses
        end = int(along.searchsorted(float(along[self.index]) + _AHEAD_M, side="right"))
        dx, dy = poses[self.index : end, 0] - pose.x, poses[self.index : end, 1] - pose.y
        self.index += int(np.argmin(dx * dx + dy * dy))

    def left_from(self, pose: Pose2D) -> float:
        """How much of it is left from here [m], where the robot has left it and come back to it farther along."""
        poses, along = self.check.poses[self.index :], self.check.along
        distances = np.hypot(poses[:, 0] - pose.x, poses[:, 1] - pose.y)
        nearest = int(np.argmin(distances))
        if distances[0] <= _BESIDE_M or distances[nearest] > _BESIDE_M:
            return self.left_m
        return float(along[-1] - along[self.index + nearest])

    def pass_mark(self) -> None:
        """The robot has passed the next goal that it leads through: it is as far along, even where it cut a corner."""
        if self.marks:
            self.index = max(self.index, int(self.check.along.searchsorted(self.marks[0] - 1e-9)))
            self.index = min(self.index, len(self.check.along) - 1)
        self.marks = self.marks[1:]

    def has_missed(self, within_m: float) -> bool:
        """Whether the robot is farther along than the next goal that it was to pass, by more than that [m]."""
        return bool(self.marks) and float(self.check.along[self.index]) > self.marks[0] + within_m

    def first_hit(self, costmap: Costmap) -> PathHit | None:
        """Where the footprint would first touch something on what is left; None if it would not."""
        return self.check.first_hit(costmap, self.index)

    def cost_from(self, costmap: Costmap, pose: Pose2D) -> float:
        """Cost of the remaining path from the robot's pose on, as of `PathCheck.cost_from`."""
        x, y, _ = self.check.poses[self.index].tolist()
        return self.check.cost_from(costmap, self.index) + pose.distance_to(Pose2D(x, y))


_SAME_PLACE_M = 1e-6
_ROUNDED_RAD = (math.radians(15.0), math.radians(150.0))
"""Bends at a pose that are rounded: a smaller one is driven as it is, and a larger one is turned back."""
_PIECE_RAD = math.radians(15.0)
_LONGEST_CUT_M = 1.0


def join_legs(legs: Sequence[Path], costmap: Costmap, within_m: float) -> tuple[Path, tuple[int, ...]]:
    """Join paths, each from where the one before ends, to one that is driven without stopping between them.

    Turns in place between two legs are left out: the robot need not have the yaw of a pose that it drives through. A
    sharp bend there is rounded, as far as the path then still passes within `within_m` of the pose and the robot fits.

    Args:
        legs: The paths.
        costmap: Where they lead.
        within_m: How far from the poses between them the path may pass [m].

    Returns:
        The path, and the index of its pose at each place where two legs meet, or nearest to it.
    """
    if len(legs) == 1:
        return legs[0], ()
    parts = [_without_turns(leg, start=k > 0, end=k < len(legs) - 1) for k, leg in enumerate(legs)]
    poses, backward = parts[0]
    joints: list[int] = []
    for after, behind in parts[1:]:
        arc = _arc(poses, after, within_m) if not (backward[-1:].any() or behind[:1].any()) else None
        if arc is not None and _is_free(poses[-2], arc, after[1], costmap):
            joints.append(len(poses) - 1 + len(arc) // 2)
            poses = np.concatenate([poses[:-1], arc, after[1:]])
            backward = np.concatenate([backward, np.zeros(len(arc) - 1, np.bool_), behind])
        else:
            joints.append(len(poses) - 1)
            poses = np.concatenate([poses, after])
            backward = np.concatenate([backward, [False], behind])
    names = dict.fromkeys(leg.planner for leg in legs)
    joined = replace(
        legs[-1],
        poses=poses,
        backward=backward,
        cost=math.fsum(leg.cost for leg in legs),
        planner="+".join(names),
        replans=sum(leg.replans for leg in legs),
        start_snapped_m=legs[0].start_snapped_m,
    )
    return joined, tuple(joints)


def _without_turns(leg: Path, *, start: bool, end: bool) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Poses and directions of a leg, without the turns in place at its start or its end."""
    poses, backward = leg.poses, leg.backward
    first, last = 0, len(poses) - 1
    while start and first < last and math.dist(poses[first + 1, :2], poses[0, :2]) <= _SAME_PLACE_M:
        first += 1
    while end and last > first and math.dist(poses[last - 1, :2], poses[-1, :2]) <= _SAME_PLACE_M:
        last -= 1
    return poses[first : last + 1], backward[first:last]


def _arc(before: FloatArray, after: FloatArray, within_m: float) -> FloatArray | None:
    """Poses of the arc that rounds the bend between two legs; None where there is none to round."""
    if len(before) < 2 or len(after) < 2 or within_m <= 0.0:
        return None
    corner = after[0, :2]
    into, out = corner - before[-2, :2], after[1, :2] - corner
    lengths = float(np.hypot(*into)), float(np.hypot(*out))
    if min(lengths) <= _SAME_PLACE_M:
        return None
    heading = math.atan2(into[1], into[0])
    bend = wrap_angle(math.atan2(out[1], out[0]) - heading)
    least, most = _ROUNDED_RAD
    if not least < abs(bend) < most:
        return None
    half = 0.5 * abs(bend)
    farthest = within_m / (1.0 / math.cos(half) - 1.0)  # the radius of which the arc passes so far from the corner
    radius = min(min(*lengths, _LONGEST_CUT_M) / math.tan(half), farthest)
    begin = corner - radius * math.tan(half) * into / lengths[0]
    side = math.copysign(1.0, bend)
    centre = begin + side * radius * np.array([-math.sin(heading), math.cos(heading)])
    yaws = heading + np.linspace(0.0, bend, math.ceil(abs(bend) / _PIECE_RAD) + 1)
    x, y = centre[0] + side * radius * np.sin(yaws), centre[1] - side * radius * np.cos(yaws)
    return np.column_stack([x, y, yaws])


def _is_free(before: FloatArray, arc: FloatArray, after: FloatArray, costmap: Costmap) -> bool:
    return PathCheck(Path(np.vstack([before, arc, after]))).first_hit(costmap) is None
