"""`MapErrors`: what is wrong on the map that a robot gets, while the world stays true."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np
from pydantic import Field

from trundle._core import label_components
from trundle.costmap import Costmap
from trundle.files.config_fields import NotNegative, Positive
from trundle.files.yaml_config import Config
from trundle.geometry import FloatArray
from trundle.maps import FREE, OCCUPIED, OccupancyGrid
from trundle.maps.cells import OCCUPIED_FROM
from trundle.mission.obstacles import Counts, FreePlaces, Lengths

_MISSING_STREAM, _GHOST_STREAM = zlib.crc32(b"missing from the map"), zlib.crc32(b"ghosts on the map")


class MapErrors(Config):
    """What is wrong on the robot's map: `{missing: 0.25, ghosts: 12}`. The world stays as it is.

    Planner, costmap and localizer get the wrong map. Start and goals are those that would be picked without errors. The
    seed of the scenario decides what is wrong.

    Attributes:
        missing: Share of the smaller objects that are left out, 0 to 1. An object is what hangs together on the map.
        largest: An object is small if it is at most so long and so wide on the map [m].
        ghosts: How many boxes are on the map that are not in the world: a number, or the least and the most. They are
            where the robot could be, away from its start and its goals. Nothing promises that the map has a path left.
        size: Edges of the ghosts [m]: a number, or the least and the most.
        room: Distance that ghosts keep from where the robot turns at its start and its goals [m].
    """

    missing: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    largest: Positive = 2.0
    ghosts: Counts = (0, 0)
    size: Lengths = (0.3, 0.8)
    room: NotNegative = 0.3

    def change(
        self, grid: OccupancyGrid, costmap: Costmap, ends: Sequence[Sequence[float]], seed: int
    ) -> OccupancyGrid:
        """Make the map that the robot gets.

        Args:
            grid: The true map.
            costmap: The robot's costmap of it.
            ends: Start and goals, in order: (x, y, …) [m], map frame.
            seed: The same seed gives the same errors.

        Raises:
            ScenarioError: If the map has no room for the ghosts.
        """
        cells = grid.data.copy()
        self._leave_out(cells, grid.resolution, np.random.default_rng([_MISSING_STREAM, seed]))
        rng = np.random.default_rng([_GHOST_STREAM, seed])
        places = FreePlaces(costmap, np.array([end[:2] for end in ends], dtype=np.float64), rng, "map_errors", "ghost")
        for _ in range(int(rng.integers(self.ghosts[0], self.ghosts[1] + 1))):
            size, yaw = rng.uniform(*self.size, 2), float(rng.uniform(-math.pi, math.pi))
            clear = costmap.circumscribed_radius + 0.5 * math.hypot(*size) + self.room
            _draw_box(cells, grid, places.draw(clear=clear), size, yaw)
        return replace(grid, data=cells)

    def _leave_out(self, cells: np.ndarray, resolution: float, rng: np.random.Generator) -> None:
        """Free the cells of a share of the small objects, and the unknown ones that these enclose."""
        taken = cells != FREE
        labels, table = label_components(taken.view(np.uint8), True)
        long = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * resolution
        solid = np.bincount(labels[cells >= OCCUPIED_FROM], minlength=len(table) + 1)[1:] > 0
        small = np.flatnonzero(solid & (long <= self.largest + 1e-9))
        chosen = rng.permutation(small)[: round(self.missing * len(small))]
        gone = np.zeros(len(table) + 1, dtype=bool)
        gone[chosen + 1] = True
        cells[gone[labels]] = FREE


def _draw_box(cells: np.ndarray, grid: OccupancyGrid, place: tuple[float, float], size: FloatArray, yaw: float) -> None:
    """Occupy the cells whose centres are in a box, and at least the one of its middle."""
    row, col = (int(one) for one in grid.world_to_cell(*place))
    reach = math.ceil(0.5 * math.hypot(*size) / grid.resolution)
    rows, cols = np.mgrid[
        max(row - reach, 0) : min(row + reach + 1, cells.shape[0]),
        max(col - reach, 0) : min(col + reach + 1, cells.shape[1]),
    ]
    x, y = grid.cell_to_world(rows, cols)
    dx, dy = x - place[0], y - place[1]
    along, across = dx * math.cos(yaw) + dy * math.sin(yaw), dy * math.cos(yaw) - dx * math.sin(yaw)
    inside = (np.abs(along) <= 0.5 * size[0]) & (np.abs(across) <= 0.5 * size[1])
    cells[rows[inside], cols[inside]] = OCCUPIED
    cells[row, col] = OCCUPIED
