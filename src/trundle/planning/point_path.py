"""`PointPath` and `any_angle_path`: ways in any direction past blocked cells, for a point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

if TYPE_CHECKING:
    from trundle.planning.grid_search import CellLike, GridSearch

PointMethod = Literal["exact", "theta_star"]
POINT_METHODS: tuple[PointMethod, ...] = ("exact", "theta_star")


@dataclass(frozen=True, slots=True)
class PointPath:
    """The way of a point from the centre of a cell to that of another.

    Attributes:
        status: "found"; "unreachable", when no way joins the cells; "timeout" or "cancelled", when it was stopped.
        length: Euclidean, in cells; infinite where the goal is unreachable, NaN where the search was stopped.
        corners: The bytes of `waypoints`, in whole half cells.
    """

    status: Literal["found", "unreachable", "timeout", "cancelled"]
    length: float
    corners: bytes

    @property
    def waypoints(self) -> FloatArray:
        """Where the way begins, turns and ends: (row, col), shape (N, 2). N is 0 where nothing was found.

        The centre of a cell has its indices as coordinates, so that the ends are the start and the goal. The corner
        between cells (0, 0) and (1, 1) is (0.5, 0.5): the turns of the exact way lie on such corners of blocked cells.
        """
        half_cells = np.frombuffer(self.corners, dtype=np.int32).reshape(-1, 2)[:, ::-1]
        return 0.5 * (half_cells.astype(np.float64) - 1.0)


def any_angle_path(blocked: npt.ArrayLike | GridSearch, start: CellLike, goal: CellLike) -> PointPath:
    """Find the shortest way between the centres of two cells that a point can take, in any direction.

    The point may touch blocked cells, and never passes between two that meet at a corner alone. What is reachable is
    what ways from cell to cell that cut no corner reach, and the length is never above theirs. It is the Euclidean
    optimum, found by Anya (D. Harabor, A. Grastien, D. Öz, V. Aksakalli, "Optimal Any-Angle Pathfinding In Practice",
    2016): no decision at a corner is rounded, and lengths are right to some 1e-15 of themselves for each turn.

    Args:
        blocked: Where one cannot go: bool, or uint8 with 0 for free; shape (rows, cols). Packing and labelling them is
            most of the work for one query: for more than one give a `GridSearch`, or call its `any_angle_path`.
        start: (row, col).
        goal: (row, col).

    Raises:
        OutsideMapError: If an end lies outside the map; `error.cell` is that end, as for:
        BlockedPoseError: If an end is blocked.
        InputError: If an argument is none of these.
    """
    from trundle.planning.grid_search import GridSearch

    search = blocked if isinstance(blocked, GridSearch) else GridSearch(blocked, method="jps")
    return search.any_angle_path(start, goal)
