"""What the planners share for which a cell is blocked or free: a `GridSearch` for each costmap."""

from __future__ import annotations

import weakref

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.planning.footprint_planner import FootprintPlanner
from trundle.planning.grid_search import GridSearch


class BinaryPlanner(FootprintPlanner):
    """The shortest way past cells of 253 and more, whatever the others cost.

    Checked with the footprint and shortened like any `FootprintPlanner`, whose options these are. `Path.cost` is its
    length [m]. The search of the last costmap is kept, so that the next plan on it only has to search.

    Args:
        name: Name of the planner, for `Path.planner`.
        method: Of `GridSearch`.
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        max_replans: How often to plan again because the footprint hits something.
        spacing: Largest distance between two poses of the path [m].

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(
        self,
        name: str,
        method: str,
        *,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
    ) -> None:
        super().__init__(
            name,
            neutral_cost=1.0,
            cost_weight=0.0,
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            max_replans=max_replans,
            spacing=spacing,
        )
        self._method = method
        self._last: tuple[weakref.ref[Costmap], GridSearch] | None = None

    def _find_cells(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> npt.NDArray[np.int32]:
        return self._search(costmap, costs).shortest_path(start, goal).cells

    def _search(self, costmap: Costmap, costs: npt.NDArray[np.uint8]) -> GridSearch:
        """The search over cells below 253; that of the costmap's own costs is kept."""
        if costs is not costmap.data:
            # For this query alone: a table would cost more than it saves.
            return GridSearch(costs >= INSCRIBED, method="jps" if self._method == "jps_plus" else self._method)
        last = self._last
        if last is None or last[0]() is not costmap:
            last = weakref.ref(costmap), GridSearch(costs >= INSCRIBED, method=self._method)
            self._last = last
        return last[1]
