"""`cost_field`: what it costs to get from every cell of a grid to the nearest goal."""

from __future__ import annotations

from typing import cast

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningStoppedError
from trundle.planning.cancellation import Cancellation, check_limits
from trundle.planning.grid.cells import as_array, check_threads

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
