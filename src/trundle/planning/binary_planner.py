"""What the planners share for which a cell is blocked or free: a `GridSearch` for each costmap."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import ClassVar, Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Patience
from trundle.planning.ends import End
from trundle.planning.footprint_planner import FootprintOptions, FootprintPlanner, to_grid, to_map
from trundle.planning.grid_search import GridSearch
from trundle.planning.kept_search import KeptSearch
from trundle.planning.tight_places import TightPlaces

_SHORTCUT_STEP_CELLS = 8
"""The shortcut may turn where the grid path turns, and at every so many cells of it."""


class BinaryPlanner(FootprintPlanner):
    """The shortest way past cells of 253 and more, whatever the others cost.

    The grid path is shortened by the cheapest lines of sight, and checked with the footprint like that of any
    `FootprintPlanner`, whose options these are. Where that hits something, which is mostly at the corners that a
    shortest path touches, it is led past with more room. `Path.cost` is its length [m]. The search of the last costmap
    is kept, so that the next plan on it only has to search; where `Costmap.update` made another one of it, the search
    is updated as well.
    """

    method: ClassVar[str]
    """Of `GridSearch`."""

    def __init__(self, **options: Unpack[FootprintOptions]) -> None:
        super().__init__(**options)
        self._kept = KeptSearch(INSCRIBED, self.method)
        self._tight_places = TightPlaces()

    def _find_way(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        # Searched from the lower cell to the higher, so that both directions give the same way.
        turned = (goal.cell, goal.pose.as_tuple()) < (start.cell, start.pose.as_tuple())
        first, last = (goal, start) if turned else (start, goal)
        with self._search(costmap, costs) as search:
            path = search.shortest_path(first.cell, last.cell, deadline_s=patience.seconds, cancel=patience.cancel)
        if path.status in ("timeout", "cancelled"):
            raise patience.stopped(path.status)
        if path.status != "found":
            return None
        centres = path.cells[_turning_points(path.cells)][:, ::-1].astype(np.float64) + 0.5
        ends = to_grid(costmap, np.array([[end.pose.x, end.pose.y] for end in (first, last)]))
        points = np.concatenate([ends[:1], centres, ends[1:]])
        patience.check()
        chosen, cost = _core.shortcut(costs, self._line_weights, points)
        vertices = to_map(costmap, points[chosen])
        vertices[0], vertices[-1] = (first.pose.x, first.pose.y), (last.pose.x, last.pose.y)
        return vertices[::-1] if turned else vertices, cost * costmap.resolution

    def _nearest_reachable(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> tuple[int, int]:
        with self._search(costmap, costs) as search:
            return search.nearest_reachable(start, goal)

    def _search(self, costmap: Costmap, costs: npt.NDArray[np.uint8]) -> AbstractContextManager[GridSearch]:
        """The search over cells below 253, of the costmap's own costs or of those of a replan."""
        return self._kept.of(costmap) if costs is costmap.data else self._kept.around(costmap, costs)


def _turning_points(cells: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
    """Which cells of a grid path may become vertices."""
    keep = np.zeros(len(cells), dtype=np.bool_)
    keep[::_SHORTCUT_STEP_CELLS] = True
    keep[-1] = True
    steps = np.diff(cells, axis=0)
    keep[1:-1] |= (steps[1:] != steps[:-1]).any(axis=1)
    return keep
