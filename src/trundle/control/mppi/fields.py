"""What the samples are judged by, over a window of the costmap: the distance to obstacles, and the cost to go.

The cost to go counts metres to where the path leaves the window, or to its end, round whatever is in between. It lets
the robot pass only where its discs pass: a cell is a wall of the field if the widest disc, centred in it, reaches an
obstacle.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.maps.cells import FREE, OCCUPIED

_FARTHEST = 254  # largest class of clearance
_UNIT_M = 0.01  # least width of a class of clearance
_NEAR_COST_M = 0.6  # beyond the disc: farther away, nearness costs nothing
_TOUCH_M = 1e-4  # a disc this near to an obstacle touches it


@dataclass(frozen=True, slots=True)
class FieldStyle:
    """What fields are made for.

    Attributes:
        radius: Radius of the widest disc [m].
        near_weight: How much longer a metre counts right beside an obstacle, as a share.
        near_distance: How fast that falls with the distance [m]: to a third over this distance.
    """

    radius: float
    near_weight: float
    near_distance: float

    @property
    def unit(self) -> float:
        """Width of a class of clearance [m]."""
        return max(_UNIT_M, (self.radius + _NEAR_COST_M) / (_FARTHEST - 1))

    def costs(self, resolution: float) -> npt.NDArray[np.float32]:
        """Return what a cell's length counts [m] by its nearness; infinite where the disc does not fit."""
        free = (_FARTHEST - np.arange(256)) * self.unit - self.radius
        costs = resolution * (1.0 + self.near_weight * np.exp(-np.maximum(free, 0.0) / self.near_distance))
        costs[free <= _TOUCH_M] = np.inf
        return costs.astype(np.float32)


@lru_cache(maxsize=16)
def _clearance_table(resolution: float, unit: float) -> npt.NDArray[np.uint8]:
    """Return the nearness by squared distance in cells to the nearest obstacle."""
    reach = (_FARTHEST * unit) / resolution + 1.0
    distances = np.sqrt(np.arange(int(reach * reach) + 1)) * resolution - 0.5 * resolution
    classes = np.clip(np.floor(distances / unit + 1e-9), 1, _FARTHEST)
    classes[0] = 0
    table = (_FARTHEST - classes).astype(np.uint8)
    table.flags.writeable = False
    return table


@lru_cache(maxsize=16)
def _nearness_of_costs(style: FieldStyle, unit: float) -> npt.NDArray[np.uint8]:
    """Return the nearness at which a metre is as long as a cost of a mask or of unseen space says, by that cost."""
    shares = np.clip(np.arange(256) / (INSCRIBED - 1), 1e-3, 1.0)
    free = np.minimum(style.radius - style.near_distance * np.log(shares), _FARTHEST * unit)
    nearness = (_FARTHEST - np.clip(np.ceil(free / unit), 1, _FARTHEST)).astype(np.uint8)
    nearness[0] = 0
    return nearness


class Window:
    """A square part of a costmap around the robot, with the distance from obstacles.

    Its frame has the origin in the lower left corner and axes along the grid, so that a costmap with a yaw costs
    nothing more.

    Args:
        costmap: The costmap.
        centre: Cell (row, col) in the middle.
        half: Cells from there to each side.
        style: What the fields are made for.
        clear: Capsules (x, y, x, y, radius) [m], map frame, whose obstacles are left out: they move, and are predicted.

    Attributes:
        costmap: The same.
        leaves_out: Whether obstacles were left out.
        nearness: 254 less the distance [`unit`] from a cell's centre to the nearest obstacle, itself less half a cell;
            254 where occupied, 0 from 254 units on; uint8, shape (rows, cols).
        unit: Length of a unit of `nearness` [m].
        resolution: Edge of a cell [m].
    """

    def __init__(
        self, costmap: Costmap, centre: tuple[int, int], half: int, style: FieldStyle, clear: FloatArray
    ) -> None:
        self.costmap, self.style, self.leaves_out = costmap, style, len(clear) > 0
        self.resolution, self.unit = costmap.resolution, style.unit
        self._row, self._col, self._size = centre[0] - half, centre[1] - half, 2 * half + 1
        corner = Pose2D(self._col * self.resolution, self._row * self.resolution)
        self._frame = costmap.origin @ corner
        self._cos, self._sin = math.cos(self._frame.yaw), math.sin(self._frame.yaw)
        # What is beyond the window's edge counts, as far as a disc reaches.
        beyond = math.ceil((style.radius + _NEAR_COST_M) / self.resolution)
        blocked = _part(costmap.data, self._row - beyond, self._col - beyond, self._size + 2 * beyond) >= LETHAL
        self._leave_out(blocked, beyond, clear)
        cells = np.where(blocked, np.int8(OCCUPIED), np.int8(FREE))
        raised = _core.inflate(cells, _clearance_table(self.resolution, self.unit))
        inner = slice(beyond, beyond + self._size)
        self.nearness: npt.NDArray[np.uint8] = np.ascontiguousarray(raised[inner, inner])
        self._classes = self._with_costs()
        self._costs = style.costs(self.resolution)

    def _leave_out(self, blocked: npt.NDArray[np.bool_], beyond: int, capsules: FloatArray) -> None:
        points = np.column_stack([capsules[:, :4].reshape(-1, 2), np.zeros(2 * len(capsules))])
        ends = (self.poses_in(points)[:, :2] / self.resolution - 0.5 + beyond).reshape(-1, 4)
        for (x0, y0, x1, y1), reach in zip(ends.tolist(), (capsules[:, 4] / self.resolution).tolist(), strict=True):
            low_row, low_col = (max(0, math.floor(min(pair) - reach)) for pair in ((y0, y1), (x0, x1)))
            high_row, high_col = (max(0, math.ceil(max(pair) + reach) + 1) for pair in ((y0, y1), (x0, x1)))
            part = blocked[low_row:high_row, low_col:high_col]
            if not part.any():
                continue
            length = math.hypot(x1 - x0, y1 - y0)
            dx, dy = ((x1 - x0) / length, (y1 - y0) / length) if length > 0.0 else (0.0, 0.0)
            x = np.arange(low_col - x0, low_col - x0 + part.shape[1] - 0.5)
            y = np.arange(low_row - y0, low_row - y0 + part.shape[0] - 0.5)[:, None]
            along = dx * x + dy * y
            nearest = np.minimum(np.maximum(along, 0.0), length)
            part[x * x + y * y - nearest * (2.0 * along - nearest) <= reach * reach] = False

    def _with_costs(self) -> npt.NDArray[np.uint8]:
        """Return the nearness for the cost to go: as it is, or more where a mask or unseen space costs more."""
        costmap = self.costmap
        if costmap.keepout is None and not (costmap.unseen is not None and costmap.unknown == "costly"):
            return self.nearness
        costs = _part(costmap.data, self._row, self._col, self._size)
        if costmap.keepout is not None:
            extra = _part(costmap.keepout, self._row, self._col, self._size)
        else:
            extra = np.zeros_like(costs)
        if costmap.unseen is not None and costmap.unknown == "costly":
            unseen = _part(costmap.unseen, self._row, self._col, self._size)
            extra = np.where(unseen, np.uint8(costmap.unknown_cost), extra)
        return np.maximum(self.nearness, _nearness_of_costs(self.style, self.unit)[extra])

    # Frames ---------------------------------------------------------------------------------------------------------

    def to_window(self, x: float, y: float) -> tuple[float, float]:
        """Return a point of the map frame in the window's [m]."""
        dx, dy = x - self._frame.x, y - self._frame.y
        return self._cos * dx + self._sin * dy, self._cos * dy - self._sin * dx

    def turn_in(self, x: float, y: float) -> tuple[float, float]:
        """Return a direction, or a velocity, of the map frame in the window's."""
        return self._cos * x + self._sin * y, self._cos * y - self._sin * x

    def pose_in(self, pose: Pose2D) -> tuple[float, float, float]:
        """Return a pose of the map frame in the window's."""
        return (*self.to_window(pose.x, pose.y), pose.yaw - self._frame.yaw)

    def poses_in(self, poses: FloatArray) -> FloatArray:
        """Return poses of the map frame in the window's, shape (N, 3)."""
        dx, dy = poses[:, 0] - self._frame.x, poses[:, 1] - self._frame.y
        return np.column_stack(
            [self._cos * dx + self._sin * dy, self._cos * dy - self._sin * dx, poses[:, 2] - self._frame.yaw]
        )

    def poses_out(self, poses: FloatArray) -> FloatArray:
        """Return poses of the window in the map frame, shape (…, 3)."""
        out = np.empty(poses.shape)
        out[..., 0] = self._frame.x + self._cos * poses[..., 0] - self._sin * poses[..., 1]
        out[..., 1] = self._frame.y + self._sin * poses[..., 0] + self._cos * poses[..., 1]
        out[..., 2] = poses[..., 2] + self._frame.yaw
        return out

    def room_around(self, x: float, y: float) -> float:
        """Return the distance [m] from a point in the window's frame to its nearest edge; negative outside."""
        size = self._size * self.resolution
        return min(x, y, size - x, size - y)

    # Reading --------------------------------------------------------------------------------------------------------

    def cells_of(self, points: FloatArray) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Return cells (row, col) of points in the window's frame, shape (N, 2)."""
        cells = np.floor(points / self.resolution).astype(np.int64)
        return cells[:, 1], cells[:, 0]

    def inside(self, rows: npt.NDArray[np.int64], cols: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
        """Return which cells lie in the window."""
        return (rows >= 0) & (rows < self._size) & (cols >= 0) & (cols < self._size)

    def clearance_at(self, points: FloatArray) -> FloatArray:
        """Return the distance [m] from points in the window's frame to the nearest obstacle; 0 outside the window."""
        rows, cols = self.cells_of(points)
        inside = self.inside(rows, cols)
        found = _FARTHEST - self.nearness[np.where(inside, rows, 0), np.where(inside, cols, 0)].astype(np.float64)
        return np.where(inside, found * self.unit, 0.0)

    def discs_fit(self, poses: FloatArray, discs: FloatArray) -> npt.NDArray[np.bool_]:
        """Return whether all discs are free at each pose of the window's frame, shape (N, 3)."""
        cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        fit = np.ones(len(poses), np.bool_)
        for x, radius in discs.tolist():
            centres = np.column_stack([poses[:, 0] + x * cos, poses[:, 1] + x * sin])
            fit &= self.clearance_at(centres) > radius + _TOUCH_M
        return fit

    def passable(self, points: FloatArray) -> npt.NDArray[np.bool_]:
        """Return whether points in the window's frame lie in cells that the cost to go may pass."""
        return self.clearance_at(points) > self.style.radius + _TOUCH_M

    def cost_to_go(
        self, seeds: FloatArray, values: FloatArray, around: tuple[float, float], beyond: float
    ) -> npt.NDArray[np.float32]:
        """Cost [m] from each cell to points in the window's frame, shape (N, 2), which start with `values` [m].

        Cells that cost more by `beyond` [m] than the cell of a point in the window are left out: they are infinite.
        """
        rows, cols = self.cells_of(seeds)
        cells = np.ascontiguousarray(np.column_stack([rows, cols]))
        col, row = (min(max(int(value / self.resolution), 0), self._size - 1) for value in around)
        return _core.eikonal_field(self._classes, self._costs, cells, values, row, col, beyond)


def _part(data: npt.NDArray[np.generic], row: int, col: int, size: int) -> npt.NDArray[np.uint8]:
    """Return a square of a costmap's array; 255 outside of it."""
    rows, cols = data.shape
    top, left = max(row, 0), max(col, 0)
    bottom, right = min(row + size, rows), min(col + size, cols)
    if (top, left, bottom, right) == (row, col, row + size, col + size):
        return np.ascontiguousarray(data[top:bottom, left:right], dtype=np.uint8)
    part = np.full((size, size), 255, np.uint8)
    if top < bottom and left < right:
        part[top - row : bottom - row, left - col : right - col] = data[top:bottom, left:right]
    return part


MOST_DISCS = 8
"""As many as the kernel takes: each costs a look-up in every step of every sample."""

_WIDER = 0.17
"""Share of the half width by which a disc may reach past the sides; more discs reach less far."""


def cover_with_discs(footprint: Footprint, padding: float = 0.0) -> FloatArray:
    """Return the fewest discs on base_link's x axis that cover a footprint and reach little past its sides.

    The outline is cut across its axis into slices of equal length. A disc lies on the axis in the middle of each slice
    and just covers it.

    Args:
        footprint: A convex outline around base_link.
        padding: What it is widened by first [m].

    Returns:
        (x, radius) [m] of each disc, base_link, from the rear to the front, shape (K, 2) with K from 1 to 8.
    """
    outline = footprint.padded(padding).outline if padding > 0.0 else footprint.outline
    half_width = float(np.abs(outline[:, 1]).max())
    discs = _cover(outline, 1)
    for count in range(2, MOST_DISCS + 1):
        if float(discs[:, 1].max()) <= (1.0 + _WIDER) * half_width:
            break
        discs = _cover(outline, count)
    return discs


def _cover(outline: FloatArray, count: int) -> FloatArray:
    rear, front = float(outline[:, 0].min()), float(outline[:, 0].max())
    edges: list[float] = np.linspace(rear, front, count + 1).tolist()
    points: list[tuple[float, float]] = [(x, y) for x, y in outline.tolist()]
    discs: list[tuple[float, float]] = []
    for low, high in itertools.pairwise(edges):
        middle = 0.5 * (low + high)
        reach = max(math.hypot(x - middle, y) for x, y in _slice(points, low, high))
        discs.append((middle, reach))
    return np.array(discs)


def _slice(points: list[tuple[float, float]], low: float, high: float) -> list[tuple[float, float]]:
    """Return corners of the part of a convex outline between two values of x."""
    kept = [(x, y) for x, y in points if low <= x <= high]
    for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[0]], strict=True):
        kept += [
            (cut, y0 + (y1 - y0) * (cut - x0) / (x1 - x0)) for cut in (low, high) if min(x0, x1) < cut < max(x0, x1)
        ]
    return kept
