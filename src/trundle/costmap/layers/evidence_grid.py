"""`EvidenceGrid`: what scans say of the cells of a map that grows; `FieldOfView`: where the newest scan looked."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.costmap.layers.layer import MapWindow
from trundle.geometry import FloatArray
from trundle.observation import Scan

_SPARE_M = 4.0  # by how much more than needed the grid grows, as each growth copies it
_MOST_CELLS = 25_000_000  # 250 x 250 m at 5 cm

MARKED = 128
"""Bit of a cell that is marked."""
SURELY_FREE = 1
"""Evidence of a cell that `misses_to_clear` scans, at least, have passed through since one last hit it."""


class EvidenceGrid:
    """A byte of evidence per cell, where in the cell the hit was that marked it, and if asked for when it was hit last.

    The grid grows with what it must hold. One that would become too large, or is told to roll, keeps what lies around
    the robot.

    Args:
        resolution: Edge of a cell [m].
        timed: Whether times of hits are kept.
        rolling: Whether it only keeps what it must hold.
    """

    def __init__(self, resolution: float, *, timed: bool, rolling: bool) -> None:
        self.resolution = resolution
        self._timed = timed
        self._rolling = rolling
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._allocate(0, 0, (0, 0))

    def begin_timing(self, time: float) -> None:
        """Keep times of hits from now on [s]; those before count as made now."""
        if not self._timed:
            self._timed = True
            self.times = np.full(self.cells.shape, time)

    def unseen(self, places: FloatArray, before: float) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Return rows and columns of marks in discs (x, y, radius) [m], map frame, that were last hit before a time."""
        found = [np.zeros(0, np.intp)]
        for x, y, radius in places.tolist():
            low, high = self._cells_of(x - radius, y - radius), self._cells_of(x + radius, y + radius)
            first_row, first_col = max(0, low[0] - self.row), max(0, low[1] - self.col)
            part = slice(first_row, max(0, high[0] + 1 - self.row)), slice(first_col, max(0, high[1] + 1 - self.col))
            row, col = np.nonzero((self.cells[part] >= MARKED) & (self.times[part] < before))
            row, col = row + first_row, col + first_col
            at_x, at_y = self.centres(row, col)
            near = np.hypot(at_x - x, at_y - y) < radius
            found.append(row[near] * self.cells.shape[1] + col[near])
        row, col = np.divmod(np.unique(np.concatenate(found)), max(1, self.cells.shape[1]))
        return row, col

    def centres(self, row: npt.NDArray[np.intp], col: npt.NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
        """Return the centres x and y of cells [m], map frame."""
        x = np.asarray((col + (self.col + 0.5)) * self.resolution, np.float64)
        return x, np.asarray((row + (self.row + 0.5)) * self.resolution, np.float64)

    def forget(self, x: float, y: float, half: float, *, outside: bool) -> None:
        """Forget a square of ±`half` [m] around a point, or all outside of it."""
        low, high = self._cells_of(x - half, y - half), self._cells_of(x + half, y + half)
        rows = slice(max(0, low[0] - self.row), max(0, high[0] + 1 - self.row))
        cols = slice(max(0, low[1] - self.col), max(0, high[1] + 1 - self.col))
        kept = self.cells[rows, cols].copy() if outside else 0
        if outside:
            self.cells[:] = 0
        self.cells[rows, cols] = kept  # points and times are not looked at where it is 0

    def hold(self, x: float, y: float, half: float) -> bool:
        """Make room for a square of ±`half` [m] around a point; return whether something was forgotten."""
        low, high = self._cells_of(x - half, y - half), self._cells_of(x + half, y + half)
        rows, cols = self.cells.shape
        if self.row <= low[0] and self.col <= low[1] and high[0] < self.row + rows and high[1] < self.col + cols:
            return False
        spare = math.ceil(_SPARE_M / self.resolution)
        row, col, row_end, col_end = low[0] - spare, low[1] - spare, high[0] + spare + 1, high[1] + spare + 1
        union = (
            min(row, self.row),
            min(col, self.col),
            max(row_end, self.row + rows),
            max(col_end, self.col + cols),
        )
        too_large = (union[2] - union[0]) * (union[3] - union[1]) > _MOST_CELLS
        if rows and not self._rolling and not too_large:
            row, col, row_end, col_end = union
        old = self.row, self.col, self.cells, self.points, self.times
        self._allocate(row, col, (row_end - row, col_end - col))
        self._take(*old)
        return bool(rows) and too_large

    def window(self, box: tuple[int, int, int, int]) -> MapWindow | None:
        """Return where a rectangle of cells (row, row end, col, col end) lies in the map; None if it is empty."""
        row, row_end, col, col_end = box
        if row == row_end:
            return None
        edge = self.resolution
        return MapWindow(
            (self.col + col) * edge, (self.row + row) * edge, (self.col + col_end) * edge, (self.row + row_end) * edge
        )

    def marks(self) -> FloatArray:
        """Return where marked cells were hit [m], map frame, shape (N, 2)."""
        row, col = np.nonzero(self.cells & MARKED)
        inside = (self.points[row, col].astype(np.float64) + 0.5) / 256.0
        return (inside + np.column_stack([col + self.col, row + self.row])) * self.resolution

    def levels(self, x: FloatArray, y: FloatArray) -> npt.NDArray[np.uint8]:
        """Return the evidence of the cells in which points x and y [m] lie, map frame; 0 outside of the grid."""
        row = np.floor(y / self.resolution).astype(np.intp) - self.row
        col = np.floor(x / self.resolution).astype(np.intp) - self.col
        inside = (row >= 0) & (row < self.cells.shape[0]) & (col >= 0) & (col < self.cells.shape[1])
        found = np.zeros(len(x), np.uint8)
        found[inside] = self.cells[row[inside], col[inside]]
        return found

    def _cells_of(self, x: float, y: float) -> tuple[int, int]:
        return math.floor(y / self.resolution), math.floor(x / self.resolution)

    def _allocate(self, row: int, col: int, shape: tuple[int, int]) -> None:
        self.row, self.col = row, col
        self.cells: npt.NDArray[np.uint8] = np.zeros(shape, np.uint8)
        self.points: npt.NDArray[np.uint8] = np.zeros((*shape, 2), np.uint8)
        self.times: FloatArray = np.zeros(shape if self._timed else (0, 0))

    def _take(
        self,
        row: int,
        col: int,
        cells: npt.NDArray[np.uint8],
        points: npt.NDArray[np.uint8],
        times: FloatArray,
    ) -> None:
        """Copy what another grid holds of this one's cells."""
        first = max(row, self.row), max(col, self.col)
        end = (
            min(row + cells.shape[0], self.row + self.cells.shape[0]),
            min(col + cells.shape[1], self.col + self.cells.shape[1]),
        )
        if first[0] >= end[0] or first[1] >= end[1]:
            return
        source = slice(first[0] - row, end[0] - row), slice(first[1] - col, end[1] - col)
        target = slice(first[0] - self.row, end[0] - self.row), slice(first[1] - self.col, end[1] - self.col)
        self.cells[target] = cells[source]
        self.points[target] = points[source]
        if self._timed:
            self.times[target] = times[source]


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """The sector that a scan looked at, in the map frame.

    Attributes:
        time: Of the scan [s].
        x, y: The sensor [m].
        middle: Direction of the sector's middle [rad].
        half: Half of its angle [rad]; π or more for a full turn.
        reach: From which range to which it counts [m].
    """

    time: float
    x: float
    y: float
    middle: float
    half: float
    reach: tuple[float, float]

    @classmethod
    def of_scan(cls, scan: Scan, poses: FloatArray, reach: tuple[float, float]) -> FieldOfView | None:
        """Return where a scan looked; None if it has no beam.

        Args:
            scan: The scan, with its beams in either order.
            poses: Of its sensor, map frame, shape (1, 3) or (beams, 3).
            reach: From which range to which it marks [m].
        """
        count = len(scan.angles)
        if count == 0:
            return None
        x, y, yaw = poses[len(poses) // 2].tolist()
        first, last = float(scan.angles.min()), float(scan.angles.max())
        half = 0.5 * (last - first) * count / max(1, count - 1)  # each beam stands for as much as lies between two
        low, high = max(scan.range_min, reach[0]), min(scan.range_max, reach[1])
        return cls(scan.time, x, y, yaw + 0.5 * (first + last), half, (low, high))

    def contains(self, x: FloatArray, y: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether it looked towards points [m], map frame; what hides them makes no difference."""
        off = np.arctan2(y - self.y, x - self.x) - self.middle
        distance = np.hypot(x - self.x, y - self.y)
        inside = np.abs((off + math.pi) % (2.0 * math.pi) - math.pi) <= self.half
        return inside & (distance >= self.reach[0]) & (distance <= self.reach[1])
