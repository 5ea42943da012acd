"""Maps of a few solids, and their occupied cells."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from trundle.geometry.solids import Mesh, Solid
from trundle.maps import OccupancyGrid


@dataclass
class Room:
    """Not a `World`: anything with solids, bounds and seeds will do."""

    solids: list[Solid]
    seeds: list[tuple[float, float]] = field(default_factory=list)

    @property
    def bounds(self):
        lows, highs = zip(*(solid.bounds() for solid in self.solids), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)


FIELD = ((-2.0, -2.0), (2.0, 2.0))


def occupied(*shapes_and_poses, bounds=FIELD, **options) -> OccupancyGrid:
    solids = [Solid(str(i), shape, pose) for i, (shape, pose) in enumerate(shapes_and_poses)]
    return OccupancyGrid.from_world(Room(solids), bounds=bounds, **options)


def count(grid: OccupancyGrid) -> int:
    return int((grid.data == 100).sum())


def extent(grid: OccupancyGrid) -> tuple[float, float, float, float]:
    """x_min, y_min, x_max, y_max [m] of the occupied cells."""
    rows, cols = np.nonzero(grid.data == 100)
    low = np.array([cols.min(), rows.min()]) * grid.resolution + (grid.origin.x, grid.origin.y)
    high = np.array([cols.max() + 1, rows.max() + 1]) * grid.resolution + (grid.origin.x, grid.origin.y)
    return tuple(round(float(number), 9) for number in (*low, *high))


def cube_mesh(edge: float) -> Mesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * edge / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))
