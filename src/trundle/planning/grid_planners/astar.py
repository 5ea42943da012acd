"""`AStarPlanner`: the shortest path past cells of 253 and more, by name `astar`."""

from __future__ import annotations

from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_search import check_method
from trundle.planning.grid_planners.binary_planner import BinaryPlanner
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, to_grid, to_map
from trundle.planning.queries.ends import End

_SHORTCUT_STEP_CELLS = 8
"""The shortcut may turn where the grid path turns, and at every this many cells of it."""


class AStarPlanner(BinaryPlanner):
    """Finds the shortest 8-connected path with A* or jump point search, and shortens it by lines of sight.

    Cells of 253 and more are blocked; the costs of others do not count. The path is checked with the footprint like
    that of any `FootprintPlanner`. Where that collides, mostly at the corners that a shortest path
    touches, it is rerouted with more room. `Path.cost` is its length [m].

    Args:
        method: "astar", "jps", or "auto" for whichever is faster on the map, as `GridSearch` has them. All find paths
            of the same length over the cells.
        options: Those of `FootprintPlanner`.
    """

    name = "astar"

    def __init__(self, *, method: str = "auto", **options: Unpack[FootprintOptions]) -> None:
        super().__init__(check_method(method), **options)

    def _find_path(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        # Searched from the lower cell to the higher, so that both directions give the same path.
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


def _turning_points(cells: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
    """Return which cells of a grid path may become vertices."""
    keep = np.zeros(len(cells), dtype=np.bool_)
    keep[::_SHORTCUT_STEP_CELLS] = True
    keep[-1] = True
    steps = np.diff(cells, axis=0)
    keep[1:-1] |= (steps[1:] != steps[:-1]).any(axis=1)
    return keep
