"""`Retries`: how often a blocked robot tries again before it gives up."""

from __future__ import annotations

import math

from trundle.geometry import Twist2D
from trundle.navigation.block_watch import BlockWatch

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
