"""`LoneHits`: leaves out what single beams return too soon, as from dust and rain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.geometry import FloatArray
from trundle.observation import Scan, make_scan

_NOTHING = np.zeros(0)
_KEPT = 8  # answers: those of the lidars of a robot or two


@dataclass(frozen=True, slots=True, eq=False)
class _Placed:
    """The arrays of a scan, which do not change, and where its sensor was."""

    ranges: FloatArray
    angles: FloatArray
    poses: FloatArray
    place: bytes

    def is_same(self, other: _Placed) -> bool:
        return self.ranges is other.ranges and self.angles is other.angles and self.place == other.place


@dataclass(frozen=True, slots=True, eq=False)
class _Answer:
    """The lone hits of a scan, after the one before."""

    scan: _Placed
    before: _Placed | None
    limits: tuple[float, float]
    lone: npt.NDArray[np.int64]


# The costmap, the tracker and the collision monitor ask the same of one scan after the other. One tuple is replaced by
# another, so that threads may do so at once.
_answers: tuple[_Answer, ...] = ()


def _find(scan: _Placed, before: _Placed | None, limits: tuple[float, float]) -> npt.NDArray[np.int64]:
    global _answers
    for known in _answers:
        if known.scan.is_same(scan) and known.limits == limits:
            earlier = known.before
            if earlier is before or (earlier is not None and before is not None and earlier.is_same(before)):
                return known.lone
    earlier = (_NOTHING, _NOTHING, scan.poses) if before is None else (before.ranges, before.angles, before.poses)
    lone = _core.find_lone_hits(scan.ranges, scan.angles, scan.poses, *earlier, *limits)
    _answers = (_Answer(scan, before, limits, lone), *_answers[: _KEPT - 1])
    return lone


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
        ranges, angles = np.ascontiguousarray(scan.ranges), np.ascontiguousarray(scan.angles)
        before, placed = self._before.get(scan.lidar), _Placed(ranges, angles, poses, poses.tobytes())
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
