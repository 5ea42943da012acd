"""Where a robot is on its path, `FollowedPath`, and whether it advances.

`BlockWatch` and `PathProgress` say whether it makes progress, `Retries` how often it tries again where it makes none.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D, arc_lengths
from trundle.path import Path
from trundle.planning import PathCheck, PathHit

_AHEAD_M = 1.0  # length of path in which the robot's position on it is searched
_BESIDE_M = 0.5  # a robot that is so far from it has left it


class FollowedPath:
    """A path that is followed from its beginning.

    Args:
        planned: The path as the planner gave it.
        path: The path as it is driven.
        joints: Indices of the poses of `path` at the goals that it leads through.

    Attributes:
        planned: The same.
        path: The same.
        check: Checks `path` for collisions.
        index: Index of the checked pose at which the robot is.
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
        """Return how much of the path is left [m] for a robot that left it and came back to it farther along."""
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
        """Return whether the robot is farther along than the next goal that it was to pass, by more than that [m]."""
        return bool(self.marks) and float(self.check.along[self.index]) > self.marks[0] + within_m

    def first_hit(self, costmap: Costmap) -> PathHit | None:
        """Return where the footprint would first touch something on what is left; None if it would not."""
        return self.check.first_hit(costmap, self.index)

    def gap_m(self, hit: PathHit, pose: Pose2D) -> float:
        """Return how far ahead of the robot a hit is [m]: along the path, or straight if the robot has backed up."""
        along_m = hit.along - float(self.check.along[self.index])
        return max(along_m, pose.distance_to(Pose2D(*hit.pose)))

    def cost_from(self, costmap: Costmap, pose: Pose2D) -> float:
        """Return the cost of the remaining path from the robot's pose on, as of `PathCheck.cost_from`."""
        x, y, _ = self.check.poses[self.index].tolist()
        return self.check.cost_from(costmap, self.index) + pose.distance_to(Pose2D(x, y))


RETRIES = 6
"""The number in Nav2's default behavior tree (`NavigateRecovery`)."""
_PROGRESS_M = 0.5  # Nav2's required_movement_radius; more than the robot backs up


class Retries:
    """A blocked robot tries again up to a number of times in a row.

    Nav2 counts until the goal is reached. Here the count restarts once the robot has made progress: once 0.5 m less of
    its path is left than at any place where it was blocked before. So people may step into a long path many times, and
    a robot that only comes back gives up.

    Args:
        dt: Control period [s].
        most: How often it tries in a row.

    Attributes:
        count: Number of tries since there was progress.
    """

    def __init__(self, dt: float, most: int = RETRIES) -> None:
        self._watch = BlockWatch(dt)
        self._most = most
        self.reset()

    def reset(self) -> None:
        """Start over."""
        self._watch.reset()
        self.count = 0
        self._least_left = math.inf

    def is_blocked(self, command: Twist2D, twist: Twist2D, left_m: float) -> bool:
        """Return whether the robot is blocked, by its command, its twist and the remaining path length [m]."""
        if left_m < self._least_left - _PROGRESS_M:
            self.count = 0
        return self._watch.is_blocked(command, twist)

    def try_again(self, left_m: float) -> bool:
        """Return whether to try again when blocked with this remaining path length [m], or to give up."""
        self._least_left = min(self._least_left, left_m)
        if self.count == self._most:
            return False
        self.count += 1
        return True


_AFTER_S = 0.5
_AT_LATEST_S = 2.0  # for a robot that does not do what it is told: some are slow to start
_DISTANCE_M, _ANGLE_RAD = 0.005, 0.01
"""Less counts as standing; not only exactly 0, as a controller may answer 1e-4 m/s for ever."""


class BlockWatch:
    """A robot is blocked that moves by less than 5 mm and turns by less than 0.01 rad in half a second.

    If its commands ask for more than that, it has two seconds, as some robots are slow to start. Turning back and forth
    does not count: the signed angles must add up to more than half of the unsigned ones.

    The distance is integrated from the robot's twist. Poses may be noisy, and the noise of a robot that stands still
    adds up to more than 5 mm.

    Args:
        dt: Control period [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._driven, self._turned = _Sum(), _Sum()
        self._asked_driven, self._asked_turned = _Sum(), _Sum()
        self.reset()

    def reset(self) -> None:
        """Start over from here."""
        self._seconds = 0.0
        for total in (self._driven, self._turned, self._asked_driven, self._asked_turned):
            total.reset()

    def is_blocked(self, command: Twist2D, twist: Twist2D) -> bool:
        """Return whether the robot has made no progress, given one more command and its twist meanwhile."""
        self._seconds += self._dt
        self._driven.add(twist.v * self._dt)
        if self._driven.farthest >= _DISTANCE_M:
            self.reset()
            return False
        self._turned.add(twist.w * self._dt)
        self._asked_driven.add(command.v * self._dt)
        self._asked_turned.add(command.w * self._dt)
        if self._seconds < _AFTER_S - 1e-9:
            return False
        turns = self._turned.leads_on
        asked = self._asked_driven.farthest >= _DISTANCE_M or self._asked_turned.leads_on
        if not turns and asked and self._seconds < _AT_LATEST_S - 1e-9:
            return False
        self.reset()
        return not turns


class _Sum:
    """Distances [m] or angles [rad], one after the other.

    Attributes:
        farthest: The largest that their sum has been, without its sign.
    """

    __slots__ = ("_total", "_unsigned", "farthest")

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Start over from 0."""
        self.farthest = self._total = self._unsigned = 0.0

    def add(self, part: float) -> None:
        """Add one."""
        self._total += part
        self._unsigned += abs(part)
        if abs(self._total) > self.farthest:
            self.farthest = abs(self._total)

    @property
    def leads_on(self) -> bool:
        """Whether these angles add up to a turn, and do not cancel each other out."""
        return abs(self._total) >= _ANGLE_RAD and abs(self._total) > 0.5 * self._unsigned


_GAIN_M = 0.5  # Nav2's required_movement_radius
_WITHIN_M, _WITHIN_RAD = 8.0, 4.0 * math.pi  # long, as backing up and going round what blocks the path gain nothing
_LONGER_PATHS = 20


class PathProgress:
    """A robot makes no progress that drives 8 m or turns twice round, and has no 0.5 m less of its path left.

    It need not hurry: time does not count, and standing is for others to judge. A new path may be longer than what was
    left of the last one, as what blocks it is seen. It then counts from there, up to 20 times until less is left than
    ever before on the drive: a robot that turns from one path to the other gets nowhere either.

    Args:
        dt: Control period [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self.reset()

    def reset(self) -> None:
        """Start over: there is another goal."""
        self._followed: FollowedPath | None = None
        self._least_m = self._least_ever_m = math.inf
        self._longer = 0
        self._begin()

    def _begin(self) -> None:
        self._driven_m = self._turned_rad = 0.0

    def is_lost(self, followed: FollowedPath, pose: Pose2D, twist: Twist2D) -> bool:
        """Return whether it makes none, given its path, its pose and how it moves; it then counts from here."""
        if followed is not self._followed:
            self._take(followed)
        self._gain(followed.left_m)
        self._driven_m += abs(twist.v) * self._dt
        self._turned_rad += abs(twist.w) * self._dt
        if self._driven_m < _WITHIN_M and self._turned_rad < _WITHIN_RAD:
            return False
        lost = not self._gain(followed.left_from(pose))
        self._begin()
        return lost

    def _take(self, followed: FollowedPath) -> None:
        self._followed = followed
        if followed.left_m > self._least_m + _GAIN_M and self._longer < _LONGER_PATHS:
            self._longer += 1
            self._least_m = followed.left_m
            self._begin()

    def _gain(self, left_m: float) -> bool:
        """Note how much of the path is left [m]; return whether that is less than before, by enough."""
        if left_m > self._least_m - _GAIN_M:
            return False
        self._least_m = left_m
        if left_m <= self._least_ever_m - _GAIN_M:
            self._least_ever_m, self._longer = left_m, 0
        self._begin()
        return True
