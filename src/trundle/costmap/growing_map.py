"""`GrowingMap`: the costmap of a map that a localizer makes while the robot drives."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.costmap.costmap import Costmap
from trundle.costmap.costmap_settings import CostmapSettings
from trundle.errors import InputError, MapError
from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.cells import UNKNOWN, round_trinary
from trundle.robots import Robot

_SPARE_M = 4.0
"""By how much more than needed the extent grows [m], so that it seldom does: then only changed cells are inflated."""
_MOST_CELLS = 64_000_000  # 400 x 400 m at 5 cm, as a layered costmap may have
_OFF_CELLS = 1e-3


class GrowingMap:
    """Holds the latest map within an extent that also has what it is asked to contain, and room to grow.

    What the map does not show is unknown, and may be driven as the settings say.

    Args:
        robot: The robot.
        settings: How the costmap is made.
    """

    def __init__(self, robot: Robot, settings: CostmapSettings) -> None:
        self._robot, self._settings = robot, settings
        self._costmap: Costmap | None = None
        self._cells = np.zeros((0, 0), np.int8)
        self._low: tuple[int, int] = (0, 0)
        """Row and column of cell (0, 0) in the lattice of the map's cells."""
        self._shift: tuple[float, float] = (0.0, 0.0)
        """Where that lattice has its origin, map frame [m]: within a cell of (0, 0)."""

    @property
    def costmap(self) -> Costmap | None:
        """The latest costmap; None before the first map."""
        return self._costmap

    def take(self, grid: OccupancyGrid) -> Costmap:
        """Take the next map, and return its costmap.

        Raises:
            InputError: If the map is turned: a map that grows has its rows along x of the map frame.
            MapError: If it would have too many cells.
        """
        if grid.origin.yaw != 0.0:
            raise InputError(
                f"a map that grows cannot be turned, its origin has a yaw of {grid.origin.yaw:g} rad: draw it with 0"
            )
        edge = grid.resolution
        row, col = round(grid.origin.y / edge), round(grid.origin.x / edge)
        shift = grid.origin.x - col * edge, grid.origin.y - row * edge
        last = self._costmap
        same = last is not None and last.resolution == edge
        if not same or math.dist(shift, self._shift) > _OFF_CELLS * edge:
            self._costmap, self._shift = None, shift
            self._cells = np.zeros((0, 0), np.int8)
        self._extend(edge, (row, col), (row + grid.shape[0], col + grid.shape[1]))
        cells = np.full_like(self._cells, UNKNOWN)
        row, col = row - self._low[0], col - self._low[1]
        cells[row : row + grid.shape[0], col : col + grid.shape[1]] = round_trinary(grid.data)
        self._costmap = self._make(cells, edge)
        self._cells = cells
        return self._costmap

    def contain(self, points: FloatArray) -> Costmap | None:
        """Contain these points [m], map frame, shape (N, 2); return the costmap if that has changed it.

        Raises:
            MapError: If it would have too many cells.
        """
        costmap = self._costmap
        if costmap is None:
            return None
        edge = costmap.resolution
        rows_cols = np.floor((points - np.array(self._shift)) / edge).astype(np.int64)[:, ::-1]
        margin = math.ceil((self._robot.circumscribed_radius + costmap.inflation_radius) / edge) + 2
        low, high = rows_cols.min(axis=0) - margin, rows_cols.max(axis=0) + 1 + margin
        if not self._extend(edge, (int(low[0]), int(low[1])), (int(high[0]), int(high[1]))):
            return None
        self._costmap = self._make(self._cells, edge)
        return self._costmap

    def _extend(self, edge: float, low: tuple[int, int], high: tuple[int, int]) -> bool:
        """Have these cells of the lattice, from the first to before the last; return whether the extent changed."""
        old, shape = self._low, self._cells.shape
        end = old[0] + shape[0], old[1] + shape[1]
        if self._cells.size and old[0] <= low[0] and old[1] <= low[1] and high[0] <= end[0] and high[1] <= end[1]:
            return False
        if self._cells.size:
            low, high = (min(low[0], old[0]), min(low[1], old[1])), (max(high[0], end[0]), max(high[1], end[1]))
        spare = math.ceil(_SPARE_M / edge)
        low, high = (low[0] - spare, low[1] - spare), (high[0] + spare, high[1] + spare)
        rows, cols = high[0] - low[0], high[1] - low[1]
        check_size(rows, cols)
        cells = np.full((rows, cols), UNKNOWN, np.int8)
        if self._cells.size:
            row, col = old[0] - low[0], old[1] - low[1]
            cells[row : row + shape[0], col : col + shape[1]] = self._cells
        self._low, self._cells, self._costmap = low, cells, None
        return True

    def _make(self, cells: npt.NDArray[np.int8], edge: float) -> Costmap:
        """The costmap of these cells: of the last one, only what has changed is inflated."""
        last = self._costmap
        if last is None:
            x, y = self._shift[0] + self._low[1] * edge, self._shift[1] + self._low[0] * edge
            return self._settings.make_costmap(OccupancyGrid(cells, edge, Pose2D(x, y)), self._robot)
        differ = cells != self._cells
        rows, cols = np.flatnonzero(differ.any(axis=1)), np.flatnonzero(differ.any(axis=0))
        if not len(rows):
            return last
        part = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
        return last.update(*part, cells[part])


def check_size(rows: int, cols: int) -> None:
    """Check that a costmap without a map has not too many cells.

    Raises:
        MapError: If it has.
    """
    if rows * cols > _MOST_CELLS:
        raise MapError(
            f"a costmap of {cols} x {rows} cells is too large; it has to contain the robot, its map and its goal: "
            "choose a nearer goal, or larger cells"
        )
