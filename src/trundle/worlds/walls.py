"""Walls where a map is occupied or unknown."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle._core import flood_largest
from trundle.errors import WorldError
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, OccupancyCells, Solid
from trundle.maps import OccupancyGrid
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.values import check_kind, is_finite_number, show_value
from trundle.worlds.map_look import ISLAND_COLOR, UNKNOWN_COLOR, WALL_COLOR, find_islands
from trundle.worlds.options import Unknown, check_choice

MOST_BOXES = 5_000
"""Above this many boxes physics engines slow down, and one field of blocked cells is used instead."""

# Classes of cells while they are merged: 0 is left out.
_FREE, _OCCUPIED, _UNKNOWN = 0, 1, 2
_KINDS = {_OCCUPIED: "wall", _UNKNOWN: "unknown"}

IntArray = npt.NDArray[np.int64]


class Rectangles(NamedTuple):
    """Rectangles of cells: rows row_begin..row_end-1, columns col_begin..col_end-1, all of one class."""

    row_begin: IntArray
    row_end: IntArray
    col_begin: IntArray
    col_end: IntArray
    kind: IntArray


class Walls(NamedTuple):
    """The data of a `World` of walls.

    Attributes:
        name: The stem of the map's file, or `map`.
        solids: Boxes, or one solid of blocked cells.
        seeds: One point (x, y) [m], in the largest free area.
    """

    name: str
    solids: tuple[Solid, ...]
    seeds: tuple[tuple[float, float], ...]


def extrude(
    grid: OccupancyGrid | str | os.PathLike[str],
    *,
    height: float = 1.0,
    unknown: Unknown = "solid",
    most_boxes: int = MOST_BOXES,
) -> Walls:
    """Extrude a map into walls.

    Cells are merged into boxes, row by row and then over equal runs of neighbouring rows. A box is named after its
    cells, as a slice of the map's data: `map[r0:r1,c0:c1]`. A map that needs more than `most_boxes` becomes one solid
    of blocked cells, `map`, whose contacts are reported as `map[row,col]`.

    Args:
        grid: A grid, or the path of a ROS map YAML.
        height: Height of the walls [m].
        unknown: Treat unknown cells as "solid" or "free".
        most_boxes: The largest number of boxes.

    Raises:
        WorldError: If the height is not positive, or the map has no free cell.
        InputError: If `unknown` is neither.
        MapError: If the file cannot be used.
    """
    check_choice("unknown", unknown, ("solid", "free"))
    if not (is_finite_number(height) and height > 0.0):
        raise WorldError(f"height must be a positive number of metres, got {show_value(height)}")
    advice = "OccupancyGrid.load(path) loads one"
    check_kind(grid, (OccupancyGrid, str, os.PathLike), "a world's map", advice)
    name = "map"
    if not isinstance(grid, OccupancyGrid):
        name = Path(grid).stem
        grid = OccupancyGrid.load(grid)
    classes = _classify(grid, unknown)
    if not (classes == _FREE).any():
        raise WorldError(f"map {name!r} has no free cell, so it has no room for a robot; trundle map check says why")
    rectangles = merge_cells(classes, most=most_boxes)
    if rectangles is None:
        shape = OccupancyCells(classes != _FREE, grid.resolution, height)
        pose = Pose3D.planar(grid.origin.x, grid.origin.y, 0.0, grid.origin.yaw)
        solids = (Solid("map", shape, pose, WALL_COLOR, "wall"),)
    else:
        islands = find_islands(classes == _OCCUPIED, grid.resolution)
        solids = _boxes(grid, rectangles, height, islands)
    return Walls(name, solids, (_seed(grid, classes),))


def merge_cells(classes: npt.NDArray[np.uint8], *, most: int) -> Rectangles | None:
    """Merge cells that are not 0 into rectangles of one class; None if more than `most` are needed.

    First merges runs of equal cells in a row, then equal runs in consecutive rows.
    """
    rows, cols = classes.shape
    padded = np.zeros((rows, cols + 2), dtype=np.uint8)
    padded[:, 1:-1] = classes
    changes = padded[:, 1:] != padded[:, :-1]
    begins = np.flatnonzero(changes[:, :-1] & (classes != 0))
    ends = np.flatnonzero(changes[:, 1:] & (classes != 0))
    row, begin, end = begins // cols, begins % cols, ends % cols + 1
    kind = classes.ravel()[begins].astype(np.int64)
    # The equal run that begins at the same column in the row below, if any.
    above = np.searchsorted(begins, begins - cols)
    above = np.minimum(above, max(len(begins) - 1, 0))
    grows = (begins[above] == begins - cols) & (end[above] == end) & (kind[above] == kind) & (row > 0)
    if len(begins) - np.count_nonzero(grows) > most:
        return None
    # Each run points to the one that it continues; pointers are doubled until all runs of a box point to its first.
    first = np.where(grows, above, np.arange(len(begins)))
    while True:
        further = first[first]
        if np.array_equal(further, first):
            break
        first = further
    heads, count = np.unique(first, return_counts=True)
    return Rectangles(row[heads], row[heads] + count, begin[heads], end[heads], kind[heads])


def _classify(grid: OccupancyGrid, unknown: Unknown) -> npt.NDArray[np.uint8]:
    """Return classes of the cells; as in a costmap, only 100 is occupied and 1 to 99 are free."""
    classes = np.full(grid.shape, _FREE, dtype=np.uint8)
    classes[grid.data == OCCUPIED] = _OCCUPIED
    if unknown == "solid":
        classes[grid.data == UNKNOWN] = _UNKNOWN
    return classes


def _boxes(grid: OccupancyGrid, cells: Rectangles, height: float, islands: npt.NDArray[np.bool_]) -> tuple[Solid, ...]:
    edge = grid.resolution
    middle = np.c_[(cells.col_begin + cells.col_end) / 2.0 * edge, (cells.row_begin + cells.row_end) / 2.0 * edge]
    places = grid.origin.transform_points(middle).tolist()
    upright = Pose3D.planar(0.0, 0.0, 0.0, grid.origin.yaw).quaternion
    solids: list[Solid] = []
    for (x, y), row, row_end, col, col_end, kind in zip(places, *(column.tolist() for column in cells), strict=True):
        size = ((col_end - col) * edge, (row_end - row) * edge, height)
        pose = Pose3D((x, y, height / 2.0), upright)
        name = f"map[{row}:{row_end},{col}:{col_end}]"
        color = UNKNOWN_COLOR
        if kind == _OCCUPIED:
            color = ISLAND_COLOR if islands[row:row_end, col:col_end].mean() > 0.5 else WALL_COLOR
        solids.append(Solid(name, Box(size), pose, color, _KINDS[kind]))
    return tuple(solids)


def _seed(grid: OccupancyGrid, classes: npt.NDArray[np.uint8]) -> tuple[float, float]:
    """Return the middle of the longest row of cells in the largest free area."""
    area = np.where(classes == _FREE, np.int8(-1), np.int8(100))
    flood_largest(area)
    rows, cols = area.shape
    padded = np.zeros((rows, cols + 2), dtype=np.int8)
    padded[:, 1:-1] = area == 0
    changes = np.diff(padded, axis=1)
    begins, ends = np.flatnonzero(changes == 1), np.flatnonzero(changes == -1)
    longest = int(np.argmax(ends - begins))
    row, col = divmod(int((begins[longest] + ends[longest] - 1) // 2), cols + 1)
    x, y = grid.cell_to_world(row, col)
    return float(x), float(y)
