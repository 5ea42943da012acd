"""`ObstacleLayer`: obstacles that lidars see, marked and cleared by ray tracing, with evidence per cell."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from trundle import _core
from trundle.costmap.layers.evidence_grid import SURELY_FREE, EvidenceGrid, FieldOfView
from trundle.costmap.layers.layer import EVERYWHERE, MapPart, MapWindow
from trundle.costmap.layers.scan_placer import PlacedScan, PlacedScans, ScanPlacer
from trundle.errors import InputError
from trundle.files.yaml_config import Config, NotNegative, Positive
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.observation import Estimate, Scan
from trundle.robots import Robot
from trundle.values import check_kind, check_number

_LARGEST_CELL_M = 10.0
_MOST_SENSORS = 32  # whose place is remembered: some robots move theirs
_BESIDE_M = 2.0  # room for the mount, and for what the robot drives while a scan is on its way

_JUMP_M, _JUMP_RAD = 0.25, math.radians(5.0)
"""A correction by more than this is a jump: one of a localizer that tracks is some centimetres, and tenths of a degree.
What is off by less lies beside its place by less than a robot leaves for clearance, and scans clear it."""
_WORTH_A_WARNING_M = 1.0
_LOOK_EVERY_S = 0.5
_BESIDE_MOVER_M = 0.3  # marks lie on the near side of a mover, and beside the place that its track has
_TURNS_WITHIN_M = 0.3  # beyond the circle in which the robot turns: it may turn into that before it looks there


class ObstacleLayerSettings(Config):
    """How scans mark and clear cells.

    A cell is hit by a scan in which at least one beam ends in it, and passed by one whose beams only go through it. One
    hit alone marks nothing unless `hits_to_mark` is 1: a range that is a few centimetres short now and then does not
    thicken a wall. What moved away disappears after `misses_to_clear` scans through its place. Between the two a cell
    stays as it is.

    Attributes:
        obstacle_max_range: Farthest range at which a beam marks [m].
        obstacle_min_range: Nearest range at which a beam marks [m].
        raytrace_max_range: Farthest range at which a beam clears [m].
        raytrace_min_range: Nearest range at which a beam clears [m].
        observation_persistence: Time after which a mark that no scan has hit disappears [s]. If None, only beams clear.
        mover_persistence: The same [s] for marks where something was seen to move, and that lie within the field of
            view and the range of a lidar: what is hidden since has probably moved on. If None, only beams clear these.
        source_timeout: Scans that are older than this are ignored [s].
        hits_to_mark: Number of scans in which a cell must be hit before it is marked, 1 to 5.
        misses_to_clear: How many scans must pass through a marked cell before it is cleared, 1 to 10.
        clear_static: Whether beams also clear obstacles of the static map, also those that lie below or above the
            lidars' planes: a map does not say how high things are.
        doubt_static: Whether a navigator that finds no path takes off the static map, until the next goal, cells that
            beams pass, of things of at most 2 m or that are drawn at a wall that was hit; and where the map alone has
            no path, things of at most 2 m that no scan has marked since the goal was set. So it gets past what is on
            the map and not in the world; what lies below or above the lidars' planes, such as forks and kerbs, it then
            does not know of.
        static_tolerance: Nothing is marked within this distance of an obstacle of the static map [m], between centres
            of cells, as a robot that is not quite where it believes to be sees walls a little beside their place. If
            None, this holds for the eight cells around it; 0 marks everything. Without effect with `clear_static`.
        footprint_clearing_enabled: Whether what lies within the robot's footprint is cleared.

    Raises:
        InputError: If a value is out of range.
    """

    obstacle_max_range: Positive = 10.0
    obstacle_min_range: NotNegative = 0.0
    raytrace_max_range: Positive = 12.0
    raytrace_min_range: NotNegative = 0.0
    observation_persistence: NotNegative | None = None
    mover_persistence: NotNegative | None = 2.0
    source_timeout: Positive = 1.0
    hits_to_mark: Annotated[int, Field(ge=1, le=5)] = 2
    misses_to_clear: Annotated[int, Field(ge=1, le=10)] = 5
    clear_static: bool = False
    doubt_static: bool = False
    static_tolerance: NotNegative | None = None
    footprint_clearing_enabled: bool = True

    @model_validator(mode="after")
    def _check(self) -> Self:
        for name in ("obstacle", "raytrace"):
            low, high = getattr(self, f"{name}_min_range"), getattr(self, f"{name}_max_range")
            if not low < high <= 1000.0:
                raise ValueError(
                    f"{name}_max_range {high:g} m must be above {name}_min_range {low:g} m, and at most 1000 m"
                )
        return self


class ObstacleLayer:
    """Marks where beams end and clears what they pass, with evidence per cell; see `ObstacleLayerSettings`.

    Each cell keeps where it was hit, so the layer can be put into a map at any angle. A cell counts at most once per
    scan, and one that a scan hits is not cleared by that scan. Infinity clears where the lidar's `inf_is_valid` says
    so; NaN, minus infinity and ranges outside the lidar's are ignored, and so are beams that end within the robot's own
    footprint.

    A scan is placed by the odometry at its own time and the newest estimate's `T_map_odom`, which a localizer may have
    found by this very scan; what it marks stays there. If the estimate jumps, by more than 0.25 m or 5 degrees beyond
    what the robot moved, what was sensed within the lidars' reach of where the robot believed to be is forgotten, and
    seen again. It cannot be moved: what was seen before a slip or a kidnapping lies right, and what was seen after it
    does not.

    Args:
        robot: The robot, with its lidars, footprint and limits.
        settings: How scans mark and clear. If None, the defaults.
        resolution: Edge of its cells [m].
        keep_within: Distance [m] from the robot, along each axis, from which on it forgets. If None, it keeps
            everything within some 100 m.

    Raises:
        InputError: If an argument is of another kind or out of range.
    """

    def __init__(
        self,
        robot: Robot,
        settings: ObstacleLayerSettings | None = None,
        *,
        resolution: float = 0.05,
        keep_within: float | None = None,
    ) -> None:
        check_kind(robot, Robot, "a layer's robot", "Robot.load(name) makes one")
        self.settings = ObstacleLayerSettings() if settings is None else settings
        check_kind(self.settings, ObstacleLayerSettings, "settings", "give ObstacleLayerSettings(…)")
        edge = check_number("resolution", resolution, 1e-3, _LARGEST_CELL_M, "m")
        reach = max(self.settings.raytrace_max_range, self.settings.obstacle_max_range) + _BESIDE_M
        self._half = reach if keep_within is None else check_number("keep_within", keep_within, 0.0, 2000.0, "m")
        self._robot = robot
        self._placer = ScanPlacer(robot, self.settings.source_timeout)
        timed = self.settings.observation_persistence is not None
        self._grid = EvidenceGrid(edge, timed=timed, rolling=keep_within is not None)
        self._rule = self.settings.misses_to_clear, self.settings.hits_to_mark
        self._sensors: dict[tuple[Pose2D, float, float], tuple[FloatArray, FloatArray]] = {}
        self._views: dict[str, tuple[Scan, FloatArray]] = {}
        self._last: Estimate | None = None
        self._frame: object = None
        self._looked_at = -math.inf

    @property
    def warnings(self) -> Mapping[str, int]:
        """How often a scan was left out, by reason, and how often the pose or its correction jumped."""
        return MappingProxyType(dict(self._placer.counts))

    def reset(self) -> None:
        """Forget everything, for a new run."""
        self._placer.reset()
        self._grid.clear()
        self._views.clear()
        self._last = self._frame = None
        self._looked_at = -math.inf

    def forget(self, pose: Pose2D, size: float, *, outside: bool) -> None:
        """Forget what was seen in a square of edge `size` [m] around a pose, or outside of it; map frame."""
        self._grid.forget(pose.x, pose.y, 0.5 * size, outside=outside)

    def forget_movers(self, places: FloatArray, time: float, *, hidden: bool = False) -> MapWindow | None:
        """Forget marks where something was seen to move, and that were not hit within `mover_persistence`.

        What no lidar looks at now stays: it is not hit, whether it is there or not.

        Args:
            places: Where that was of late: x, y and radius [m], map frame, shape (N, 3).
            time: Now [s]. It looks for such marks twice a second.
            hidden: Whether to look at once, and to forget also what no lidar looks at, unless it is so near that the
                robot may turn into it.

        Returns:
            What changed, in the map frame, or None if nothing changed.
        """
        persistence, grid = self.settings.mover_persistence, self._grid
        waits = not hidden and 0.0 <= time - self._looked_at < _LOOK_EVERY_S
        if persistence is None or len(places) == 0 or waits:
            return None
        self._looked_at = time
        grid.begin_timing(time)
        row, col = grid.unseen(places + np.array([0.0, 0.0, _BESIDE_MOVER_M]), time - persistence)
        x, y = grid.centres(row, col)
        views = self._fields_of_view(time - self.settings.source_timeout)
        gone = np.any([np.zeros(len(row), np.bool_), *(view.contains(x, y) for view in views)], 0)
        if hidden and self._last is not None:
            pose, reach = self._last.pose, self._robot.planar.circumscribed_radius + _TURNS_WITHIN_M
            gone |= np.hypot(x - pose.x, y - pose.y) > reach
        row, col = row[gone], col[gone]
        if len(row) == 0:
            return None
        misses, hits = self._rule
        grid.cells[row, col] = 1 + hits * misses
        return grid.window((int(row.min()), int(row.max()) + 1, int(col.min()), int(col.max()) + 1))

    def update(self, scans: Sequence[Scan], estimate: Estimate) -> MapWindow | None:
        """Mark and clear by new scans; see `Layer`.

        Returns:
            What changed, in the map frame, or None if nothing changed.

        Raises:
            InputError: If the estimate's time is not after the last one, or these are no scans.

        Warns:
            SensorWarning: Once for each kind of scan that is left out; if the odometry jumps, which clears the layer;
                and if the estimate is corrected by more than 1 m.
        """
        check_kind(estimate, Estimate, "an estimate", "a localizer's update returns one")
        if self._last is not None and not estimate.time > self._last.time:
            raise InputError(
                f"times must increase: an estimate of {estimate.time:g} s came after one of {self._last.time:g} s"
            )
        return self.take(self._placer.place(scans, estimate))

    def take(self, placed: PlacedScans) -> MapWindow | None:
        """Mark and clear by new scans that somebody has placed for several users: `update` without its checks."""
        estimate, last = placed.estimate, self._last
        jumped = self._frame is not None and placed.frame is not self._frame
        if jumped:
            self._grid.clear()
        elif last is not None:
            jumped = self._correct(last, estimate, placed.odom_pose)
        self._last, self._frame = estimate, placed.frame
        pose, T_map_odom = estimate.pose, estimate.T_map_odom
        forgot = self._grid.hold(pose.x, pose.y, self._half)
        boxes = [
            self._mark(one, _in_map(T_map_odom, one.poses))
            for one in placed.scans
            if not self._placer.is_stale(one.scan, estimate.time)
        ]
        grid, persistence = self._grid, self.settings.observation_persistence
        if persistence is not None:
            boxes.append(_core.unmark_before(grid.cells, grid.times, estimate.time - persistence, *self._rule))
        if self.settings.footprint_clearing_enabled:
            outline = pose.transform_points(self._robot.planar.outline)
            boxes.append(
                _core.unmark_within(grid.cells, grid.points, grid.row, grid.col, grid.resolution, outline, *self._rule)
            )
        return EVERYWHERE if jumped or forgot else grid.window(_union(boxes))

    def paint(self, part: MapPart) -> None:
        """Write free space and obstacles into `part.cells`: what was seen and unknown is free, then marks."""
        grid = self._grid
        _core.paint_marks(
            grid.cells,
            grid.points,
            grid.row,
            grid.col,
            grid.resolution,
            part.cells,
            part.kept,
            *part.pose.as_tuple(),
            part.resolution,
            self.settings.clear_static,
        )

    def repaint(
        self,
        cells: npt.NDArray[np.int8],
        part: tuple[slice, slice],
        base: npt.NDArray[np.int8],
        kept: npt.NDArray[np.uint8],
        pose: Pose2D,
        resolution: float,
    ) -> tuple[slice, slice] | None:
        """Paint a part of a map again, as `paint` does, where this is its only layer.

        Args:
            cells: The whole map as it was painted last, shape (rows, cols); its part is changed.
            part: Rows and columns to paint.
            base: The static map, of the same shape.
            kept: Not 0 where nothing may be marked, of the same shape.
            pose: Pose of the part's lower left corner in the map frame.
            resolution: Edge of a cell [m].

        Returns:
            Rows and columns that hold all cells that changed, or None if none did.
        """
        grid, (rows, cols) = self._grid, part
        row, row_end, col, col_end = _core.repaint_marks(
            *(grid.cells, grid.points, grid.row, grid.col, grid.resolution, cells, base, kept),
            (rows.start, rows.stop, cols.start, cols.stop),
            *(*pose.as_tuple(), resolution, self.settings.clear_static),
        )
        return (slice(row, row_end), slice(col, col_end)) if row < row_end else None

    def obstacles(self) -> FloatArray:
        """Return where marked cells were hit [m], map frame, shape (N, 2)."""
        return self._grid.marks()

    def passes(self, x: FloatArray, y: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether scans agree, `misses_to_clear` of them, that beams pass through points x and y [m], map frame."""
        return self._grid.levels(x, y) == SURELY_FREE

    def _correct(self, before: Estimate, estimate: Estimate, odom_pose: Pose2D) -> bool:
        """Forget what lies around the robot if the estimate jumps from the one before; return whether it does."""
        after, T_map_odom = estimate.pose, before.T_map_odom
        if estimate.T_map_odom is T_map_odom or estimate.T_map_odom == T_map_odom:
            return False
        # Where wheels slip and the same update puts that right, the pose goes on evenly: all marks are where they were.
        believed, last = T_map_odom @ odom_pose, before.pose
        moved = min(after.distance_to(believed), after.distance_to(last))
        turned = min(abs(wrap_angle(after.yaw - believed.yaw)), abs(wrap_angle(after.yaw - last.yaw)))
        if moved <= _JUMP_M and turned <= _JUMP_RAD:
            return False
        self._grid.forget(believed.x, believed.y, self._half, outside=False)
        if moved > _WORTH_A_WARNING_M:
            self._placer.warn(
                "correction",
                f"the estimate was corrected by {moved:.1f} m at {estimate.time:g} s: the obstacles sensed around the "
                "robot are forgotten",
            )
        return True

    def _mark(self, placed: PlacedScan, poses: FloatArray) -> tuple[int, int, int, int]:
        grid, scan = self._grid, placed.scan
        outline, limits = self._sensor_of(scan)
        if len(scan.angles):
            self._views[scan.lidar] = scan, poses
        return _core.mark_scan(
            grid.cells,
            grid.points,
            grid.times,
            grid.row,
            grid.col,
            grid.resolution,
            poses,
            scan.angles,
            placed.ranges,
            outline,
            limits,
            self._robot.lidars[scan.lidar].inf_is_valid,
            *self._rule,
            scan.time,
        )

    def _fields_of_view(self, oldest: float) -> list[FieldOfView]:
        """Where the newest scan of each lidar looked, unless that is older [s]."""
        reach = self.settings.obstacle_min_range, self.settings.obstacle_max_range
        newest = [(scan, poses) for scan, poses in self._views.values() if scan.time >= oldest]
        views = (FieldOfView.of_scan(scan, poses, reach) for scan, poses in newest)
        return [view for view in views if view is not None]

    def _sensor_of(self, scan: Scan) -> tuple[FloatArray, FloatArray]:
        """Return the robot's outline in the frame of a scan's sensor, and the ranges that mark and clear."""
        sensor = scan.mount, scan.range_min, scan.range_max
        if sensor not in self._sensors:
            if len(self._sensors) >= _MOST_SENSORS:
                self._sensors.clear()
            settings = self.settings
            limits = [
                *(scan.range_min, scan.range_max),
                *(settings.obstacle_min_range, settings.obstacle_max_range),
                *(settings.raytrace_min_range, settings.raytrace_max_range),
            ]
            outline = scan.mount.inverse().transform_points(self._robot.planar.outline)
            self._sensors[sensor] = outline, np.array(limits)
        return self._sensors[sensor]


def _in_map(T_map_odom: Pose2D, poses: FloatArray) -> FloatArray:
    """Return poses x, y, yaw in the map frame, given those in odom, shape (N, 3)."""
    x, y, turn = T_map_odom.as_tuple()
    if x == y == turn == 0.0:
        return poses
    cos, sin = math.cos(turn), math.sin(turn)
    if len(poses) == 1:
        ((at_x, at_y, yaw),) = poses.tolist()
        return np.array([(x + cos * at_x - sin * at_y, y + sin * at_x + cos * at_y, yaw + turn)])
    seen = np.empty_like(poses)
    seen[:, 0] = x + cos * poses[:, 0] - sin * poses[:, 1]
    seen[:, 1] = y + sin * poses[:, 0] + cos * poses[:, 1]
    seen[:, 2] = poses[:, 2] + turn
    return seen


def _union(boxes: Sequence[tuple[int, int, int, int]]) -> tuple[int, int, int, int]:
    changed = [box for box in boxes if box[0] < box[1]]
    if not changed:
        return 0, 0, 0, 0
    row, row_end, col, col_end = zip(*changed, strict=True)
    return min(row), max(row_end), min(col), max(col_end)
