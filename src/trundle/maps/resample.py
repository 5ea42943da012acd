"""Maps on another lattice of cells: rotated, finer, coarser or moved, without losing an obstacle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.geometry import FloatArray, Pose2D, Pose3D
from trundle.geometry.solids import OccupancyCells, Solid
from trundle.maps.cells import MAX_CELLS, OCCUPIED, UNKNOWN, UNKNOWN_RANK, Ranks, count_values, from_ranks, to_ranks
from trundle.maps.frame import GridFrame
from trundle.maps.grid import OccupancyGrid
from trundle.maps.rasterise import HeightBand, SolidRaster

SLACK = 0.02
"""Tolerance [cells] within which cell edges coincide everywhere, so a yaw of 1.5708 is a quarter turn."""

_ROUNDING = 1e-9  # [cells]: an edge this near to another is the same.
_BLOCK_CELLS = 1 << 20  # cells whose centres are computed at once, which bounds the memory


@dataclass(frozen=True, slots=True)
class CellLayout(GridFrame):
    """Cells without values, aligned with the axes.

    Attributes:
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0); its yaw is 0.
        rows: Number of cells in y.
        cols: Number of cells in x.
    """

    resolution: float
    origin: Pose2D
    rows: int
    cols: int

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.rows, self.cols


@dataclass(frozen=True, slots=True, eq=False)
class Resampled:
    """Cells on a new lattice.

    Attributes:
        cells: int8, shape (rows, cols).
        lossless: Whether each new cell lies in one old cell, so that no values were merged.
        moved: Largest shift of a cell onto the new lattice [m], within `SLACK`.
    """

    cells: npt.NDArray[np.int8]
    lossless: bool
    moved: float


def resample_axis_aligned(
    grid: OccupancyGrid, *, resolution: float | None = None, max_cells: int = MAX_CELLS
) -> OccupancyGrid:
    """Make a map with an origin of yaw 0 that covers the same area; see `resample` for the cells' values.

    Args:
        grid: The map.
        resolution: Edge of the new cells [m]; by default the map's.
        max_cells: The most cells to accept.

    Raises:
        MapError: If the resolution is not a positive number or the map would have too many cells.
    """
    edge = check_resolution(grid.resolution if resolution is None else resolution)
    if grid.origin.yaw == 0.0 and edge == grid.resolution:
        return grid
    low, high = find_bounds(grid)
    with np.errstate(over="ignore"):
        count = np.ceil((high - low) / edge - find_slack(grid, edge))
    check_size(count, max_cells)
    layout = CellLayout(edge, Pose2D(float(low[0]), float(low[1])), int(count[1]), int(count[0]))
    return OccupancyGrid(resample(grid, layout).cells, edge, layout.origin, grid.surface)


def resample(grid: OccupancyGrid, layout: CellLayout) -> Resampled:
    """Return cells of a map on another lattice.

    A new cell takes the most conservative value of all old cells that it overlaps, in the order free, 1 to 64, unknown
    (also outside the map), 65 to 99, occupied. So no occupied area is lost, and a new cell is free only if all of its
    area was. Finer cells whose edges align with the old ones, and quarter turns, lose nothing.
    """
    turns, off = _find_quarter(grid)
    if turns is None:
        return Resampled(_resample_turned(grid, layout), lossless=False, moved=0.0)
    ranks = np.rot90(to_ranks(grid.data)[::-1], turns)[::-1]
    low, _ = find_bounds(grid)
    lossless, moved = True, 0.0
    for axis, start in enumerate((layout.origin.y - low[1], layout.origin.x - low[0])):
        edges = (start + np.arange(layout.shape[axis] + 1) * layout.resolution) / grid.resolution
        edges, parts, shift = _snap(edges, layout.resolution / grid.resolution)
        lossless &= parts
        moved = max(moved, shift)
        ranks = _join_cells(ranks, edges, axis)
    return Resampled(from_ranks(ranks), lossless, (off + moved) * grid.resolution)


def find_bounds(grid: OccupancyGrid) -> tuple[FloatArray, FloatArray]:
    """Return the corners (low, high) [m] of the rectangle around a map, each of shape (2,); exact for quarter turns."""
    rows, cols = grid.shape
    turns, _ = _find_quarter(grid)
    pose = grid.origin if turns is None else Pose2D(grid.origin.x, grid.origin.y, 0.0)
    extent = np.array([[0, 0], [cols, 0], [0, rows], [cols, rows]]) * grid.resolution
    if turns is not None:
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[turns]
        extent = extent @ np.array([[cos, sin], [-sin, cos]], dtype=np.float64)
    corners = pose.transform_points(extent)
    return corners.min(axis=0), corners.max(axis=0)


def find_slack(grid: OccupancyGrid, resolution: float) -> float:
    """Return the share of a new cell that a map's border may lack: `SLACK` of the smaller of both cells."""
    return SLACK * min(1.0, grid.resolution / resolution)


def check_resolution(resolution: float) -> float:
    """Return the edge of a cell [m] as a float, or raise `MapError` if it is not a positive number."""
    edge = float(resolution)
    if not (math.isfinite(edge) and edge > 0.0):
        raise MapError(f"resolution must be a positive number of metres per cell, got {resolution}")
    return edge


def check_size(count: npt.ArrayLike, max_cells: int) -> None:
    """Raise `MapError` if a map would have too many (cols, rows) cells."""
    cols, rows = (float(number) for number in np.asarray(count))
    if not rows * cols <= max_cells:
        raise MapError(
            f"a map of {cols:.0f} x {rows:.0f} cells is more than {max_cells} cells; use larger cells or a smaller "
            "area, or raise max_cells"
        )


def _find_quarter(grid: OccupancyGrid) -> tuple[int | None, float]:
    """Find the quarter turns, 0 to 3, that a map's yaw nearly is, else None; and how far a corner shifts [cells]."""
    quarters = grid.origin.yaw / (math.pi / 2.0)
    turns = round(quarters)
    off = abs(quarters - turns) * (math.pi / 2.0) * math.hypot(*grid.shape)
    return (turns % 4, off) if off <= SLACK else (None, 0.0)


def _snap(edges: FloatArray, ratio: float) -> tuple[FloatArray, bool, float]:
    """Return the edges of new cells, in units of old cells, snapped to the old lattice or a subdivision of it if close.

    Returns:
        The edges, whether each new cell lies in one old one, and the largest shift of an edge [cells].
    """
    parts = max(1, round(1.0 / ratio))
    whole = np.round(edges * parts)
    off = float(np.abs(whole - edges * parts).max())
    if off > SLACK:
        return edges, False, 0.0
    return whole / parts, bool((np.diff(whole) == 1.0).all()), off / parts


def _join_cells(ranks: Ranks, edges: FloatArray, axis: int) -> Ranks:
    """Return the highest rank between consecutive edges along an axis; unknown beyond the first and last cell."""
    border = [(0, 0), (0, 0)]
    border[axis] = (1, 1)
    padded = np.pad(ranks, border, constant_values=UNKNOWN_RANK)
    count = ranks.shape[axis]
    first = np.clip(np.floor(edges[:-1] + _ROUNDING), -1, count).astype(np.int64) + 1
    last = np.clip(np.ceil(edges[1:] - _ROUNDING) - 1, -1, count).astype(np.int64) + 1
    joined = padded.take(first, axis)
    for step in range(1, int((last - first).max()) + 1):
        np.maximum(joined, padded.take(np.minimum(first + step, last), axis), out=joined)
    return joined


def _resample_turned(grid: OccupancyGrid, layout: CellLayout) -> npt.NDArray[np.int8]:
    # In units of old cells, so that the raster's micrometre is a millionth of a cell of any size.
    edge = layout.resolution / grid.resolution
    corner = (
        (layout.origin.x - grid.origin.x) / grid.resolution,
        (layout.origin.y - grid.origin.y) / grid.resolution,
    )
    pose = Pose3D.planar(0.0, 0.0, 0.0, grid.origin.yaw)
    ranks = _find_outside(grid, layout)
    source = to_ranks(grid.data)
    present = to_ranks(np.flatnonzero(count_values(grid.data)).astype(np.int8) + UNKNOWN)
    for rank in sorted(present[present > 0].tolist()):
        touched = np.full(layout.shape, UNKNOWN, dtype=np.int8)
        alike = OccupancyCells(source == rank, 1.0, 1.0)
        SolidRaster(touched, edge, corner, HeightBand(0.0, 1.0)).add([Solid("cells", alike, pose)])
        np.maximum(ranks, rank, out=ranks, where=touched == OCCUPIED)
    return from_ranks(ranks)


def _find_outside(grid: OccupancyGrid, layout: CellLayout) -> Ranks:
    """Return the rank unknown for new cells that extend beyond the map, else free."""
    ranks = np.empty(layout.shape, dtype=np.uint8)
    rows, cols = grid.shape
    yaw = grid.origin.yaw
    cos, sin = math.cos(yaw), math.sin(yaw)
    reach = layout.resolution / grid.resolution * (abs(cos) + abs(sin)) / 2.0 - _ROUNDING
    x, y = layout.cell_to_world(np.arange(layout.rows), np.zeros(layout.rows))
    across = (y - grid.origin.y) / grid.resolution
    x, y = layout.cell_to_world(np.zeros(layout.cols), np.arange(layout.cols))
    along = (x - grid.origin.x) / grid.resolution
    step = max(1, _BLOCK_CELLS // layout.cols)
    for first in range(0, layout.rows, step):
        part = across[first : first + step, None]
        col, row = cos * along + sin * part, cos * part - sin * along
        inside = (col >= reach) & (col <= cols - reach) & (row >= reach) & (row <= rows - reach)
        ranks[first : first + step] = np.where(inside, 0, UNKNOWN_RANK)
    return ranks
