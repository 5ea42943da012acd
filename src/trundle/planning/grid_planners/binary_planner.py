"""What planners on blocked and free cells share: the `GridSearch` of the last costmap, updated with it."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.grid_planners.detours import TightPlaces
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, FootprintPlanner

_SMALL = 8
"""A search is updated where a changed rectangle is at most one in so many parts of the map, and made anew otherwise."""


@dataclass(slots=True)
class _Kept:
    """A search, the `version` of its costmap, and the number of plans that use it now."""

    version: object
    search: GridSearch
    users: int = 0


@dataclass(slots=True)
class _Detour:
    """A search over changed costs, and the `version` of the costmap that they come from."""

    version: object
    search: GridSearch
    costs: npt.NDArray[np.uint8]


class KeptSearch:
    """Keeps one search between plans, and applies the changes of `Costmap.update` to it.

    A second search is kept for costs that differ from the costmap's in a few places, such as those that are closed
    after a collision.

    Any number of threads may plan, on one costmap or several.

    Args:
        blocked_from: Costs from here on block.
        method: Method of the `GridSearch`.
        connectivity: Connectivity of the `GridSearch`.
    """

    def __init__(self, blocked_from: int, method: str, connectivity: int = 8) -> None:
        self._blocked_from, self._method, self._connectivity = blocked_from, method, connectivity
        self._lock = threading.Lock()
        self._kept: _Kept | None = None
        self._detour: _Detour | None = None

    @contextmanager
    def of(self, costmap: Costmap) -> Iterator[GridSearch]:
        """Lend the search of a costmap, which does not change within the `with` block."""
        kept = self._take(costmap)
        try:
            yield kept.search
        finally:
            with self._lock:
                kept.users -= 1

    @contextmanager
    def around(self, costmap: Costmap, costs: npt.NDArray[np.uint8]) -> Iterator[GridSearch]:
        """Lend a search over changed costs of a costmap for the `with` block; the costs must not change later."""
        with self._lock:
            detour, self._detour = self._detour, None
        if detour is None or detour.version is not costmap.version or not self._turn(detour, costs):
            search = GridSearch(costs >= self._blocked_from, self._connectivity, method=self._method)
            detour = _Detour(costmap.version, search, costs)
        yield detour.search
        with self._lock:
            self._detour = detour

    def _turn(self, detour: _Detour, costs: npt.NDArray[np.uint8]) -> bool:
        """Update a search to other costs if they differ in a small part of the map alone; return whether it did."""
        rows, cols = np.divmod(np.flatnonzero(detour.costs != costs), costs.shape[1])
        if len(rows) > 0:
            changed = slice(int(rows.min()), int(rows.max()) + 1), slice(int(cols.min()), int(cols.max()) + 1)
            blocked = costs[changed] >= self._blocked_from
            if _SMALL * blocked.size > costs.size:
                return False
            detour.search.update(*changed, blocked)
        detour.costs = costs
        return True

    def _take(self, costmap: Costmap) -> _Kept:
        with self._lock:
            kept = self._kept
            if kept is None or not self._bring_up_to_date(kept, costmap):
                blocked = costmap.data >= self._blocked_from
                kept = _Kept(costmap.version, GridSearch(blocked, self._connectivity, method=self._method))
                self._kept = kept
            kept.users += 1
            return kept

    def _bring_up_to_date(self, kept: _Kept, costmap: Costmap) -> bool:
        """Update the search to a costmap if it can be, and is not in use; return whether it is of this costmap now."""
        if kept.version is costmap.version:
            return True
        changes = costmap.changes_since(kept.version)
        if changes is None or kept.users > 0:
            return False
        for rows, cols in changes:
            kept.search.update(rows, cols, costmap.data[rows, cols] >= self._blocked_from)
        kept.version = costmap.version
        return True


class BinaryPlanner(FootprintPlanner):
    """Base of the planners for the shortest path around cells of 253 and more; other costs do not count.

    The search of the last costmap is kept, so that the next plan on it only has to search; where `Costmap.update` made
    another one of it, the search is updated as well.

    Args:
        method: Method of the `GridSearch`.
        options: Options of `FootprintPlanner`.
    """

    def __init__(self, method: str, **options: Unpack[FootprintOptions]) -> None:
        super().__init__(**options)
        self._kept = KeptSearch(INSCRIBED, method)
        self._tight_places = TightPlaces()

    def _nearest_reachable(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> tuple[int, int]:
        with self._search(costmap, costs) as search:
            return search.nearest_reachable(start, goal)

    def _search(self, costmap: Costmap, costs: npt.NDArray[np.uint8]) -> AbstractContextManager[GridSearch]:
        """Lend the search over cells below 253, of the costmap's own costs or of those of a replan."""
        return self._kept.of(costmap) if costs is costmap.data else self._kept.around(costmap, costs)
