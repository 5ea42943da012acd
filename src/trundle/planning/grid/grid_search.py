"""`GridSearch`: shortest paths on a grid whose cells are blocked or free; `any_angle_path` for one query."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Cancellation, check_limits
from trundle.planning.grid.cells import CellLike, GridEnds, Moved, Span, as_bytes, as_span, check_threads
from trundle.planning.grid.grid_paths import (
    PARTIAL,
    STATUSES,
    CellArray,
    GridPath,
    GridPaths,
    PointPath,
    PointPaths,
    Status,
)

METHODS = ("auto", "jps", "astar")

_LONGEST_POINT_SIDE = 2**29
_STATUS_NAMES = np.array(STATUSES)
_ROOT_2 = math.sqrt(2.0)
_Paths = TypeVar("_Paths", GridPaths, PointPaths)


class GridSearch:
    """Grid search: shortest paths on a map whose cells are blocked or free, for many queries.

    8-connected paths never cut a corner: a diagonal step needs both cells beside it. Their length is the octile
    optimum, kept in integers (5741 and 8119, √2 to 1e-8) and given exactly from the counts of steps; it is the same in
    both directions. The map is packed into bits, and the array is not kept. Any number of threads may search at once;
    `update` waits for them, and they for it.

    `method` is the search:

    - "jps": jump point search with bit-packed rows (Harabor and Grastien 2014, "JPS (B + P)").
    - "astar": A* with a bucket queue; faster where jumps are short, and the search for `connectivity=4`.
    - "auto": "astar" where `clutter` is above 0.08, as with 5 to 45 % of the cells blocked at random, "jps" otherwise;
      chosen again after every update.

    Args:
        blocked: Blocked cells: bool, or uint8 with 0 for free; shape (rows, cols), read where it lies, also as
            a view with strides.
        connectivity: 8, or 4 for paths without diagonal steps.
        method: One of the above.

    Raises:
        InputError: If an argument is invalid.
    """

    def __init__(self, blocked: npt.ArrayLike, connectivity: int = 8, *, method: str = "auto") -> None:
        values = as_bytes(blocked, "blocked")
        if values.ndim != 2 or values.size == 0:
            raise InputError(f"blocked needs shape (rows, cols) with at least one cell, got {values.shape}")
        if connectivity not in (4, 8):
            raise InputError(f"connectivity is 4 or 8, got {connectivity!r}")
        if check_method(method) == "jps" and connectivity == 4:
            raise InputError("method 'jps' is for connectivity 8; 4-connected paths are found by 'astar'")
        try:
            self._grid = _core.BinaryGrid(values, int(connectivity), method)
        except ValueError as error:
            raise InputError(f"a map of {values.shape[0]} x {values.shape[1]} cells: {error}") from error
        self._shape = values.shape[0], values.shape[1]
        self._ends = GridEnds(self._grid, self._shape)
        self._connectivity = int(connectivity)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self._shape

    @property
    def connectivity(self) -> int:
        """8 or 4."""
        return self._connectivity

    @property
    def method(self) -> str:
        """The method in use: "jps" or "astar"."""
        return self._grid.method

    @property
    def clutter(self) -> float:
        """The geometric mean of the number of free-standing obstacles and of all corners, per free cell.

        Blocked cells that touch are one obstacle. A maze has corners, but hardly an obstacle that stands free.
        """
        return self._grid.clutter

    @property
    def nbytes(self) -> int:
        """Memory in use, besides the map itself: bits, labels, tables, and buffers kept between searches."""
        return self._grid.bytes

    def shortest_path(
        self,
        start: CellLike,
        goal: CellLike,
        *,
        start_tolerance: float = 0.0,
        goal_tolerance: float = 0.0,
        partial: bool = False,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> GridPath:
        """Find the shortest path between two cells.

        A blocked end is an error, unless it may be moved: the start to the nearest free cell, the goal to the nearest
        reachable cell, or else the nearest free one. Distances are straight, between centres; of equally near cells
        the one of the lowest row, then of the lowest column, is taken. The path says how far its ends were moved.

        Args:
            start: (row, col).
            goal: (row, col).
            start_tolerance: How far a blocked start may be moved, in cells.
            goal_tolerance: How far a blocked goal may be moved, in cells.
            partial: Where the goal cannot be reached, or is blocked beyond its tolerance, go to the reachable cell
                nearest to it; `status` is "partial" then, and `remaining` the distance that is left.
            deadline_s: Give up after this time [s]; `status` is "timeout" then.
            cancel: Give up once this is cancelled; `status` is "cancelled" then.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
            BlockedPoseError: If an end is blocked.
            InputError: If an end is not a pair of integers, or another argument is invalid.
        """
        flag = check_limits(deadline_s, cancel)
        start, goal, moved = self._ends.settle(start, goal, start_tolerance, goal_tolerance, partial)
        code, straight, diagonal, corners = self._grid.find_path(start, goal, deadline_s, flag)
        if code < 0:
            raise self._ends.refusal(code, start, goal)
        return GridPath(*_outcome(code, straight + _ROOT_2 * diagonal, moved), corners, *moved)

    def any_angle_path(
        self,
        start: CellLike,
        goal: CellLike,
        *,
        start_tolerance: float = 0.0,
        goal_tolerance: float = 0.0,
        partial: bool = False,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> PointPath:
        """Find the shortest path of a point between the centres of two cells, in any direction; see `any_angle_path`.

        Args:
            start: (row, col).
            goal: (row, col).
            start_tolerance: As in `shortest_path`.
            goal_tolerance: As in `shortest_path`.
            partial: As in `shortest_path`.
            deadline_s: Give up after this time [s]; `status` is "timeout" then.
            cancel: Give up once this is cancelled; `status` is "cancelled" then.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
            BlockedPoseError: If an end is blocked.
            InputError: If an end is not a pair of integers, or another argument is invalid.
        """
        self._check_sides()
        flag = check_limits(deadline_s, cancel)
        start, goal, moved = self._ends.settle(start, goal, start_tolerance, goal_tolerance, partial)
        code, length, corners = self._grid.find_point_path(start, goal, deadline_s, flag)
        if code < 0:
            raise self._ends.refusal(code, start, goal)
        return PointPath(*_outcome(code, length, moved), corners, *moved)

    def plan_many(
        self,
        starts: npt.ArrayLike,
        goals: npt.ArrayLike,
        *,
        start_tolerance: float = 0.0,
        goal_tolerance: float = 0.0,
        partial: bool = False,
        threads: int | None = None,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> GridPaths:
        """Find the shortest paths of many queries, in several threads without the GIL.

        Args:
            starts: (row, col) of each, integers, shape (N, 2).
            goals: (row, col) of each, likewise.
            start_tolerance: As in `shortest_path`.
            goal_tolerance: As in `shortest_path`.
            partial: As in `shortest_path`.
            threads: How many to use. If None, TRUNDLE_THREADS, or as many as there are processors, up to 8.
            deadline_s: Give up after this time for all [s]; those not found have the status "timeout".
            cancel: Give up once this is cancelled; those not found have the status "cancelled".

        Raises:
            OutsideMapError: If an end lies outside the map; the message says of which query.
            BlockedPoseError: If an end is blocked.
            InputError: If an argument is invalid.
        """
        flag, count = check_limits(deadline_s, cancel), check_threads(threads)
        first, last, moved = self._ends.settle_many(starts, goals, start_tolerance, goal_tolerance, partial)
        wrong, code, *found = self._grid.find_paths(first, last, count, deadline_s, flag)
        if wrong >= 0:
            raise self._ends.refusal(code, first[wrong].tolist(), last[wrong].tolist(), wrong)
        codes, steps, ends, corners = found
        return _paths_of(GridPaths, codes, steps[:, 0] + _ROOT_2 * steps[:, 1], corners, ends, moved)

    def any_angle_paths(
        self,
        starts: npt.ArrayLike,
        goals: npt.ArrayLike,
        *,
        start_tolerance: float = 0.0,
        goal_tolerance: float = 0.0,
        partial: bool = False,
        threads: int | None = None,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> PointPaths:
        """Find the paths of `any_angle_path` for many queries, in several threads without the GIL.

        For the arguments and errors see `any_angle_path` and `plan_many`.
        """
        self._check_sides()
        flag, count = check_limits(deadline_s, cancel), check_threads(threads)
        first, last, moved = self._ends.settle_many(starts, goals, start_tolerance, goal_tolerance, partial)
        wrong, code, *found = self._grid.find_point_paths(first, last, count, deadline_s, flag)
        if wrong >= 0:
            raise self._ends.refusal(code, first[wrong].tolist(), last[wrong].tolist(), wrong)
        codes, length, ends, corners = found
        return _paths_of(PointPaths, codes, length, corners, ends, moved)

    def nearest_reachable(self, start: CellLike, goal: CellLike) -> tuple[int, int]:
        """Return the (row, col) nearest to `goal`, blocked or free, of the cells that can be reached from `start`.

        It is where `shortest_path(start, goal, partial=True)` ends. It is found from the labels, without a search.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end.
            BlockedPoseError: If the start is blocked.
            InputError: If an end is not a pair of integers.
        """
        row, col = self._ends.settle(start, goal, 0.0, 0.0, True)[1]
        return int(row), int(col)

    def _check_sides(self) -> None:
        if max(self._shape) > _LONGEST_POINT_SIDE:
            rows, cols = self._shape
            raise InputError(f"a map of {rows} x {cols} cells: a side has more than 2^29 cells")

    def update(self, rows: Span, cols: Span, blocked: npt.ArrayLike) -> None:
        """Change a rectangle of the map. The labels of connected cells are updated when this returns.

        Args:
            rows: Which rows: a slice, a (first, end) pair, or one row.
            cols: Which columns.
            blocked: Their new values, of the rectangle's shape, or one value for all.

        Raises:
            OutsideMapError: If the rectangle is not within the map.
            InputError: If an argument is invalid, or of another shape.
        """
        row, row_end = as_span(rows, "rows", self._shape[0])
        col, col_end = as_span(cols, "cols", self._shape[1])
        values = as_bytes(blocked, "blocked")
        shape = row_end - row, col_end - col
        if values.ndim == 0:
            values = np.broadcast_to(values, shape)
        if values.shape != shape:
            raise InputError(
                f"rows {row}:{row_end} and cols {col}:{col_end} need values of shape {shape}, got {values.shape}"
            )
        self._grid.update(row, col, values)


def any_angle_path(blocked: npt.ArrayLike | GridSearch, start: CellLike, goal: CellLike) -> PointPath:
    """Find the shortest path of a point between the centres of two cells, in any direction.

    The point may touch blocked cells, and never passes between two that meet at a corner alone. What is reachable is
    what paths from cell to cell that cut no corner reach, and the length is never above theirs. It is the Euclidean
    optimum, found by Anya (D. Harabor, A. Grastien, D. Öz, V. Aksakalli, "Optimal Any-Angle Pathfinding In Practice",
    2016): no decision at a corner is rounded, and lengths are right to some 1e-15 of themselves for each turn.

    Args:
        blocked: Blocked cells: bool, or uint8 with 0 for free; shape (rows, cols). Packing and labelling them is
            most of the work for one query: for more than one give a `GridSearch`, or call its `any_angle_path`.
        start: (row, col).
        goal: (row, col).

    Raises:
        OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
        BlockedPoseError: If an end is blocked.
        InputError: If an argument is invalid.
    """
    search = blocked if isinstance(blocked, GridSearch) else GridSearch(blocked, method="jps")
    return search.any_angle_path(start, goal)


def check_method(method: str) -> str:
    """Return a `method` of `GridSearch`, checked.

    Raises:
        InputError: If there is no method of that name.
    """
    if method not in METHODS:
        raise InputError(f"method is one of {', '.join(METHODS)}; got {method!r}")
    return method


def _outcome(code: int, length: float, moved: Moved[float]) -> tuple[Status, float]:
    """Return status and length of one path."""
    if code == 0:
        return ("partial" if moved[2] > 0.0 else "found"), length
    return STATUSES[code], math.inf if code == 1 else math.nan


def _paths_of(
    kind: type[_Paths],
    codes: npt.NDArray[np.uint8],
    length: FloatArray,
    corners: CellArray,
    ends: npt.NDArray[np.int64],
    moved: Moved[FloatArray],
) -> _Paths:
    codes[(codes == 0) & (moved[2] > 0.0)] = PARTIAL
    length[codes == 1] = math.inf
    length[(codes > 1) & (codes != PARTIAL)] = math.nan
    return kind(_STATUS_NAMES[codes], length, corners, ends, *moved)
