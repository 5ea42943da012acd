"""`MapFit`: whether what a robot sees is what the map shows, before it is believed to be where it was told."""

from __future__ import annotations

from collections import deque

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.map_field import MapField
from trundle.maps import OccupancyGrid
from trundle.observation import Scan

LEAST_AGREE, MOST_THROUGH = 0.4, 0.4
"""Least share of beams that agree with the map, and most that go through its walls, where a robot sets off.

Clutter that is not on the map hides walls: it costs agreement, and lets no beam through them. A map of another site and
mirrored scans do both.
"""

MISFIT = "the scans do not fit the map"
"""So begins why a robot stands that is not where it was told to be."""

SCANS = 5
"""So many scans are judged, the latest ones: the localizer refines a pose that it was told with the first of them."""

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
