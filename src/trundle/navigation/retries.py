"""`Retries`: what a robot tries when it is blocked, and when it gives up."""

from __future__ import annotations

import math

from trundle.geometry import Twist2D
from trundle.navigation.block_watch import BlockWatch

_RETRIES = 6
_BACK_UP_M = 0.3
_BACK_UP_MPS = 0.15
_PROGRESS_M = 0.5  # Nav2's required_movement_radius; more than the robot backs up


class Retries:
    """A blocked robot replans, every second time after backing up, up to six times in a row.

    Six is the number in Nav2's default behavior tree (`NavigateRecovery`), which counts until the goal is reached. Here
    the count restarts once the robot has made progress: once 0.5 m less of its path is left than at any place where it
    was blocked before. So people may step into a long path many times, and a robot that only comes back gives up.

    Args:
        dt: Control period [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._watch = BlockWatch(dt)
        self.reset()

    def reset(self) -> None:
        """Start over."""
        self._watch.reset()
        self._count = 0
        self._least_left = math.inf
        self._back_up_left = 0.0

    def is_blocked(self, command: Twist2D, twist: Twist2D, left_m: float) -> bool:
        """Whether the robot makes no progress, given its command, its twist and the remaining path length [m]."""
        if left_m < self._least_left - _PROGRESS_M:
            self._count = 0
        return self._watch.is_blocked(command, twist)

    def try_again(self, left_m: float) -> bool:
        """Whether to try again when blocked with this remaining path length [m], or to give up."""
        self._least_left = min(self._least_left, left_m)
        if self._count == _RETRIES:
            return False
        self._count += 1
        return True

    @property
    def backs_up_first(self) -> bool:
        """Whether this try backs up before it plans."""
        return self._count % 2 == 0

    # Backing up -----------------------------------------------------------------------------------------------------

    @property
    def is_backing_up(self) -> bool:
        """Whether the robot is backing up."""
        return self._back_up_left > 0.0

    def start_backing_up(self) -> None:
        """Start driving back by 0.3 m."""
        self._back_up_left = _BACK_UP_M

    def stop_backing_up(self) -> None:
        """Stop driving back."""
        self._back_up_left = 0.0

    def back_up(self) -> Twist2D:
        """The command for one control period."""
        self._back_up_left -= _BACK_UP_MPS * self._dt
        return Twist2D(-_BACK_UP_MPS, 0.0)
