"""`PlanningTries`: the deadline of plans, when the robot stops to plan, and when the navigator gives up."""

from __future__ import annotations

import math

from trundle.errors import PlanningError, PlanningStoppedError
from trundle.geometry import Twist2D
from trundle.planning.cancellation import check_limits

TRIES = 3
"""How often a plan is tried that is not done by its deadline."""

PAUSE_S = 1.0
"""Between two tries [s]."""

_MOVING_SHARE = 0.25
_STANDING_MPS = 0.01
_STANDING_RADPS = 0.02
_STOP_WITHIN_S = 3.0  # then it plans all the same: some odometry never says 0


class PlanningTries:
    """The deadline of plans, a safety net: while its navigator plans, a moving robot drives blindly.

    A plan may take `deadline_s` while the robot stands, and a quarter of that while it moves. After a plan that took
    longer than that quarter, the robot is stopped before the next one. Each further try may take twice as long as the
    one before: a planner that is asked the same again needs as long again.

    Args:
        deadline_s: [s] of the computer's time; none means as long as it takes, and that the robot is never stopped.

    Attributes:
        pending: Whether there is a plan to be made before the robot drives on.

    Raises:
        InputError: If the deadline is no positive number of seconds.
    """

    def __init__(self, deadline_s: float | None) -> None:
        check_limits(deadline_s, None)
        self._deadline_s = deadline_s
        self.reset()

    def reset(self) -> None:
        """Forget how planning went."""
        self._is_slow = False
        self.settle()

    def settle(self) -> None:
        """No plan is pending any more."""
        self.pending = False
        self._count = 0
        self._resume_at = -math.inf
        self._stop_by: float | None = None

    @property
    def all_spent(self) -> bool:
        """Whether three plans in a row were not done by their deadline."""
        return self._count >= TRIES

    def deadline_s(self, twist: Twist2D) -> float | None:
        """How long a plan may take [s] for a robot that moves like this."""
        if self._deadline_s is None:
            return None
        if self._counts_as_standing(twist):
            return self._deadline_s * 2.0**self._count
        return _MOVING_SHARE * self._deadline_s

    def stops_first(self, twist: Twist2D) -> bool:
        """Whether the robot moves, and is to stand before it plans."""
        return self._deadline_s is not None and self._is_slow and moves(twist)

    def must_wait(self, twist: Twist2D, time: float) -> bool:
        """Whether a plan is to wait now [s], for the robot to stand or for the end of a pause; it is pending then."""
        if self.stops_first(twist) and self._stop_by is None:
            self._stop_by = time + _STOP_WITHIN_S
        stopping = self._stop_by is not None and time < self._stop_by and self.stops_first(twist)
        waits = stopping or time < self._resume_at
        self.pending = self.pending or waits
        return waits

    def _counts_as_standing(self, twist: Twist2D) -> bool:
        return self._stop_by is not None or not moves(twist)

    def time_out(self, twist: Twist2D, time: float) -> None:
        """A plan was not done by its deadline; it is pending, and counts as a try if the robot stood."""
        self.pending = self._is_slow = True
        if self._deadline_s is None or self._counts_as_standing(twist):
            self._count += 1
            self._resume_at = time + PAUSE_S

    def succeed(self, seconds: float) -> None:
        """A plan was made in this time [s]."""
        self.settle()
        self._is_slow = self._deadline_s is not None and seconds > _MOVING_SHARE * self._deadline_s


def timed_out(error: PlanningError) -> bool:
    """Whether a plan was not done by its deadline, so that another try may find a path."""
    return isinstance(error, PlanningStoppedError) and error.status == "timeout"


def moves(twist: Twist2D) -> bool:
    """Whether a robot with this twist does not count as standing."""
    return abs(twist.v) >= _STANDING_MPS or abs(twist.w) >= _STANDING_RADPS
