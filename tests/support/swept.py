"""Rooms, costmaps of them, and what a footprint sweeps over on a path, by shapely."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import shapely

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.robots import Robot

CARTER = Robot.load("nova_carter").outline


def room(width, height, *blocks, resolution=0.05):
    """A room with walls of one cell, its inside from (0, 0), and blocks (x0, y0, x1, y1) [m] in it."""
    data = np.zeros((round(height / resolution) + 2, round(width / resolution) + 2), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    for block in blocks:
        x0, y0, x1, y1 = (round(value / resolution) + 1 for value in block)
        data[y0:y1, x0:x1] = 100
    return data


def costmap_of(data, footprint: npt.ArrayLike = CARTER, resolution=0.05, origin=None):
    return Costmap.from_grid(
        OccupancyGrid(data, resolution, origin or Pose2D(-resolution, -resolution)), np.array(footprint)
    )


def densely(path: Path, step: float = 0.01) -> FloatArray:
    """Poses along the straight lines and turns of a path."""
    return np.concatenate([path.poses[:1], along_legs(path.poses[:-1], path.poses[1:], step)])


def along_legs(first: FloatArray, last: FloatArray, step: float, turn: float = 0.01) -> FloatArray:
    """Poses along lines and turns, shape (N, 3), `step` [m] and `turn` [rad] apart at most, but the first of each."""
    change = last - first
    change[:, 2] = np.remainder(change[:, 2] + math.pi, 2 * math.pi) - math.pi
    counts = 1 + np.maximum(np.hypot(change[:, 0], change[:, 1]) / step, np.abs(change[:, 2]) / turn).astype(int)
    owner = np.repeat(np.arange(len(first)), counts)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    return first[owner] + (number / counts[owner])[:, None] * change[owner]


def penalised_length(path: Path, *, reverse: float, change: float, turn: float) -> float:
    """Length [m] of a path along its arcs, weighted backwards, with a price for each change and radian in place."""
    steps = np.diff(path.poses, axis=0)
    turns = np.abs(np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi)
    chords = np.hypot(steps[:, 0], steps[:, 1])
    moving = chords > 1e-6
    arcs = chords / np.sinc(turns / 2 / np.pi)
    backward = path.backward & moving
    total = arcs[moving & ~backward].sum() + reverse * arcs[backward].sum() + turn * turns[~moving].sum()
    # A turn in place between two stretches parts them: no change is counted there.
    changes = (moving[:-1] & moving[1:] & (backward[:-1] != backward[1:])).sum()
    return float(total + change * changes)


def swept_area_blocked(costmap: Costmap, path: Path, outline: FloatArray | None = None) -> float:
    """Area [m²] of blocked cells that an outline sweeps over: hulls of neighbouring placements, by shapely."""
    poses = densely(path, math.inf)  # the hull of what only moves is what it sweeps
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    corners = costmap.footprint if outline is None else outline
    placed = np.stack(
        [
            poses[:, :1] + cos[:, None] * corners[:, 0] - sin[:, None] * corners[:, 1],
            poses[:, 1:2] + sin[:, None] * corners[:, 0] + cos[:, None] * corners[:, 1],
        ],
        axis=2,
    )
    both = np.concatenate([placed[:-1], placed[1:]], axis=1)
    swept = shapely.union_all(shapely.convex_hull(shapely.multipoints(both)))
    rows, cols = np.nonzero(costmap.data >= 254)
    edges = [
        costmap.origin.transform_points(costmap.resolution * np.column_stack([cols + dx, rows + dy]))
        for dx, dy in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
    shapely.prepare(swept)
    cells = shapely.polygons(np.stack(edges, axis=1))
    met = cells[shapely.intersects(swept, cells)]
    return float(shapely.area(shapely.intersection(met, swept)).sum())
