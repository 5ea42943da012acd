"""Finding the blocked cell of a contact with a field of cells."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import Pose2D
from trundle.geometry.solids import OccupancyCells, Solid
from trundle.worlds import World


class CellNames:
    """Names contacts with a world's blocked cells, alike for all simulators: `map[row,col]`.

    Args:
        world: Whose cells.
    """

    def __init__(self, world: World) -> None:
        self._cells = {
            solid.name: (solid, solid.shape) for solid in world.solids if isinstance(solid.shape, OccupancyCells)
        }

    def name(self, solid: str, x: float, y: float) -> str:
        """Return a solid's name, followed by the touched cell at (x, y) [m], map frame, if the solid has cells."""
        if solid not in self._cells:
            return solid
        row, col = nearest_blocked_cell(*self._cells[solid], x, y)
        return f"{solid}[{row},{col}]"


def nearest_blocked_cell(solid: Solid, cells: OccupancyCells, x: float, y: float) -> tuple[int, int]:
    """The blocked cell (row, col) nearest to a point [m] in the map frame, among its own cell and the neighbours."""
    origin = Pose2D(solid.pose.position[0], solid.pose.position[1], solid.pose.yaw())
    local = origin.inverse() @ Pose2D(x, y)
    along, across = local.x / cells.resolution, local.y / cells.resolution
    rows, cols = cells.blocked.shape
    row = min(max(math.floor(across), 0), rows - 1)
    col = min(max(math.floor(along), 0), cols - 1)
    low_row, low_col = max(row - 1, 0), max(col - 1, 0)
    near = np.argwhere(cells.blocked[low_row : row + 2, low_col : col + 2]) + np.array([low_row, low_col])
    if len(near) == 0:
        return row, col
    best = near[np.argmin(np.hypot(near[:, 0] + 0.5 - across, near[:, 1] + 0.5 - along))]
    return int(best[0]), int(best[1])
