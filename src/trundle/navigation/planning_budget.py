"""`PlanningBudget`: how much a navigator may search when it plans again: in expansions, so that runs are repeatable."""

from __future__ import annotations

import math

from trundle.errors import PlanningError, PlanningStoppedError

_AT_ONCE_S = 1.0
"""So many seconds of expansions may be made at once before the next plan waits."""

_FULL_DRIVE_S = 600.0


class PlanningBudget:
    """Counts the expansions of plans after the first one, by the second and by the drive.

    By the second: a plan is paid for in the time after it, and the next one waits until then. By the drive: when the
    sum is used up, no other plan is made. The first plan of a drive is not counted.

    Args:
        per_s: Expansions that each second pays for; None for no limit.
        per_drive: Expansions of a drive of up to ten minutes, and in proportion more of a longer one; None for no
            limit.
    """

    def __init__(self, per_s: float | None, per_drive: int | None) -> None:
        self._per_s, self._per_drive = per_s, per_drive
        self.reset()

    def reset(self) -> None:
        """Start over: there is another goal, or the robot has reached one."""
        self._plans = self._expansions = 0
        self._began: float | None = None
        self._paid_at = -math.inf
        self._error: PlanningStoppedError | None = None

    def spend(self, expansions: int, time: float, *, needed: bool) -> None:
        """Count a plan that was made at this time [s].

        Args:
            expansions: Of the plan.
            time: Now [s].
            needed: Whether there was no path to follow: a look for a better one counts by the second alone.
        """
        if self._began is None:
            self._began = time
            return
        self._error = None
        if needed:
            self._plans += 1
            self._expansions += expansions
        if self._per_s is not None:
            self._paid_at = max(self._paid_at, time - _AT_ONCE_S) + expansions / self._per_s

    def must_wait(self, time: float) -> bool:
        """Whether earlier plans are not paid for by now [s]."""
        return time < self._paid_at - 1e-9

    def is_spent(self, time: float) -> bool:
        """Whether the expansions of the drive are used up by now [s]."""
        if self._per_drive is None or self._began is None:
            return False
        return self._expansions >= self._per_drive * max(1.0, (time - self._began) / _FULL_DRIVE_S)

    def refuse(self, last: PlanningError | None) -> PlanningStoppedError:
        """The error for a plan that is not made, after this last one that found no path; the same until one is made."""
        if self._error is None:
            why = "" if last is None else f"; the last one: {last}"
            self._error = PlanningStoppedError(
                f"gave up planning after {self._expansions:,} expansions in {self._plans} plans beyond the first "
                f"(replan_expansions){why}",
                pose=None if last is None else last.pose,
                cell=None if last is None else last.cell,
                status="exhausted",
            )
        return self._error
