"""`OwnHits`: beams that meet the robot itself, found in a recording of a robot whose outline is not known."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

_NEAR_M = 1.0  # a part of the robot is nearer to its lidar
_SAME_M = 0.05
_SHARE = 0.9  # of the scans that were taken while the robot had moved on
_LEAST_SCANS = 30
_MOST_SCANS = 400
_MOVED_M, _MOVED_RAD = 0.3, 0.3


class OwnHits:
    """Looks for beams that measure the same short range wherever the robot is.

    Scans are sampled evenly: when there are too many, every second one is forgotten and half as many are taken.
    """

    def __init__(self) -> None:
        self._times: list[float] = []
        self._ranges: list[npt.NDArray[np.float32]] = []
        self._every, self._seen = 1, 0

    def add(self, time: float, ranges: FloatArray) -> None:
        """Add a scan of the lidar; scans with another number of beams than the first one are ignored."""
        self._seen += 1
        if self._seen % self._every or (self._ranges and len(ranges) != len(self._ranges[0])):
            return
        self._times.append(time)
        self._ranges.append(np.asarray(ranges, dtype=np.float32))
        if len(self._times) > 2 * _MOST_SCANS:
            self._times, self._ranges, self._every = self._times[::2], self._ranges[::2], 2 * self._every

    def find(self, poses: FloatArray) -> npt.NDArray[np.bool_]:
        """Return which beams meet the robot, shape (B,); none where too few scans tell.

        Args:
            poses: Poses of the robot at the times of the scans that were kept [m, rad], shape (N, 3); see `times`.
        """
        if not self._ranges:
            return np.zeros(0, dtype=bool)
        chosen, last = [], None
        for number, pose in enumerate(poses):
            if last is None or np.hypot(*(pose - last)[:2]) > _MOVED_M or abs(pose[2] - last[2]) > _MOVED_RAD:
                chosen.append(number)
                last = pose
        ranges = np.array([self._ranges[number] for number in chosen])
        if len(ranges) < _LEAST_SCANS:
            return np.zeros(len(self._ranges[0]), dtype=bool)
        near = np.where(np.isfinite(ranges) & (ranges > 0.0), ranges, np.inf)
        usual = np.median(near, axis=0)
        with np.errstate(invalid="ignore"):
            same = (np.abs(near - usual) < _SAME_M).mean(axis=0)
        return (usual < _NEAR_M) & (same >= _SHARE)

    @property
    def times(self) -> FloatArray:
        """Times of the scans that were kept [s]."""
        return np.array(self._times)
