"""`BlockWatch`: whether the commands of a controller lead a robot nowhere."""

from __future__ import annotations

from trundle.geometry import Twist2D

_AFTER_S = 0.5
_STANDING_MPS = 0.01


class BlockWatch:
    """A robot is blocked while it is told to stand, or to turn in place this way and that, for half a second.

    Turning in place that leads on goes one way: the angles told add up to more than half of what they are without
    their signs.

    Args:
        dt: Control period [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self.reset()

    def reset(self) -> None:
        """Begin anew."""
        self._seconds = 0.0
        self._turn = 0.0
        self._turning = 0.0

    def is_blocked(self, command: Twist2D, twist: Twist2D) -> bool:
        """Take in one command and how the robot moves meanwhile; whether it has got nowhere for half a second."""
        if command.v != 0.0 or abs(twist.v) >= _STANDING_MPS:
            self.reset()
            return False
        self._seconds += self._dt
        self._turn += command.w
        self._turning += abs(command.w)
        if self._seconds < _AFTER_S - 1e-9:
            return False
        turns_on = abs(self._turn) > 0.5 * self._turning
        self.reset()
        return not turns_on
