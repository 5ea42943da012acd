"""`any_angle_path`: the shortest path of a point in any direction, around blocked cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy.typing as npt

from trundle.planning.grid.grid_paths import PointPath

if TYPE_CHECKING:
    from trundle.planning.grid.cells import CellLike
    from trundle.planning.grid.grid_search import GridSearch


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
    from trundle.planning.grid.grid_search import GridSearch

    search = blocked if isinstance(blocked, GridSearch) else GridSearch(blocked, method="jps")
    return search.any_angle_path(start, goal)
