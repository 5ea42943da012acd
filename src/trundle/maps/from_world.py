"""A world's occupancy map: its solids in a height band, then a flood fill of free space from seed points."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle._core import flood_free, flood_largest
from trundle.errors import MapError, MapWarning
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Box, Solid, solids_bounds
from trundle.maps.cells import MAX_CELLS, OCCUPIED, UNKNOWN, PlacedCells, Surface
from trundle.maps.height_field import HeightField
from trundle.maps.over_floor import mark_over_floor
from trundle.maps.rasterise import DEPTH, TOUCH, HeightBand, SolidRaster
from trundle.values import as_array, first_names, is_finite_number, show_value

_LEAST_DEPTH = 0.25
"""Share of a cell, on average over the faces: halfway between walls on cell borders (0) and walls anywhere (a half)."""

_SQUARE = 1e-9


def find_surface(solids: Sequence[Solid], resolution: float, corner: tuple[float, float], band: HeightBand) -> Surface:
    """Return where surfaces lie in the cells that solids reach into.

    The faces of a box that is aligned with the cells lie at a known depth below the rim of what is marked; those of any
    other shape lie half a cell below it on average.

    Args:
        solids: What the map shows.
        resolution: Edge of a cell [m].
        corner: Lower-left corner of the map [m].
        band: The heights that are marked.
    """
    if not solids:
        return "border"
    lows, highs = solids_bounds(solids)
    inside = (highs[:, 2] > band.low) & (lows[:, 2] < band.high)
    aligned = np.array([_is_aligned(solid) for solid in solids], dtype=np.bool_)
    low, high = ((bounds[inside][:, :2] - corner) / resolution for bounds in (lows, highs))
    # How far the rim of the marked cells is outside of each face, in cells; a micrometre of rounding is none.
    slack = 1e-6 / resolution
    depths = np.stack([low - np.floor(low + slack), np.ceil(high - slack) - high], axis=1).clip(0.0, 1.0)
    depths[~aligned[inside]] = 0.5
    lengths = np.stack([(high - low)[:, ::-1]] * 2, axis=1)  # a face across x is as long as the solid is in y
    total = float(lengths.sum())
    return "overlap" if total > 0.0 and float((depths * lengths).sum()) / total > _LEAST_DEPTH else "border"


def _is_aligned(solid: Solid) -> bool:
    """Return whether a solid is a box whose sides are parallel to the axes."""
    if not isinstance(solid.shape, Box):
        return False
    rotation = np.abs(solid.pose.rotation())
    return bool((np.minimum(rotation, np.abs(1.0 - rotation)) < _SQUARE).all())


Bounds: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
Coverage: TypeAlias = Literal["any", "centre"]
Style: TypeAlias = Literal["exact", "isaac"]

MIN_RESOLUTION, MAX_RESOLUTION = 1e-4, 5.0
"""Largest resolution of a world's map [m]: coarser cells are useless for planning, and 50 is a typo for 0.05."""

FAR = 2_000.0
"""A wider world [m] causes a warning: often its unit is not the metre, or a solid is far away by mistake."""

MAX_SLOPE = math.radians(10.0)
"""Default of the steepest drivable floor [rad]: a little more than a loading ramp."""


class SolidWorld(Protocol):
    """A source of solids for a map, such as `trundle.worlds.World`."""

    @property
    def solids(self) -> Sequence[Solid]:
        """Its solids, in the map frame."""
        ...

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Axis-aligned bounds (low, high) [m] of all solids, each of shape (3,)."""
        ...

    @property
    def seeds(self) -> Sequence[tuple[float, float]]:
        """Points (x, y) [m] that are free and reachable; may be empty."""
        ...


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where the cells lie: lower-left corner [m] of cell (0, 0), and (rows, cols)."""

    resolution: float
    corner: tuple[float, float]
    shape: tuple[int, int]

    def describe(self) -> str:
        x, y = self.corner
        width, height = self.shape[1] * self.resolution, self.shape[0] * self.resolution
        return f"x {x:g} to {x + width:g}, y {y:g} to {y + height:g}"


def rasterise_world(
    world: SolidWorld,
    *,
    resolution: float = 0.05,
    z_range: tuple[float, float] = (0.10, 0.62),
    floor_z: float = 0.0,
    floor: HeightField | None = None,
    max_slope: float | None = None,
    bounds: Bounds | None = None,
    seeds: Sequence[tuple[float, float]] | None = None,
    coverage: Coverage = "any",
    style: Style = "exact",
    half_cell_origin: bool = False,
    margin: float = 0.0,
    max_cells: int = MAX_CELLS,
) -> PlacedCells:
    """Make the cells of a world's map; see `OccupancyGrid.from_world`."""
    if not isinstance(getattr(world, "solids", None), Sequence):
        raise MapError(
            f"a map needs a World, got {type(world).__name__}; World.load(path) and World.generate(name) make one"
        )
    if not (is_finite_number(resolution) and MIN_RESOLUTION <= resolution <= MAX_RESOLUTION):
        raise MapError(
            f"resolution must be the edge of a cell, {MIN_RESOLUTION:g} to {MAX_RESOLUTION:g} m, "
            f"got {show_value(resolution)}"
        )
    if coverage not in ("any", "centre"):
        raise MapError(f'coverage is {coverage!r}; it must be "any" or "centre"')
    if style not in ("exact", "isaac"):
        raise MapError(f'style is {style!r}; it must be "exact" or "isaac"')
    if style == "isaac" and coverage != "any":
        raise MapError('style="isaac" marks every touched cell: leave coverage at "any"')
    if not (is_finite_number(margin) and margin >= 0.0):
        raise MapError(f"margin must be a number of metres of at least 0, got {show_value(margin)}")
    slope = _check_floor(floor, max_slope, floor_z, style)
    band = _choose_band(z_range, floor_z, resolution, style)
    remarks: list[str] = []
    layout = _lay_out(world, resolution, bounds, margin, max_cells, remarks)
    points = _choose_seeds(world, seeds, layout)
    if floor is None:
        cells = _mark_solids(world, layout, band, coverage, style, remarks)
        free = _free_from_seeds(cells, points, layout, f"between heights {band.low:g} and {band.high:g} m")
    else:
        cells, no_floor = _mark_over_floor(world, layout, band, coverage, floor, slope, remarks)
        _check_seeds_have_floor(points, no_floor, layout)
        # Unknown cells stop the flood fill, and stay unknown.
        cells[no_floor] = OCCUPIED
        above = f"between {band.low:g} and {band.high:g} m above the floor, or where it is steeper than {slope:g} rad"
        free = _free_from_seeds(cells, points, layout, above)
        cells[no_floor] = UNKNOWN
    if free == 0 and not remarks:
        remarks.append("no cell of the map is free: solids fill all of it. Check z_range, floor_z, bounds and the unit")
    for remark in remarks:
        warnings.warn(remark, MapWarning, stacklevel=3)
    shift = resolution / 2.0 if half_cell_origin else 0.0
    # Cells are marked by their centres: surfaces are inside of their borders as often as outside.
    centred = coverage == "centre"
    surface = "border" if centred else find_surface(tuple(world.solids), resolution, layout.corner, band)
    return PlacedCells(cells, resolution, Pose2D(layout.corner[0] + shift, layout.corner[1] + shift), surface)


def _check_floor(floor: HeightField | None, max_slope: float | None, floor_z: float, style: Style) -> float:
    """Return the steepest drivable floor [rad]."""
    if floor is None:
        if max_slope is not None:
            raise MapError("max_slope applies only to an uneven floor: give floor, a HeightField, as well")
        return 0.0
    if style == "isaac":
        raise MapError('style="isaac" supports only a level floor: omit floor, or leave style at "exact"')
    if floor_z != 0.0:
        raise MapError(f"floor_z is {floor_z} and a height field is given: omit floor_z, the field has the heights")
    slope = MAX_SLOPE if max_slope is None else float(max_slope)
    if not 0.0 <= slope < math.pi / 2.0:
        raise MapError(
            f"max_slope is an angle in radians from 0 to less than {math.pi / 2.0:.4f}, got {slope:g}; 10 degrees are "
            f"{math.radians(10.0):.4f}"
        )
    return slope


def _choose_band(z_range: tuple[float, float], floor_z: float, resolution: float, style: Style) -> HeightBand:
    numbers = as_array(z_range, np.float64, "z_range", MapError).ravel().tolist()
    if len(numbers) != 2 or not all(map(math.isfinite, numbers)) or numbers[1] - numbers[0] <= 4.0 * DEPTH:
        raise MapError(f"z_range must be (lowest, highest) height in metres, lowest first, got {show_value(z_range)}")
    if not is_finite_number(floor_z):
        raise MapError(f"floor_z must be a height in metres, got {show_value(floor_z)}")
    low, high = numbers[0] + floor_z, numbers[1] + floor_z
    if style == "isaac":
        # Per cell, Isaac Sim's generator queries overlaps with a box of half extents (cell/2, cell/2, Δz/2 + cell/2).
        return HeightBand(low - resolution / 2.0, high + resolution / 2.0, TOUCH)
    return HeightBand(low, high)


def _lay_out(
    world: SolidWorld,
    resolution: float,
    bounds: Bounds | None,
    margin: float,
    max_cells: int,
    remarks: list[str],
) -> _Layout:
    if bounds is None:
        if not world.solids:
            raise MapError("the world has no solids, so its map has no bounds: give bounds=((x, y), (x, y))")
        low, high = (np.asarray(corner, dtype=np.float64)[:2] for corner in world.bounds)
        # A micrometre of rounding adds no extra cell and occupies none; a flat world still has one cell.
        first = np.floor((low - margin + DEPTH) / resolution)
        count = np.maximum(np.ceil((high + margin - DEPTH) / resolution) - first, 1)
        corner = np.round(first * resolution, 9)
    else:
        corners = as_array(bounds, np.float64, "bounds", MapError)
        if corners.shape != (2, 2) or not np.isfinite(corners).all() or (corners[1] - corners[0] <= DEPTH).any():
            raise MapError(f"bounds must be ((x_min, y_min), (x_max, y_max)) in metres, smaller first, got {bounds}")
        corner = corners[0] - margin
        count = np.maximum(np.ceil((corners[1] + margin - corner - DEPTH) / resolution), 1)
    if not np.isfinite(count).all() or count[0] * count[1] > max_cells:
        where = f" ({find_outlier(world.solids)})" if bounds is None else ""
        raise MapError(
            f"a map of {count[0]:.0f} x {count[1]:.0f} cells of {resolution} m is more than {max_cells} cells: use a "
            f"larger resolution or smaller bounds, or look for a solid that is far away by mistake{where}"
        )
    if bounds is None and max(count) * resolution > FAR:
        remarks.append(
            f"the world measures {count[0] * resolution:.0f} x {count[1] * resolution:.0f} m: "
            f"{find_outlier(world.solids)}. If that is a mistake, check its unit and its pose, or give bounds"
        )
    return _Layout(resolution, (float(corner[0]), float(corner[1])), (int(count[1]), int(count[0])))


def find_outlier(solids: Sequence[Solid]) -> str:
    """Return the solid that reaches farthest from the centre of the others, for messages."""
    lows, highs = solids_bounds(solids)
    # The world's origin is included, so that of two solids the one far from it is named.
    middle = np.median(np.vstack([(lows + highs)[:, :2] / 2.0, np.zeros((1, 2))]), axis=0)
    reach = np.maximum(middle - lows[:, :2], highs[:, :2] - middle).max(axis=1)
    index = int(np.argmax(reach))
    low, high = lows[index], highs[index]
    return (
        f"{solids[index].name!r} reaches farthest, x {low[0]:.9g} to {high[0]:.9g}, y {low[1]:.9g} to {high[1]:.9g} m"
    )


def _mark_solids(
    world: SolidWorld, layout: _Layout, band: HeightBand, coverage: Coverage, style: Style, remarks: list[str]
) -> npt.NDArray[np.int8]:
    """Return cells that are occupied or unknown."""
    edge = layout.resolution
    # One cell more on each side, so that a wall on the map's border is checked from both sides.
    cells = np.full((layout.shape[0] + 2, layout.shape[1] + 2), UNKNOWN, dtype=np.int8)
    origin = (layout.corner[0] - edge, layout.corner[1] - edge)
    raster = SolidRaster(cells, edge, origin, band, centre=coverage == "centre", fill=style == "exact")
    raster.add(world.solids)
    cells = cells[1:-1, 1:-1].copy()
    if style == "exact" and raster.open_meshes:
        remarks.append(_tell_open(raster.open_meshes))
    if not (cells == OCCUPIED).any():
        remarks.append(_nothing_there(world, f"heights {band.low:g} to {band.high:g} m"))
    return cells


def _mark_over_floor(
    world: SolidWorld,
    layout: _Layout,
    band: HeightBand,
    coverage: Coverage,
    floor: HeightField,
    max_slope: float,
    remarks: list[str],
) -> tuple[npt.NDArray[np.int8], npt.NDArray[np.bool_]]:
    """Return cells that are occupied or unknown, and where there is no floor."""
    edge = layout.resolution
    rows, cols = layout.shape
    cells = np.full((rows + 2, cols + 2), UNKNOWN, dtype=np.int8)
    marks = mark_over_floor(
        cells,
        world.solids,
        floor,
        resolution=edge,
        origin=(layout.corner[0] - edge, layout.corner[1] - edge),
        band=band,
        max_slope=max_slope,
        centre=coverage == "centre",
    )
    inner = slice(1, -1), slice(1, -1)
    cells, no_floor, steep = cells[inner].copy(), marks.no_floor[inner], marks.steep[inner]
    missing = int(no_floor.sum())
    (x, y), (x_end, y_end) = floor.bounds
    extent = f"the height field spans x {x:g} to {x_end:g}, y {y:g} to {y_end:g} m and the map {layout.describe()} m"
    if missing == no_floor.size:
        raise MapError(
            f"the floor's height is unknown in every cell of the map: {extent}. Check the field's origin and unit"
        )
    if missing:
        remarks.append(
            f"the floor's height is unknown in {missing} of {no_floor.size} cells, which become unknown: {extent}"
        )
    if marks.open_meshes:
        remarks.append(_tell_open(marks.open_meshes))
    if not (cells == OCCUPIED).any():
        remarks.append(_nothing_there(world, f"{band.low:g} to {band.high:g} m above the floor"))
    elif (steep | no_floor).all():
        remarks.append(f"the floor is steeper than {max_slope:g} rad in every known cell: check the field's unit")
    return cells, no_floor


def _tell_open(names: Sequence[str]) -> str:
    return (
        "not watertight, so only the surface is marked and not the inside: "
        f"{first_names([repr(name) for name in names])}. Close the mesh's holes, or ignore this for sheets"
    )


def _choose_seeds(world: SolidWorld, seeds: Sequence[tuple[float, float]] | None, layout: _Layout) -> FloatArray:
    """Return points [m], shape (N, 2): the given ones, or the world's seeds inside the bounds."""
    points = as_array(world.seeds if seeds is None else seeds, np.float64, "seeds", MapError)
    if points.size % 2:
        raise MapError(f"seeds are points of shape (N, 2), got {points.shape}")
    points = points.reshape(-1, 2)
    if not np.isfinite(points).all():
        raise MapError(f"seeds must be finite points (x, y), got {points.tolist()}")
    local = (points - layout.corner) / layout.resolution
    inside = ((local >= 0.0) & (local < layout.shape[::-1])).all(axis=1)
    if seeds is not None and not inside.all():
        x, y = points[~inside][0]
        raise MapError(
            f"the seed ({x:g}, {y:g}) lies outside the map: {layout.describe()}; give a point inside, or larger bounds"
        )
    return points[inside]


def _check_seeds_have_floor(points: FloatArray, no_floor: npt.NDArray[np.bool_], layout: _Layout) -> None:
    for (x, y), (col, row) in zip(points, _cells_of(points, layout), strict=True):
        if no_floor[row, col]:
            raise MapError(
                f"the seed ({x:g}, {y:g}) lies where the floor's height is unknown; give a point on the known floor"
            )


def _cells_of(points: FloatArray, layout: _Layout) -> npt.NDArray[np.int64]:
    """Return cells (col, row) of points."""
    return np.floor((points - layout.corner) / layout.resolution).astype(np.int64)


def _free_from_seeds(cells: npt.NDArray[np.int8], points: FloatArray, layout: _Layout, where: str) -> int:
    """Flood from the seeds, or fill the largest area; returns how many cells became free."""
    if len(points) == 0:
        return flood_largest(cells)
    seeds = np.ascontiguousarray(_cells_of(points, layout)[:, ::-1])
    for (x, y), (row, col) in zip(points, seeds, strict=True):
        if cells[row, col] == OCCUPIED:
            raise MapError(
                f"the seed ({x:g}, {y:g}) lies in a cell of {layout.resolution:g} m that contains part of an obstacle "
                f"{where}; give a free point, or a smaller resolution"
            )
    return flood_free(cells, seeds)


def _nothing_there(world: SolidWorld, heights: str) -> str:
    low, high = world.bounds
    there = f"the solids span heights {low[2]:g} to {high[2]:g} m" if world.solids else "the world has no solids"
    nothing = f"the map has no obstacles: no solid within its bounds reaches into {heights}"
    return f"{nothing} ({there}). Check z_range and bounds"
