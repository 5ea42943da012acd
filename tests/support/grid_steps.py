"""Paths over binary grids, step by step."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from support.grid_graph import cheapest_costs

STRAIGHT, DIAGONAL = 5741, 8119
"""What a step costs in the integers of the kernels."""


def path_costs_from(
    blocked: npt.NDArray[np.bool_], start: tuple[int, int], connectivity: int = 8
) -> npt.NDArray[np.float64]:
    """Cost of the path to each cell by SciPy's Dijkstra, in those integers; infinity where there is none."""
    return cheapest_costs(np.ones(blocked.shape), blocked, [start], connectivity, (STRAIGHT, DIAGONAL))


def count_steps(
    blocked: npt.NDArray[np.bool_], path: Any, start: Any, goal: Any, connectivity: int = 8
) -> tuple[int, int]:
    """Straight and diagonal steps of a path, each of which is allowed; its waypoints are its turning points."""
    cells = path.cells
    assert cells.dtype == np.int32
    assert tuple(cells[0]) == tuple(start)
    assert tuple(cells[-1]) == tuple(goal)
    assert not blocked[cells[:, 0], cells[:, 1]].any()
    steps, before = np.diff(cells, axis=0), cells[:-1]
    assert (np.abs(steps).max(axis=1) == 1).all()
    assert not blocked[before[:, 0] + steps[:, 0], before[:, 1]].any()
    assert not blocked[before[:, 0], before[:, 1] + steps[:, 1]].any()
    turns = np.ones(len(cells), bool)
    turns[1:-1] = (steps[1:] != steps[:-1]).any(axis=1)
    assert np.array_equal(path.waypoints, cells[turns])
    diagonal = int(np.abs(steps).sum(axis=1).sum()) - len(steps)
    assert connectivity == 8 or diagonal == 0
    return len(steps) - diagonal, diagonal
