"""Good maps to plant mistakes in."""

from __future__ import annotations

from functools import cache

import numpy as np

from trundle.geometry import Pose2D, Pose3D
from trundle.maps import OccupancyGrid
from trundle.solids import Box, Solid
from trundle.worlds import World

EDGE = 0.05


@cache
def warehouse() -> World:
    return World.generate("warehouse", seed=7)


@cache
def room() -> World:
    """An 8 x 5 m room with a box in a corner and a wall with a door of 1 m: nothing about it is symmetric."""
    pieces = {
        "south": ((0.0, -0.1, 8.2, 0.2)),
        "north": ((0.0, 5.1, 8.2, 0.2)),
        "west": ((-4.1, 2.5, 0.2, 5.4)),
        "east": ((4.1, 2.5, 0.2, 5.4)),
        "box": ((-3.0, 0.6, 1.0, 0.7)),
        "wall": ((1.0, 1.0, 0.2, 2.0)),
        "wall beyond the door": ((1.0, 4.0, 0.2, 2.0)),
    }
    return World("room", tuple(block(name, *piece) for name, piece in pieces.items()), seeds=((0.0, 2.5),))


@cache
def square_room() -> World:
    """A room that looks the same turned by quarters and mirrored."""
    pieces = ((0.0, 3.1, 6.4, 0.2), (0.0, -3.1, 6.4, 0.2), (3.1, 0.0, 0.2, 6.0), (-3.1, 0.0, 0.2, 6.0))
    return World("square", tuple(block(f"wall {n}", *piece) for n, piece in enumerate(pieces)), seeds=((0.0, 0.0),))


@cache
def long_room() -> World:
    """A room that looks the same turned by 180° alone: two boxes in opposite corners."""
    pieces = (
        (0.0, 3.1, 10.4, 0.2),
        (0.0, -3.1, 10.4, 0.2),
        (5.1, 0.0, 0.2, 6.0),
        (-5.1, 0.0, 0.2, 6.0),
        (-4.0, 2.0, 1.0, 0.6),
        (4.0, -2.0, 1.0, 0.6),
    )
    return World("long", tuple(block(f"part {n}", *piece) for n, piece in enumerate(pieces)), seeds=((0.0, 0.0),))


def block(name: str, x: float, y: float, width: float, depth: float) -> Solid:
    return Solid(name, Box((width, depth, 1.0)), Pose3D((x, y, 0.5)))


@cache
def map_of(world: World) -> OccupancyGrid:
    return OccupancyGrid.from_world(world, resolution=EDGE)


def changed(grid: OccupancyGrid, *boxes: tuple[float, float, float, float, int]) -> OccupancyGrid:
    """A map with boxes (x, y, x end, y end, value) painted into it."""
    data = grid.data.copy()
    for x, y, x_end, y_end, value in boxes:
        row, col = grid.world_to_cell(x + 1e-6, y + 1e-6)
        row_end, col_end = grid.world_to_cell(x_end - 1e-6, y_end - 1e-6)
        data[row : row_end + 1, col : col_end + 1] = value
    return OccupancyGrid(data, grid.resolution, grid.origin)


def moved(grid: OccupancyGrid, right: float, up: float) -> OccupancyGrid:
    """A map whose origin is off by so many cells."""
    origin = grid.origin
    return OccupancyGrid(grid.data, grid.resolution, Pose2D(origin.x + right * EDGE, origin.y + up * EDGE, origin.yaw))


def redrawn(grid: OccupancyGrid, data: np.ndarray) -> OccupancyGrid:
    return OccupancyGrid(data, grid.resolution, grid.origin)


def same(one: OccupancyGrid, other: OccupancyGrid) -> bool:
    return (
        one.shape == other.shape
        and np.array_equal(one.data, other.data)
        and np.allclose(one.origin.as_tuple(), other.origin.as_tuple(), atol=1e-6)
    )
