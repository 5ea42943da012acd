"""When planning has to stop, by a deadline or a flag that another thread may set, and how much it has searched."""

from __future__ import annotations

import math
import numbers
import time
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, PlanningStoppedError
from trundle.geometry import FloatArray

Stop = Literal["timeout", "cancelled"]

_CELLS_AN_EXPANSION = 500
"""Cells that a wavefront settles while a search of poses expands one node: 30 to 40 million a second against 50,000 to
80,000 (benchmarks/planning/RESULTS.md)."""

_MOST_NOMINAL = 5_000
"""The most that a search over cells counts as, so that a drive over a map of 10,000² cells may plan again as often as
one through a hall: once a second."""


class Cancellation:
    """Stops planning from another thread, and counts how much was searched: pass it to a search or a planner.

    Attributes:
        expansions: How many nodes were expanded by the planners that it was passed to, as they say, or None where they
            do not say.
    """

    def __init__(self) -> None:
        self.flag: npt.NDArray[np.uint8] = np.zeros(1, dtype=np.uint8)
        self.expansions: int | None = None

    def cancel(self) -> None:
        """Stop everything that this was passed to, now and in future."""
        self.flag[0] = 1

    @property
    def cancelled(self) -> bool:
        """Whether `cancel` was called."""
        return bool(self.flag[0])

    def count(self, expansions: int) -> None:
        """Add to `expansions`: a planner calls it for each search, whether that found a path or not."""
        self.expansions = expansions + (self.expansions or 0)


class Patience:
    """The time left for one plan, over all its stages, and the flag that may end it.

    Args:
        deadline_s: Give up after this time [s] from now on. If None, plan as long as it takes.
        cancel: Give up once this is cancelled.
        what: What is given up, for the message: "no path … found yet".
        pose: The pose that the error has.
        cell: The cell that the error has.

    Raises:
        InputError: If the deadline is no positive number of seconds, or `cancel` is no `Cancellation`.
    """

    def __init__(
        self,
        deadline_s: float | None,
        cancel: Cancellation | None,
        what: str,
        *,
        pose: tuple[float, float, float] | None = None,
        cell: tuple[int, int] | None = None,
    ) -> None:
        self.flag = check_limits(deadline_s, cancel)
        self.cancel = cancel
        self._deadline_s = deadline_s
        self._end = math.inf if deadline_s is None else time.monotonic() + float(deadline_s)
        self._what, self._pose, self._cell = what, pose, cell

    @property
    def seconds(self) -> float | None:
        """The time left [s], at least a nanosecond, or None where there is no deadline."""
        return None if self._deadline_s is None else max(1e-9, self._end - time.monotonic())

    def count(self, expansions: int) -> None:
        """Count the expansions of a search for whoever asked for the plan."""
        if self.cancel is not None:
            self.cancel.count(expansions)

    def check(self) -> None:
        """Raise `PlanningStoppedError` if it is time to stop."""
        if self.flag is not None and self.flag[0]:
            raise self.stopped("cancelled")
        if time.monotonic() >= self._end:
            raise self.stopped("timeout")

    def stopped(self, status: Stop) -> PlanningStoppedError:
        """Make the error for a kernel that gave up."""
        why = "it was cancelled" if status == "cancelled" else f"the deadline of {self._deadline_s:g} s passed"
        return PlanningStoppedError(f"{self._what} when {why}", pose=self._pose, cell=self._cell, status=status)


def sooner(deadline_s: float | None, other_s: float | None) -> float | None:
    """Return the shorter of two deadlines [s]; None if neither is given."""
    given = [seconds for seconds in (deadline_s, other_s) if seconds is not None]
    return min(given, default=None)


def check_limits(deadline_s: float | None, cancel: Cancellation | None) -> npt.NDArray[np.uint8] | None:
    """Check a deadline and a cancellation, and return the flag of the latter for the kernels, if there is one.

    Raises:
        InputError: If the deadline is no positive number of seconds, or `cancel` is no `Cancellation`.
    """
    if deadline_s is not None:
        is_number = isinstance(deadline_s, numbers.Real) and not isinstance(deadline_s, bool)
        if not (is_number and deadline_s > 0.0):
            raise InputError(f"deadline_s must be a positive number of seconds, got {deadline_s!r}")
    if cancel is None:
        return None
    if not isinstance(cancel, Cancellation):
        raise InputError(f"cancel must be a Cancellation, got {type(cancel).__name__}")
    return cancel.flag


def nominal_expansions(shape: tuple[int, ...], points: FloatArray | None = None) -> int:
    """Return the expansions that a search over cells counts as, by the rectangle around its path.

    Where it found no path, the whole map counts. It is 5,000 at most: how long such a search takes depends on the map,
    and is no reason to give up a drive.

    Args:
        shape: Shape of the map, in cells.
        points: Points of the path, in cells, shape (N, 2), or None where it found none.
    """
    cells = math.prod(shape)
    if points is not None:
        cells = min(cells, math.ceil(math.prod((points.max(axis=0) - points.min(axis=0) + 1.0).tolist())))
    return min(1 + cells // _CELLS_AN_EXPANSION, _MOST_NOMINAL)
