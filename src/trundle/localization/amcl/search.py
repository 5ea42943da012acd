"""Where on the map could the robot be? Branch and bound round a pose, or over the whole map."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import search_poses
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField

_POINTS = 60
_POINT_CELL_M = 0.1
_YAW_STEP_RAD = math.radians(2.0)
_MOST = 12  # poses
_APART_M, _APART_RAD = 0.6, 0.3
_LEAST_SCORE = 100.0  # of 255: about two of five beams end on the map
_SHARE = 0.8  # of the best one's score that others need
_NEAR_LEAST, _NEAR_SHARE, _NEAR_MOST = 50.0, 0.5, 8
"""Near a pose more candidates are kept: where a lidar sees what stands behind a kerb, few beams end on the map."""

_MOST_NODES = 2_000_000


def search_map(field: MapField, beams: Beams) -> list[Pose2D]:
    """Return where on the whole map the scan fits, best first; several where places look alike."""
    rows, cols = field.shape
    window = np.array((0.0, cols * field.resolution, 0.0, rows * field.resolution, -math.pi, math.pi - 1e-6))
    return _search(field, beams, window, _LEAST_SCORE, _SHARE, _APART_M, _MOST)


def search_near(field: MapField, beams: Beams, pose: Pose2D, metres: float, radians: float) -> list[Pose2D]:
    """Return where the scan fits within a distance and an angle of a pose, best first."""
    x, y, yaw = pose.as_tuple()
    radians = min(radians, math.pi - 1e-6)
    window = np.array((x - metres, x + metres, y - metres, y + metres, yaw - radians, yaw + radians))
    return _search(field, beams, window, _NEAR_LEAST, _NEAR_SHARE, 0.3, _NEAR_MOST)


def _search(
    field: MapField, beams: Beams, window: FloatArray, least: float, share: float, apart_m: float, most: int
) -> list[Pose2D]:
    table, free, resolution = field.search_tables
    settings = np.array((_YAW_STEP_RAD, least, share, apart_m, _APART_RAD))
    poses, _, _ = search_poses(table, free, resolution, _thinned(beams.points), window, settings, most, _MOST_NODES)
    return [Pose2D(*pose) for pose in poses.tolist()]


def _thinned(points: FloatArray) -> FloatArray:
    """One point for each cell of a grid, so that what is near does not count for more, and not too many."""
    cells = np.floor(points / _POINT_CELL_M).astype(np.int64)
    _, first = np.unique(cells[:, 0] * 1_000_003 + cells[:, 1], return_index=True)
    first.sort()
    if len(first) > _POINTS:
        first = first[np.linspace(0, len(first) - 1, _POINTS).astype(np.intp)]
    return np.ascontiguousarray(points[first])
