"""`LayeredCostmap`: the static map, the keep-out mask and what layers sense, as one costmap."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import Field

from trundle.costmap.costmap import Costmap
from trundle.costmap.costmap_settings import CostmapSettings
from trundle.costmap.layers.extent import Extent, differences, read_static
from trundle.costmap.layers.layer import EVERYWHERE, Layer, MapPart, MapWindow
from trundle.costmap.layers.obstacle_layer import ObstacleLayer, ObstacleLayerSettings
from trundle.costmap.layers.scan_placer import PlacedScans
from trundle.errors import InputError
from trundle.files.yaml_config import Config
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.cells import OCCUPIED
from trundle.maps.grid import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.observation import Estimate, Scan, check_scans
from trundle.robots import Robot
from trundle.values import as_array, check_kind, check_number

_Slices = tuple[slice, slice]

_MARGIN_M = 1.0  # room around what must be contained, so that its inflation ends within the costmap


class LayersSettings(Config):
    """The layers of a costmap and its extent.

    Attributes:
        obstacle: How scans become obstacles. If None, they are left out.
        rolling_window: Whether the costmap is a window that moves with the robot instead of the whole map. What was
            sensed outside the window is forgotten.
        width: Width of the window, or of the first extent where there is no map [m].
        height: Height of the window, or of the first extent where there is no map [m].

    Raises:
        InputError: If a value is out of range.
    """

    obstacle: ObstacleLayerSettings | None = ObstacleLayerSettings()
    rolling_window: bool = False
    width: Annotated[float, Field(gt=0.0, le=1000.0)] = 12.0
    height: Annotated[float, Field(gt=0.0, le=1000.0)] = 12.0


class LayeredCostmap:
    """A costmap of the static map and of what is sensed, for one robot; it returns immutable `Costmap`s.

    Of the static map obstacles stay, unless `clear_static` is set; unknown cells become free where they are seen. With
    `LayersSettings.rolling_window` the costmap is a window that moves with the robot by whole cells of the map. Without
    a map everything is unknown at first, and costs more than what was seen unless `costmap` says otherwise; the extent
    grows with the robot and contains what was asked for by `require`.

    What is sensed stays in the map where the estimate of its time put it. Where the estimate jumps, what was sensed
    around the robot is forgotten; an odometry pose that jumps clears everything: see `ObstacleLayer`.

    All methods may be called from several threads.

    Args:
        static: The map, or a costmap of it, or None where there is no map.
        robot: The robot, with its lidars.
        costmap: How the costmap is made. If None, by the defaults. Not with a `Costmap`, which is made already.
        layers: The layers and the extent. If None, the defaults.
        keepout: Zones to keep out of; not with a `Costmap`, which has its own.
        resolution: Edge of a cell [m], where there is no map.
        extra_layers: Further layers, painted after the obstacles.

    Raises:
        InputError: If an argument is of another kind or out of range.
        MapError: If the mask lies beside the map.
    """

    def __init__(
        self,
        static: OccupancyGrid | Costmap | None,
        robot: Robot,
        *,
        costmap: CostmapSettings | None = None,
        layers: LayersSettings | None = None,
        keepout: KeepoutMask | None = None,
        resolution: float = 0.05,
        extra_layers: Sequence[Layer] = (),
    ) -> None:
        check_kind(robot, Robot, "a layered costmap's robot", "Robot.load(name) makes one")
        self.settings = LayersSettings() if layers is None else layers
        check_kind(self.settings, LayersSettings, "layers", "give LayersSettings(…)")
        edge = check_number("resolution", resolution, 1e-3, 10.0, "m")
        self._robot, obstacle = robot, self.settings.obstacle
        self._take_static(static, costmap, keepout, edge)
        self._obstacle = None if obstacle is None else self._make_obstacle_layer(robot)
        for layer in extra_layers:
            check_kind(layer, Layer, "a layer", "it needs reset, update, paint and obstacles")
        self._layers: list[Layer] = [*([] if self._obstacle is None else [self._obstacle]), *extra_layers]
        self._lock = threading.RLock()
        self._forget()

    def _take_static(
        self,
        static: OccupancyGrid | Costmap | None,
        costmap: CostmapSettings | None,
        keepout: KeepoutMask | None,
        resolution: float,
    ) -> None:
        fixed, grid, self._style = read_static(static, self._robot, costmap, keepout, resolution)
        obstacle = self.settings.obstacle
        self._extent = Extent(
            grid,
            floor=None if fixed is None else fixed.keepout,
            keepout=keepout,
            resolution=resolution,
            size=(self.settings.width, self.settings.height),
            rolling=self.settings.rolling_window,
            tolerance=None if obstacle is None else obstacle.static_tolerance,
        )
        self._fixed = fixed if self._extent.is_fixed else None

    @property
    def costmap(self) -> Costmap:
        """The latest costmap.

        Raises:
            InputError: If there is none before the first update, as it is where the robot is.
        """
        if self._costmap is None:
            raise InputError("there is no costmap before the first update, as it is where the robot is; call update(…)")
        return self._costmap

    @property
    def changed(self) -> tuple[slice, slice] | None:
        """Rows and columns of `costmap` whose occupancy the last update changed, or None if it changed nothing."""
        return self._changed

    @property
    def warnings(self) -> Mapping[str, int]:
        """How often scans were left out, by reason, and how often the pose or its correction jumped, since a reset."""
        with self._lock:
            return MappingProxyType({}) if self._obstacle is None else self._obstacle.warnings

    @property
    def sensed(self) -> npt.NDArray[np.bool_]:
        """Cells of `costmap` that are occupied by what was sensed and not by the static map, shape (rows, cols)."""
        with self._lock:
            return (self._cells == OCCUPIED) & (self._base != OCCUPIED)

    def obstacles(self) -> FloatArray:
        """Return where obstacles were sensed that are not on the static map [m], map frame, shape (N, 2)."""
        with self._lock:
            if self._pose is None or self._costmap is None:
                return np.zeros((0, 2))
            points = np.concatenate([np.zeros((0, 2)), *(layer.obstacles() for layer in self._layers)])
            row, col = self._costmap.world_to_cell(points[:, 0], points[:, 1])
            inside = self._costmap.contains(row, col)
            points, row, col = points[inside], row[inside], col[inside]
            return points[(self._base[row, col] != OCCUPIED) & (self._kept[row, col] == 0)]

    def hits(self) -> FloatArray:
        """Return where scans have marked obstacles [m], also those of the static map, map frame, shape (N, 2)."""
        with self._lock:
            return np.zeros((0, 2)) if self._obstacle is None else self._obstacle.obstacles()

    def passes(self, x: FloatArray, y: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether scans agree that beams pass through points x and y [m], map frame, shape (N,)."""
        with self._lock:
            return np.zeros(len(x), np.bool_) if self._obstacle is None else self._obstacle.passes(x, y)

    def reset(self) -> None:
        """Forget what was sensed, for a new run."""
        with self._lock:
            for layer in self._layers:
                layer.reset()
            self._forget()

    def replace_static(self, static: Costmap) -> Costmap:
        """Take another costmap of the map; what was sensed stays.

        Args:
            static: The costmap, with its own keep-out mask, of any extent.

        Returns:
            The costmap then: the static one before the first update.

        Raises:
            InputError: If its cells are of another size.
        """
        check_kind(static, Costmap, "a static costmap", "CostmapSettings().make_costmap(grid, robot) makes one")
        with self._lock:
            if static.resolution != self._extent.resolution:
                raise InputError(
                    f"a static costmap must have cells of {self._extent.resolution:g} m, as the one before, got "
                    f"{static.resolution:g} m: make another LayeredCostmap"
                )
            self._take_static(static, None, None, static.resolution)
            if self._pose is None:
                self._forget()
                return static
            self._extent.follow(self._pose)
            self._rebuild()
            return self.costmap

    def clear(self, region: Literal["around", "except"], size: float, *, at: Pose2D | None = None) -> Costmap:
        """Forget the obstacles that were sensed in a square around the robot, or around another pose, or outside of it.

        Layers that were given as `extra_layers` keep what they have.

        Args:
            region: "around" for the square, "except" for all but the square.
            size: Its edge [m]; it is aligned with the map frame.
            at: The middle of the square, map frame. If None, it is the robot.

        Returns:
            The costmap then.

        Raises:
            InputError: If the region is neither, the size is not positive, or there was no update yet.
        """
        if region not in ("around", "except"):
            raise InputError(f"the region to clear is 'around' or 'except', got {region!r}")
        size = check_number("size", size, 1e-3, 1e4, "m")
        with self._lock:
            if self._pose is None:
                raise InputError("there is nothing to clear before the first update")
            if self._obstacle is not None:
                self._obstacle.forget(self._pose if at is None else at, size, outside=region == "except")
            self._repaint([EVERYWHERE])
            return self.costmap

    def forget_hidden(self, places: FloatArray) -> None:
        """Forget marks where something was seen to move, (N, 3) as in `update`, and nothing looks, but near ones."""
        with self._lock:
            if self._obstacle is not None and self._time is not None:
                window = self._obstacle.forget_movers(places, self._time, hidden=True)
                self._repaint([] if window is None else [window])

    def require(self, points: npt.ArrayLike) -> Costmap | None:
        """Contain these points where there is no map, for example a goal.

        Args:
            points: [m], map frame, shape (N, 2) or (2,).

        Returns:
            The costmap, or None before the first update. With a map or a rolling window it stays as it is.

        Raises:
            InputError: If the points are not finite or of another shape.
            MapError: If they are so far away that the costmap would have too many cells.
        """
        array = np.atleast_2d(as_array(points, np.float64, "points"))
        if array.ndim != 2 or array.shape[1] != 2 or not np.isfinite(array).all():
            raise InputError(f"points need shape (N, 2) [m] and finite numbers, got shape {array.shape}")
        with self._lock:
            if len(array) and not self._extent.is_fixed and not self._extent.rolling:
                margin = self._style.inflation_radius + self._style.planar.circumscribed_radius + _MARGIN_M
                if self._extent.require(array, margin):
                    self._rebuild()
            return self._costmap

    def update(self, scans: Sequence[Scan], estimate: Estimate, *, moved: npt.ArrayLike = ()) -> Costmap:
        """Take the scans that arrived since the last update, and return the costmap.

        Args:
            scans: Oldest first; each is placed by the estimates at its own time.
            estimate: Where the robot is now.
            moved: Where something was seen to move of late: x, y and radius [m], map frame, shape (N, 3). What was
                marked there and is not seen any more is forgotten; see `ObstacleLayerSettings.mover_persistence`.

        Returns:
            The same object as before if nothing changed.

        Raises:
            InputError: If the estimate's time is not after the last one, these are no scans, or `moved` has another
                shape or numbers that are not finite.
            MapError: If there is no map and the robot has driven so far that the costmap would have too many cells.

        Warns:
            SensorWarning: Once for each kind of scan that is left out, and of jump.
        """
        taken = check_scans(scans)
        check_kind(estimate, Estimate, "an estimate", "a localizer's update returns one")
        places = as_array(moved, np.float64, "moved")
        if places.size and (places.ndim != 2 or places.shape[1] != 3 or not np.isfinite(places).all()):
            raise InputError(f"moved needs shape (N, 3): x, y and radius [m], finite, got shape {places.shape}")
        return self._follow(lambda layer: layer.update(taken, estimate), estimate, places.reshape(-1, 3))

    def take(self, placed: PlacedScans, moved: FloatArray) -> Costmap:
        """Do as `update` with scans that a `ScanPlacer` has placed and counted; `moved` has shape (N, 3)."""
        estimate, obstacle = placed.estimate, self._obstacle

        def update(layer: Layer) -> MapWindow | None:
            if obstacle is not None and layer is obstacle:
                return obstacle.take(placed)
            return layer.update(placed.arrived, estimate)

        return self._follow(update, estimate, moved)

    def _follow(self, update: Callable[[Layer], MapWindow | None], estimate: Estimate, moved: FloatArray) -> Costmap:
        with self._lock:
            if self._time is not None and not estimate.time > self._time:
                raise InputError(
                    f"times must increase: an estimate of {estimate.time:g} s came after one of {self._time:g} s"
                )
            windows = [update(layer) for layer in self._layers]
            if self._obstacle is not None:
                windows.append(self._obstacle.forget_movers(moved, estimate.time))
            changed = [EVERYWHERE] if self._pose is None else [window for window in windows if window is not None]
            self._time, self._pose = estimate.time, estimate.pose
            if self._extent.follow(estimate.pose) or self._costmap is None:
                self._rebuild()
            else:
                self._repaint(changed)
            return self.costmap

    def _make_obstacle_layer(self, robot: Robot) -> ObstacleLayer:
        settings, keep = self.settings, None
        if settings.rolling_window:
            keep = 0.5 * math.hypot(settings.width, settings.height) * 1.2 + _MARGIN_M
        return ObstacleLayer(robot, settings.obstacle, resolution=self._extent.resolution, keep_within=keep)

    def _forget(self) -> None:
        self._time: float | None = None
        self._pose: Pose2D | None = None
        self._costmap = self._fixed
        self._changed: _Slices | None = None
        if not self._extent.is_fixed:
            self._extent.window = None
            self._base = self._cells = np.zeros((0, 0), np.int8)
            self._kept = np.zeros((0, 0), np.uint8)
            return
        self._base, self._kept = self._extent.cells(), self._kept_cells()
        self._cells = self._base.copy()

    def _kept_cells(self) -> npt.NDArray[np.uint8]:
        near = self._extent.near()
        obstacle = self.settings.obstacle
        return np.zeros_like(near) if obstacle is not None and obstacle.clear_static else near

    def _rebuild(self) -> None:
        """Make the costmap of a new extent."""
        self._base, self._kept = self._extent.cells(), self._kept_cells()
        rows, cols = self._base.shape
        everything = slice(0, rows), slice(0, cols)
        self._cells = self._painted(everything)
        origin = self._extent.origin
        self._costmap = self._style.make(self._cells, self._extent.resolution, origin, self._extent.floor())
        self._changed = everything

    def _repaint(self, windows: Sequence[MapWindow]) -> None:
        """Paint what changed, and update the costmap where that makes a difference."""
        self._changed = None
        if not windows:
            return
        part = self._extent.cells_under(windows)
        if part is None:
            return
        changed = self._take_over(part)
        if changed is None:
            return
        self._costmap = self.costmap.update(*changed, self._cells[changed])
        self._changed = changed

    def _take_over(self, part: _Slices) -> _Slices | None:
        """Paint a part again, and return which of its cells have changed."""
        if self._obstacle is not None and len(self._layers) == 1:
            pose = self._extent.origin @ self._corner_of(part)
            return self._obstacle.repaint(self._cells, part, self._base, self._kept, pose, self._extent.resolution)
        painted = self._painted(part)
        changed = differences(painted, self._cells[part])
        if changed is None:
            return None
        rows, cols = (
            slice(whole.start + inner.start, whole.start + inner.stop)
            for whole, inner in zip(part, changed, strict=True)
        )
        self._cells[rows, cols] = painted[changed]
        return rows, cols

    def _corner_of(self, part: _Slices) -> Pose2D:
        rows, cols = part
        return Pose2D(cols.start * self._extent.resolution, rows.start * self._extent.resolution)

    def _painted(self, part: _Slices) -> npt.NDArray[np.int8]:
        """Return a part of the static map with the layers painted on it."""
        cells = np.array(self._base[part])
        if self._pose is None or not self._layers:
            return cells
        pose = self._extent.origin @ self._corner_of(part)
        kept = np.ascontiguousarray(self._kept[part])
        for layer in self._layers:
            layer.paint(MapPart(cells, kept, self._extent.resolution, pose))
        return cells
