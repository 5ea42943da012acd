"""A world's occupancy map: its solids in a height band, then a flood fill from where a robot may stand."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Literal, Protocol, TypeAlias

import numpy as np

from trundle._core import flood_free, flood_largest
from trundle.errors import MapError, MapWarning
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.grid import MAX_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid
from trundle.maps.rasterise import DEPTH, HeightBand, SolidRaster
from trundle.solids import Solid

Bounds: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
Coverage: TypeAlias = Literal["any", "centre"]

MIN_RESOLUTION = 1e-4


class SolidWorld(Protocol):
    """What a map is made from; `trundle.worlds.World` is one."""

    @property
    def solids(self) -> Sequence[Solid]:
        """What there is, in the map frame."""
        ...

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Axis-aligned bounds (low, high) [m] of all solids, each of shape (3,)."""
        ...

    @property
    def seeds(self) -> Sequence[tuple[float, float]]:
        """Points (x, y) [m] that are free and reachable; may be empty."""
        ...


def rasterise_world(
    world: SolidWorld,
    *,
    resolution: float = 0.05,
    z_range: tuple[float, float] = (0.10, 0.62),
    bounds: Bounds | None = None,
    seeds: Sequence[tuple[float, float]] | None = None,
    coverage: Coverage = "any",
    margin: float = 0.0,
    max_cells: int = MAX_CELLS,
) -> OccupancyGrid:
    """Make a world's map; see `OccupancyGrid.from_world`."""
    if not (math.isfinite(resolution) and resolution >= MIN_RESOLUTION):
        raise MapError(f"resolution must be at least {MIN_RESOLUTION} m a cell, got {resolution}")
    if coverage not in ("any", "centre"):
        raise MapError(f'coverage is {coverage!r}, it must be "any" or "centre"')
    if not (math.isfinite(margin) and margin >= 0.0):
        raise MapError(f"margin must be a number of metres of at least 0, got {margin}")
    band = _check_band(z_range)
    origin, shape = _lay_out(world, resolution, bounds, margin, max_cells)
    cells = np.full(shape, UNKNOWN, dtype=np.int8)
    raster = SolidRaster(cells, resolution, origin, band, centre=coverage == "centre")
    raster.add(world.solids)
    if not (cells == OCCUPIED).any():
        _warn_of_nothing(world, z_range)
    grid_origin = Pose2D(*origin)
    _free_from_seeds(cells, _choose_seeds(world, seeds, resolution, origin, shape), resolution, origin)
    return OccupancyGrid(cells, resolution, grid_origin)


def _check_band(z_range: tuple[float, float]) -> HeightBand:
    numbers = [float(height) for height in z_range]
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)) or numbers[1] - numbers[0] <= 4.0 * DEPTH:
        raise MapError(f"z_range must be (lowest, highest) height in metres, lowest first, got {tuple(z_range)}")
    return HeightBand(numbers[0], numbers[1])


def _lay_out(
    world: SolidWorld, resolution: float, bounds: Bounds | None, margin: float, max_cells: int
) -> tuple[tuple[float, float], tuple[int, int]]:
    """The lower-left corner [m] and (rows, cols)."""
    if bounds is None:
        if not world.solids:
            raise MapError("the world has no solids, so its map has no bounds: give bounds=((x, y), (x, y))")
        low, high = (np.asarray(corner, dtype=np.float64)[:2] for corner in world.bounds)
        # A micrometre of rounding makes no extra cell, as it makes no occupied one; a flat world still has one cell.
        first = np.floor((low - margin + DEPTH) / resolution)
        count = np.maximum(np.ceil((high + margin - DEPTH) / resolution) - first, 1)
        corner = np.round(first * resolution, 9)
    else:
        corners = np.asarray(bounds, dtype=np.float64)
        if corners.shape != (2, 2) or not np.isfinite(corners).all() or (corners[1] - corners[0] <= DEPTH).any():
            raise MapError(f"bounds must be ((x_min, y_min), (x_max, y_max)) in metres, smaller first, got {bounds}")
        corner = corners[0] - margin
        count = np.maximum(np.ceil((corners[1] + margin - corner - DEPTH) / resolution), 1)
    if not np.isfinite(count).all() or count[0] * count[1] > max_cells:
        raise MapError(
            f"a map of {count[0]:.0f} x {count[1]:.0f} cells of {resolution} m is more than {max_cells} cells: use a "
            "larger resolution or smaller bounds, or look for a solid that is far away by mistake"
        )
    return (float(corner[0]), float(corner[1])), (int(count[1]), int(count[0]))


def _choose_seeds(
    world: SolidWorld,
    seeds: Sequence[tuple[float, float]] | None,
    resolution: float,
    origin: tuple[float, float],
    shape: tuple[int, int],
) -> FloatArray:
    """Points [m], shape (N, 2): the given ones, or those of the world's that lie inside the bounds."""
    points = np.asarray(world.seeds if seeds is None else seeds, dtype=np.float64).reshape(-1, 2)
    if not np.isfinite(points).all():
        raise MapError(f"seeds must be finite points (x, y), got {points.tolist()}")
    local = (points - origin) / resolution
    inside = ((local >= 0.0) & (local < (shape[1], shape[0]))).all(axis=1)
    if seeds is not None and not inside.all():
        x, y = points[~inside][0]
        raise MapError(
            f"the seed ({x:g}, {y:g}) lies outside the map: x {origin[0]:g} to {origin[0] + shape[1] * resolution:g}, "
            f"y {origin[1]:g} to {origin[1] + shape[0] * resolution:g}; give a point inside, or larger bounds"
        )
    return points[inside]


def _free_from_seeds(
    cells: np.ndarray[tuple[int, int], np.dtype[np.int8]],
    points: FloatArray,
    resolution: float,
    origin: tuple[float, float],
) -> None:
    if len(points) == 0:
        flood_largest(cells)
        return
    local = np.floor((points - origin) / resolution).astype(np.int64)
    seeds = np.ascontiguousarray(local[:, ::-1])
    for (x, y), (row, col) in zip(points, seeds, strict=True):
        if cells[row, col] == OCCUPIED:
            raise MapError(f"the seed ({x:g}, {y:g}) lies in an obstacle; give a point that is free")
    flood_free(cells, seeds)


def _warn_of_nothing(world: SolidWorld, z_range: tuple[float, float]) -> None:
    low, high = world.bounds
    there = f"the solids span heights {low[2]:g} to {high[2]:g} m" if world.solids else "the world has no solids"
    warnings.warn(
        f"the map has no obstacle: no solid within its bounds reaches into heights {z_range[0]:g} to {z_range[1]:g} m "
        f"({there}). Check z_range and bounds",
        MapWarning,
        stacklevel=4,
    )
