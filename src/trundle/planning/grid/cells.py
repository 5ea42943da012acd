"""What callers give a grid search: cells, read, checked and moved; `cost_field`: what it costs from each to a goal."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Sequence
from typing import Any, TypeVar, cast

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningError, PlanningStoppedError
from trundle.geometry import FloatArray
from trundle.planning.cancellation import Cancellation, check_limits
from trundle.values import check_count, check_flag, check_number

THREADS_VARIABLE = "TRUNDLE_THREADS"
"""Environment variable for programs that use every processor already, as the workers of an evaluation do."""

_Distance = TypeVar("_Distance", float, FloatArray)

CellLike = Sequence[int] | npt.NDArray[np.integer]
Cells = npt.NDArray[np.int64]
Span = slice | tuple[int, int] | int
"""Some rows or columns: a slice, a (first, end) pair, or one of them."""
Moved = tuple[_Distance, _Distance, _Distance]
"""Distances in cells: from a start and a goal to where they were moved, and of what is left to a goal out of reach."""


def as_array(values: npt.ArrayLike, what: str) -> npt.NDArray[Any]:
    """Convert to an array, without a copy if it is one.

    Raises:
        InputError: If its rows differ in length, or it is a masked array, whose mask a search would not see.
    """
    if callable(getattr(values, "filled", None)):
        raise InputError(f"{what} are masked, which grid searches ignore: give them as {what}.filled(value)")
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InputError(f"{what} need shape (rows, cols): {error}") from None


def as_bytes(values: npt.ArrayLike, what: str) -> npt.NDArray[np.uint8]:
    """Return bool or uint8 as uint8, without a copy."""
    array = as_array(values, what)
    if array.dtype == np.bool_:
        return array.view(np.uint8)
    if array.dtype != np.uint8:
        raise InputError(
            f"{what} must be bool or uint8 (0 is free), got {array.dtype}; compare it first, as in costs >= 253"
        )
    return array


def check_threads(threads: int | None) -> int:
    """Return how many threads to use: by default TRUNDLE_THREADS, or as many as there are processors, up to 8.

    Raises:
        InputError: If it is not an integer from 1 to 1024.
    """
    if threads is not None:
        return check_count("threads", threads, 1, 1024)
    given = os.environ.get(THREADS_VARIABLE, "").strip()
    if given:
        return check_count(THREADS_VARIABLE, int(given) if given.isdecimal() else given, 1, 1024)
    return min(8, os.cpu_count() or 1)


def as_pair(cell: CellLike, what: str) -> tuple[int, int]:
    """Read a (row, col) of two integers; one of more than 64 bits becomes one that lies outside any map."""
    try:
        row, col = (max(-(2**62), min(2**62, operator.index(number))) for number in cell)
    except (TypeError, ValueError):
        raise InputError(f"the {what} must be a pair of integers (row, col), got {cell!r}") from None
    return row, col


def as_cells(cells: npt.ArrayLike, what: str) -> Cells:
    """Read many (row, col) as integers, shape (N, 2)."""
    try:
        array = np.asarray(cells)
    except ValueError as error:
        raise InputError(f"{what} must be integers (row, col) of shape (N, 2): {error}") from error
    if array.shape in ((0,), (0, 2)):
        return np.empty((0, 2), dtype=np.int64)
    if array.ndim != 2 or array.shape[1] != 2 or array.dtype.kind not in "iu":
        raise InputError(f"{what} must be integers (row, col) of shape (N, 2), got {array.dtype} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.int64)


def as_span(span: Span, what: str, count: int) -> tuple[int, int]:
    """Read some rows or columns as the first of them and the one after the last."""
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


class GridEnds:
    """The ends of queries on a grid.

    Args:
        grid: The grid; it may change.
        shape: Its (rows, cols).
    """

    def __init__(self, grid: _core.BinaryGrid, shape: tuple[int, int]) -> None:
        self._grid = grid
        self._shape = shape

    def settle(
        self, start: CellLike, goal: CellLike, start_tolerance: float, goal_tolerance: float, partial: bool
    ) -> tuple[CellLike, CellLike, Moved[float]]:
        """Return where one query begins and ends; without tolerances these are its own ends, unchecked.

        Raises:
            OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
            BlockedPoseError: If an end is blocked beyond its tolerance.
            InputError: If an end is not a pair of integers, or a tolerance is not 0 or more.
        """
        if not partial and start_tolerance == 0.0 and goal_tolerance == 0.0:
            return start, goal, (0.0, 0.0, 0.0)
        pairs = [as_pair(start, "start"), as_pair(goal, "goal")]
        first, last = (np.array([pair], dtype=np.int64) for pair in pairs)
        first, last, moved = self._move(first, last, start_tolerance, goal_tolerance, partial, one=True)
        start_moved, goal_moved, remaining = (float(part[0]) for part in moved)
        return first[0].tolist(), last[0].tolist(), (start_moved, goal_moved, remaining)

    def settle_many(
        self, starts: npt.ArrayLike, goals: npt.ArrayLike, start_tolerance: float, goal_tolerance: float, partial: bool
    ) -> tuple[Cells, Cells, Moved[FloatArray]]:
        """Return where many queries begin and end, as `settle` does for one; the errors say which query."""
        first, last = as_cells(starts, "starts"), as_cells(goals, "goals")
        if len(first) != len(last):
            raise InputError(f"there are {len(first)} starts and {len(last)} goals; each query needs both")
        if not partial and start_tolerance == 0.0 and goal_tolerance == 0.0:
            nothing = np.zeros(len(first))
            return first, last, (nothing, nothing, nothing)
        return self._move(first, last, start_tolerance, goal_tolerance, partial, one=False)

    def _move(
        self, starts: Cells, goals: Cells, start_tolerance: float, goal_tolerance: float, partial: bool, *, one: bool
    ) -> tuple[Cells, Cells, Moved[FloatArray]]:
        start_reach = check_number("start_tolerance", start_tolerance, 0.0, math.inf, "cells")
        goal_reach = check_number("goal_tolerance", goal_tolerance, 0.0, math.inf, "cells")
        partial = check_flag("partial", partial)
        wrong, code, first, last, nearly = self._grid.settle_ends(starts, goals, start_reach, goal_reach, partial)
        if wrong >= 0:
            raise self.refusal(code, starts[wrong].tolist(), goals[wrong].tolist(), None if one else wrong)
        start_moved, goal_moved = (np.hypot(*(new - old).T) for new, old in ((first, starts), (last, goals)))
        is_partial = nearly.astype(np.bool_)
        return first, last, (start_moved, np.where(is_partial, 0.0, goal_moved), np.where(is_partial, goal_moved, 0.0))

    def refusal(
        self, code: int, start: CellLike, goal: CellLike, query: int | None = None
    ) -> InputError | PlanningError:
        """Make the error for ends that the kernel refuses with a code; `query` is the index of one of many."""
        which = "the " if query is None else f"query {query}: the "
        what, cell = ("start", start) if code % 2 == 0 else ("goal", goal)
        if code in (-6, -5):
            return InputError(f"{which}{what} must be a pair of integers (row, col), got {cell!r}")
        row, col = int(cell[0]), int(cell[1])
        rows, cols = self._shape
        if code in (-4, -3):
            return OutsideMapError(
                f"{which}{what} ({row}, {col}) lies outside the map: rows are 0 to {rows - 1}, columns 0 to {cols - 1}",
                cell=(row, col),
            )
        return BlockedPoseError(f"{which}{what} ({row}, {col}) is blocked; choose a free cell", cell=(row, col))


CostArray = npt.NDArray[np.uint8] | npt.NDArray[np.uint16] | npt.NDArray[np.float32]

_WALLS: dict[str, float] = {"uint8": 255, "uint16": 65535, "float32": np.inf}
_CANCELLED = 3  # the kernel's status


def cost_field(
    costs: npt.ArrayLike,
    goals: npt.ArrayLike,
    *,
    connectivity: int = 8,
    threads: int | None = None,
    deadline_s: float | None = None,
    cancel: Cancellation | None = None,
) -> npt.NDArray[np.float32]:
    """Compute the cost of the cheapest path from every cell to the nearest goal.

    A step between two cells costs the mean of their costs times its length in cells: 1 straight on, √2 along a
    diagonal, which both cells beside it must leave open. The largest value of the type is a wall: 255, 65535 or
    infinity. Costs of 0 are allowed.

    The result is exact, whatever the number of threads: with whole costs up to the 2.6e-7 by which 1393/985 is below
    √2, and to the rounding to float32. The memory used is the result's own (4 bytes a cell), up to 9 MB, and half a
    byte a cell, or a byte where costs are float32 or so large that a path does not fit 29 bits. The GIL is released.

    Args:
        costs: What a cell's length costs to cross, shape (rows, cols). uint8, uint16 and float32 arrays in C order are
            used as they are; bool arrays (True is a wall, free cells cost 1) and others are converted once.
        goals: (row, col), or several of them in shape (N, 2).
        connectivity: 8, or 4 for straight steps alone.
        threads: How many to use. If None, TRUNDLE_THREADS, or as many as there are processors, up to 8.
        deadline_s: Give up after this time [s].
        cancel: Give up once this is cancelled.

    Returns:
        float32, shape (rows, cols): 0 at the goals, infinity in walls and where no path leads to a goal.

    Raises:
        InputError: If the costs have another shape or kind, are negative, NaN or so large that a path through all cells
            would cost more than float32 holds, or an option is out of range.
        OutsideMapError: If a goal lies outside the grid; `cell` says which.
        BlockedPoseError: If a goal lies in a wall; `cell` says which.
        PlanningStoppedError: If it gave up: out of time, or cancelled.
    """
    array = _as_costs(costs)
    cells = _as_cells(goals, array)
    if connectivity not in (4, 8):
        raise InputError(f"connectivity is {connectivity!r}, it must be 4 or 8")
    count = check_threads(threads)
    flag = check_limits(deadline_s, cancel)
    status, field = _core.cost_field(array, cells, int(connectivity), count, deadline_s, flag)
    if field is None:
        why = "it was cancelled" if status == _CANCELLED else f"{deadline_s:g} s passed (deadline_s)"
        raise PlanningStoppedError(
            f"the cost field of {array.shape[0]} x {array.shape[1]} was not done when {why}",
            status="cancelled" if status == _CANCELLED else "timeout",
        )
    return field


def _as_costs(costs: npt.ArrayLike) -> CostArray:
    """Check the costs, and return them as an array that the kernel takes."""
    array = as_array(costs, "costs")
    if array.ndim != 2 or array.size == 0:
        raise InputError(f"costs need shape (rows, cols) with at least one cell, got {array.shape}")
    if array.dtype == np.bool_:
        array = np.where(array, np.uint8(255), np.uint8(1))
    elif array.dtype.kind in "iu" and array.dtype.name not in _WALLS:
        if array.min() < 0 or array.max() > 65535:
            row, col = (int(index) for index in np.argwhere((array < 0) | (array > 65535))[0])
            raise InputError(
                f"whole costs must be from 0 to 65535 (65535 is a wall); ({row}, {col}) is {array[row, col]}; "
                "use float32 for larger ones"
            )
        array = array.astype(np.uint16)
    elif array.dtype.kind == "f":
        if array.dtype.itemsize < 4:  # whose range does not hold the bounds that it is checked against
            array = array.astype(np.float32)
        _check_numbers(array)
        array = array.astype(np.float32, copy=False)
    elif array.dtype.name not in _WALLS:
        raise InputError(f"costs of type {array.dtype} cannot be used; give uint8, uint16, float32 or bool")
    return cast("CostArray", np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("=")))


def _check_numbers(costs: npt.NDArray[np.floating]) -> None:
    """Raise `InputError` unless all are costs or walls, and no path through all cells costs more than float32 holds."""
    most = float(np.finfo(np.float32).max) / (2.0 * costs.size)
    fine = costs <= most  # in place, for two masks at most on large maps
    fine |= costs == np.inf
    fine &= costs >= 0.0
    if not fine.all():
        row, col = (int(index) for index in np.argwhere(~fine)[0])
        raise InputError(
            f"costs must be from 0 to {most:.3g} on a map of this size, or infinity for a wall; "
            f"({row}, {col}) is {costs[row, col]}"
        )


def _as_cells(goals: npt.ArrayLike, costs: CostArray) -> npt.NDArray[np.int64]:
    try:
        cells = np.asarray(goals)
    except ValueError as error:
        raise InputError(f"goals need integers (row, col), or shape (N, 2): {error}") from None
    if cells.dtype.kind not in "iu" or cells.ndim not in (1, 2) or cells.shape[-1] != 2 or cells.size == 0:
        raise InputError(f"goals need integers (row, col), or shape (N, 2), got {cells.dtype} {cells.shape}")
    cells = np.ascontiguousarray(cells.reshape(-1, 2), dtype=np.int64)
    rows, cols = costs.shape
    for row, col in cells.tolist():
        if not (0 <= row < rows and 0 <= col < cols):
            raise OutsideMapError(f"the goal ({row}, {col}) lies outside the grid of {rows} x {cols}", cell=(row, col))
        if costs[row, col] == _WALLS[costs.dtype.name]:
            raise BlockedPoseError(f"the goal ({row}, {col}) lies in a wall", cell=(row, col))
    return cells
