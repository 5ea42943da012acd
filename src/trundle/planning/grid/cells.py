"""What callers give a grid search: cells, read and checked, and moved to free ones where they are blocked."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningError
from trundle.geometry import FloatArray
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
