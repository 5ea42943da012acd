"""Whether a robot makes progress: `BlockWatch`, `PathProgress`; and how often it tries again: `Retries`."""

from __future__ import annotations

import math

from trundle.geometry import Pose2D, Twist2D
from trundle.navigation.followed_path import FollowedPath

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
        """Whether the robot makes no progress, given its command, its twist and the remaining path length [m]."""
        if left_m < self._least_left - _PROGRESS_M:
            self.count = 0
        return self._watch.is_blocked(command, twist)

    def try_again(self, left_m: float) -> bool:
        """Whether to try again when blocked with this remaining path length [m], or to give up."""
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
        """Whether the robot has made no progress, given one more command and its twist meanwhile."""
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
        """Whether it makes none, given its path, its pose and how it moves; it then counts from here."""
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
        """Take how much of the path is left [m]; whether that is less, by enough."""
        if left_m > self._least_m - _GAIN_M:
            return False
        self._least_m = left_m
        if left_m <= self._least_ever_m - _GAIN_M:
            self._least_ever_m, self._longer = left_m, 0
        self._begin()
        return True
