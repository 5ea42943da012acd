"""What a navigator makes of scans: `SensedMap`, the costmap with what they saw; `SensedTracks`, what moves."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from trundle.costmap import LETHAL, Costmap, CostmapSettings
from trundle.costmap.doubted_map import without_passed, without_unseen
from trundle.costmap.growing_map import GrowingMap, check_size
from trundle.costmap.layers import LayeredCostmap, LayersSettings, PlacedScan, PlacedScans, ScanPlacer
from trundle.errors import MapError, OutsideMapError, SensorWarning
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.cells import UNKNOWN
from trundle.observation import Estimate, Track
from trundle.path import Path
from trundle.robots import Robot
from trundle.tracking import Tracker, TrackerSettings

RESOLUTION_M = 0.05
_AROUND_M = 6.0  # of unknown space around start and goals, for ways round what is in between
_JUMP_M = 1.0  # beyond what the robot drove: then what was sensed lies elsewhere
_NOTE_HITS_EVERY_S = 0.5  # so that noting what a scan hit costs little in each period
_FIRST_SCAN_S = 2.0
_NOTHING_M = 1e-3  # edge of a square that holds nothing
_CORRECTED_M = 0.5  # a robot that is so far from its path has left it: see FollowedPath


class SensedMap:
    """Puts scans into the costmap of a map, or of no map at all.

    The layers are made at the first scan, so that a robot without scans pays nothing for them.

    Args:
        static: The costmap of the map; None without a map.
        robot: The robot.
        costmap: How the costmap is made where there is no map.
        layers: How scans are put into it; None for the defaults, False to leave scans out.

    Attributes:
        costmap: The latest.
    """

    def __init__(
        self,
        static: Costmap | None,
        robot: Robot,
        *,
        costmap: CostmapSettings | None,
        layers: LayersSettings | Literal[False] | None,
    ) -> None:
        self._robot, self._settings = robot, _without_map(costmap)
        self._layers: LayersSettings | Literal[False] | None = layers
        obstacle = None if layers is False else (layers or LayersSettings()).obstacle
        self._may_take_off = obstacle is not None and obstacle.doubt_static
        self._has_map = static is not None
        self._static = self._blank([]) if static is None else static
        self._trusted: Costmap | None = None  # the whole map, while things on it are doubted
        self._awaiting_since: float | None = None  # a first scan [s]
        self._hit: npt.NDArray[np.bool_] | None = None  # cells of the map that carried a mark since the goal was set
        self._hits_noted_at = -math.inf
        self._reset_time = True
        self._grown: GrowingMap | None = None
        self._wanted: list[tuple[float, float]] = []  # what the costmap was last asked to contain [m]
        self.reset()

    def begin_run(self) -> None:
        """Forget what was sensed, and a map that has grown."""
        if self._grown is not None:
            self._grown, self._static = None, self._blank([])
        self.reset()
        self._hit = None

    def grow(self, grid: OccupancyGrid, path: Path | None, *, corrected: bool) -> None:
        """Use the map that a localizer has made so far where there is no other; see `Agent.set_map`.

        The costmap also contains the robot, what it was asked to contain, and the path that is followed. What was
        sensed beside a map that has moved since is forgotten: it would lie where nothing is, and the scans show it
        again.

        Raises:
            InputError: If the map is turned.
            MapError: If it is too large.
        """
        if self._has_map:
            return
        if self._grown is None:
            self._grown = GrowingMap(self._robot, self._settings)
        points = list(self._wanted)
        if self._last_pose is not None:
            points.append((self._last_pose.x, self._last_pose.y))
        if path is not None:
            points += (path.poses[:, :2].min(axis=0), path.poses[:, :2].max(axis=0))
        costmap = self._grown.take(grid)
        if points:
            costmap = self._grown.contain(np.array(points)) or costmap
        if corrected:
            self.clear_region("except", _NOTHING_M)
        self._put(costmap)

    def _put(self, costmap: Costmap) -> None:
        """Drive on this costmap of the map; what was sensed stays, unless the cells are of another size."""
        if costmap is self._static:
            return
        self._static = costmap
        if self._layered is None or costmap.resolution != self.costmap.resolution:
            self.reset()
        else:
            self.costmap = self._layered.replace_static(costmap)

    def reset(self) -> None:
        """Forget what was sensed, but not which things on the map were hit."""
        self.costmap: Costmap = self._static
        self._layered: LayeredCostmap | None = None
        self._hits_noted_at, self._awaiting_since = -math.inf, None
        self._waiting: tuple[PlacedScan, ...] = ()
        self._frame: object = None
        self._time: float | None = None
        self._last_pose: Pose2D | None = None
        self._T_map_odom: Pose2D | None = None

    def replace_static(self, costmap: Costmap) -> None:
        """Replace the costmap of the map; what was sensed stays, unless the cells are of another size."""
        self._has_map, self._trusted, self._hit = True, None, None
        self._put(costmap)

    def doubt_static(self) -> bool:
        """Remove small things that no scan has hit from the map until the next goal; return whether there are any.

        Nothing is taken off unless the layers' settings say so, and there was a scan.
        """
        return self.may_doubt and self._take_off(without_unseen(self._static, self._note_hits()))

    def doubt_passed(self, pose: Pose2D) -> bool:
        """Take cells off the map that beams pass, or that a robot at `pose` stands in; else as `doubt_static`."""
        if not self.may_doubt or self._layered is None:
            return False
        outline = None  # a robot beside a thing stays out of it: a low kerb would have a gap as long as the robot
        if self._static.footprint_collides(pose.as_tuple())[0]:
            outline = pose.transform_points(self._robot.planar.padded(self._static.resolution).outline)
        return self._take_off(without_passed(self._static, self._note_hits(), self._layered.passes, outline))

    def _take_off(self, doubted: Costmap | None) -> bool:
        if doubted is None:
            return False
        self._trusted = self._static if self._trusted is None else self._trusted
        self._put(doubted)
        return True

    @property
    def may_doubt(self) -> bool:
        """Whether `doubt_static` may take things off the map: the settings say so, and there was a scan."""
        return self._doubts and self._layered is not None

    @property
    def _doubts(self) -> bool:
        return self._has_map and self._may_take_off

    def await_scan(self, time: float) -> bool:
        """Begin at this time [s] to wait for a first scan, unless that has begun; return whether it goes on."""
        if self._awaiting_since is None or time < self._awaiting_since:
            self._awaiting_since = time
        return self.awaits_scan(time)

    def awaits_scan(self, time: float) -> bool:
        """Whether a plan is to wait at this time [s], for 2 s at most, as the map may be doubted after a first scan."""
        if self.may_doubt or not self._doubts:
            return False
        return self._awaiting_since is None or time - self._awaiting_since <= _FIRST_SCAN_S

    def _note_hits(self) -> npt.NDArray[np.bool_]:
        """Return which cells of the map have carried a mark since the goal was set: marks may be forgotten later."""
        static = self._static
        if self._hit is None or self._hit.shape != static.shape:
            self._hit = np.zeros(static.shape, np.bool_)
        if self._layered is not None:
            hits = self._layered.hits()
            row, col = static.world_to_cell(hits[:, 0], hits[:, 1])
            inside = static.contains(row, col)
            self._hit[row[inside], col[inside]] = True
        return self._hit

    def clear_region(self, region: Literal["around", "except"], size: float, at: Pose2D | None = None) -> None:
        """Forget what was sensed in a square of this edge [m] around the robot or another pose, or outside of it."""
        if self._layered is not None:
            if self.may_doubt:
                self._note_hits()
            self.costmap = self._layered.clear(region, size, at=at)

    def forget_hidden(self, places: FloatArray) -> None:
        """Forget marks where something was seen to move, (N, 3) as in `update`, and nothing looks, but near ones."""
        if self._layered is not None:
            self._layered.forget_hidden(places)
            self.costmap = self._layered.costmap

    def begin(self) -> None:
        """Expect that the time may start over, and the robot be elsewhere: there is a new goal."""
        self._reset_time = True
        self._last_pose = self._T_map_odom = self._hit = self._awaiting_since = None
        self._wanted = []
        if self._trusted is not None:
            self.replace_static(self._trusted)

    @property
    def is_active(self) -> bool:
        """Whether scans have been put into the costmap."""
        return self._layered is not None

    @property
    def static(self) -> Costmap | None:
        """The costmap without what was sensed; None without a map."""
        return self._static if self._has_map else None

    def may_contain(self, pose: Pose2D) -> bool:
        """Return whether the costmap may come to contain a pose: there is no map, or the map contains it."""
        return not self._has_map or _contains(self._static, [(pose.x, pose.y)])

    def contain(self, *poses: Pose2D) -> Costmap | None:
        """Extend the costmap to contain these poses where there is no map; return it if that has changed it.

        Raises:
            OutsideMapError: If they are so far away that it would have too many cells.
        """
        if self._has_map:
            return None
        points, before = [(pose.x, pose.y) for pose in poses], self.costmap
        try:
            if self._grown is not None:
                if (costmap := self._grown.contain(np.array(points))) is not None:
                    self._put(costmap)
            elif self._layered is not None:
                self.costmap = self._layered.require(np.array(points)) or self.costmap
            elif not _contains(self.costmap, points):
                self.costmap = self._static = self._blank(points)
        except MapError as error:
            raise OutsideMapError(str(error)) from None
        self._wanted = points
        return None if self.costmap is before else self.costmap

    def update(self, placed: PlacedScans, goal: Goal | None, moved: FloatArray) -> None:
        """Put scans into the costmap.

        Args:
            placed: Scans that arrived since the last call, and the pose of the robot now.
            goal: Where it is driving to.
            moved: Where something was seen to move of late: x, y and radius [m], map frame, shape (N, 3).

        Warns:
            SensorWarning: If the time goes back, after which what was sensed is forgotten.
        """
        if self._layers is False or (self._layered is None and not placed.arrived):
            return
        time = placed.estimate.time
        if self._time is not None and time <= self._time:
            if time == self._time:
                self._waiting += placed.scans
                return
            self._go_back(time)
        if self._waiting and placed.frame is self._frame:
            placed = replace(placed, scans=(*self._waiting, *placed.scans))
        self._waiting, self._reset_time, self._time, self._frame = (), False, time, placed.frame
        if self._layered is None:
            self._layered = self._make_layered()
            if goal is not None:
                self._layered.require((goal.x, goal.y))
        self.costmap = self._layered.take(placed, moved)
        if self.may_doubt and not 0.0 <= time - self._hits_noted_at < _NOTE_HITS_EVERY_S:
            self._hits_noted_at = time
            self._note_hits()

    def jump(self, pose: Pose2D, driven_m: float, estimate: Estimate | None) -> float | None:
        """Return how far the robot's pose has moved since the last call [m], if it jumps.

        It does if it moves by 1 m more than the robot may have driven, or if a localizer corrects it by 0.5 m.
        """
        last, self._last_pose = self._last_pose, pose
        before, self._T_map_odom = self._T_map_odom, None if estimate is None else estimate.T_map_odom
        if last is None or not self.is_active:
            return None
        moved = pose.distance_to(last)
        if moved > driven_m + _JUMP_M:
            return moved
        if estimate is None or before is None or before == estimate.T_map_odom:
            return None
        corrected = min(moved, pose.distance_to(before @ estimate.odom_pose))
        return corrected if corrected > _CORRECTED_M else None

    def obstacle_near(self, x: float, y: float, within: float) -> tuple[float, float]:
        """Return the obstacle nearest to a point [m], map frame; the point itself where there is none so near."""
        costmap = self.costmap
        reach = math.ceil(within / costmap.resolution)
        row, col = (int(index) for index in costmap.world_to_cell(x, y))
        rows, cols = slice(max(0, row - reach), row + reach + 1), slice(max(0, col - reach), col + reach + 1)
        found = np.argwhere(costmap.data[rows, cols] == LETHAL)
        if len(found) == 0:
            return x, y
        found_x, found_y = costmap.cell_to_world(found[:, 0] + rows.start, found[:, 1] + cols.start)
        nearest = int(np.hypot(found_x - x, found_y - y).argmin())
        return float(found_x[nearest]), float(found_y[nearest])

    def _go_back(self, time: float) -> None:
        if not self._reset_time:
            warnings.warn(
                f"the time went back from {self._time:g} s to {time:g} s: what was sensed is forgotten; call reset() "
                "or set_goal(…) before a new run",
                SensorWarning,
                stacklevel=4,
            )
        self.reset()

    def _make_layered(self) -> LayeredCostmap:
        layers = None if self._layers is False else self._layers
        if self._has_map or self._grown is not None:
            return LayeredCostmap(self._static, self._robot, layers=layers)
        layered = LayeredCostmap(None, self._robot, costmap=self._settings, layers=layers, resolution=RESOLUTION_M)
        low = self._static.origin
        rows, cols = self._static.shape
        size = cols * self._static.resolution, rows * self._static.resolution
        layered.require(np.array([(low.x + 1.0, low.y + 1.0), (low.x + size[0] - 1.0, low.y + size[1] - 1.0)]))
        return layered

    def _blank(self, points: Sequence[tuple[float, float]]) -> Costmap:
        """Return a costmap of unknown space around points, and around the origin without one."""
        corners = np.array(points or [(0.0, 0.0)])
        low, high = corners.min(axis=0) - _AROUND_M, corners.max(axis=0) + _AROUND_M
        low = np.floor(low / RESOLUTION_M) * RESOLUTION_M
        cols, rows = np.ceil((high - low) / RESOLUTION_M).astype(int).tolist()
        check_size(rows, cols)
        cells = np.full((rows, cols), UNKNOWN, np.int8)
        grid = OccupancyGrid(cells, RESOLUTION_M, Pose2D(float(low[0]), float(low[1])))
        return self._settings.make_costmap(grid, self._robot)


def _without_map(settings: CostmapSettings | None) -> CostmapSettings:
    """Return settings with which unknown space can be driven, unless they say otherwise."""
    settings = CostmapSettings() if settings is None else settings
    if "unknown" in settings.model_fields_set:
        return settings
    return settings.model_copy(update={"unknown": "costly"})


def _contains(costmap: Costmap, points: Sequence[tuple[float, float]]) -> bool:
    array = np.array(points)
    return bool(costmap.contains(*costmap.world_to_cell(array[:, 0], array[:, 1])).all())


class SensedTracks:
    """Follows what moves through a navigator's scans; the tracker is made at the first one.

    Args:
        robot: The robot.
        tracking: When something counts as moving; None for the defaults, False to follow nothing.
        warn: Whether to warn of scans that are left out.
    """

    def __init__(self, robot: Robot, tracking: TrackerSettings | Literal[False] | None, *, warn: bool) -> None:
        self._robot, self._warns = robot, warn
        self._settings = None if tracking is False else tracking
        self._is_on = tracking is not False
        self.reset()

    def reset(self) -> None:
        """Forget what was followed."""
        self._tracker: Tracker | None = None
        self._time: float | None = None
        self._may_go_back = True

    def begin(self) -> None:
        """Expect that the time may start over: there is a new goal."""
        self._may_go_back = True

    def update(self, placed: PlacedScans) -> tuple[Track, ...]:
        """Take the scans that arrived since the last call; return all tracks, predicted to now, map frame."""
        if not self._is_on or (self._tracker is None and not placed.arrived):
            return ()
        if self._tracker is None:
            self._tracker = Tracker(self._robot, self._settings, warn=self._warns)
        estimate = placed.estimate
        if self._time is not None and estimate.time < self._time and self._may_go_back:
            self._tracker.reset()
        self._time, self._may_go_back = estimate.time, False
        tracks = self._tracker.take(placed)
        return tuple([track.seen_from(estimate.T_map_odom) for track in tracks]) if tracks else ()


def make_placer(
    robot: Robot, layers: LayersSettings | Literal[False] | None, tracking: TrackerSettings | Literal[False] | None
) -> ScanPlacer:
    """Return what places scans for the costmap and the tracker: once for both."""
    obstacle = None if layers is False else (layers or LayersSettings()).obstacle
    followed = None if tracking is False else tracking or TrackerSettings()
    users = [settings.source_timeout for settings in (obstacle, followed) if settings is not None]
    return ScanPlacer(robot, max(users, default=0.0), warn=bool(users))
