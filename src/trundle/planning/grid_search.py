"""`GridSearch`: shortest ways between the cells of a map that is blocked or free."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, overload

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningError
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Cancellation, check_limits
from trundle.planning.point_path import POINT_METHODS, PointMethod, PointPath

Status = Literal["found", "unreachable", "timeout", "cancelled"]
STATUSES: tuple[Status, ...] = ("found", "unreachable", "timeout", "cancelled")
METHODS = ("auto", "jps", "jps_plus", "astar")

CellLike = Sequence[int] | npt.NDArray[np.integer]
CellArray = npt.NDArray[np.int32]
Span = slice | tuple[int, int] | int
"""Some rows or columns: a slice, a (first, end) pair, or one of them."""


@dataclass(frozen=True, slots=True)
class GridPath:
    """What a search over cells found.

    Attributes:
        status: "found"; "unreachable", when no way joins the cells; "timeout" or "cancelled", when it was stopped.
        length: In cells, a diagonal step being √2; infinite where the goal is unreachable, NaN where it was stopped.
        corners: The bytes of `waypoints`.
    """

    status: Status
    length: float
    corners: bytes

    @property
    def waypoints(self) -> CellArray:
        """Start, turning points and goal: (row, col), shape (M, 2), read-only. M is 0 where nothing was found."""
        return np.frombuffer(self.corners, dtype=np.int32).reshape(-1, 2)

    @property
    def cells(self) -> CellArray:
        """Every cell from start to goal: (row, col), shape (N, 2). N is 0 where nothing was found."""
        return _core.walk_corners(self.waypoints)


@dataclass(frozen=True, slots=True, eq=False)
class GridPaths(Sequence[GridPath]):
    """What `GridSearch.plan_many` found: a sequence of `GridPath`, and their numbers as arrays.

    Attributes:
        status: As of `GridPath`, shape (N,).
        length: In cells, as of `GridPath`, shape (N,).
        corners: The waypoints of all, one after the other, shape (M, 2).
        ends: Where the waypoints of each end in `corners`, shape (N,).
    """

    status: npt.NDArray[np.str_]
    length: FloatArray
    corners: CellArray
    ends: npt.NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.length)

    @overload
    def __getitem__(self, index: int) -> GridPath: ...
    @overload
    def __getitem__(self, index: slice) -> list[GridPath]: ...
    def __getitem__(self, index: int | slice) -> GridPath | list[GridPath]:
        if isinstance(index, slice):
            return [self._path(i) for i in range(*index.indices(len(self)))]
        if not -len(self) <= index < len(self):
            raise IndexError(f"there are {len(self)} paths, and no path {index}")
        return self._path(index % len(self))

    def __iter__(self) -> Iterator[GridPath]:
        return (self._path(i) for i in range(len(self)))

    def _path(self, index: int) -> GridPath:
        first = int(self.ends[index - 1]) if index > 0 else 0
        corners = self.corners[first : int(self.ends[index])].tobytes()
        return GridPath(STATUSES[_STATUS_CODES[str(self.status[index])]], float(self.length[index]), corners)


_STATUS_CODES = {status: code for code, status in enumerate(STATUSES)}
_STATUS_NAMES = np.array(STATUSES)
_ROOT_2 = math.sqrt(2.0)


class GridSearch:
    """Shortest ways on a map whose cells are blocked or free, for many queries.

    8-connected ways never cut a corner: a diagonal step needs both cells beside it. Their length is the octile optimum,
    kept in whole numbers (5741 and 8119, √2 to 1e-8) and given exactly from the counts of steps; it is the same in
    both directions. The map is packed into bits, and the array is not kept. Any number of threads may search at once;
    `update` waits for them, and they for it.

    `method` says how:

    - "jps": jump point search with bit-packed rows (Harabor and Grastien 2014, "JPS (B + P)").
    - "astar": A* with a bucket queue; faster where jumps are short, and the way for `connectivity=4`.
    - "jps_plus": jumps from a table of 16 bytes a cell, for maps that do not change: `update` makes it anew.
    - "auto": "astar" where `clutter` is above 0.06, as with a tenth of the cells blocked at random, "jps" otherwise;
      chosen again after every update.

    Args:
        blocked: Where one cannot go: bool, or uint8 with 0 for free; shape (rows, cols), read where it lies, also as
            a view with strides.
        connectivity: 8, or 4 for ways without diagonal steps.
        method: One of the above.

    Raises:
        InputError: If an argument is none of these.
    """

    def __init__(self, blocked: npt.ArrayLike, connectivity: int = 8, *, method: str = "auto") -> None:
        values = _as_bytes(blocked, "blocked")
        if values.ndim != 2 or values.size == 0:
            raise InputError(f"blocked needs shape (rows, cols) with at least one cell, got {values.shape}")
        if connectivity not in (4, 8):
            raise InputError(f"connectivity is 4 or 8, got {connectivity!r}")
        if method not in METHODS:
            raise InputError(f"method is one of {', '.join(METHODS)}; got {method!r}")
        if connectivity == 4 and method in ("jps", "jps_plus"):
            raise InputError(f"method {method!r} is for connectivity 8; 4-connected ways are found by 'astar'")
        try:
            self._grid = _core.BinaryGrid(values, int(connectivity), method)
        except ValueError as error:
            raise InputError(f"a map of {values.shape[0]} x {values.shape[1]} cells: {error}") from error
        self._shape = values.shape[0], values.shape[1]
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
        """The method in use: "jps", "jps_plus" or "astar"."""
        return self._grid.method

    @property
    def clutter(self) -> float:
        """Obstacles that one can go round, per free cell; blocked cells that touch are one obstacle."""
        return self._grid.clutter

    @property
    def nbytes(self) -> int:
        """Memory that is held, besides the map itself: bits, labels, tables and what searches left for the next."""
        return self._grid.bytes

    def shortest_path(
        self,
        start: CellLike,
        goal: CellLike,
        *,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> GridPath:
        """Find the shortest way between two cells.

        Args:
            start: (row, col).
            goal: (row, col).
            deadline_s: Give up after this time [s]; `status` is "timeout" then.
            cancel: Give up when this says so; `status` is "cancelled" then.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
            BlockedPoseError: If an end is blocked.
            InputError: If an end is no pair of whole numbers, or the deadline is not positive.
        """
        flag = check_limits(deadline_s, cancel)
        code, straight, diagonal, corners = self._grid.find_way(start, goal, deadline_s, flag)
        if code == 0:
            return GridPath("found", straight + _ROOT_2 * diagonal, corners)
        if code > 0:
            return GridPath(STATUSES[code], math.inf if code == 1 else math.nan, corners)
        raise self._refusal(code, "the ", start, goal)

    def any_angle_path(
        self,
        start: CellLike,
        goal: CellLike,
        *,
        method: PointMethod = "exact",
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> PointPath:
        """Find the way of a point between the centres of two cells, in any direction, as `any_angle_path` explains.

        Args:
            start: (row, col).
            goal: (row, col).
            method: "exact" for the shortest way; "theta_star" for that of Theta* (K. Daniel, A. Nash, S. Koenig,
                A. Felner, 2010), which turns at the centres of cells and is not the shortest.
            deadline_s: Give up after this time [s]; `status` is "timeout" then.
            cancel: Give up when this says so; `status` is "cancelled" then.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
            BlockedPoseError: If an end is blocked.
            InputError: If an end is no pair of whole numbers, or another argument is none of these.
        """
        if method not in POINT_METHODS:
            raise InputError(f"method is one of {', '.join(POINT_METHODS)}; got {method!r}")
        flag = check_limits(deadline_s, cancel)
        try:
            found = self._grid.find_point_way(start, goal, method == "theta_star", deadline_s, flag)
        except ValueError as error:
            raise InputError(f"a map of {self._shape[0]} x {self._shape[1]} cells: {error}") from error
        code, length, corners = found
        if code == 0:
            return PointPath("found", length, corners)
        if code > 0:
            return PointPath(STATUSES[code], math.inf if code == 1 else math.nan, corners)
        raise self._refusal(code, "the ", start, goal)

    def plan_many(
        self,
        starts: npt.ArrayLike,
        goals: npt.ArrayLike,
        *,
        threads: int | None = None,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> GridPaths:
        """Find the shortest ways of many queries, in several threads without the GIL.

        Args:
            starts: (row, col) of each, whole numbers, shape (N, 2).
            goals: The same.
            threads: How many to use; none means as many as there are processors, up to 8.
            deadline_s: Give up after this time for all [s]; those not found have the status "timeout".
            cancel: Give up when this says so; those not found have the status "cancelled".

        Raises:
            OutsideMapError: If an end lies outside the map; the message says of which query.
            BlockedPoseError: If an end is blocked.
            InputError: If an argument is none of these.
        """
        flag = check_limits(deadline_s, cancel)
        if threads is None:
            threads = min(8, os.cpu_count() or 1)
        if not (isinstance(threads, int) and 1 <= threads <= 1024):
            raise InputError(f"threads must be a whole number from 1 to 1024, got {threads!r}")
        first, last = _as_cells(starts, "starts"), _as_cells(goals, "goals")
        if len(first) != len(last):
            raise InputError(f"there are {len(first)} starts and {len(last)} goals; each query needs both")
        wrong, code, *found = self._grid.find_ways(first, last, threads, deadline_s, flag)
        if wrong >= 0:
            raise self._refusal(code, f"query {wrong}: the ", first[wrong].tolist(), last[wrong].tolist())
        codes, steps, ends, corners = found
        length = steps[:, 0] + _ROOT_2 * steps[:, 1]
        length[codes == 1] = math.inf
        length[codes > 1] = math.nan
        return GridPaths(_STATUS_NAMES[codes], length, corners, ends)

    def update(self, rows: Span, cols: Span, blocked: npt.ArrayLike) -> None:
        """Change a rectangle of the map. Which cells can reach which is right as soon as this returns.

        Args:
            rows: Which rows: a slice, a (first, end) pair, or one row.
            cols: Which columns.
            blocked: Their new values, of the rectangle's shape, or one value for all.

        Raises:
            OutsideMapError: If the rectangle is not within the map.
            InputError: If an argument is none of these, or of another shape.
        """
        row, row_end = _as_span(rows, "rows", self._shape[0])
        col, col_end = _as_span(cols, "cols", self._shape[1])
        values = _as_bytes(blocked, "blocked")
        shape = row_end - row, col_end - col
        if values.ndim == 0:
            values = np.broadcast_to(values, shape)
        if values.shape != shape:
            raise InputError(
                f"rows {row}:{row_end} and cols {col}:{col_end} need values of shape {shape}, got {values.shape}"
            )
        self._grid.update(row, col, values)

    def _refusal(self, code: int, which: str, start: CellLike, goal: CellLike) -> InputError | PlanningError:
        what, cell = ("start", start) if code % 2 == 0 else ("goal", goal)
        if code in (-6, -5):
            return InputError(f"{which}{what} must be a pair of whole numbers (row, col), got {cell!r}")
        row, col = int(cell[0]), int(cell[1])
        rows, cols = self._shape
        if code in (-4, -3):
            return OutsideMapError(
                f"{which}{what} ({row}, {col}) lies outside the map: rows are 0 to {rows - 1}, columns 0 to {cols - 1}",
                cell=(row, col),
            )
        return BlockedPoseError(f"{which}{what} ({row}, {col}) is blocked; choose a free cell", cell=(row, col))


def _as_bytes(values: npt.ArrayLike, what: str) -> npt.NDArray[np.uint8]:
    """Bool or uint8 as uint8, without a copy."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(f"{what} must be an array of bool or uint8: {error}") from error
    if array.dtype == np.bool_:
        return array.view(np.uint8)
    if array.dtype != np.uint8:
        raise InputError(
            f"{what} must be bool or uint8 (0 is free), got {array.dtype}; compare it first, as in costs >= 253"
        )
    return array


def _as_cells(cells: npt.ArrayLike, what: str) -> npt.NDArray[np.int64]:
    try:
        array = np.asarray(cells)
    except ValueError as error:
        raise InputError(f"{what} must be whole numbers (row, col) of shape (N, 2): {error}") from error
    if array.shape in ((0,), (0, 2)):
        return np.empty((0, 2), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iu":
        raise InputError(f"{what} must be whole numbers (row, col) of shape (N, 2), got {array.dtype} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.int64)


def _as_span(span: Span, what: str, count: int) -> tuple[int, int]:
    """First and end of some rows or columns."""
    if isinstance(span, slice):
        if span.step not in (None, 1):
            raise InputError(f"{what} must be without gaps, got {span}")
        pair = (0 if span.start is None else span.start, count if span.stop is None else span.stop)
    else:
        pair = span if isinstance(span, tuple) else (span, None)
    try:
        first, last = pair
        first = operator.index(first)
        end = first + 1 if last is None else operator.index(last)
    except (TypeError, ValueError):
        raise InputError(f"{what} is a slice, a (first, end) pair or one number, all whole; got {span!r}") from None
    if not 0 <= first <= end <= count:
        raise OutsideMapError(f"{what} {first}:{end} are not within the map: there are 0:{count}")
    return first, end
