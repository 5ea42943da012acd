"""`ObstacleLayer`: obstacles that lidars see, marked and cleared by ray tracing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from trundle import _core
from trundle.costmap.layers.evidence_grid import EvidenceGrid
from trundle.costmap.layers.layer import EVERYWHERE, MapPart, OdomWindow
from trundle.costmap.layers.scan_gate import ScanGate
from trundle.costmap.layers.settings import ObstacleLayerSettings
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Estimate, Scan
from trundle.robots import Robot
from trundle.values import check_kind, check_number

_LARGEST_CELL_M = 10.0
_MOST_SENSORS = 32  # whose place is remembered: some robots move theirs
_BESIDE_M = 2.0  # room for the mount, and for what the robot drives while a scan is on its way


class ObstacleLayer:
    """Marks where beams end and clears what they pass, with evidence per cell; see `ObstacleLayerSettings`.

    Each cell keeps where it was hit. So the layer can be put into a map at any angle, and once more after a correction
    of the pose. A cell counts at most once per scan, and one that a scan hits is not cleared by that scan. Infinity
    clears where the lidar's `inf_is_valid` says so; NaN, minus infinity and ranges outside the lidar's are ignored, and
    so are beams that end within the robot's own footprint.

    Args:
        robot: The robot, with its lidars, footprint and limits.
        settings: None means the defaults.
        resolution: Edge of its cells [m].
        keep_within: Distance [m] from the robot, along each axis, from which on it forgets; none means that it keeps
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
        self._gate = ScanGate(robot, self.settings.source_timeout)
        timed = self.settings.observation_persistence is not None
        self._grid = EvidenceGrid(edge, timed=timed, rolling=keep_within is not None)
        self._rule = self.settings.misses_to_clear, self.settings.hits_to_mark
        self._sensors: dict[tuple[Pose2D, float, float], tuple[FloatArray, FloatArray]] = {}

    @property
    def warnings(self) -> Mapping[str, int]:
        """How often a scan was left out, by reason, and how often the pose jumped."""
        return MappingProxyType(dict(self._gate.counts))

    def reset(self) -> None:
        """Forget everything, for a new run."""
        self._gate.reset()
        self._grid.clear()

    def forget(self, pose: Pose2D, size: float, *, outside: bool) -> None:
        """Forget what was seen in a square of edge `size` [m] around a pose, or outside of it; odom frame."""
        self._grid.forget(pose.x, pose.y, 0.5 * size, outside=outside)

    def update(self, scans: Sequence[Scan], estimate: Estimate) -> OdomWindow | None:
        """Mark and clear by new scans; see `Layer`.

        Returns:
            What changed, in the odom frame; None if nothing did.

        Raises:
            InputError: If the estimate's time is not after the last one, or these are no scans.

        Warns:
            SensorWarning: Once for each kind of scan that is left out; and if the pose jumps, which clears the layer.
        """
        jumped = self._gate.follow(estimate)
        if jumped:
            self._grid.clear()
        pose = estimate.odom_pose
        forgot = self._grid.hold(pose.x, pose.y, self._half)
        boxes = [self._mark(scan, poses) for scan, poses in self._gate.admit(scans)]
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

    def obstacles(self) -> FloatArray:
        """Where marked cells were hit [m], odom frame, shape (N, 2)."""
        return self._grid.marks()

    def _mark(self, scan: Scan, poses: FloatArray) -> tuple[int, int, int, int]:
        grid = self._grid
        outline, limits = self._seen_from(scan)
        return _core.mark_scan(
            grid.cells,
            grid.points,
            grid.times,
            grid.row,
            grid.col,
            grid.resolution,
            poses,
            scan.angles,
            scan.ranges,
            outline,
            limits,
            self._robot.lidars[scan.lidar].inf_is_valid,
            *self._rule,
            scan.time,
        )

    def _seen_from(self, scan: Scan) -> tuple[FloatArray, FloatArray]:
        """The robot's outline in the frame of a scan's sensor, and the ranges that mark and clear; kept by sensor."""
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


def _union(boxes: Sequence[tuple[int, int, int, int]]) -> tuple[int, int, int, int]:
    changed = [box for box in boxes if box[0] < box[1]]
    if not changed:
        return 0, 0, 0, 0
    row, row_end, col, col_end = zip(*changed, strict=True)
    return min(row), max(row_end), min(col), max(col_end)
