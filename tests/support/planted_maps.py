"""Good maps to plant mistakes in."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
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


@cache
def round_room() -> World:
    """A room of six equal walls: it looks the same turned by sixths."""
    walls: list[Solid] = []
    for index in range(6):
        angle = index * math.pi / 3.0
        pose = Pose3D.planar(3.0 * math.cos(angle), 3.0 * math.sin(angle), 0.5, angle)
        walls.append(Solid(f"wall {index}", Box((0.2, 3.6, 1.0)), pose))
    return World("round", tuple(walls), seeds=((0.0, 0.0),))


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


def turned(grid: OccupancyGrid, degrees: float, right: float = 0.0, up: float = 0.0) -> OccupancyGrid:
    """What a map looks like whose own frame is turned and then moved [m]: each cell has the value at its centre."""
    frame = Pose2D(right, up, math.radians(degrees))
    rows, cols = grid.shape
    corners = frame.transform_points(
        grid.origin.transform_points([(x, y) for x in (0, cols * EDGE) for y in (0, rows * EDGE)])
    )
    low = np.floor(corners.min(axis=0) / EDGE) * EDGE
    width, height = np.ceil((corners.max(axis=0) - low) / EDGE).astype(int)
    made = OccupancyGrid(np.full((height, width), -1, dtype=np.int8), EDGE, Pose2D(*low))
    x, y = np.broadcast_arrays(*made.cell_to_world(np.arange(height)[:, None], np.arange(width)))
    places = frame.inverse().transform_points(np.column_stack([x.ravel(), y.ravel()]))
    row, col = grid.world_to_cell(places[:, 0], places[:, 1])
    inside = grid.contains(row, col)
    data = np.full(width * height, -1, dtype=np.int8)
    data[inside] = grid.data[row[inside], col[inside]]
    return redrawn(made, data.reshape(height, width))


def surveyed(grid: OccupancyGrid, seed: int, *, seen: float = 0.7) -> OccupancyGrid:
    """A map as a robot makes it: the surfaces of things, noisy and with gaps, moved boxes, and a part never seen."""
    random = np.random.default_rng(seed)
    rows, cols = grid.shape
    free, occupied = grid.data == 0, grid.data == 100
    for _ in range(rows * cols // 8000):
        row, col = random.integers(0, rows - 12), random.integers(0, cols - 12)
        box = np.s_[row : row + random.integers(5, 12), col : col + random.integers(5, 12)]
        if free[box].all():
            free[box], occupied[box] = False, True
    beside = np.pad(free, 1)
    near = beside[:-2, 1:-1] | beside[2:, 1:-1] | beside[1:-1, :-2] | beside[1:-1, 2:]
    row, col = np.nonzero(occupied & near & (random.random(grid.shape) > 0.1))
    off = random.integers(-1, 2, (2, len(row))) * (random.random(len(row)) < 0.3)
    data = np.where(free, 0, -1).astype(np.int8)
    data[np.clip(row + off[0], 0, rows - 1), np.clip(col + off[1], 0, cols - 1)] = 100
    angle = random.uniform(0.0, 2.0 * math.pi)
    along = np.add.outer(np.arange(rows) * math.sin(angle), np.arange(cols) * math.cos(angle))
    data[along > np.quantile(along[free], seen)] = -1
    return redrawn(grid, data)
