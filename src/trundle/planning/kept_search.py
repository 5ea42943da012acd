"""`KeptSearch`: the `GridSearch` of the last costmap, changed as that changes."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from trundle.costmap import Costmap
from trundle.planning.grid_search import GridSearch


@dataclass(slots=True)
class _Kept:
    """A search, the `version` of the costmap that it is of, and in how many plans it is in use."""

    version: object
    search: GridSearch
    users: int = 0


class KeptSearch:
    """Keeps one search from plan to plan, and brings it up to date with what `Costmap.update` changed.

    Any number of threads may plan, on one costmap or several.

    Args:
        blocked_from: Costs from here on block.
        method: Of `GridSearch`.
        connectivity: Of `GridSearch`.
    """

    def __init__(self, blocked_from: int, method: str, connectivity: int = 8) -> None:
        self._blocked_from, self._method, self._connectivity = blocked_from, method, connectivity
        self._lock = threading.Lock()
        self._kept: _Kept | None = None

    @contextmanager
    def of(self, costmap: Costmap) -> Iterator[GridSearch]:
        """The search of a costmap, which does not change within the `with` block."""
        kept = self._take(costmap)
        try:
            yield kept.search
        finally:
            with self._lock:
                kept.users -= 1

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
        """Whether the search is that of the costmap, or could be made so: one in use stays as it is."""
        if kept.version is costmap.version:
            return True
        changes = costmap.changes_since(kept.version)
        if changes is None or kept.users > 0:
            return False
        for rows, cols in changes:
            kept.search.update(rows, cols, costmap.data[rows, cols] >= self._blocked_from)
        kept.version = costmap.version
        return True
