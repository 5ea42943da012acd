"""`FollowedPath`: a path, and where the robot is on it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import Pose2D, arc_lengths
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
        self.index += int((dx * dx + dy * dy).argmin())

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

    def gap_m(self, hit: PathHit, pose: Pose2D) -> float:
        """How far ahead of the robot a hit is [m]: along the path, or straight, where the robot has backed up."""
        along_m = hit.along - float(self.check.along[self.index])
        return max(along_m, pose.distance_to(Pose2D(*hit.pose)))

    def cost_from(self, costmap: Costmap, pose: Pose2D) -> float:
        """Cost of the remaining path from the robot's pose on, as of `PathCheck.cost_from`."""
        x, y, _ = self.check.poses[self.index].tolist()
        return self.check.cost_from(costmap, self.index) + pose.distance_to(Pose2D(x, y))
