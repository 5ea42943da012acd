"""`Wait`: stand for a while."""

from __future__ import annotations

import math

from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.navigation.behaviors.behavior import Behavior, BehaviorContext
from trundle.values import check_number

_STAND = Twist2D()


class Wait(Behavior):
    """Stand for a while.

    Args:
        seconds: For how long [s].

    Raises:
        InputError: If that is negative, or not finite.
    """

    def __init__(self, seconds: float = 5.0) -> None:
        self.seconds = check_number("seconds", seconds, 0.0, math.inf)
        if math.isinf(self.seconds):
            raise InputError("wait needs a finite number of seconds")
        self._until = 0.0

    def __repr__(self) -> str:
        return f"Wait({self.seconds:g})"

    @property
    def time_allowance(self) -> float:
        """That time, and 5 s [s]."""
        return self.seconds + 5.0

    def start(self, context: BehaviorContext) -> None:
        """Begin now."""
        self._until = context.time + self.seconds

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return zero; None when the time is over."""
        return None if context.time >= self._until - 1e-9 else _STAND
