"""Which episode a worker drives next: `EpisodeOrder` interleaves them, `Schedule` gives them out."""

from __future__ import annotations

import math
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from trundle.evaluation.episode.places import MOST_PLACES
from trundle.evaluation.suite import Suite

_BLOCK = 4
"""Missions that follow one another in a place that has to be made for them.

Of 20 worlds of BARN, each takes 0.5 s to make, and a mission there 1 s.
"""

Indices = NDArray[np.int64]


class EpisodeOrder:
    """The episodes of a suite, interleaved: first one mission of each place, then another of each, and so on.

    A place is a world with a robot. All cases of a mission (planners, controllers, backends, settings) follow one
    another, so that pairs are complete. A place with more missions has more of them in any part of the order. Places,
    and missions in them, come in steps of the golden section, so that those that are listed by difficulty are spread.
    Where workers cannot keep all places, missions after the first come in blocks of four.

    Args:
        suite: The suite; it is not expanded.
    """

    def __init__(self, suite: Suite) -> None:
        expansion, robots = suite.expansion, len(suite.robots)
        parts = list(expansion.missions())
        places = len(parts) * robots
        turn = _spread(places)
        keeps_all = places <= MOST_PLACES and not any(world.is_seeded for world, _ in parts)
        shares: list[NDArray[np.float64]] = []
        steps: list[Indices] = []
        for world, missions in parts:
            count, listed = missions.count, len(missions.listed or (None,))
            number = np.arange(count, dtype=np.int64)
            step = _spread(count)[number % (count // listed) * listed + number // (count // listed)]
            block = 1 if keeps_all or world.is_seeded else _BLOCK
            first = np.where(step < 1, step, 1 + (step - 1) // block * block)
            shares += [(first + 0.5) / count] * robots
            steps += [step] * robots
        place = np.repeat(turn, [len(part) for part in steps])
        share, step = np.concatenate(shares), np.concatenate(steps)
        order = np.lexsort((step, place, share))
        self.cases = expansion.cases
        self._rank = np.empty(len(order), np.int64)
        self._rank[order] = np.arange(len(order))
        self._batch = self._rank
        if not keeps_all:
            starts = (np.diff(share[order], prepend=-1.0) != 0.0) | (np.diff(place[order], prepend=-1) != 0)
            self._batch = np.empty(len(order), np.int64)
            self._batch[order] = np.cumsum(starts)

    def sort(self, indices: Indices) -> Indices:
        """Return episodes, by their numbers in the suite, in this order."""
        missions, cases = np.divmod(indices, self.cases)
        return indices[np.argsort(self._rank[missions] * self.cases + cases, kind="stable")]

    def rank_of(self, index: int) -> int:
        """Return how many missions come before the one of an episode."""
        return int(self._rank[index // self.cases])

    def batch_of(self, index: int) -> int:
        """Return the number of the batch of an episode: those in one place that one worker should drive."""
        return int(self._batch[index // self.cases])


def _spread(count: int) -> Indices:
    """Return positions of 0, 1, …, count - 1, where each step goes on by about the golden section of their number."""
    stride = round(count * (math.sqrt(5.0) - 1.0) / 2.0)
    while math.gcd(stride, count) != 1:
        stride += 1
    return np.arange(count, dtype=np.int64) * pow(stride, -1, count) % count


PROBATION = 10
"""Missions that every combination of planner, controller, backend and settings drives before one is given up.

More of them cost time where a plug-in raises at once; fewer give one up that raises in a few worlds only.
"""

_OPEN = 2
"""Batches that may be begun and not ended, for each worker: a worker that is lost leaves one behind."""


class GivenUp:
    """Combinations of planner, controller, backend and settings that are given up.

    These are the ones of which the first ten episodes, in the order of the evaluation, all ended in `error`: the same
    for any number of workers, and when an evaluation is continued.

    Args:
        order: The order of the episodes.
    """

    def __init__(self, order: EpisodeOrder) -> None:
        self._order = order
        self._errors: Counter[int] = Counter()

    def note(self, index: int, outcome: str) -> None:
        """Count the outcome of an episode; call it once for each."""
        if outcome == "error" and self._order.rank_of(index) < PROBATION:
            self._errors[index % self._order.cases] += 1

    def has(self, index: int) -> bool:
        """Return whether an episode is of such a combination."""
        return self._errors[index % self._order.cases] >= PROBATION


class Schedule:
    """Gives episodes to workers in order; those that follow one another in a place go to one worker, which has made it.

    Args:
        indices: The numbers of the episodes, in order.
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
        """Return the next episode for a worker.

        Raises:
            StopIteration: If there are no more.
        """
        while True:
            index = self._find_batch(worker).popleft()
            if not self._is_left_out(index):
                self.in_flight[index] = time.monotonic()
                return index

    def _find_batch(self, worker: int) -> deque[int]:
        """Return the worker's own batch, or else a new one, or else the oldest of another worker."""
        if self._begun.get(worker):
            return self._begun[worker]
        self._begun = {owner: batch for owner, batch in self._begun.items() if batch}
        if len(self._begun) < self._most_begun:
            for batch in self._batches:
                self._begun[worker] = batch
                return batch
        return next(iter(self._begun.values()))
