"""Planners on blocked and free cells, `astar` and `any_angle`, with one `GridSearch` that follows the costmap."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import Unpack

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import FloatArray, path_length
from trundle.planning.cancellation import Patience
from trundle.planning.grid.grid_search import GridSearch, check_method
from trundle.planning.grid_planners.detours import TightPlaces
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, FootprintPlanner, to_grid, to_map
from trundle.planning.queries.ends import End

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


class AnyAnglePlanner(BinaryPlanner):
    """Finds the shortest path of a point around cells of 253 and more, in any direction (`any_angle_path`).

    Between the centres of the cells that hold the start and the goal it is the Euclidean optimum. It is joined to their
    poses directly where the straight line is free, and through the centres of these cells otherwise. The robot's centre
    touches the corners of cells of 253, where it may be up to 0.71 of a cell nearer to an obstacle than the inscribed
    radius, and never enters one. Whether the robot fits is decided by its footprint alone: every pose is checked with
    it, and after a collision the path is planned again around those cells, as with every grid planner. The result is
    the shortest path of a point around the cells that are blocked by then. `Path.cost` is its length [m]; the costs of
    cells below 253 do not count. For the options see `FootprintPlanner`.
    """

    name = "any_angle"

    def __init__(self, **options: Unpack[FootprintOptions]) -> None:
        super().__init__("jps", **options)

    def _find_path(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        with self._search(costmap, costs) as search:
            path = search.any_angle_path(start.cell, goal.cell, deadline_s=patience.seconds, cancel=patience.cancel)
        if path.status in ("timeout", "cancelled"):
            raise patience.stopped(path.status)
        if path.status != "found":
            return None
        points = path.waypoints[:, ::-1] + 0.5
        first, last = to_grid(costmap, np.array([[end.pose.x, end.pose.y] for end in (start, goal)]))
        if len(points) <= 2:
            inner = points[:0] if self._is_free(costs, first, last) else points
        else:
            skip_first = self._is_free(costs, first, points[1])
            skip_last = self._is_free(costs, points[-2], last)
            inner = points[int(skip_first) : len(points) - int(skip_last)]
        vertices: FloatArray = to_map(costmap, np.concatenate([[first], inner, [last]]))
        vertices[0], vertices[-1] = (start.pose.x, start.pose.y), (goal.pose.x, goal.pose.y)
        return vertices, path_length(vertices)

    def _is_free(self, costs: npt.NDArray[np.uint8], a: FloatArray, b: FloatArray) -> bool:
        """Return whether the line between two points in grid units is clear of blocked cells, but for its ends."""
        return bool(np.isfinite(_core.line_costs(costs, self._line_weights, a.reshape(1, 2), b.reshape(1, 2))[0]))


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
        options: Options of `FootprintPlanner`.
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
