"""`LoneHits`: leaves out what single beams return too soon, as from dust and rain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trundle import _core
from trundle.geometry import FloatArray
from trundle.observation import Scan

_NOTHING = np.zeros(0)


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
        self._before: dict[str, tuple[FloatArray, FloatArray, FloatArray]] = {}

    def without(self, scan: Scan, poses: FloatArray, *, put: float) -> Scan:
        """Return the next scan of a lidar without its lone hits; the same scan where it has none.

        Args:
            scan: As the lidar measured it.
            poses: Of the sensor (x, y, yaw) [m, rad] in a frame that does not move, shape (1, 3), or (beams, 3).
            put: Range of the beams with a lone hit: NaN is no measurement, infinity no return.
        """
        ranges, angles = np.ascontiguousarray(scan.ranges), np.ascontiguousarray(scan.angles)
        before = self._before.get(scan.lidar, (_NOTHING, _NOTHING, poses))
        self._before[scan.lidar] = ranges, angles, poses
        if not len(ranges):
            return scan
        lone = _core.find_lone_hits(ranges, angles, poses, *before, scan.range_min, scan.range_max)
        if not len(lone):
            return scan
        cleaned = ranges.copy()
        cleaned[lone] = put
        return replace(scan, ranges=cleaned)
