"""`BlockWatch`: whether a robot makes no progress."""

from __future__ import annotations

from trundle.geometry import Twist2D

_AFTER_S = 0.5
_AT_LATEST_S = 2.0
_DISTANCE_M = 0.005
_ANGLE_RAD = 0.01


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
        self._turned.add(twist.w * self._dt)
        self._asked_driven.add(command.v * self._dt)
        self._asked_turned.add(command.w * self._dt)
        if self._driven.farthest >= _DISTANCE_M:
            self.reset()
            return False
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
        """Whether these angles add up to one worth it."""
        return abs(self._total) >= _ANGLE_RAD and abs(self._total) > 0.5 * self._unsigned
