"""`LoneHits`: leaves out what single beams return too soon, as from dust and rain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.geometry import FloatArray
from trundle.observation import Scan, make_scan

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
