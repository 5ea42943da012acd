"""Where a disc can be in a world, and the shortest paths to any place of it, in NumPy."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from trundle._core import cost_field, inflate, label_components
from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid
from trundle.maps.rasterise import HeightBand, SolidRaster

IndexArray = npt.NDArray[np.int64]

# Edge of a cell [m], as in the usual maps; it grows in larger worlds, which bounds the number of cells.
_RESOLUTION = 0.05
_MOST_CELLS = 1_000_000
_FLOOR_TOP = 0.05  # what is not higher is driven over [m]
_WALL = 255  # the cost that `cost_field` takes for impassable
_BASE, _EXTRA, _DECAY_M = 10.0, 60.0, 0.4  # what a cell costs: paths keep off solids where there is room
_NEAR_M = 1.2  # solids that are farther than this from the disc are not felt [m]
_AHEAD_M = 0.3  # how far along its path somebody looks [m]
_AROUND = np.array([(0, 0), (-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)])


class WalkableFloor:
    """The places where a disc is clear of a world's solids, as far as one can get from the largest such area.

    Args:
        solids: The world's solids.
        bounds: (x0, y0, x1, y1) [m], which the disc does not leave.
        radius: Radius of the disc [m].
        top: Solids that start above this height do not matter [m].
    """

    def __init__(
        self, solids: Sequence[Solid], bounds: tuple[float, float, float, float], radius: float, top: float
    ) -> None:
        x0, y0, x1, y1 = bounds
        edge = max(_RESOLUTION, math.sqrt((x1 - x0) * (y1 - y0) / _MOST_CELLS))
        rows, cols = math.ceil((y1 - y0) / edge) + 2, math.ceil((x1 - x0) / edge) + 2
        occupied = np.zeros((rows, cols), dtype=np.int8)
        self.resolution = edge
        self._corner = np.array([x0 - edge, y0 - edge])
        SolidRaster(occupied, edge, (x0 - edge, y0 - edge), HeightBand(_FLOOR_TOP, max(top, 2 * _FLOOR_TOP))).add(
            solids
        )
        occupied[[0, -1], :] = occupied[:, [0, -1]] = 100
        # Between the middles of two cells; points in them may be nearer by a diagonal.
        least = radius + math.sqrt(2.0) * edge
        reach = least + _NEAR_M
        distances = np.sqrt(np.arange(int((reach / edge) ** 2) + 1)) * edge
        costs = _BASE + _EXTRA * np.exp(-np.maximum(0.0, distances - least) / _DECAY_M)
        costs[distances <= least] = _WALL
        self._costs = np.maximum(inflate(occupied, costs.astype(np.uint8)), np.uint8(_BASE))
        self._costs[occupied != 0] = _WALL
        self._nearness = inflate(occupied, np.round(255.0 * (1.0 - distances / reach)).astype(np.uint8))
        self._nearness = self._nearness.astype(np.float64)
        self._reach = reach
        self._last = np.array([rows - 2, cols - 2])
        self._keep_largest()

    def _keep_largest(self) -> None:
        labels, table = label_components((self._costs != _WALL).view(np.uint8), False)
        self.free: IndexArray = np.zeros((0, 2), dtype=np.int64)
        if len(table):
            inside = labels == int(np.argmax(table[:, 0])) + 1
            self._costs[~inside] = _WALL
            self.free = np.ascontiguousarray(np.argwhere(inside), dtype=np.int64)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        rows, cols = self._costs.shape
        return rows, cols

    def cells_of(self, points: FloatArray) -> IndexArray:
        """Return cells (row, col) of points [m] within the bounds, shape (N, 2), never those of the rim."""
        cells = np.floor((points - self._corner) / self.resolution).astype(np.int64)[:, ::-1]
        return np.minimum(np.maximum(cells, 1), self._last)

    def middles_of(self, cells: IndexArray) -> FloatArray:
        """Return middles (x, y) [m] of cells, shape (…, 2)."""
        return (cells[..., ::-1].astype(np.float64) + 0.5) * self.resolution + self._corner

    def is_free(self, points: FloatArray) -> npt.NDArray[np.bool_]:
        """Return whether the disc is clear of everything with its centre at points [m], shape (N, 2) → (N,)."""
        cells = self.cells_of(points)
        return self._costs[cells[:, 0], cells[:, 1]] != _WALL

    def field_to(self, cell: IndexArray, discs: FloatArray | None = None) -> npt.NDArray[np.float32]:
        """Return the cost of the cheapest path from every cell to one, infinity where there is none.

        Args:
            cell: (row, col).
            discs: (x, y, radius) [m] that the path goes round, shape (K, 3).
        """
        costs = self._costs if discs is None or len(discs) == 0 else self._without(discs)
        _, field = cost_field(costs, cell.reshape(1, 2), 8, 1, None, None)
        return field if field is not None else np.full(self._costs.shape, np.inf, dtype=np.float32)

    def _without(self, discs: FloatArray) -> npt.NDArray[np.uint8]:
        """Return the costs of the cells, with those in discs blocked."""
        costs = self._costs.copy()
        cells = self.cells_of(discs[:, :2]).tolist()
        for (x, y, radius), (row, col) in zip(discs.tolist(), cells, strict=True):
            reach = math.ceil(radius / self.resolution) + 1
            rows, cols = (np.arange(max(0, at - reach), at + reach + 1) for at in (row, col))
            rows, cols = rows[rows < costs.shape[0]], cols[cols < costs.shape[1]]
            away_x = (cols + 0.5) * self.resolution + self._corner[0] - x
            away_y = (rows + 0.5) * self.resolution + self._corner[1] - y
            inside = np.hypot(away_x, away_y[:, None]) < radius
            costs[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1][inside] = _WALL
        return costs

    def ahead(self, points: FloatArray, fields: npt.NDArray[np.float32]) -> FloatArray:
        """Return points [m] a little ahead on the path down each one's field, shape (N, 2); fields (N, rows, cols)."""
        cols = self._costs.shape[1]
        cells = self.cells_of(points)
        flat = cells[:, 0] * cols + cells[:, 1]
        steps = _AROUND[:, 0] * cols + _AROUND[:, 1]
        values, which = fields.reshape(len(points), -1), np.arange(len(points))
        for _ in range(max(1, round(_AHEAD_M / self.resolution))):
            around = flat[:, None] + steps
            flat = around[which, values[which[:, None], around].argmin(axis=1)]
        return self.middles_of(np.column_stack(np.divmod(flat, cols)))

    def push(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the distance [m] from points to the nearest solid, if it is near, and the direction away from it."""
        cells = self.cells_of(points)
        rows, cols = cells[:, 0], cells[:, 1]
        near = self._nearness
        away = np.column_stack(
            [near[rows, cols - 1] - near[rows, cols + 1], near[rows - 1, cols] - near[rows + 1, cols]]
        )
        away /= np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-9)[:, None]
        return (1.0 - near[rows, cols] / 255.0) * self._reach, away
