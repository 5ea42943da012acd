"""`EpisodeOrder`: episodes interleaved, so that those of an unfinished evaluation are a balanced sample."""

from __future__ import annotations

import math

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
        """Episodes by their numbers in the suite, in this order."""
        missions, cases = np.divmod(indices, self.cases)
        return indices[np.argsort(self._rank[missions] * self.cases + cases, kind="stable")]

    def rank_of(self, index: int) -> int:
        """How many missions come before the one of an episode."""
        return int(self._rank[index // self.cases])

    def batch_of(self, index: int) -> int:
        """Number of the episodes that follow one another in a place, which one worker should drive."""
        return int(self._batch[index // self.cases])


def _spread(count: int) -> Indices:
    """Positions of 0, 1, …, count - 1 where each step goes on by about the golden section of their number."""
    stride = round(count * (math.sqrt(5.0) - 1.0) / 2.0)
    while math.gcd(stride, count) != 1:
        stride += 1
    return np.arange(count, dtype=np.int64) * pow(stride, -1, count) % count
