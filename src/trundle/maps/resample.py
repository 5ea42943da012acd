"""Turned maps made axis-aligned, for tools that ignore the yaw of a map's origin."""

from __future__ import annotations

import math

import numpy as np

from trundle.errors import MapError
from trundle.geometry import Pose2D, Pose3D
from trundle.maps.grid import FREE, MAX_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid
from trundle.maps.rasterise import HeightBand, SolidRaster
from trundle.solids import OccupancyCells, Solid

_SLACK = 1e-6  # Of a cell: rounding that makes no extra row or column.
_BLOCK_CELLS = 1 << 20


def resample_axis_aligned(
    grid: OccupancyGrid, *, resolution: float | None = None, max_cells: int = MAX_CELLS
) -> OccupancyGrid:
    """Make a map whose origin has yaw 0 and that covers the same ground.

    A cell takes the value of the source cell at its centre, unknown outside; then it takes the highest value above 0
    of all source cells that it overlaps, so that no obstacle is lost.

    Args:
        grid: The map.
        resolution: Edge of the new cells [m]; by default the map's.
        max_cells: The most cells to accept.

    Raises:
        MapError: If the resolution is not a positive number or the map would have too many cells.
    """
    edge = grid.resolution if resolution is None else float(resolution)
    if not (math.isfinite(edge) and edge > 0.0):
        raise MapError(f"resolution must be a positive number of metres a cell, got {resolution}")
    if grid.origin.yaw == 0.0 and edge == grid.resolution:
        return grid
    rows, cols = grid.shape
    extent = np.array([[0, 0], [cols, 0], [0, rows], [cols, rows]]) * grid.resolution
    corners = grid.origin.transform_points(extent)
    low = corners.min(axis=0)
    count = np.ceil((corners.max(axis=0) - low) / edge - _SLACK)
    if count[0] * count[1] > max_cells:
        raise MapError(f"a map of {count[0]:.0f} x {count[1]:.0f} cells is more than {max_cells}; use larger cells")
    empty = np.full((int(count[1]), int(count[0])), UNKNOWN, dtype=np.int8)
    aligned = OccupancyGrid(empty, edge, Pose2D(float(low[0]), float(low[1])))
    cells = _sample_nearest(grid, aligned)
    _keep_obstacles(grid, aligned, cells)
    return OccupancyGrid(cells, edge, aligned.origin)


def _sample_nearest(grid: OccupancyGrid, aligned: OccupancyGrid) -> np.ndarray[tuple[int, int], np.dtype[np.int8]]:
    rows, cols = aligned.shape
    cells = np.full((rows, cols), UNKNOWN, dtype=np.int8)
    step = max(1, _BLOCK_CELLS // cols)
    for first in range(0, rows, step):
        block_rows = np.arange(first, min(rows, first + step))
        row, col = grid.world_to_cell(*aligned.cell_to_world(block_rows[:, None], np.arange(cols)))
        inside = grid.contains(row, col)
        block = np.full(row.shape, UNKNOWN, dtype=np.int8)
        block[inside] = grid.data[row[inside], col[inside]]
        cells[first : first + len(block)] = block
    return cells


def _keep_obstacles(
    grid: OccupancyGrid, aligned: OccupancyGrid, cells: np.ndarray[tuple[int, int], np.dtype[np.int8]]
) -> None:
    pose = Pose3D.planar(grid.origin.x, grid.origin.y, 0.0, grid.origin.yaw)
    corner = (aligned.origin.x, aligned.origin.y)
    for value in np.unique(grid.data[grid.data > FREE]):
        touched = np.full(cells.shape, UNKNOWN, dtype=np.int8)
        walls = OccupancyCells(grid.data == value, grid.resolution, 1.0)
        SolidRaster(touched, aligned.resolution, corner, HeightBand(0.0, 1.0)).add([Solid("walls", walls, pose)])
        cells[(touched == OCCUPIED) & (cells < value)] = value
