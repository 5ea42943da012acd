"""What planners on blocked and free cells share: a `GridSearch` for each costmap."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.grid.kept_search import KeptSearch
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, FootprintPlanner
from trundle.planning.grid_planners.tight_places import TightPlaces


class BinaryPlanner(FootprintPlanner):
    """Base of the planners for the shortest path around cells of 253 and more; other costs do not count.

    The search of the last costmap is kept, so that the next plan on it only has to search; where `Costmap.update` made
    another one of it, the search is updated as well.

    Args:
        method: Of `GridSearch`.
        options: Of `FootprintPlanner`.
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
        """The search over cells below 253, of the costmap's own costs or of those of a replan."""
        return self._kept.of(costmap) if costs is costmap.data else self._kept.around(costmap, costs)
