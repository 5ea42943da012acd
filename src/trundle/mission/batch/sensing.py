"""`Sensing`: what robots sense on their drives, and whether it would have made them drive otherwise."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from trundle._core import chebyshev_field
from trundle.control import CollisionMonitor
from trundle.control.controller import Intent
from trundle.control.pursuit_settings import PursuitSettings
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.costmap import LETHAL, Costmap
from trundle.costmap.layers import LayersSettings, ObstacleLayerSettings
from trundle.costmap.layers.extent import Extent, read_static
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.geometry.solids import Solid
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.mission.batch.surroundings import Surroundings
from trundle.mission.obstacles import KIND
from trundle.mission.running.run_log import RunLog
from trundle.mission.scenario import Setting
from trundle.navigation import Navigator
from trundle.observation import Scan
from trundle.planning import PathCheck
from trundle.robots import Lidar, Robot
from trundle.sim.beams import WorldOutline
from trundle.sim.lidar import LidarSet, SceneBeams
from trundle.worlds import World

_TICK_S = 0.1
"""Control periods up to this [s] are part of what a robot needs to stop; longer ones count as they are."""
_CLEARANCE_M = 0.1  # the stop check looks no farther than this beside the footprint
_SPARE_CELLS = 2.0  # for the corners of cells
_ROUNDED_CELLS = 1.0 / 128.0  # marks lie within 1/512 of a cell of their hits
_FARTHEST_CELLS = 254.0  # that a field of Chebyshev distances has


@dataclass(frozen=True, eq=False)
class BatchDrive:
    """What was driven along a path on the map.

    Attributes:
        time: Time at the beginning of each control period, and at the end [s], shape (N,).
        rows: (x, y, yaw, v, w) then, and the command (v, w) of the period before, shape (N, 7).
        check: Checks the path for collisions.
        ending: How it ended, by the kernel's number.
        reasons: In how many control periods the controller made no progress, by its reason.
        needs: What it needs that a batch has not; empty where it needs nothing.
    """

    time: FloatArray
    rows: FloatArray
    check: PathCheck
    ending: int
    reasons: Counter[str] = field(default_factory=Counter[str])
    needs: str = ""

    @cached_property
    def places(self) -> FloatArray:
        """Where the robot was, and where its path leads [m], shape (N + P, 2)."""
        return np.concatenate([self.rows[:, :2], self.check.poses[:, :2]])


class Sensing:
    """Makes what robots sense of their worlds; it keeps what missions in one world share.

    With the right map, layers change only cells that are unknown, and free ones beside these: whatever the lidars see
    and miss, the costmap lies between one in which all of them are free and one in which all are occupied. Where those
    agree on all that the navigator looks up on a drive, nothing that its layers show makes a difference.

    `regulated_pure_pursuit` takes no tracks, and a tracker matters only where a path is blocked; so it need not run.
    """

    def __init__(self) -> None:
        self._doubts: tuple[Costmap, float | None, _Doubts] | None = None
        self._beams: tuple[World, SceneBeams] | None = None

    def begin(self, setting: Setting) -> MissionSensing:
        """Begin a drive.

        Raises:
            UnknownNameError: If the robot has no lidar of a chosen name.
        """
        doubts, obstacle = None, layers_of(setting).obstacle
        if setting.scenario.lidar and obstacle is not None:
            doubts = self._doubts_of(setting.navigator, obstacle)
        return MissionSensing(setting, self._beams_in(setting.world), doubts)

    def _beams_in(self, world: World) -> SceneBeams:
        if self._beams is None or self._beams[0] is not world:
            self._beams = world, SceneBeams(world, None)
        return self._beams[1]

    def _doubts_of(self, navigator: Navigator, layer: ObstacleLayerSettings) -> _Doubts:
        costmap, kept = navigator.costmap, self._doubts
        if kept is None or kept[0] is not costmap or kept[1] != layer.static_tolerance:
            kept = costmap, layer.static_tolerance, _Doubts.of(costmap, navigator.robot, layer.static_tolerance)
            self._doubts = kept
        return kept[2]


class MissionSensing:
    """What the robot of one mission senses.

    Args:
        setting: The mission.
        beams: Casts the beams of lidars in its world.
        doubts: Where its layers may change the costmap; None where it has none.

    Attributes:
        log: What the collision monitor did.
    """

    def __init__(self, setting: Setting, beams: SceneBeams, doubts: _Doubts | None) -> None:
        self._setting, self._doubts = setting, doubts
        robot, chosen = setting.robot, setting.scenario.lidar
        self._lidars = LidarSet(robot, chosen, beams.cast)
        beams.prepare(self._lidars.heights)
        self._lidars.reset(setting.scenario.seed)
        self._since = -1.0
        self._scatters = not all(_reads_exactly(robot.lidars[name], robot) for name in _lidars_of(setting))
        self._unexpected: list[FloatArray] = []
        self._surroundings: Surroundings | None = None
        self._boxes = (
            [solid for solid in setting.world.solids if solid.kind == KIND] if setting.scenario.unmapped else []
        )
        costmap = setting.navigator.costmap
        self._far = (
            max(_stopping_reach(setting.navigator), costmap.inflation_radius) + _SPARE_CELLS * costmap.resolution
        )
        self._monitor = _make_monitor(setting)
        self.log = RunLog()

    def check(
        self,
        command: Twist2D,
        twist: Twist2D,
        scans: Sequence[Scan],
        time: float,
        pose: Pose2D,
        intent: Intent | None = None,
    ) -> Twist2D:
        """Return what the collision monitor sends instead of a command, by the scans up to now [s]."""
        if self._monitor is None:
            return command
        self._monitor.set_intent(intent)
        report = self._monitor.check(command, twist, scans, time, pose)
        self.log.add_report(report)
        return report.command

    def surroundings(self) -> Surroundings:
        """Return what the robot's software makes of its scans, for a controller that looks all around.

        Where no cell of the map may change, and all that the lidars see is on it, the layers are left out.
        """
        doubts, setting = self._doubts, self._setting
        is_as_mapped = doubts is None or (
            not (self._scatters or self._boxes or doubts.is_somewhere)
            and doubts.expect_all(setting.world, self._lidars.heights)
        )
        goal = setting.goals[0] if setting.goals else None
        self._surroundings = Surroundings(setting.navigator, None if is_as_mapped else layers_of(setting), goal)
        return self._surroundings

    def comes_near_box(self, places: FloatArray) -> bool:
        """Return whether an unmapped box may matter to a robot at some places [m], shape (N, 2) or more columns."""
        costmap = self._setting.navigator.costmap
        return any(_is_near(places, box, self._far + costmap.resolution) for box in self._boxes)

    def find_difference(self, drive: BatchDrive) -> str:
        """Return in a few words what was sensed that may have changed a drive; empty if nothing was."""
        setting, costmap = self._setting, self._setting.navigator.costmap
        if self.comes_near_box(drive.places):
            return "an unmapped box near the path"
        if self._doubts is None or self._surroundings is not None:
            return ""
        if not self._doubts.expect_all(setting.world, self._lidars.heights):
            return "lidars see what is not on the map"
        if drive.check.first_hit(costmap) is not None:
            return "a path that is blocked on the map"
        if self._doubts.matter_to(drive, _stopping_reach(setting.navigator)):
            return "unknown cells near the path"
        if self._scatters:
            seen = 0 if self._monitor is None else len(drive.rows) - 1
            for time, pose in zip(drive.time[seen:].tolist(), drive.rows[seen:, :3].tolist(), strict=True):
                self.look(time, Pose2D(*pose))
            places = np.concatenate([np.zeros((0, 2)), *self._unexpected]).tolist()
            if any(_distance(drive.places, x, y) <= self._far for x, y in places):
                return "noise of a lidar near the path"
        return ""

    def look(self, time: float, pose: Pose2D) -> tuple[Scan, ...]:
        """Simulate the scans that are due after the last look and up to now [s]."""
        scans = self._lidars.scan(pose, self._since, time)
        self._since = time
        if self._scatters and self._doubts is not None and self._surroundings is None:
            obstacle = layers_of(self._setting).obstacle or ObstacleLayerSettings()
            limits = obstacle.obstacle_min_range, obstacle.obstacle_max_range
            self._unexpected += [self._doubts.unexpected(scan, pose, *limits) for scan in scans]
        return scans


def _points_on(outline: WorldOutline, step: float) -> FloatArray:
    """Points on the section of a world, so far apart [m] at most; its cells are those of the map. Shape (N, 2)."""
    points = [np.zeros((0, 2))]
    for x0, y0, x1, y1 in outline.segments.tolist():
        count = math.ceil(math.hypot(x1 - x0, y1 - y0) / step) + 1
        points.append(np.linspace((x0, y0), (x1, y1), count))
    for x, y, radius in outline.discs.tolist():
        turns = np.linspace(0.0, math.tau, math.ceil(math.tau * radius / step) + 1)
        points.append(np.column_stack([x + radius * np.cos(turns), y + radius * np.sin(turns)]))
    return np.concatenate(points)


def layers_of(setting: Setting) -> LayersSettings:
    """Return how the scans of a mission are put into its costmap."""
    return LayersSettings() if setting.scenario.layers is None else setting.scenario.layers


def monitors(setting: Setting) -> bool:
    """Return whether the commands of a mission pass a collision monitor."""
    chosen = setting.scenario.collision_monitor
    return bool(_lidars_of(setting)) if chosen is None else chosen is not False


def _lidars_of(setting: Setting) -> tuple[str, ...]:
    chosen = setting.scenario.lidar
    return tuple(setting.robot.lidars if chosen is True else chosen or ())


def _stopping_reach(navigator: Navigator) -> float:
    """How far from base_link [m] an obstacle can matter to pursuit and its stop check, and not by its inflation."""
    robot, controller = navigator.robot, navigator.controller
    settings = controller.settings if isinstance(controller, RegulatedPurePursuit) else PursuitSettings()
    limits = robot.limits
    fastest = max(limits.linear_speed, limits.reverse_speed or 0.0)
    stop = fastest * (max(_TICK_S, navigator.dt) + fastest / (2.0 * limits.linear_acceleration))
    around = robot.circumscribed_radius + settings.footprint_padding + _CLEARANCE_M
    return around + max(stop, settings.lookahead_dist)


@dataclass(frozen=True, slots=True, eq=False)
class _Doubts:
    """Where the layers of a costmap may differ from it, whatever is seen of a world that is as the map.

    Attributes:
        costmap: The costmap.
        costs: Cells whose cost may be another, bool, shape (rows, cols).
        near: Chebyshev distance [cells] of each cell from the nearest one that is free or beside a free one, and may
            become blocked or no longer be, uint8, shape (rows, cols).
        expected: Cells in which hits change nothing else, bool, shape (rows, cols).
        is_somewhere: Whether there is any cell that they may change.
        known: Heights [m] of lidars that see only what is expected, or not.
    """

    costmap: Costmap
    costs: npt.NDArray[np.bool_]
    near: npt.NDArray[np.uint8]
    expected: npt.NDArray[np.bool_]
    is_somewhere: bool
    known: dict[float, bool] = field(default_factory=dict)

    @classmethod
    def of(cls, costmap: Costmap, robot: Robot, tolerance: float | None) -> _Doubts:
        """Find them for a distance from static obstacles within which nothing is marked [m]."""
        _, grid, style = read_static(costmap, robot, None, None, costmap.resolution)
        if grid is None:
            raise InputError("the layers of a mission in a batch need a map")
        extent = Extent(
            grid,
            floor=costmap.keepout,
            keepout=None,
            resolution=costmap.resolution,
            size=(1.0, 1.0),
            rolling=False,
            tolerance=tolerance,
        )
        cells, kept = grid.data, extent.near() != 0
        unknown, solid = cells == UNKNOWN, cells != FREE
        # A hit lies on the edge of a cell that is not free, or by rounding in one of the eight around.
        beside = (chebyshev_field(solid.view(np.uint8)) <= 1) & ~solid & ~kept
        least, most = np.where(unknown, np.int8(FREE), cells), np.where(unknown | beside, np.int8(OCCUPIED), cells)
        given = np.minimum(costmap.data, LETHAL)
        costs, blocked = np.zeros(given.shape, np.bool_), np.zeros(given.shape, np.bool_)
        for occupancy in (least, most):
            made = style.make(np.ascontiguousarray(occupancy), costmap.resolution, costmap.origin, extent.floor())
            found = np.minimum(made.data, LETHAL)
            costs |= found != given
            blocked |= (found == LETHAL) != (given == LETHAL)
        # What lies deeper in a blocked area is not touched before its edge is.
        blocked &= chebyshev_field((given < LETHAL).view(np.uint8)) <= 1
        return cls(
            costmap,
            costs,
            chebyshev_field(blocked.view(np.uint8)),
            solid | kept | beside,
            bool((unknown | beside).any()),
        )

    def matter_to(self, drive: BatchDrive, reach: float) -> bool:
        """Return whether one of these cells is looked up on a drive; blocked ones are within a reach [m]."""
        cells = reach / self.costmap.resolution + _SPARE_CELLS
        if cells > _FARTHEST_CELLS:
            return bool((self.near < _FARTHEST_CELLS).any())
        row, col = self._cells_at(drive.places.T)
        count = len(drive.rows)
        return bool(self.costs[row[:count], col[:count]].any() or (self.near[row, col] <= cells).any())

    def unexpected(self, scan: Scan, pose: Pose2D, least: float, most: float) -> FloatArray:
        """Return hits of a scan at a pose, from a range on and up to another [m], that may mark other cells.

        Returns:
            Where they are [m], map frame, shape (hits, 2).
        """
        hit = np.isfinite(scan.ranges) & (scan.ranges >= least) & (scan.ranges <= most)
        sensor, ranges, angles = pose @ scan.mount, scan.ranges[hit], scan.angles[hit]
        x = sensor.x + ranges * np.cos(angles + sensor.yaw)
        y = sensor.y + ranges * np.sin(angles + sensor.yaw)
        return self._unexpected_of(np.column_stack([x, y]))

    def expect_all(self, world: World, heights: Sequence[float]) -> bool:
        """Return whether hits at some heights [m], but for those on unmapped boxes, are where the map has something."""
        for height in heights:
            if height not in self.known:
                mapped = replace(world, solids=tuple(solid for solid in world.solids if solid.kind != KIND))
                points = _points_on(WorldOutline(mapped, height), 0.5 * self.costmap.resolution)
                self.known[height] = len(self._unexpected_of(points)) == 0
        return all(self.known[height] for height in heights)

    def _unexpected_of(self, points: FloatArray) -> FloatArray:
        spare = _ROUNDED_CELLS * self.costmap.resolution
        fits = np.ones(len(points), np.bool_)
        for dx, dy in ((-spare, -spare), (-spare, spare), (spare, -spare), (spare, spare)):
            row, col = self.costmap.world_to_cell(points[:, 0] + dx, points[:, 1] + dy)
            inside = self.costmap.contains(row, col)
            fits &= ~inside | self.expected[np.where(inside, row, 0), np.where(inside, col, 0)]
        return points[~fits]

    def _cells_at(self, places: FloatArray) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Return rows and columns of the cells that hold some places [m], or of those nearest to them on the map."""
        row, col = self.costmap.world_to_cell(places[0], places[1])
        rows, cols = self.costmap.shape
        return np.clip(row, 0, rows - 1), np.clip(col, 0, cols - 1)


def _make_monitor(setting: Setting) -> CollisionMonitor | None:
    if not monitors(setting):
        return None
    chosen = setting.scenario.collision_monitor
    return CollisionMonitor(setting.navigator.robot, None if isinstance(chosen, bool) else chosen)


def _reads_exactly(lidar: Lidar, robot: Robot) -> bool:
    """Return whether a lidar has no noise, and all that it can see without the robot touching it is in its range."""
    outline = robot.planar.outline
    along = np.roll(outline, -1, axis=0) - outline
    off = (lidar.x, lidar.y) - outline
    inwards = (along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0]) / np.hypot(along[:, 0], along[:, 1])
    return lidar.noise == 0.0 and bool(inwards.min() >= lidar.range_min)


def _is_near(places: FloatArray, box: Solid, reach: float) -> bool:
    """Return whether a box comes within a reach [m] of one of some places."""
    low, high = box.bounds()
    half = 0.5 * math.hypot(float(high[0] - low[0]), float(high[1] - low[1]))
    x, y, _ = box.pose.position
    return _distance(places, x, y) <= reach + half


def _distance(places: FloatArray, x: float, y: float) -> float:
    return float(np.hypot(places[:, 0] - x, places[:, 1] - y).min())
