"""`PathProgress`: whether what a robot drives brings it further along its path."""

from __future__ import annotations

import math

from trundle.geometry import Pose2D, Twist2D
from trundle.navigation.followed_path import FollowedPath

_GAIN_M = 0.5  # Nav2's required_movement_radius
_WITHIN_M, _WITHIN_RAD = 8.0, 4.0 * math.pi
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
