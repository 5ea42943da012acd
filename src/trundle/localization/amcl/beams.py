"""`BeamPicker`: the beams of all lidars that one update uses, placed in base_link at the time of the observation."""

from __future__ import annotations

import math
import warnings
from collections import Counter
from dataclasses import dataclass

import numpy as np

from trundle._core import pick_beams
from trundle.errors import SensorWarning
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.observation import Observation, PoseBuffer, Scan, check_scans
from trundle.robots import Robot

_JUMP_M, _JUMP_RAD = 1.0, 1.0  # beyond what the robot can move in the time: another frame, no slip of wheels
_TOO_OLD_S = 1.0
_GOLDEN = 0.6180339887498949
_BODY_PADDING_M = 0.03


@dataclass(frozen=True, slots=True)
class Beams:
    """Beams that met something.

    Attributes:
        points: Where they ended, base_link at the time of the observation [m], shape (N, 2).
        sensors: Where they began, likewise.
    """

    points: FloatArray
    sensors: FloatArray

    def __len__(self) -> int:
        return len(self.points)


class BeamPicker:
    """Follows the odometry, and places scans by it at their own times.

    Args:
        robot: The robot; beams that end on its own body are left out.
        most: The most beams of one update.
        longest: The longest beams that are used [m]; None for as long as each lidar measures.
    """

    def __init__(self, robot: Robot, most: int, longest: float | None) -> None:
        self._robot = robot
        self._most = most
        self._longest = math.inf if longest is None else longest
        outline = robot.planar.padded(_BODY_PADDING_M).outline
        edges = np.roll(outline, -1, axis=0) - outline
        normals = np.stack([edges[:, 1], -edges[:, 0]], axis=1) / np.hypot(edges[:, 0], edges[:, 1])[:, np.newaxis]
        self._body = np.column_stack([normals, (normals * outline).sum(axis=1)])
        self._poses = PoseBuffer()
        self.reset()

    def reset(self) -> None:
        """Forget the odometry and the scans."""
        self._poses.clear()
        self._last: tuple[float, Pose2D] | None = None
        self._newest: dict[str, float] = {}
        self._picks = 0
        self.counts: Counter[str] = Counter()

    def follow(self, observation: Observation) -> bool:
        """Take the next odometry; return whether it jumped, by more than the robot can drive.

        Raises:
            InputError: If the time is not after the last one.
        """
        time, pose = observation.time, observation.odometry
        self._poses.add(time, pose)
        last, self._last = self._last, (time, pose)
        if last is None:
            return False
        seconds, limits = time - last[0], self._robot.limits
        moved, turned = pose.distance_to(last[1]), abs(wrap_angle(pose.yaw - last[1].yaw))
        if moved <= _JUMP_M + limits.linear_speed * seconds and turned <= _JUMP_RAD + limits.angular_speed * seconds:
            return False
        self._poses.clear()
        self._poses.add(time, pose)
        self.warn(
            "jump",
            f"the odometry jumped by {moved:.1f} m and {math.degrees(turned):.0f} degrees at {time:g} s: how the robot "
            "moved in between is not known",
        )
        return True

    def warn(self, kind: str, message: str) -> None:
        """Count an event, and warn of the first of its kind."""
        self.counts[kind] += 1
        if self.counts[kind] == 1:
            warnings.warn(f"{message} (more of this kind are counted only)", SensorWarning, stacklevel=5)

    def pick(self, observation: Observation) -> Beams | None:
        """Return the beams of the scans of an observation that met something; None without a scan that can be used."""
        placed = [pair for scan in check_scans(observation.scans) if (pair := self._place(scan, observation))]
        if not placed:
            return None
        share = -(-self._most // len(placed))
        self._picks += 1
        offset = (self._picks * _GOLDEN) % 1.0
        points, sensors = [], []
        for scan, first, last in placed:
            one = self._pick_from(scan, first, last, share, offset)
            if one is not None:
                points.append(one[0])
                sensors.append(one[1])
        if not points:
            when = f"no beam of the scans at {observation.time:g} s met anything"
            self.warn("no beam", f"{when}: they do not tell where the robot is")
            return Beams(np.empty((0, 2)), np.empty((0, 2)))
        if len(points) == 1:
            return Beams(points[0], sensors[0])
        return Beams(np.concatenate(points), np.concatenate(sensors))

    def _place(self, scan: Scan, observation: Observation) -> tuple[Scan, Pose2D, Pose2D] | None:
        """A scan with its poses of base_link at the first and last beam, seen from base_link now."""
        end = scan.time + scan.time_increment * max(0, len(scan.ranges) - 1)
        now = observation.time
        if scan.time <= self._newest.get(scan.lidar, -math.inf):
            self.warn("out of order", f"a scan of {scan.lidar!r} at {scan.time:g} s came after a later one")
            return None
        if scan.time < now - _TOO_OLD_S or end > now + 0.1:
            self.warn("time", f"a scan of {scan.lidar!r} at {scan.time:g} s does not fit the time {now:g} s")
            return None
        placed = self.scan_poses(scan, observation)
        if placed is None:
            self.counts["before the first pose"] += 1
            return None
        self._newest[scan.lidar] = scan.time
        return scan, *placed

    def scan_poses(self, scan: Scan, observation: Observation) -> tuple[Pose2D, Pose2D] | None:
        """Return base_link at a scan's first and last beam, seen from where it is now; None where that is not known."""
        end = scan.time + scan.time_increment * max(0, len(scan.ranges) - 1)
        first = self._poses.at(scan.time)
        last = first if end == scan.time else self._poses.at(end)
        if first is None or last is None:
            return None
        back = observation.odometry.inverse()
        seen = back @ first
        return seen, seen if last is first else back @ last

    def _pick_from(
        self, scan: Scan, first: Pose2D, last: Pose2D, most: int, offset: float
    ) -> tuple[FloatArray, FloatArray] | None:
        mount = scan.mount
        points, sensors = pick_beams(
            scan.ranges,
            scan.angles,
            np.array((mount.x, mount.y, mount.yaw)),
            np.array((first.as_tuple(), last.as_tuple())),
            self._body,
            scan.range_min,
            min(scan.range_max, self._longest),
            most,
            offset,
        )
        return (points, sensors) if len(points) else None
