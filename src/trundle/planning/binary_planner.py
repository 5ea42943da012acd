"""What the planners share for which a cell is blocked or free: a `GridSearch` for each costmap."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import ClassVar, Unpack

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.planning.cancellation import Patience
from trundle.planning.footprint_planner import FootprintOptions, FootprintPlanner
from trundle.planning.grid_search import GridSearch
from trundle.planning.kept_search import KeptSearch


class BinaryPlanner(FootprintPlanner):
    """The shortest way past cells of 253 and more, whatever the others cost.

    Checked with the footprint and shortened like any `FootprintPlanner`, whose options these are. `Path.cost` is its
    length [m]. The search of the last costmap is kept, so that the next plan on it only has to search; where
    `Costmap.update` made another one of it, the search is updated as well.
    """

    method: ClassVar[str]
    """Of `GridSearch`."""

    def __init__(self, **options: Unpack[FootprintOptions]) -> None:
        super().__init__(**options)
        self._kept = KeptSearch(INSCRIBED, self.method)

    def _find_cells(
        self,
        costmap: Costmap,
        costs: npt.NDArray[np.uint8],
        start: tuple[int, int],
        goal: tuple[int, int],
        patience: Patience,
    ) -> npt.NDArray[np.int32]:
        with self._search(costmap, costs) as search:
            path = search.shortest_path(start, goal, deadline_s=patience.seconds, cancel=patience.cancel)
        if path.status in ("timeout", "cancelled"):
            raise patience.stopped(path.status)
        return path.cells

    def _nearest_reachable(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> tuple[int, int]:
        with self._search(costmap, costs) as search:
            return search.nearest_reachable(start, goal)

    @contextmanager
    def _search(self, costmap: Costmap, costs: npt.NDArray[np.uint8]) -> Iterator[GridSearch]:
        """The search over cells below 253; that of the costmap's own costs is kept."""
        if costs is costmap.data:
            with self._kept.of(costmap) as search:
                yield search
        else:
            # For this query alone: a table would cost more than it saves.
            yield GridSearch(costs >= INSCRIBED, method="jps" if self.method == "jps_plus" else self.method)
