"""`Recovery`: what a robot tries where it is blocked, and when it gives up."""

from __future__ import annotations

import math

from trundle.geometry import Twist2D
from trundle.navigation.block_watch import BlockWatch

_RETRIES = 6
_BACK_UP_M = 0.3
_BACK_UP_MPS = 0.15
_GOT_ON_M = 0.5  # Nav2's required_movement_radius; more than the robot backs up


class Recovery:
    """Where the robot is blocked it plans anew, at every second time after backing up; six times in a row.

    Six is what Nav2's default behavior tree has (`NavigateRecovery`). There they are counted until the goal is reached.
    Here they are counted anew once the robot has got on: once 0.5 m less of its path is left than wherever it was
    blocked before. So many people may step into a long way, and a robot that only comes back to where it was gives up.

    Args:
        dt: Control period [s].
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._watch = BlockWatch(dt)
        self.reset()

    def reset(self) -> None:
        """Begin anew."""
        self._watch.reset()
        self._count = 0
        self._least_left = math.inf
        self._back_up_left = 0.0

    def is_blocked(self, command: Twist2D, twist: Twist2D, left_m: float) -> bool:
        """Take in a command, how the robot moves, and what is left of its path [m]; whether it gets nowhere."""
        if left_m < self._least_left - _GOT_ON_M:
            self._count = 0
        return self._watch.is_blocked(command, twist)

    def try_again(self, left_m: float) -> bool:
        """Whether to try again where the robot is blocked and so much of its path is left [m], or to give up."""
        self._least_left = min(self._least_left, left_m)
        if self._count == _RETRIES:
            return False
        self._count += 1
        return True

    @property
    def backs_up_first(self) -> bool:
        """Whether this time it backs up before it plans."""
        return self._count % 2 == 0

    # Backing up -----------------------------------------------------------------------------------------------------

    @property
    def is_backing_up(self) -> bool:
        """Whether the robot is to drive back."""
        return self._back_up_left > 0.0

    def start_backing_up(self) -> None:
        """Have it drive back by 0.3 m from now on."""
        self._back_up_left = _BACK_UP_M

    def stop_backing_up(self) -> None:
        """Have it drive back no longer."""
        self._back_up_left = 0.0

    def back_up(self) -> Twist2D:
        """The command for one control period."""
        self._back_up_left -= _BACK_UP_MPS * self._dt
        return Twist2D(-_BACK_UP_MPS, 0.0)
