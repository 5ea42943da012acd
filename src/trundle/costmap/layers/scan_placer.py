"""`ScanPlacer`: which scans can be used, where their sensor was, and which of their hits are real; `PlacedScans`."""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle import _core
from trundle.errors import SensorWarning
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.observation import Estimate, PoseBuffer, Scan, check_scans
from trundle.robots import Robot
from trundle.values import check_kind

_AHEAD_S = 0.1  # as far as PoseBuffer continues a motion
_JUMP_M, _JUMP_RAD = 1.0, 1.0  # beyond what the robot can move in the time: no slip of wheels, but another frame
_NOTHING = np.zeros(0)


@dataclass(frozen=True, slots=True, eq=False)
class PlacedScan:
    """A scan without its lone hits, and where its sensor was.

    A hit is lone if the two beams on each side of it saw past it, by 0.15 m and three times the distance between beams
    there, and the lidar's scan before hit nothing at that place: within 0.1 m along the beam, and 0.03 m and two beams
    across. So dust and rain are left out. A thin pole that one beam meets is there from its second scan on; what two
    neighbouring beams meet is there at once.

    Attributes:
        scan: As the lidar measured it.
        ranges: Its ranges [m]; NaN, which is no measurement, for lone hits.
        poses: Of the sensor (x, y, yaw) [m, rad], odom frame, shape (1, 3), or (beams, 3) where the beams are measured
            one after the other.
    """

    scan: Scan
    ranges: FloatArray
    poses: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PlacedScans:
    """What arrived in one control period.

    Attributes:
        estimate: Where the robot is now.
        odom_pose: Pose of base_link in the odom frame.
        scans: Those that can be used, in the order in which they came.
        frame: Stands for the odom frame: what was placed in another one lies nowhere in this.
        arrived: All that arrived, with those that cannot be used.
    """

    estimate: Estimate
    odom_pose: Pose2D
    scans: tuple[PlacedScan, ...]
    frame: object
    arrived: tuple[Scan, ...]


class ScanPlacer:
    """Places scans in the odom frame at their own times, once for all that use them.

    Scans that are stale, out of order, from the future, or from a lidar that the robot lacks are counted, with one
    `SensorWarning` for each kind. Scans from before the first pose, which were on their way when the run began, are
    only counted.

    Args:
        robot: The robot, with its lidars and limits.
        source_timeout: Age from which on a scan is stale [s].
        warn: Whether to warn; else events are only counted.

    Attributes:
        counts: How often each kind of event was counted.
    """

    def __init__(self, robot: Robot, source_timeout: float, *, warn: bool = True) -> None:
        self._robot = robot
        self._warns = warn
        self._source_timeout = source_timeout
        self._poses = PoseBuffer()
        self.reset()

    def reset(self) -> None:
        """Forget poses and counts."""
        self.counts: Counter[str] = Counter()
        self._forget()
        self._time, self._pose = -math.inf, Pose2D(0.0, 0.0)
        self._newest: dict[str, float] = {}

    def _forget(self) -> None:
        self._frame = object()
        self._poses.clear()
        self._before: dict[str, PlacedScan] = {}

    def place(self, scans: Sequence[Scan], estimate: Estimate) -> PlacedScans:
        """Take the scans that arrived since the last call, and where the robot is now.

        The time may stand still; where it goes back, all that was before is forgotten.

        Raises:
            InputError: If these are no scans, or this is no estimate.
        """
        check_kind(estimate, Estimate, "an estimate", "a localizer's update returns one")
        taken = check_scans(scans)
        if estimate.time < self._time:
            self.reset()
        if estimate.time != self._time:
            self._follow(estimate)
        placed = tuple([one for scan in taken if (one := self._place(scan)) is not None])
        return PlacedScans(estimate, self._pose, placed, self._frame, tuple(taken))

    def _follow(self, estimate: Estimate) -> None:
        """Take the next pose; where it jumps, poses before it are useless."""
        pose, before, seconds = estimate.odom_pose, self._pose, estimate.time - self._time
        self._poses.add(estimate.time, pose)
        self._time, self._pose = estimate.time, pose
        if seconds == math.inf:
            return
        limits = self._robot.limits
        moved, turned = pose.distance_to(before), abs(wrap_angle(pose.yaw - before.yaw))
        if moved <= _JUMP_M + limits.linear_speed * seconds and turned <= _JUMP_RAD + limits.angular_speed * seconds:
            return
        self._forget()
        self._poses.add(estimate.time, pose)
        self.warn(
            "jump",
            f"the pose jumped by {moved:.1f} m and {math.degrees(turned):.0f} degrees at {estimate.time:g} s: what "
            "was sensed before is forgotten",
        )

    def warn(self, kind: str, message: str, *, stacklevel: int = 4) -> None:
        """Count an event, and warn of the first of its kind."""
        self.counts[kind] += 1
        if self.counts[kind] == 1 and self._warns:
            warnings.warn(f"{message} (more of this kind are counted only)", SensorWarning, stacklevel=stacklevel)

    def _place(self, scan: Scan) -> PlacedScan | None:
        now, lidar, time = self._time, scan.lidar, scan.time
        end = time if scan.time_increment == 0.0 else time + max(0, len(scan.angles) - 1) * scan.time_increment
        if lidar not in self._robot.lidars:
            known = ", ".join(self._robot.lidars) or "none"
            self._leave_out(scan, "unknown lidar", f"{self._robot.name} has no such lidar; it has: {known}")
        elif end > now + _AHEAD_S:
            self._leave_out(scan, "future", f"it lies {end - now:.2g} s after the estimate of {now:g} s")
        elif time <= self._newest.get(lidar, -math.inf):
            self._leave_out(scan, "out of order", f"one of {self._newest[lidar]:g} s has already been used")
        elif not self.is_stale(scan, now):
            first = self._poses.at(time)
            last = first if end == time else self._poses.at(end)
            if first is None or last is None:
                self.counts["before the first pose"] += 1
                return None
            self._newest[lidar] = time
            return self._without_lone_hits(scan, _sensor_poses(first, last, scan))
        return None

    def is_stale(self, scan: Scan, now: float) -> bool:
        """Whether a scan is too old now [s]; then it is counted."""
        if scan.time >= now - self._source_timeout:
            return False
        age = f"it is {now - scan.time:.2g} s old, and source_timeout is {self._source_timeout:g} s"
        self._leave_out(scan, "stale", age)
        return True

    def _leave_out(self, scan: Scan, kind: str, reason: str) -> None:
        self.warn(kind, f"scan of lidar {scan.lidar!r} of {scan.time:g} s is left out: {reason}", stacklevel=6)

    def _without_lone_hits(self, scan: Scan, poses: FloatArray) -> PlacedScan:
        before, ranges = self._before.get(scan.lidar), scan.ranges
        earlier = (
            (_NOTHING, _NOTHING, poses) if before is None else (before.scan.ranges, before.scan.angles, before.poses)
        )
        lone = _core.find_lone_hits(ranges, scan.angles, poses, *earlier, scan.range_min, scan.range_max)
        if len(lone):
            ranges = ranges.copy()
            ranges[lone] = math.nan
        placed = self._before[scan.lidar] = PlacedScan(scan, ranges, poses)
        return placed


def _sensor_poses(first: Pose2D, last: Pose2D, scan: Scan) -> FloatArray:
    """Return poses of the sensor while the robot moves evenly from the first to the last pose."""
    start = first @ scan.mount
    if scan.time_increment == 0.0:
        return np.array([start.as_tuple()])
    share = np.linspace(0.0, 1.0, len(scan.angles))
    yaw = first.yaw + share * wrap_angle(last.yaw - first.yaw)
    cos, sin = np.cos(yaw), np.sin(yaw)
    x = first.x + share * (last.x - first.x) + cos * scan.mount.x - sin * scan.mount.y
    y = first.y + share * (last.y - first.y) + sin * scan.mount.x + cos * scan.mount.y
    return np.column_stack([x, y, yaw + scan.mount.yaw])
