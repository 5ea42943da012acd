"""`Headway`: whether samples bring the robot further along its path."""

from __future__ import annotations

import math

from trundle.geometry import Twist2D

_BY_M = 0.3
_WITHIN_M, _WITHIN_RAD = 2.0, 2.0 * math.pi
_STRETCH_M, _MOST_M = 0.3, 10.0
_FORGET_M = 5.0


class Headway:
    """Compares what a robot drives with what is left of its path.

    It is lost where 2 m are driven, or a full turn is made, and no 0.3 m less of the path is left, or where the robot
    stands. It then follows a stretch of the path itself: 0.3 m, and twice as much each time that headway is lost again
    within 5 m of path.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Start over: nothing was driven, and the next stretch is short."""
        self._stretch_m = _STRETCH_M
        self._kept_m = 0.0
        self.begin()

    def begin(self) -> None:
        """Start over from here, on another path or another part of this one."""
        self._least_m = math.inf
        self._driven_m = self._turned_rad = 0.0

    def is_lost(self, left_m: float, twist: Twist2D, dt: float) -> bool:
        """Whether there is none, given how the robot moves for a period [s] and how much of the path is left [m]."""
        if left_m <= self._least_m - _BY_M:
            self._kept_m += 0.0 if math.isinf(self._least_m) else self._least_m - left_m
            self._least_m, self._driven_m, self._turned_rad = left_m, 0.0, 0.0
            if self._kept_m >= _FORGET_M:
                self._stretch_m, self._kept_m = _STRETCH_M, 0.0
        self._driven_m += abs(twist.v) * dt
        self._turned_rad += abs(twist.w) * dt
        return self._driven_m >= _WITHIN_M or self._turned_rad >= _WITHIN_RAD

    def lose(self) -> float:
        """How long a stretch of the path to follow [m], now that there is none."""
        stretch_m, self._kept_m = self._stretch_m, 0.0
        self._stretch_m = min(2.0 * stretch_m, _MOST_M)
        self.begin()
        return stretch_m
