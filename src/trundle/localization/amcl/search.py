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
_MOST_NODES = 2_000_000


def search_map(field: MapField, beams: Beams) -> list[Pose2D]:
    """Return where on the whole map the scan fits, best first; several where places look alike."""
    rows, cols = field.shape
    window = np.array((0.0, cols * field.resolution, 0.0, rows * field.resolution, -math.pi, math.pi - 1e-6))
    return _search(field, beams, window, apart_m=_APART_M)


def search_near(field: MapField, beams: Beams, pose: Pose2D, metres: float, radians: float) -> list[Pose2D]:
    """Return where the scan fits within a distance and an angle of a pose, best first."""
    x, y, yaw = pose.as_tuple()
    radians = min(radians, math.pi - 1e-6)
    window = np.array((x - metres, x + metres, y - metres, y + metres, yaw - radians, yaw + radians))
    return _search(field, beams, window, apart_m=0.3)[:3]


def _search(field: MapField, beams: Beams, window: FloatArray, *, apart_m: float) -> list[Pose2D]:
    table, free, resolution = field.search_tables
    settings = np.array((_YAW_STEP_RAD, _LEAST_SCORE, _SHARE, apart_m, _APART_RAD))
    poses, _, _ = search_poses(
        table, free, resolution, thin_out(beams.points, _POINT_CELL_M, _POINTS), window, settings, _MOST, _MOST_NODES
    )
    return [Pose2D(*pose) for pose in poses.tolist()]


def thin_out(points: FloatArray, cell_m: float, most: int) -> FloatArray:
    """Return one point for each cell of a grid, so that what is near does not count for more, and not too many.

    Args:
        points: (x, y) [m], shape (N, 2).
        cell_m: Edge of a cell [m].
        most: How many points are kept at most, evenly spread over those of the cells.
    """
    cells = np.floor(points / cell_m).astype(np.int64)
    _, first = np.unique(cells[:, 0] * 1_000_003 + cells[:, 1], return_index=True)
    first.sort()
    if len(first) > most:
        first = first[np.linspace(0, len(first) - 1, most).astype(np.intp)]
    return np.ascontiguousarray(points[first])
