"""Where paths of a `GridSearch` begin and end after blocked ends are moved, and the errors for invalid ends."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningError
from trundle.geometry import FloatArray
from trundle.planning.grid.cells import CellLike, Cells, as_cells, as_pair
from trundle.values import check_flag, check_number

_Distance = TypeVar("_Distance", float, FloatArray)
Moved = tuple[_Distance, _Distance, _Distance]
"""Distances in cells: from a start and a goal to where they were moved, and of what is left to a goal out of reach."""


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
        """Where one query begins and ends; without tolerances these are its own ends, unchecked.

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
        """The same for many queries; the errors say which."""
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
        """The error for ends that the kernel refuses with a code; `query` is the index of one of many."""
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
