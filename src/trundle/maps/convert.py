"""Maps resampled, cropped, aligned with the axes and merged, in one step so that obstacles are inflated only once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

import numpy as np

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps.cells import (
    FREE,
    MAX_CELLS,
    OCCUPIED,
    OCCUPIED_FROM,
    UNKNOWN,
    VALUES,
    Cells,
    count_values,
    round_trinary,
)
from trundle.maps.grid import OccupancyGrid
from trundle.maps.occupancy import Mode
from trundle.maps.resample import (
    CellLayout,
    Resampled,
    check_resolution,
    check_size,
    find_bounds,
    find_slack,
    resample,
)
from trundle.maps.ros_writer import read_back

if TYPE_CHECKING:
    from trundle.maps.from_world import Bounds

Prefer: TypeAlias = Literal["occupied", "free", "first", "second"]
Crop: TypeAlias = "Bounds | Literal['content']"

PREFERENCES: tuple[Prefer, ...] = ("occupied", "free", "first", "second")

_ROUNDING = 1e-6  # [cells]: tolerance by which a rectangle may reach into the next cell.
_BLOCK_CELLS = 1 << 20  # cells whose centres are computed at once, which bounds the memory
_MOVED = 1e-6  # [m]: smaller shifts are rounding errors.

LossKind: TypeAlias = Literal[
    "resampled", "moved", "cropped", "disagreement", "values", "unknown", "origin", "resolution"
]
Format: TypeAlias = Literal["ros", "movingai"]

_MOVINGAI_RESOLUTION = 1.0  # Assumed by readers, the format has none.


@dataclass(frozen=True, slots=True)
class Loss:
    """Information that a converted map has lost.

    Attributes:
        kind: Kind of the loss.
        message: Description for the user.
        cells: Number of cells concerned, None for the whole map.
    """

    kind: LossKind
    message: str
    cells: int | None = None


def find_file_losses(grid: OccupancyGrid, form: Format, mode: Mode = "trinary") -> tuple[Loss, ...]:
    """Return the information that a map loses when it is written to a file.

    Args:
        grid: The map.
        form: The format of the file.
        mode: The mode of a ROS map.
    """
    if form == "ros":
        return _find_changed_values(grid, read_back(mode), f"mode {mode}", "; mode raw keeps them")
    table = round_trinary(VALUES)
    table[table == UNKNOWN] = OCCUPIED
    losses = [*_find_changed_values(grid, table, "a MovingAI map", "")]
    if grid.resolution != _MOVINGAI_RESOLUTION:
        text = f"a MovingAI map has no resolution: cells of {grid.resolution:g} m are read as 1 m"
        losses.append(Loss("resolution", text))
    if grid.origin != Pose2D(0.0, 0.0, 0.0):
        x, y, yaw = grid.origin.as_tuple()
        text = f"a MovingAI map has no origin: ({x:g}, {y:g}, {yaw:g}) is read as (0, 0, 0)"
        losses.append(Loss("origin", text))
    return tuple(losses)


def _find_changed_values(
    grid: OccupancyGrid, table: np.ndarray[tuple[int], np.dtype[np.int8]], where: str, advice: str
) -> tuple[Loss, ...]:
    counts = np.where(table != VALUES, count_values(grid.data), 0)
    losses: list[Loss] = []
    if counts[0]:
        text = f"{where} has no unknown cells: {counts[0]} of them become occupied"
        losses.append(Loss("unknown", text, int(counts[0])))
        counts[0] = 0
    if counts.any():
        ends = {"free": table == FREE, "occupied": table == OCCUPIED, "unknown": table == UNKNOWN}
        parts = [f"{counts[hit].sum()} become {name}" for name, hit in ends.items() if counts[hit].any()]
        other = counts[(table > FREE) & (table < OCCUPIED)].sum()
        parts += [f"{other} another value"] if other else []
        text = f"{where} does not keep {counts.sum()} cells between free and occupied: {', '.join(parts)}{advice}"
        losses.append(Loss("values", text, int(counts.sum())))
    return tuple(losses)


@dataclass(frozen=True, slots=True)
class Conversion:
    """A map made from one or two others, and the information lost."""

    grid: OccupancyGrid
    losses: tuple[Loss, ...]


def convert_grid(
    grid: OccupancyGrid,
    *,
    other: OccupancyGrid | None = None,
    prefer: Prefer = "occupied",
    align: bool = False,
    resolution: float | None = None,
    crop: Crop | None = None,
    max_cells: int = MAX_CELLS,
) -> Conversion:
    """Convert a map, or merge two: another resolution, an axis-aligned origin, a cropped part.

    No obstacle is lost, unless `prefer` says so: a new cell takes the most conservative value of all old cells that it
    overlaps, in the order free, 1 to 64, unknown (also outside the map), 65 to 99, occupied. It is free only if all of
    its area was. Finer cells that align with the old ones, quarter turns and cropping keep every value.

    Args:
        grid: The map. Its lower-left corner, and without `align` its yaw, stay where they are.
        other: A second map, merged into it, on any lattice of cells.
        prefer: Which value wins where a cell is known in both maps: "occupied" (the higher value), "free" (the lower
            one), "first" or "second". A cell that is unknown in one map takes the other's value.
        align: Whether to make the yaw of the origin 0.
        resolution: Edge of the new cells [m]; by default the map's.
        crop: ((x_min, y_min), (x_max, y_max)) [m] in the map frame, expanded to whole cells; "content": the smallest
            rectangle with all known cells.
        max_cells: The most cells to accept.

    Raises:
        MapError: If a number is invalid, the map would have too many cells, or the result is empty.
    """
    if prefer not in PREFERENCES:
        raise MapError(f"prefer is {prefer!r}; it must be one of {', '.join(PREFERENCES)}")
    edge = check_resolution(grid.resolution if resolution is None else resolution)
    frame = Pose2D(0.0, 0.0, 0.0) if align else grid.origin
    named = {"the map" if other is None else "the first map": _express(grid, frame)}
    if other is not None:
        named["the second map"] = _express(other, frame)
    whole = _lay_out(list(named.values()), edge)
    layout = whole if crop is None or crop == "content" else _crop_layout(whole, crop, frame, max_cells)
    check_size((layout.cols, layout.rows), max_cells)
    losses: list[Loss] = []
    made: list[Resampled] = []
    for name, part in named.items():
        made.append(resample(part, layout))
        losses += _describe_resampling(name, part, layout, made[-1])
        losses += _describe_cut(name, part, layout) if layout != whole else []
    cells = made[0].cells
    if other is not None:
        losses += _describe_disagreement(made[0].cells, made[1].cells, prefer)
        cells = _merge(made[0].cells, made[1].cells, prefer)
    row, col = 0, 0
    if crop == "content":
        cells, row, col = _crop_to_content(cells)
    return Conversion(OccupancyGrid(cells, edge, _place(frame, layout, row, col), grid.surface), tuple(losses))


def _express(grid: OccupancyGrid, frame: Pose2D) -> OccupancyGrid:
    """Return a map in another frame."""
    if frame == grid.origin:
        return replace(grid, origin=Pose2D(0.0, 0.0, 0.0))
    return replace(grid, origin=frame.inverse() @ grid.origin)


def _lay_out(grids: Sequence[OccupancyGrid], edge: float) -> CellLayout:
    """Return a cell layout over all maps, with the corner of the first map on the corner of a cell."""
    corner, _ = find_bounds(grids[0])
    first, end = np.zeros(2), np.zeros(2)
    for grid in grids:
        with np.errstate(over="ignore"):
            low, high = ((bound - corner) / edge for bound in find_bounds(grid))
        slack = find_slack(grid, edge)
        first = np.minimum(first, np.floor(low + slack))
        end = np.maximum(end, np.ceil(high - slack))
    if not np.isfinite(end - first).all():
        raise MapError(f"the map is far too large for cells of {edge:g} m: use larger cells")
    origin = corner + first * edge
    cols, rows = (end - first).tolist()
    return CellLayout(edge, Pose2D(float(origin[0]), float(origin[1])), int(rows), int(cols))


def _crop_layout(whole: CellLayout, crop: Bounds, frame: Pose2D, max_cells: int) -> CellLayout:
    try:
        corners = np.asarray(crop, dtype=np.float64)
    except (TypeError, ValueError):
        corners = np.empty(0)
    if corners.shape != (2, 2) or not np.isfinite(corners).all() or (corners[1] <= corners[0]).any():
        raise MapError(
            f'crop must be ((x_min, y_min), (x_max, y_max)) in metres, smaller first, or "content", got {crop!r}'
        )
    left, bottom, right, top = (float(number) for number in corners.ravel())
    around = frame.inverse().transform_points([[left, bottom], [right, bottom], [left, top], [right, top]])
    local = (around - (whole.origin.x, whole.origin.y)) / whole.resolution
    limit = np.array([whole.cols, whole.rows], dtype=np.float64)
    first = np.floor(local.min(axis=0) + _ROUNDING)
    end = np.maximum(np.ceil(local.max(axis=0) - _ROUNDING), first + 1.0)
    first, end = np.maximum(first, 0.0), np.minimum(end, limit)
    if (end <= first).any():
        width, height = limit * whole.resolution
        low = frame.transform_points([[whole.origin.x, whole.origin.y]])[0]
        raise MapError(
            f"no part of the map lies in x {left:g} to {right:g}, y {bottom:g} to {top:g}: it begins at ({low[0]:g}, "
            f"{low[1]:g}) and measures {width:g} x {height:g} m"
        )
    check_size(end - first, max_cells)
    x, y = (whole.origin.x, whole.origin.y) + first * whole.resolution
    cols, rows = (end - first).tolist()
    return CellLayout(whole.resolution, Pose2D(float(x), float(y)), int(rows), int(cols))


def _crop_to_content(cells: Cells) -> tuple[Cells, int, int]:
    """Return the smallest rectangle with all known cells, and its first row and column."""
    known = cells != UNKNOWN
    rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    if len(rows) == 0:
        raise MapError("all cells of the map are unknown: it has no content to crop to")
    return cells[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1], int(rows[0]), int(cols[0])


def _place(frame: Pose2D, layout: CellLayout, row: int, col: int) -> Pose2D:
    x, y = layout.origin.x + col * layout.resolution, layout.origin.y + row * layout.resolution
    if x == y == 0.0:
        return frame
    placed = frame @ Pose2D(x, y, 0.0)
    # Sums of multiples of 0.05 end in …001; round to a picometre.
    return Pose2D(round(placed.x, 12), round(placed.y, 12), frame.yaw)


def _merge(first: Cells, second: Cells, prefer: Prefer) -> Cells:
    if prefer == "occupied":
        return np.maximum(first, second)
    if prefer == "free":  # Unknown is 255 there.
        return np.minimum(first.view(np.uint8), second.view(np.uint8)).view(np.int8)
    winner, filler = (first, second) if prefer == "first" else (second, first)
    return np.where(winner == UNKNOWN, filler, winner)


def _describe_resampling(name: str, grid: OccupancyGrid, layout: CellLayout, made: Resampled) -> list[Loss]:
    losses: list[Loss] = []
    if made.moved > _MOVED:
        text = f"{name} is moved or rotated by up to {made.moved * 1e3:.2g} mm to align its cells with the new ones"
        losses.append(Loss("moved", text))
    if not made.lossless:
        yaw = math.degrees(grid.origin.yaw)
        quarter = abs(yaw / 90.0 - round(yaw / 90.0)) * 90.0
        turned = f", turned by {yaw:.4g}°," if quarter > 0.01 else ""
        text = (
            f"{name} goes from cells of {grid.resolution:g} m{turned} to other ones of {layout.resolution:g} m: "
            f"obstacles and unknown space reach up to {layout.resolution:g} m farther in x and y"
        )
        losses.append(Loss("resampled", text))
    return losses


def _describe_cut(name: str, grid: OccupancyGrid, layout: CellLayout) -> list[Loss]:
    """Return the loss of known cells whose centre was cut away, if there are any."""
    rows, cols = grid.shape
    free = occupied = 0
    step = max(1, _BLOCK_CELLS // cols)
    for first in range(0, rows, step):
        part = grid.data[first : first + step]
        place = layout.world_to_cell(*grid.cell_to_world(np.arange(first, first + len(part))[:, None], np.arange(cols)))
        gone = ~layout.contains(*place)
        free += int(np.count_nonzero(gone & (part == FREE)))
        occupied += int(np.count_nonzero(gone & (part > FREE)))
    if free + occupied == 0:
        return []
    return [Loss("cropped", f"{free} free and {occupied} other known cells of {name} are cut away", free + occupied)]


def _describe_disagreement(first: Cells, second: Cells, prefer: Prefer) -> list[Loss]:
    differ = (first != second) & (first != UNKNOWN) & (second != UNKNOWN)
    count = int(np.count_nonzero(differ))
    if count == 0:
        return []
    opposed = int(np.count_nonzero(differ & ((first >= OCCUPIED_FROM) != (second >= OCCUPIED_FROM))))
    winner = {"occupied": "the higher value", "free": "the lower value"}.get(prefer, f"the {prefer} map")
    text = f"the maps differ in {count} cells, {opposed} of them occupied in one of them alone: {winner} wins"
    return [Loss("disagreement", text, count)]
