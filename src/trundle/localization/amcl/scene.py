"""`Scene`: whether the lidars suddenly see another place: somebody has carried the robot there.

Two scans that follow each other show the same surroundings, wherever on the map the robot is; so this needs no map, and
parts of a map that look alike do not deceive it. Wheels that slip move what is seen by centimetres from scan to scan.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle.geometry import Pose2D
from trundle.observation import Scan

_EVERY = 8  # of a scan's beams
_ASIDE = 8  # beams of the scan before, on each side, one of which has to be like it: wheels that slip turn the robot
_TOLERANCE_M = 0.25  # a slip of wheels, and a person who walks, within two scans of 10 Hz
_OTHER = 0.1
"""Share of beams that contradict the scan before. People who come near end beams too soon, and those who leave let them
through: only both together contradict. In three recorded drives with slips it was at most 0.05 over two scans, and in
pairs of scans of two of their places at least 0.15 in 99 %."""

_CONFIRMATIONS = 2  # scans: one alone may be a fault of the lidar
_FEWEST = 10  # beams
_OLDEST_S = 1.0

_Seen = dict[str, tuple[Scan, Pose2D]]


class Scene:
    """Compares the scans of each lidar with those before.

    Args:
        longest: The longest beams that are used [m].
        oldest_s: Scans are compared with those before up to this age [s].
    """

    def __init__(self, longest: float, *, oldest_s: float = _OLDEST_S) -> None:
        self._longest = longest
        self._oldest_s = oldest_s
        self.reset()

    def reset(self) -> None:
        """Forget what was seen."""
        self._before: _Seen = {}
        self._differ = 0

    def is_another(self, scans: Sequence[Scan], odometry: Pose2D, *, surprising: bool) -> bool:
        """Return whether these scans, and those before them, show another place than the ones before those.

        Args:
            scans: Those that arrived.
            odometry: Pose of base_link in the odom frame now.
            surprising: Whether they fit the map worse than before. They are compared only then.
        """
        if not surprising:
            self._differ = 0
        elif self._contradiction(scans, odometry) > _OTHER:
            self._differ += 1
            if self._differ < _CONFIRMATIONS:
                return False  # the next scans are compared with the same ones
            self._differ = 0
            self._keep(scans, odometry)
            return True
        else:
            self._differ = 0
        self._keep(scans, odometry)
        return False

    @property
    def is_doubtful(self) -> bool:
        """Whether the last scans showed another place, and the next ones will tell."""
        return self._differ > 0

    def _keep(self, scans: Sequence[Scan], odometry: Pose2D) -> None:
        self._before.update((scan.lidar, (scan, odometry)) for scan in scans)

    def _contradiction(self, scans: Sequence[Scan], odometry: Pose2D) -> float:
        agree = short = through = 0
        for scan in scans:
            before = self._before.get(scan.lidar)
            if before is None or not 0.0 < scan.time - before[0].time < self._oldest_s:
                continue
            counts = self._compare(before[0], before[1].inverse() @ odometry, scan)
            agree, short, through = agree + counts[0], short + counts[1], through + counts[2]
        total = agree + short + through
        return 2.0 * min(short, through) / total if total >= _FEWEST else 0.0

    def _compare(self, before: Scan, moved: Pose2D, now: Scan) -> tuple[int, int, int]:
        """How many beams end where those before did, too soon, and behind that."""
        ranges, angles = now.ranges[::_EVERY], now.angles[::_EVERY]
        used = (ranges >= now.range_min) & (ranges <= min(now.range_max, self._longest))
        if not used.any() or len(before.angles) < 2:
            return 0, 0, 0
        sensor = before.mount.inverse() @ moved @ now.mount
        ranges, angles = ranges[used], angles[used] + sensor.yaw
        x, y = sensor.x + ranges * np.cos(angles), sensor.y + ranges * np.sin(angles)
        step = (before.angles[-1] - before.angles[0]) / (len(before.angles) - 1)
        index = np.rint(np.remainder(np.arctan2(y, x) - before.angles[0], math.copysign(2.0 * math.pi, step)) / step)
        index = index.astype(np.intp)
        seen = index < len(before.angles)
        near = np.clip(index[seen, np.newaxis] + np.arange(-_ASIDE, _ASIDE + 1), 0, len(before.angles) - 1)
        expected = np.where(np.isnan(before.ranges[near]), math.inf, np.minimum(before.ranges[near], self._longest))
        distance = np.hypot(x, y)[seen]
        short = distance < expected.min(axis=1) - _TOLERANCE_M
        through = distance > expected.max(axis=1) + _TOLERANCE_M
        return int((~short & ~through).sum()), int(short.sum()), int(through.sum())
