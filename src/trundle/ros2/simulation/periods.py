"""`PeriodCounter`: how many control periods were driven, for those who wait for some."""

from __future__ import annotations

from collections.abc import Callable


class PeriodCounter:
    """Counts control periods over all runs; the thread that drives adds, the listening thread waits.

    Attributes:
        count: How many were driven.
        runs: How many runs have begun.
    """

    def __init__(self) -> None:
        self.count = 0
        self.runs = 0
        self._awaited: tuple[int, Callable[[], None]] | None = None

    def add(self) -> None:
        """A control period was driven."""
        self.count += 1
        awaited = self._awaited
        if awaited is not None and self.count >= awaited[0]:
            self._awaited = None
            awaited[1]()

    def expect(self, count: int, call: Callable[[], None]) -> None:
        """Call this, in the thread that drives, once so many were driven in all; it replaces what was expected."""
        self._awaited = count, call
