"""`Schedule`: which episode a worker drives next, and which combinations are given up as they only raise."""

from __future__ import annotations

import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from itertools import groupby

from trundle.evaluation.order import EpisodeOrder

PROBATION = 10
"""Missions that every combination of planner, controller, backend and settings drives before one is given up."""

_OPEN = 2
"""Batches that may be begun and not ended, for each worker: a worker that is lost leaves one behind."""


class GivenUp:
    """Combinations of planner, controller, backend and settings that are given up.

    These are the ones of which the first ten episodes, in the order of the evaluation, all ended in `error`: the same
    for any number of workers, and when an evaluation is continued.

    Args:
        order: Of the episodes.
    """

    def __init__(self, order: EpisodeOrder) -> None:
        self._order = order
        self._errors: Counter[int] = Counter()

    def note(self, index: int, outcome: str) -> None:
        """Take the outcome of an episode; each only once."""
        if outcome == "error" and self._order.rank_of(index) < PROBATION:
            self._errors[index % self._order.cases] += 1

    def has(self, index: int) -> bool:
        """Whether an episode is of such a combination."""
        return self._errors[index % self._order.cases] >= PROBATION


class Schedule:
    """Gives episodes to workers in order; those that follow one another in a place go to one worker, which has made it.

    Args:
        indices: Of the episodes, in order.
        order: That order.
        workers: How many workers there are.
        is_left_out: Says of an episode that it is not to be given to any.

    Attributes:
        in_flight: When each episode that a worker has was given to it, in terms of `time.monotonic` [s].
    """

    def __init__(
        self, indices: Iterable[int], order: EpisodeOrder, workers: int, is_left_out: Callable[[int], bool]
    ) -> None:
        self._batches = (deque(batch) for _, batch in groupby(indices, order.batch_of))
        self._begun: dict[int, deque[int]] = {}
        self._most_begun = _OPEN * workers
        self._is_left_out = is_left_out
        self.in_flight: dict[int, float] = {}

    def take(self, worker: int) -> int:
        """The next episode for a worker.

        Raises:
            StopIteration: If there are no more.
        """
        while True:
            index = self._find_batch(worker).popleft()
            if not self._is_left_out(index):
                self.in_flight[index] = time.monotonic()
                return index

    def _find_batch(self, worker: int) -> deque[int]:
        """Its own, or else a new one, or else the oldest of another worker."""
        if self._begun.get(worker):
            return self._begun[worker]
        self._begun = {owner: batch for owner, batch in self._begun.items() if batch}
        if len(self._begun) < self._most_begun:
            for batch in self._batches:
                self._begun[worker] = batch
                return batch
        return next(iter(self._begun.values()))
