"""When a navigator may plan, and for how long: `PlanningTries`, `PlanningBudget` and `FailedPlan`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import PlanningError, PlanningStoppedError
from trundle.geometry import Goal, Pose2D, Twist2D, wrap_angle
from trundle.planning import Planner
from trundle.planning.cancellation import check_limits

_AT_ONCE_S = 1.0
"""So many seconds of expansions may be made at once before the next plan waits."""

_FULL_DRIVE_S = 600.0
"""The expansions of a drive suffice for so long [s]; a longer one may make more, in proportion."""


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
        self._plans = self._expansions = self._extra = 0
        self._began: float | None = None
        self._paid_at = -math.inf
        self._error: PlanningStoppedError | None = None

    def spend(self, expansions: int, time: float, *, needed: bool) -> None:
        """Count a plan that was made at this time [s].

        Args:
            expansions: Expansions of the plan that was made.
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

    def allow_more(self) -> None:
        """Add a third to the allowance of the drive: the robot has made room for others, so there may be a path now."""
        if self._per_drive is not None:
            self._extra += self._per_drive // 3
            self._error = None

    def must_wait(self, time: float) -> bool:
        """Return whether earlier plans are not paid for by now [s]."""
        return time < self._paid_at - 1e-9

    def is_spent(self, time: float) -> bool:
        """Return whether the expansions of the drive are used up by now [s]."""
        if self._per_drive is None or self._began is None:
            return False
        allowed = self._per_drive * max(1.0, (time - self._began) / _FULL_DRIVE_S)
        return self._expansions >= allowed + self._extra

    def refuse(self, last: PlanningError | None) -> PlanningStoppedError:
        """Return the error of a plan that is not made, after the last one's; it stays the same until a plan is made."""
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


TRIES = 3
"""How often a plan is tried that is not done by its deadline."""

PAUSE_S = 1.0
"""Between two tries [s]."""

_MOVING_SHARE = 0.25  # of the deadline, in which a moving robot drives blindly: 0.5 s by default
_STANDING_MPS = 0.01  # below these a robot stands: odometry has noise
_STANDING_RADPS = 0.02
_STOP_WITHIN_S = 3.0  # then it plans all the same: some odometry never says 0


class PlanningTries:
    """The deadline of plans, a safety net: while its navigator plans, a moving robot drives blindly.

    A plan may take `deadline_s` while the robot stands, and a quarter of that while it moves. After a plan that took
    longer than that quarter, the robot is stopped before the next one. Each further try may take twice as long as the
    one before: a planner that is asked the same again needs as long again.

    Args:
        deadline_s: How long a plan may take [s] of the computer's time. If None, it takes as long as it takes, and the
            robot is never stopped for it.

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
        """Note that no plan is pending any more."""
        self.pending = False
        self._count = 0
        self._resume_at = -math.inf
        self._stop_by: float | None = None

    @property
    def all_spent(self) -> bool:
        """Whether three plans in a row were not done by their deadline."""
        return self._count >= TRIES

    def deadline_s(self, twist: Twist2D) -> float | None:
        """Return how long a plan may take [s] for a robot that moves like this."""
        if self._deadline_s is None:
            return None
        if self._counts_as_standing(twist):
            return self._deadline_s * 2.0**self._count
        return _MOVING_SHARE * self._deadline_s

    def stops_first(self, twist: Twist2D) -> bool:
        """Return whether the robot moves, and is to stand before it plans."""
        return self._deadline_s is not None and self._is_slow and moves(twist)

    def must_wait(self, twist: Twist2D, time: float) -> bool:
        """Return whether a plan must wait now [s] until the robot stands or a pause ends; it is pending until then."""
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
    """Return whether a plan was not done by its deadline, so that another try may find a path."""
    return isinstance(error, PlanningStoppedError) and error.status == "timeout"


def moves(twist: Twist2D) -> bool:
    """Return whether a robot with this twist does not count as standing."""
    return abs(twist.v) >= _STANDING_MPS or abs(twist.w) >= _STANDING_RADPS


_NEAR_M, _NEAR_RAD = 0.1, 0.1
"""A start so near is in the same or the next of the states of hybrid A*, which are 0.1 m and 5° wide."""


@dataclass(frozen=True, slots=True)
class FailedPlan:
    """A plan that found no path.

    Attributes:
        error: Why.
        planner: What planned.
        start: Pose from which it was planned.
        goals: To where.
        costmap: Costmap on which it was planned.
    """

    error: PlanningError
    planner: Planner
    start: Pose2D
    goals: tuple[Goal, ...]
    costmap: Costmap

    def holds(self, start: Pose2D, goals: tuple[Goal, ...], costmap: Costmap, *, noisy: bool) -> bool:
        """Return whether a plan from here would fail, too: the robot has hardly moved, and nothing has become free.

        Args:
            start: Where the robot is.
            goals: Where it is to go.
            costmap: Now.
            noisy: Whether the costmap holds what was sensed: then single cells come and go at every surface, and only
                room for the robot's centre in a square of 3 × 3 cells counts.
        """
        return (
            goals == self.goals
            and start.distance_to(self.start) <= _NEAR_M
            and abs(wrap_angle(start.yaw - self.start.yaw)) <= _NEAR_RAD
            and not _is_freer(costmap, self.costmap, noisy=noisy)
        )


def _is_freer(costmap: Costmap, before: Costmap, *, noisy: bool) -> bool:
    """Return whether a costmap has room that was occupied or unknown before, or lies elsewhere."""
    if costmap is before:
        return False
    if costmap.shape != before.shape or costmap.origin != before.origin or costmap.resolution != before.resolution:
        return True
    if not noisy:
        return bool(((costmap.data < LETHAL) & (before.data >= LETHAL)).any())
    freed = (costmap.data < INSCRIBED) & (before.data >= INSCRIBED)
    rows, cols = np.flatnonzero(freed.any(axis=1)), np.flatnonzero(freed.any(axis=0))
    if len(rows) == 0:
        return False
    freed = freed[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]
    freed = freed[2:] & freed[1:-1] & freed[:-2]
    return bool((freed[:, 2:] & freed[:, 1:-1] & freed[:, :-2]).any())
