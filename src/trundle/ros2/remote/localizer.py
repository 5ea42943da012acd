"""`RemoteLocalizer`: where a robot is that was not told, or that others locate; `MapFit`: whether the map agrees."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.localization import Localizer
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.map_field import MapField
from trundle.mapping import PoseGraph
from trundle.mapping.slam_localizer import SlamLocalizer
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation, Scan
from trundle.ros2.remote.map_odom import MapOdomInput

LEAST_AGREE, MOST_THROUGH = 0.4, 0.4
"""Least share of beams that agree with the map, and most that go through its walls, where a robot sets off.

Clutter that is not on the map hides walls: it costs agreement, and lets no beam through them. A map of another site and
mirrored scans do both.
"""

SCANS = 5
"""So many scans are judged, the latest ones: the localizer refines a pose that it was told with the first of them."""

MISFIT = "the scans do not fit the map"
"""So begins why a robot stands that is not where it was told to be."""

# A hit agrees that is so near to something on the map; a beam contradicts that ends so far behind something.
_TOLERANCE_M, _DEPTH_M = 0.25, 0.3
_BEAMS = 180
_LONGEST_M = 15.0


class MapFit:
    """Judges scans on a map.

    Args:
        grid: The map.
    """

    def __init__(self, grid: OccupancyGrid) -> None:
        self._grid, self._field = grid, MapField(grid, AmclSettings())
        self._judged: deque[tuple[float, float]] = deque(maxlen=SCANS)

    def reset(self) -> None:
        """Forget what was judged: the pose was told again."""
        self._judged.clear()

    def judge(self, scans: tuple[Scan, ...], pose: Pose2D) -> None:
        """Judge scans that were measured at a pose, map frame."""
        counts = sum((self._count(scan, pose) for scan in scans), np.zeros(3))
        agree, short, through = counts.tolist()
        if agree + short + through > 0.0:
            seen = max(agree + through + 0.5 * short, 1.0)
            self._judged.append((agree / seen, through / max(agree + through, 1.0)))

    @property
    def why(self) -> str:
        """Why the robot does not set off from there; empty where it may."""
        if len(self._judged) < SCANS:
            return "the robot is not located yet: its first scans are compared with the map"
        agree, through = np.mean(self._judged, axis=0).tolist()
        if agree >= LEAST_AGREE and through <= MOST_THROUGH:
            return ""
        return (
            f"{MISFIT} where the robot was told to be: {100 * agree:.0f} % of the beams agree, and "
            f"{100 * through:.0f} % of what can be compared go through walls. Is it the map of this site, is the pose "
            "right, and do the angles of the scans run the right way?"
        )

    def _count(self, scan: Scan, pose: Pose2D) -> FloatArray:
        """Count the beams that agree, that end too soon, and that go through something.

        Those without a return, which end nowhere, can only go through something.
        """
        every = slice(None, None, -(-len(scan.ranges) // _BEAMS))
        ranges, angles = np.array(scan.ranges[every]), scan.angles[every]
        is_free = np.isposinf(ranges)
        ranges[is_free] = scan.range_max
        known = np.isfinite(ranges)
        ranges, angles, is_free = np.minimum(ranges[known], _LONGEST_M), angles[known], is_free[known]
        sensor, step = pose @ scan.mount, self._grid.resolution
        along = np.append(np.arange(0.0, ranges.max(initial=0.0), step), 0.0) + np.zeros((len(ranges), 1))
        along[:, -1] = ranges
        turn = (angles + sensor.yaw)[:, None]
        distance = self._distance(sensor.x + along * np.cos(turn), sensor.y + along * np.sin(turn))
        through = ((distance[:, :-1] < step) & (along[:, :-1] < ranges[:, None] - _DEPTH_M)).any(axis=1)
        agrees = ~through & ~is_free & (distance[:, -1] < _TOLERANCE_M)
        short = ~through & ~is_free & ~agrees
        return np.array([agrees.sum(), short.sum(), through.sum()], dtype=np.float64)

    def _distance(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the distance of points to the nearest occupied cell [m]; far outside of the map."""
        row, col = self._grid.world_to_cell(x.ravel(), y.ravel())
        inside = self._grid.contains(row, col)
        found = np.full(x.size, np.inf)
        found[inside] = np.abs(self._field.values[row[inside], col[inside]])
        return found.reshape(x.shape)


_NOWHERE = Pose2D(0.0, 0.0)

_NO_SCAN = "the robot is not located yet: its localizer waits for odometry and scans"

_CARRIED = (
    "nobody knows how the robot has moved: it drives on where it recognises its map. Drive it by hand to what the map "
    "shows, or give its pose on that map"
)


_NEAR_M, _NEAR_SHARE = 0.25, 0.6
"""Ranges that differ by less are the same [m]; a view is the same where this share of its beams has the same range."""


def is_same_view(before: Scan, after: Scan) -> bool:
    """Return whether a lidar sees what it saw, give or take what a robot moves while its odometry jumps."""
    if before.ranges.shape != after.ranges.shape:
        return False
    known = np.isfinite(before.ranges) | np.isfinite(after.ranges)
    ours, theirs = (np.minimum(np.nan_to_num(one.ranges, nan=np.inf), 1e3) for one in (before, after))
    return not known.any() or float((np.abs(ours - theirs)[known] < _NEAR_M).mean()) >= _NEAR_SHARE


class RemoteLocalizer(Localizer):
    """Gives a localizer its pose once there is one and the robot has sent its odometry; before, the robot is lost.

    A run that begins again does not move the robot: it goes on where it was.

    Args:
        inner: What estimates the pose.
        start: Where the robot is at first, map frame; None where that is to be told.
        is_ready: Whether the robot has sent its odometry, without which a pose cannot be kept.
        needs_scan: Whether the robot is located only once a scan was seen.
        fit: Says whether its scans fit the map where it was told to be; None where that is not asked.

    Attributes:
        is_located: Whether the robot knows where it is, so that it may drive.
        is_told: Whether it was told where it is, or is to search.
        why: Why it is not located, where there is more to say than that nobody has told it.
    """

    def __init__(
        self,
        inner: Localizer,
        start: Pose2D | None,
        is_ready: Callable[[], bool],
        *,
        needs_scan: bool,
        fit: MapFit | None = None,
    ) -> None:
        self._inner, self._is_ready, self._needs_scan = inner, is_ready, needs_scan
        self._pending: tuple[Pose2D | None, FloatArray | None] | None = None if start is None else (start, None)
        self._shown = _NOWHERE if start is None else start
        self._seed = 0
        self._begins = True
        self._last: Estimate | None = None
        self._fit = fit
        self._mapper = inner if isinstance(inner, SlamLocalizer) else None
        self.is_told = False
        self.is_located = False
        self.why = "" if start is None else _NO_SCAN
        self._scans: dict[str, Scan] = {}
        self._before: dict[str, Scan] = {}
        """The last scan of each lidar before a jump, until there is one after it."""

    # The map that it makes -------------------------------------------------------------------------------------------

    @property
    def corrections(self) -> int:  # type: ignore[override]
        """How often poses that were mapped before have been corrected."""
        return self._inner.corrections

    def map(self) -> OccupancyGrid | None:
        """Return the map so far; None where it makes none, and before the first scan."""
        return self._inner.map()

    def graph(self) -> PoseGraph | None:
        """Return what the map is drawn from; None where it makes none."""
        return None if self._mapper is None else self._mapper.graph()

    def finish(self) -> None:
        """Finish the map."""
        self._inner.finish()

    @property
    def bridges_jumps(self) -> bool:
        """Whether it wants odometry that goes on where it was before a jump: scans say whether that is true."""
        return self._mapper is not None and self.is_told

    def use_map(self, inner: Localizer, fit: MapFit | None, pose: Pose2D | None) -> None:
        """Locate the robot on another map.

        Args:
            inner: What estimates its pose there.
            fit: Says whether its scans fit that map; None where that is not asked.
            pose: Where it is, map frame; None where that is to be told.
        """
        self._inner, self._fit = inner, fit
        self._pending = None if pose is None else (pose, None)
        self._last, self.is_told, self.is_located = None, False, False
        self.why = "" if pose is None else _NO_SCAN

    # Where it is -----------------------------------------------------------------------------------------------------

    @property
    def waits_for_pose(self) -> bool:
        """Whether nobody has said where the robot is."""
        return not self.is_told and self._pending is None

    @property
    def shown(self) -> Pose2D:
        """Where the robot is, as far as that is known; map frame."""
        return self._shown

    def begin(self) -> None:
        """Expect a `reset` from a run that begins: it says nothing new, as the robot is where it was."""
        self._begins = True
        if self.is_told:  # the times of a run begin at 0
            self._pending, self.is_told, self.is_located = (self._shown, None), False, False
            self._scans, self._before = {}, {}

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Start over with the robot at `pose`, once its odometry is there."""
        self._seed, self._last = seed, None
        if self._begins:
            self._begins = False
            return
        if not self.is_told or not self._is_ready():
            self._pending = pose, covariance
            if pose is not None:
                self._shown = pose
            return
        self._tell(pose, covariance)

    def reinitialize_global(self) -> None:
        """Search the whole map."""
        if self.is_told:
            self._inner.reinitialize_global()
        else:
            self._pending = None, None

    def doubt(self) -> None:
        """Note that the robot has moved by an unknown amount: its pose has to be told again.

        One that makes its map goes on where the odometry alone has jumped: its scans are what they were. Otherwise a
        new part of the map begins, and the robot is located once it recognises what it has mapped before.
        """
        self.is_located = False
        if self._mapper is not None and self.is_told:
            self._before, self.why, self._last = dict(self._scans), _CARRIED, None
            return
        self.is_told = False
        self._pending = None
        self._last = None

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is: the same where the observation is the same."""
        if self._last is not None and self._last.time == observation.time:
            return self._last
        if self._pending is not None and self._is_ready():
            pose, covariance = self._pending
            self._pending = None
            self._tell(pose, covariance)
        if not self.is_told:
            origin = self._shown @ observation.odometry.inverse()
            return Estimate(observation.time, self._shown, None, origin, state="lost")
        self._look(observation.scans)
        self._last = found = self._inner.update(observation)
        self._shown = found.pose
        if not self.is_located and (observation.scans or not self._needs_scan):
            self.is_located = self._check(observation, found)
        return found

    def _check(self, observation: Observation, found: Estimate) -> bool:
        """Return whether the robot may set off from where its localizer puts it."""
        if self._fit is not None and observation.scans:
            self._fit.judge(observation.scans, found.pose)
            self.why = self._fit.why
        is_joined = self._mapper is None or (not self._before and self._mapper.mapper.joined)
        return found.state == "localized" and is_joined and not (self._fit is not None and self._fit.why)

    def _look(self, scans: Sequence[Scan]) -> None:
        """Compare the first scans after a jump with the last ones before, for a localizer that makes its map."""
        if self._mapper is None or not scans:
            return
        known = [(self._before[scan.lidar], scan) for scan in scans if scan.lidar in self._before]
        if known:
            self._before = {}
            if not all(is_same_view(before, after) for before, after in known):
                self._mapper.mapper.new_part()
        self._scans |= {scan.lidar: scan for scan in scans}

    def _tell(self, pose: Pose2D | None, covariance: FloatArray | None) -> None:
        self.is_located, self.why = False, _NO_SCAN
        if self._fit is not None:
            self._fit.reset()
        self._before = {}
        try:
            if self.is_told and pose is not None:
                self._inner.relocate(pose, covariance=covariance, seed=self._seed)
            else:
                self._inner.reset(pose, covariance=covariance, seed=self._seed)
        except InputError:
            self.is_told = False
            raise
        self.is_told = True


class TfLocalizer(Localizer):
    """The robot is where map → odom from outside puts it.

    Args:
        map_odom: map → odom from outside.
        start: Where the robot is at first, for those who wait to be told; None where nobody is.

    Attributes:
        is_located: Whether there is a map → odom that says where the robot is.
    """

    def __init__(self, map_odom: MapOdomInput, start: Pose2D | None = None) -> None:
        self._map_odom, self._start = map_odom, start
        self.is_located = False
        self.waits_for_pose = self.bridges_jumps = False

    @property
    def why(self) -> str:
        """Why it is not located."""
        return self._map_odom.why

    @property
    def shown(self) -> Pose2D | None:
        """Where the robot is at first, until map → odom says where it is; after that, that is long ago."""
        return self._start

    def begin(self) -> None:
        """Do nothing: where the robot is comes from outside."""

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Do nothing: the pose comes from outside."""

    def doubt(self) -> None:
        """Do nothing: map → odom is in doubt since the jump."""

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is by map → odom."""
        found = self._map_odom.pose
        self.is_located = found is not None
        if found is None:
            return Estimate(observation.time, observation.odometry, state="lost")
        self._start = None
        return Estimate(observation.time, found @ observation.odometry, None, found)
