"""`ScanFilter`: which scans a layer may use; `LoneHits`: what single beams return too soon, as from dust and rain."""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import SensorWarning
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.observation import Estimate, PoseBuffer, Scan, check_scans, make_scan
from trundle.robots import Robot
from trundle.values import check_kind

_NOTHING = np.zeros(0)
_KEPT = 16  # answers: those of the lidars of a robot or two


class _Placed(NamedTuple):
    """The arrays of a scan, which do not change, and where its sensor was."""

    ranges: FloatArray
    angles: FloatArray
    poses: FloatArray
    place: bytes


class _Answer(NamedTuple):
    """The lone hits of a scan, after the one before."""

    scan: _Placed
    before: _Placed | None
    limits: tuple[float, float]
    lone: npt.NDArray[np.int64]


# The costmap and the tracker ask the same of one scan after the other, by the array of its ranges. It is kept with the
# answer, so that no other one gets its number.
_answers: dict[int, _Answer] = {}


def _find(scan: _Placed, before: _Placed | None, limits: tuple[float, float]) -> npt.NDArray[np.int64]:
    known = _answers.get(id(scan.ranges))
    if known is not None and known.limits == limits and _is_same(known.scan, scan) and _is_same(known.before, before):
        return known.lone
    earlier = (_NOTHING, _NOTHING, scan.poses) if before is None else (before.ranges, before.angles, before.poses)
    lone = _core.find_lone_hits(scan.ranges, scan.angles, scan.poses, *earlier, *limits)
    if len(_answers) >= _KEPT:
        _answers.clear()
    _answers[id(scan.ranges)] = _Answer(scan, before, limits, lone)
    return lone


def _is_same(one: _Placed | None, other: _Placed | None) -> bool:
    if one is None or other is None:
        return one is other
    return one.ranges is other.ranges and one.angles is other.angles and one.place == other.place


class LoneHits:
    """Takes the lone hits out of the scans of a robot's lidars.

    A hit is lone if the two beams on each side of it saw past it, by 0.15 m and three times the distance between beams
    there, and the lidar's scan before hit nothing at that place: within 0.1 m along the beam, and 0.03 m and two beams
    across. A thin pole that one beam meets is therefore there from its second scan on; what two neighbouring beams meet
    is there at once.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget the scans before."""
        self._before: dict[str, _Placed] = {}

    def without(self, scan: Scan, poses: FloatArray, *, put: float) -> Scan:
        """Return the next scan of a lidar without its lone hits; the same scan where it has none.

        Args:
            scan: As the lidar measured it.
            poses: Of the sensor (x, y, yaw) [m, rad] in a frame that does not move, shape (1, 3), or (beams, 3).
            put: Range of the beams with a lone hit: NaN is no measurement, infinity no return.
        """
        ranges = scan.ranges
        before, placed = self._before.get(scan.lidar), _Placed(ranges, scan.angles, poses, poses.tobytes())
        self._before[scan.lidar] = placed
        if not len(ranges):
            return scan
        lone = _find(placed, before, (scan.range_min, scan.range_max))
        if not len(lone):
            return scan
        cleaned = ranges.copy()
        cleaned[lone] = put
        return make_scan(
            *(scan.lidar, scan.time, scan.mount, scan.height, scan.angles, cleaned),
            *(scan.range_min, scan.range_max, scan.time_increment),
        )


_AHEAD_S = 0.1  # as far as PoseBuffer continues a motion
_JUMP_M, _JUMP_RAD = 1.0, 1.0  # beyond what the robot can move in the time: no slip of wheels, but another frame


class ScanFilter:
    """Places scans in the odom frame at their own times, and leaves out those that cannot be used.

    Scans that are stale, out of order, from the future, or from a lidar that the robot lacks are counted, with one
    `SensorWarning` for each kind. Scans from before the first pose, which were on their way when the run began, are
    only counted. Lone hits (see `LoneHits`) become beams that measured nothing.

    Args:
        robot: The robot, with its lidars and limits.
        source_timeout: Age from which on a scan is stale [s].
        warn: Whether to warn; else events are only counted.
    """

    def __init__(self, robot: Robot, source_timeout: float, *, warn: bool = True) -> None:
        self._robot = robot
        self._warns = warn
        self._source_timeout = source_timeout
        self._poses = PoseBuffer()
        self._lone = LoneHits()
        self.reset()

    @property
    def odom_pose(self) -> Pose2D:
        """The latest pose of base_link in the odom frame."""
        return self._pose

    def reset(self) -> None:
        """Forget poses and counts."""
        self.counts: Counter[str] = Counter()
        self._poses.clear()
        self._lone.clear()
        self._time, self._pose = -math.inf, Pose2D(0.0, 0.0)
        self._newest: dict[str, float] = {}

    def follow(self, estimate: Estimate) -> bool:
        """Take the next estimate; return whether the pose in the odom frame jumped, and poses before it are useless.

        Raises:
            InputError: If its time is not after the last one.
        """
        check_kind(estimate, Estimate, "an estimate", "a localizer's update returns one")
        pose, before, seconds = estimate.odom_pose, self._pose, estimate.time - self._time
        self._poses.add(estimate.time, pose)
        self._time, self._pose = estimate.time, pose
        if seconds == math.inf:
            return False
        limits = self._robot.limits
        moved, turned = pose.distance_to(before), abs(wrap_angle(pose.yaw - before.yaw))
        if moved <= _JUMP_M + limits.linear_speed * seconds and turned <= _JUMP_RAD + limits.angular_speed * seconds:
            return False
        self._poses.clear()
        self._lone.clear()
        self._poses.add(estimate.time, pose)
        self.warn(
            "jump",
            f"the pose jumped by {moved:.1f} m and {math.degrees(turned):.0f} degrees at {estimate.time:g} s: the "
            "obstacles sensed before are forgotten",
        )
        return True

    def admit(self, scans: Sequence[Scan]) -> Iterator[tuple[Scan, FloatArray]]:
        """Yield the scans that can be used, without lone hits, each with its sensor's poses in the odom frame.

        The poses have shape (1, 3), or (beams, 3) where the beams are measured one after the other.

        Raises:
            InputError: If these are no scans.
        """
        for scan in check_scans(scans):
            poses = self._place(scan)
            if poses is not None:
                yield self._lone.without(scan, poses, put=math.nan), poses

    def warn(self, kind: str, message: str, *, stacklevel: int = 4) -> None:
        """Count an event, and warn of the first of its kind."""
        self.counts[kind] += 1
        if self.counts[kind] == 1 and self._warns:
            warnings.warn(f"{message} (more of this kind are counted only)", SensorWarning, stacklevel=stacklevel)

    def _place(self, scan: Scan) -> FloatArray | None:
        now = self._time
        end = self._end(scan)
        if scan.lidar not in self._robot.lidars:
            known = ", ".join(self._robot.lidars) or "none"
            self._leave_out(scan, "unknown lidar", f"{self._robot.name} has no such lidar; it has: {known}")
        elif end > now + _AHEAD_S:
            self._leave_out(scan, "future", f"it lies {end - now:.2g} s after the estimate of {now:g} s")
        elif scan.time <= self._newest.get(scan.lidar, -math.inf):
            self._leave_out(scan, "out of order", f"one of {self._newest[scan.lidar]:g} s has already been used")
        elif scan.time < now - self._source_timeout:
            self._leave_out(
                scan,
                "stale",
                f"it is {now - scan.time:.2g} s old, and source_timeout is {self._source_timeout:g} s",
            )
        else:
            first = self._poses.at(scan.time)
            last = first if end == scan.time else self._poses.at(end)
            if first is None or last is None:
                self.counts["before the first pose"] += 1
                return None
            self._newest[scan.lidar] = scan.time
            return _sensor_poses(first, last, scan)
        return None

    def _leave_out(self, scan: Scan, kind: str, reason: str) -> None:
        self.warn(kind, f"scan of lidar {scan.lidar!r} of {scan.time:g} s is left out: {reason}", stacklevel=5)

    @staticmethod
    def _end(scan: Scan) -> float:
        return scan.time + max(0, len(scan.angles) - 1) * scan.time_increment


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
