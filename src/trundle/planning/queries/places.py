"""Cells near a pose, nearest first, and whether the footprint fits in them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.frame import CellArray


def cells_near(
    costmap: Costmap, pose: Pose2D, radius: float, below: int, *, beyond: float = -1.0
) -> tuple[CellArray, CellArray, FloatArray]:
    """Rows, cols and distances [m] of cells that cost less than `below`, nearest first.

    Args:
        costmap: Which cells.
        pose: Distances are from here to their centres.
        radius: How far they may be [m].
        below: What they cost less than.
        beyond: How far they must be at least, and a little farther [m].
    """
    reach = int(radius / costmap.resolution) + 1
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    bottom, left = max(0, row - reach), max(0, col - reach)
    window = costmap.data[bottom : row + reach + 1, left : col + reach + 1]
    rows, cols = np.nonzero(window < below)
    rows, cols = (rows + bottom).astype(np.int64), (cols + left).astype(np.int64)
    x, y = costmap.cell_to_world(rows, cols)
    distances = np.hypot(x - pose.x, y - pose.y)
    order = np.argsort(distances, kind="stable")
    order = order[(distances[order] <= radius) & (distances[order] > beyond)]
    return rows[order], cols[order], distances[order]


def footprint_fits(costmap: Costmap, x: FloatArray, y: FloatArray, yaws: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether the footprint fits at points x, y [m], shape (N,), with each of M yaws [rad]; shape (N, M)."""
    poses = np.column_stack([np.repeat(x, len(yaws)), np.repeat(y, len(yaws)), np.tile(yaws, len(x))])
    return ~costmap.footprint_collides(poses).reshape(len(x), len(yaws))
