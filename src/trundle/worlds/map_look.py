"""How worlds made of maps are drawn: what a wall is, what stands between walls, and what nobody has seen.

Only pictures use this. A robot collides with the solids of the world, and its lidars see them, as they are.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Color, OccupancyCells, Solid, solids_bounds

WALL_COLOR: Color = (0.80, 0.81, 0.83, 1.0)
ISLAND_COLOR: Color = (0.74, 0.62, 0.47, 1.0)
UNKNOWN_COLOR: Color = (0.36, 0.38, 0.42, 1.0)
CAP_COLOR: Color = (0.20, 0.25, 0.34, 1.0)
"""Colour of the tops of walls: from above they read as the black lines of the map."""

FOOT_COLOR: Color = (0.34, 0.36, 0.40, 1.0)

RISE = 0.2
"""How much higher walls are drawn than they are, as a share of their height: higher than what stands between them."""

_LONGEST_M = 2.5  # occupied areas that are longer than this are walls,
_THIN_M = 0.45  # but for their parts that are thicker than this
_THIN_CELLS = 2.5  # and than this many cells,
_BULK_M = 3.0  # if not thicker than this
_MOST_CELLS = 16_000_000
_PLATE_M = 0.04  # height of unknown cells as they are drawn, so that they hide nothing

_MAP_BOX = re.compile(r"map\[(\d+):(\d+),(\d+):(\d+)\]")


@dataclass(frozen=True, slots=True)
class DrawnSolid:
    """A solid as it is drawn.

    Attributes:
        solid: Its shape, pose and colour in pictures.
        capped: Whether it is a wall with a dark top.
        of_map: Whether it is made of a map's cells.
    """

    solid: Solid
    capped: bool = False
    of_map: bool = False


def find_islands(occupied: npt.NDArray[np.bool_], resolution: float) -> npt.NDArray[np.bool_]:
    """Return which occupied cells are no walls: areas of at most 2.5 m, and what is too thick, such as a cupboard.

    What is thicker than 3 m is all that lies beyond a wall. Of maps with more than 16 million cells all are walls.

    Args:
        occupied: Shape (rows, cols).
        resolution: Edge of a cell [m].
    """
    if occupied.size > _MOST_CELLS:
        return np.zeros(occupied.shape, dtype=np.bool_)
    labels, table = label_components(np.ascontiguousarray(occupied).view(np.uint8), True)
    longest = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * resolution
    small = np.concatenate([[False], longest <= _LONGEST_M])[labels]
    thick = int(max(_THIN_M / resolution, _THIN_CELLS)) + 1
    bulk = max(int(_BULK_M / resolution), thick) + 1
    return small | (_opened(occupied, thick) & ~_opened(occupied, bulk))


def _opened(cells: npt.NDArray[np.bool_], side: int) -> npt.NDArray[np.bool_]:
    """Return which cells are in a square of set cells with this side."""
    if min(cells.shape) < side:
        return np.zeros(cells.shape, dtype=np.bool_)
    squares = _window_sums(cells, side) == side * side
    return _window_sums(np.pad(squares, side - 1), side) > 0


def _window_sums(cells: npt.NDArray[np.bool_], side: int) -> npt.NDArray[np.int32]:
    """Return how many cells are set in each square, by its first cell."""
    sums = np.pad(cells.cumsum(axis=0, dtype=np.int32).cumsum(axis=1, dtype=np.int32), ((1, 0), (1, 0)))
    return sums[side:, side:] - sums[:-side, side:] - sums[side:, :-side] + sums[:-side, :-side]


def as_drawn(solid: Solid) -> list[DrawnSolid]:
    """Return how a solid is drawn: itself, unless it is made of a map's cells.

    Of these, walls are higher than what stands between them, and unknown cells are a dark plate.
    """
    match solid.shape:
        case OccupancyCells(blocked, resolution, height):
            islands = find_islands(blocked, resolution)
            walls = OccupancyCells(blocked & ~islands, resolution, height * (1.0 + RISE))
            drawn = [DrawnSolid(replace(solid, shape=walls), capped=True, of_map=True)] if walls.blocked.any() else []
            if islands.any():
                low = OccupancyCells(islands, resolution, height)
                island = Solid(f"{solid.name}:islands", low, solid.pose, ISLAND_COLOR, solid.kind)
                drawn.append(DrawnSolid(island, of_map=True))
            return drawn
        case Box((width, depth, height)) if _MAP_BOX.fullmatch(solid.name):
            if solid.kind == "unknown":
                return [DrawnSolid(_with_height(solid, (width, depth, height), min(height, _PLATE_M)), of_map=True)]
            if solid.color == ISLAND_COLOR:
                return [DrawnSolid(solid, of_map=True)]
            wall = _with_height(solid, (width, depth, height), height * (1.0 + RISE))
            return [DrawnSolid(wall, capped=True, of_map=True)]
        case _:
            return [DrawnSolid(solid)]


def _with_height(solid: Solid, size: tuple[float, float, float], height: float) -> Solid:
    """Return a box of this size [m] with another height [m], on the same floor."""
    lift = (height - size[2]) / 2.0
    return replace(solid, shape=Box((*size[:2], height)), pose=solid.pose @ Pose3D((0.0, 0.0, lift)))


def shown_bounds(solids: Sequence[Solid]) -> tuple[FloatArray, FloatArray]:
    """Return bounds (low, high) [m] of what a picture of a world's solids shows, each of shape (3,); zeros without any.

    Those of a map end where only unknown cells follow.
    """
    if not solids:
        return np.zeros(3), np.zeros(3)
    known = _known_area(solids)
    shown = [solid for solid in solids if solid.kind != "unknown"] if known else solids
    lows, highs = (np.reshape(edges, (-1, 3)) for edges in solids_bounds(shown))
    if known:
        lows, highs = np.vstack([lows, known[0]]), np.vstack([highs, known[1]])
    return lows.min(axis=0), highs.max(axis=0)


def _known_area(solids: Sequence[Solid]) -> tuple[FloatArray, FloatArray] | None:
    """Return the bounds [m] of the cells of a map that are known; None where all are, or none."""
    frame = None
    cells: list[list[int]] = []
    for solid in solids:
        found = _MAP_BOX.fullmatch(solid.name) if solid.kind == "unknown" else None
        if found and isinstance(solid.shape, Box):
            cells.append([int(number) for number in found.groups()])
            frame = (solid.pose, solid.shape.size, cells[-1])
    if frame is None:
        return None
    known = np.ones((max(row[1] for row in cells), max(row[3] for row in cells)), dtype=np.bool_)
    for row, row_end, col, col_end in cells:
        known[row:row_end, col:col_end] = False
    if not known.any():
        return None
    pose, size, (row, row_end, col, col_end) = frame
    edge = size[0] / (col_end - col)
    rows, cols = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    x = (np.array([cols[0], cols[-1] + 1]) - (col + col_end) / 2.0) * edge
    y = (np.array([rows[0], rows[-1] + 1]) - (row + row_end) / 2.0) * edge
    z = size[2] / 2.0
    corners = pose.transform_points([(at_x, at_y, at_z) for at_x in x for at_y in y for at_z in (-z, z)])
    return corners.min(axis=0), corners.max(axis=0)


def drawn_solids(solids: Sequence[Solid]) -> list[DrawnSolid]:
    """Return how solids are drawn."""
    return [drawn for solid in solids for drawn in as_drawn(solid)]
