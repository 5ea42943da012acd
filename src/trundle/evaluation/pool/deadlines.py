"""When workers must have done what they do."""

from __future__ import annotations

import time


class Deadlines:
    """One time for each worker at most.

    Times of the same length are kept in the order in which they were set, which is the order in which they pass; so
    nothing here takes longer with more workers.
    """

    def __init__(self) -> None:
        self._times: dict[float, dict[int, float]] = {}
        self._length_of: dict[int, float] = {}

    def set(self, worker: int, seconds: float | None) -> None:
        """Give a worker so many seconds from now, or any time, instead of what it had."""
        self.clear(worker)
        if seconds is not None:
            self._times.setdefault(seconds, {})[worker] = time.monotonic() + seconds
            self._length_of[worker] = seconds

    def clear(self, worker: int) -> None:
        """Give it any time."""
        length = self._length_of.pop(worker, None)
        if length is not None:
            del self._times[length][worker]

    def soonest(self) -> float | None:
        """The next time, by time.monotonic(); None without any."""
        return min((next(iter(times.values())) for times in self._times.values() if times), default=None)

    def take_passed(self) -> list[int]:
        """Workers whose time has passed; they have any time from now on."""
        soonest, now = self.soonest(), time.monotonic()
        if soonest is None or soonest > now:
            return []
        passed = [worker for times in self._times.values() for worker, due in times.items() if due <= now]
        for worker in passed:
            self.clear(worker)
        return passed
