"""`Extent`: which cells a layered costmap has now, and what the static map says of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap.costmap import Costmap, CostmapStyle
from trundle.costmap.costmap_settings import CostmapSettings
from trundle.costmap.costs import LETHAL
from trundle.costmap.layers.layer import MapWindow
from trundle.errors import InputError, MapError
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.frame import GridFrame
from trundle.maps.grid import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.robots import Robot
from trundle.values import check_kind

_GROWTH_M = 4.0  # by how much more than needed it grows, as each growth makes the whole costmap anew
_DRIFT_SHARE = 0.05  # of a window's width: so far the robot may be from its middle
_MOST_CELLS = 64_000_000  # 400 x 400 m at 5 cm
_EIGHT_AROUND = 1.5  # cells: between the diagonal neighbours at 1.41 and the next ones at 2

_Item = TypeVar("_Item", bound=np.generic)


class CellWindow(NamedTuple):
    """A rectangle of cells of an endless grid."""

    row: int
    col: int
    rows: int
    cols: int


@dataclass(frozen=True, slots=True)
class _Frame(GridFrame):
    resolution: float
    origin: Pose2D
    size: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        return self.size


class Extent:
    """Cells aligned with the static map, or with the map frame where there is none.

    Args:
        static: Occupancy, origin and resolution of the static map, or None where there is no map.
        floor: Lowest costs of its cells by the keep-out mask.
        keepout: The mask, where there is no static map.
        resolution: Edge of a cell [m], where there is no static map.
        size: Width and height of the window, or of the first extent without a map [m].
        rolling: Whether the window moves with the robot.
        tolerance: Distance from static obstacles within which nothing is marked [m]. If None, the eight cells around.
    """

    def __init__(
        self,
        static: OccupancyGrid | None,
        *,
        floor: npt.NDArray[np.uint8] | None,
        keepout: KeepoutMask | None,
        resolution: float,
        size: tuple[float, float],
        rolling: bool,
        tolerance: float | None,
    ) -> None:
        self.resolution = resolution if static is None else static.resolution
        self._frame = Pose2D(0.0, 0.0) if static is None else static.origin
        self._static, self._floor, self._keepout = static, floor, keepout
        self._near = None if static is None else _near_obstacles(static, tolerance)
        self._size = size
        self.rolling = rolling
        self._required: list[tuple[float, float]] = []
        self.window: CellWindow | None = None
        self._placed: tuple[CellWindow, Pose2D, Pose2D] | None = None
        if static is not None and not rolling:
            self.window = CellWindow(0, 0, *static.shape)

    @property
    def is_fixed(self) -> bool:
        """Whether it is the static map and never changes."""
        return self._static is not None and not self.rolling

    @property
    def origin(self) -> Pose2D:
        """Pose of the lower left corner in the map frame."""
        return self._place()[1]

    def _place(self) -> tuple[CellWindow, Pose2D, Pose2D]:
        """The window, the pose of its lower left corner, and that of the map frame in this."""
        window = self._now()
        if self._placed is None or self._placed[0] is not window:
            origin = self._frame @ Pose2D(window.col * self.resolution, window.row * self.resolution)
            self._placed = window, origin, origin.inverse()
        return self._placed

    def follow(self, pose: Pose2D) -> bool:
        """Move or grow for a robot at this pose, map frame; return whether that changed anything.

        Raises:
            MapError: If it would have too many cells.
        """
        if self.is_fixed:
            return False
        (x, y), (wide, high) = self._to_cells([(pose.x, pose.y)])[0], self._size_in_cells()
        centred = CellWindow(round(y - high / 2.0), round(x - wide / 2.0), high, wide)
        old = self.window
        if self.rolling:
            off = max(abs(centred.row - old.row) / high, abs(centred.col - old.col) / wide) if old else math.inf
            if off <= _DRIFT_SHARE:
                return False
            self.window = centred
            return True
        return self._grow([(centred.col, centred.row), (centred.col + wide, centred.row + high)])

    def require(self, points: FloatArray, margin: float) -> bool:
        """Contain points [m], map frame, with a margin [m]; return whether that changed anything.

        Raises:
            MapError: If it would have too many cells.
        """
        cells, spare = self._to_cells(points), margin / self.resolution
        wanted = [(x + dx, y + dy) for x, y in cells for dx in (-spare, spare) for dy in (-spare, spare)]
        if self.window is None:
            _check_size(_around(wanted))
            self._required += wanted
            return False
        return self._grow(wanted)

    def cells(self) -> npt.NDArray[np.int8]:
        """Return the static map here; cells are −1 where there is none."""
        return self._cut(None if self._static is None else self._static.data, np.int8(UNKNOWN))

    def near(self) -> npt.NDArray[np.uint8]:
        """Return 1 where nothing is marked, as it is near a static obstacle, and 0 elsewhere."""
        return self._cut(self._near, np.uint8(0))

    def floor(self) -> npt.NDArray[np.uint8] | None:
        """Return the lowest costs by the keep-out mask; None if there is no mask."""
        if self._floor is not None:
            return self._cut(self._floor, np.uint8(0))
        if self._keepout is None:
            return None
        window = self._now()
        try:
            return self._keepout.costs_on(_Frame(self.resolution, self.origin, (window.rows, window.cols)))
        except MapError:  # the mask lies elsewhere
            return None

    def cells_under(self, windows: Sequence[MapWindow]) -> tuple[slice, slice] | None:
        """Return the rows and columns that one or more windows reach into; None where they lie elsewhere."""
        window, _, place = self._place()
        rows, cols = window.rows, window.cols
        if len(windows) == 1:
            x0, y0, x1, y1 = windows[0]
        else:
            low_x, low_y, high_x, high_y = zip(*windows, strict=True)
            x0, y0, x1, y1 = min(low_x), min(low_y), max(high_x), max(high_y)
        if not math.isfinite(x0 + y0 + x1 + y1):
            return slice(0, rows), slice(0, cols)
        edge = self.resolution
        if place.yaw == 0.0:  # as below, without what is multiplied with 0
            across, up = ((place.x + x0) / edge, (place.x + x1) / edge), ((place.y + y0) / edge, (place.y + y1) / edge)
        else:
            cos, sin = math.cos(place.yaw), math.sin(place.yaw)
            corners = (x0, y0), (x1, y0), (x0, y1), (x1, y1)
            across = tuple([(place.x + cos * x - sin * y) / edge for x, y in corners])
            up = tuple([(place.y + sin * x + cos * y) / edge for x, y in corners])
        # Centres are looked up in the evidence, so cells up to half a cell's diagonal away may change.
        (row, row_end), (col, col_end) = _cells_between(up, rows), _cells_between(across, cols)
        return (slice(row, row_end), slice(col, col_end)) if row < row_end and col < col_end else None

    def _now(self) -> CellWindow:
        if self.window is None:
            raise MapError(
                "a costmap without a map, or that moves with the robot, is where the robot is: update it first"
            )
        return self.window

    def _grow(self, points: list[tuple[float, float]]) -> bool:
        wanted = points + self._required
        self._required = []
        old, new = self.window, _around(wanted)
        if old is not None:
            if (
                old.row <= new.row
                and old.col <= new.col
                and new.row + new.rows <= old.row + old.rows
                and new.col + new.cols <= old.col + old.cols
            ):
                return False
            spare = math.ceil(_GROWTH_M / self.resolution)
            new = _union(old, CellWindow(new.row - spare, new.col - spare, new.rows + 2 * spare, new.cols + 2 * spare))
        _check_size(new)
        self.window = new
        return True

    def _to_cells(self, points: list[tuple[float, float]] | FloatArray) -> list[tuple[float, float]]:
        """Return points [m] as x, y in cells of the endless grid."""
        at = self._frame.inverse().transform_points(points) / self.resolution
        return [(x, y) for x, y in at.tolist()]

    def _size_in_cells(self) -> tuple[int, int]:
        wide, high = (max(1, math.ceil(side / self.resolution - 1e-9)) for side in self._size)
        return wide, high

    def _cut(self, full: npt.NDArray[_Item] | None, outside: _Item) -> npt.NDArray[_Item]:
        """Return this extent's part of an array of the static map's shape."""
        window = self._now()
        part = np.full((window.rows, window.cols), outside)
        if full is None:
            return part
        if self.is_fixed:
            return full
        first = max(0, window.row), max(0, window.col)
        end = min(full.shape[0], window.row + window.rows), min(full.shape[1], window.col + window.cols)
        if first[0] < end[0] and first[1] < end[1]:
            part[first[0] - window.row : end[0] - window.row, first[1] - window.col : end[1] - window.col] = full[
                first[0] : end[0], first[1] : end[1]
            ]
        return part


def _cells_between(places: Sequence[float], count: int) -> tuple[int, int]:
    """Return the first of `count` cells around some places, in cells, with one cell more, and the one after them."""
    return max(0, min(count, math.floor(min(places)) - 1)), max(0, min(count, math.ceil(max(places)) + 1))


def _around(points: list[tuple[float, float]]) -> CellWindow:
    low, high = np.floor(np.min(points, axis=0)), np.ceil(np.max(points, axis=0))
    (col, row), (col_end, row_end) = low.astype(int).tolist(), high.astype(int).tolist()
    return CellWindow(row, col, max(1, row_end - row), max(1, col_end - col))


def _union(one: CellWindow, other: CellWindow) -> CellWindow:
    row, col = min(one.row, other.row), min(one.col, other.col)
    row_end, col_end = max(one.row + one.rows, other.row + other.rows), max(one.col + one.cols, other.col + other.cols)
    return CellWindow(row, col, row_end - row, col_end - col)


def _check_size(window: CellWindow) -> None:
    if window.rows * window.cols > _MOST_CELLS:
        raise MapError(
            f"a costmap of {window.cols} x {window.rows} cells is too large; without a map it has to contain the "
            "robot and its goal: choose a nearer goal, larger cells, or a rolling window"
        )


def _near_obstacles(static: OccupancyGrid, tolerance: float | None) -> npt.NDArray[np.uint8]:
    cells = _EIGHT_AROUND if tolerance is None else min(tolerance / static.resolution, float(max(static.shape)))
    occupied = np.where(static.data == OCCUPIED, np.int8(OCCUPIED), np.int8(FREE))
    table = np.ones(math.floor(cells * cells + 1e-9) + 1, np.uint8)
    return np.minimum(_core.inflate(occupied, table), np.uint8(1))


def read_static(
    static: OccupancyGrid | Costmap | None,
    robot: Robot,
    costmap: CostmapSettings | None,
    keepout: KeepoutMask | None,
    resolution: float,
) -> tuple[Costmap | None, OccupancyGrid | None, CostmapStyle]:
    """Return the static costmap and its occupancy, if there is a map, and how costmaps are made."""
    settings = CostmapSettings() if costmap is None else costmap
    check_kind(settings, CostmapSettings, "costmap", "give CostmapSettings(…)")
    grid: OccupancyGrid | None = None
    if isinstance(static, Costmap):
        if costmap is not None or keepout is not None:
            raise InputError(
                "a Costmap has its settings and its keep-out mask: give the OccupancyGrid to choose others"
            )
        made = static
        data = np.where(static.data == LETHAL, np.int8(OCCUPIED), np.int8(FREE))
        if static.keepout is not None:
            data[static.keepout == LETHAL] = FREE
        data[static.unknown_cells] = UNKNOWN
        grid = OccupancyGrid(data, static.resolution, static.origin)
    elif static is not None:
        check_kind(static, OccupancyGrid, "a layered costmap's map", "OccupancyGrid.load(path) reads one")
        made, grid = settings.make_costmap(static, robot, keepout=keepout), static
    else:
        if "unknown" not in settings.model_fields_set:
            settings = settings.model_copy(update={"unknown": "costly"})
        made = settings.make_costmap(OccupancyGrid(np.zeros((1, 1), np.int8), resolution), robot)
    style = CostmapStyle(made.planar, made.inflation_radius, made.cost_scaling_factor, made.unknown, made.unknown_cost)
    return (None if grid is None else made), grid, style


def differences(one: npt.NDArray[np.int8], other: npt.NDArray[np.int8]) -> tuple[slice, slice] | None:
    """Return the smallest rectangle outside of which two arrays are equal; None if they are equal."""
    differ = one != other
    cells = differ.tobytes()  # searched faster than an array
    first = cells.find(1)
    if first < 0:
        return None
    rows = slice(first // differ.shape[1], cells.rfind(1) // differ.shape[1] + 1)
    cols = differ[rows].any(axis=0).tobytes()
    return rows, slice(cols.find(1), cols.rfind(1) + 1)
