"""`ScanWindow`: the front end. A scan is matched with the surfaces that about the last 40 key frames saw.

Correlative search within what the odometry leaves open (Olson 2009), then Gauss-Newton on the field of the surfaces,
with the odometry as prior. Its frame is smooth: corrections of the pose graph do not move it.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from trundle._core import SurfaceMap
from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.nodes import Surface

CELL_M = 0.1
_KEY_FRAMES = 40  # of the window: older ones are matched as submaps, when the robot comes back
# The search compares its points at every pose of a grid, the match at every step alone, so that it can afford more.
_SEARCH_POINTS = 120
_MATCH_POINTS = 240
# Points are picked in between evenly over the beams and evenly along what was seen: by the root of their distance, up
# to this one [m]. Evenly over the beams, people near the robot count for more than the walls, and some who walked along
# a corridor with it took the match with them: in an office with six people the path was 0.38 m off, and is 0.011 m now.
# Evenly along what was seen, the heading of a robot in a warehouse of 100 m drifted by 0.04° a metre: 0.194 m in ten
# minutes, 0.055 m now. Scans of fewer points stay as they are: so Belgioioso (361 beams) has 0.089 m, not 0.137 m.
_DENSE_POINTS = 480
_FAR_M = 12.0
_YAW_STEP = math.radians(0.5)
_FIRST_WIDTH_M, _LAST_WIDTH_M, _NOISE_M, _MOST_BEAMS, _ITERATIONS = 0.2, 0.08, 0.03, 60.0, 15
# Below this fit a wider search is worth its time; what it finds must be clearly better, as the odometry says otherwise.
_POOR_FIT, _BETTER = 0.65, 0.1
_WIDE_M, _WIDE_RAD = 0.25, math.radians(8.0)
SETTINGS = np.array((_FIRST_WIDTH_M, _LAST_WIDTH_M, _NOISE_M, _MOST_BEAMS, _ITERATIONS))
_MOST_BYTES = 32 << 20  # of the window's tiles: beyond, those that the robot has left behind are dropped
_MOST_REACH_M, _MOST_REACH_RAD = 2.0, math.radians(30.0)  # after a step of many metres a search takes too long


@dataclass(frozen=True, slots=True)
class Match:
    """Where a scan fits.

    Attributes:
        pose: Pose of base_link.
        covariance: Covariance of the pose (x, y, yaw).
        fit: Mean weight of its points, 0 to 1: 1 where all lie on surfaces.
        overlap: Share of its points that are near surfaces.
    """

    pose: Pose2D
    covariance: FloatArray
    fit: float
    overlap: float


class ScanWindow:
    """Surfaces of the last key frames."""

    def __init__(self) -> None:
        self._map = SurfaceMap(CELL_M)
        self._frames: deque[tuple[Surface, FloatArray]] = deque()

    def __len__(self) -> int:
        return len(self._frames)

    def add(self, surface: Surface, pose: Pose2D) -> None:
        """Add a key frame; the oldest leaves when there are more than 40."""
        at = np.array(pose.as_tuple())
        self._map.add(surface.points, surface.normals, at, 1)
        self._frames.append((surface, at))
        if len(self._frames) > _KEY_FRAMES:
            old, where = self._frames.popleft()
            self._map.add(old.points, old.normals, where, -1)
        if self._map.memory > _MOST_BYTES:  # of tiles that the robot has left behind
            self._map = SurfaceMap(CELL_M)
            for one, where in self._frames:
                self._map.add(one.points, one.normals, where, 1)

    def match(self, surface: Surface, predicted: Pose2D, covariance: FloatArray) -> Match:
        """Return where a scan fits near where the odometry says."""
        surface = _spread(surface)
        sigma = math.sqrt(max(covariance[0, 0], covariance[1, 1])), math.sqrt(covariance[2, 2])
        reach = 3.0 * sigma[0], 3.0 * sigma[1]
        found = match_surface(self._map, surface, predicted, covariance, reach)
        if found.fit >= _POOR_FIT:
            return found
        wider = max(2.0 * reach[0], _WIDE_M), max(2.0 * reach[1], _WIDE_RAD)
        other = match_surface(self._map, surface, predicted, 9.0 * covariance, wider)
        return other if other.fit > found.fit + _BETTER else found


def match_surface(
    known: SurfaceMap, surface: Surface, predicted: Pose2D, covariance: FloatArray, reach: tuple[float, float]
) -> Match:
    """Search within a reach (metres, radians) of a pose, and refine the best of what is found."""
    prior = np.array(predicted.as_tuple())
    starts = [prior]
    reach = min(reach[0], _MOST_REACH_M), min(reach[1], _MOST_REACH_RAD)
    if reach[0] > 0.5 * CELL_M or reach[1] > _YAW_STEP:
        window = np.array((reach[0], reach[1], _YAW_STEP))
        sigmas = np.array((max(reach[0] / 3.0, 0.02), max(reach[1] / 3.0, 0.005)))
        found, _ = known.search(_thinned(surface.points, _SEARCH_POINTS), prior, window, sigmas)
        starts = [found]
    keep = slice(None, None, -(-len(surface.points) // _MATCH_POINTS) or 1)
    points, normals = (np.ascontiguousarray(array[keep]) for array in (surface.points, surface.normals))
    poses, spreads, fits = known.match(points, normals, np.array(starts), prior, covariance, SETTINGS)
    best = int(np.argmax(fits[:, 0]))
    return Match(Pose2D(*poses[best].tolist()), spreads[best], float(fits[best, 0]), float(fits[best, 2]))


def _thinned(points: FloatArray, most: int) -> FloatArray:
    if len(points) <= most:
        return points
    return np.ascontiguousarray(points[np.linspace(0, len(points) - 1, most).astype(np.intp)])


def _spread(surface: Surface) -> Surface:
    """Some points of a scan, more of them where they are far from each other; all if they are few."""
    points = surface.points
    if len(points) <= _DENSE_POINTS:
        return surface
    along = np.cumsum(np.sqrt(np.minimum(np.hypot(*points.T), _FAR_M)))
    keep = np.unique(np.searchsorted(along, np.linspace(0.0, along[-1], _MATCH_POINTS)))
    return Surface(*(np.ascontiguousarray(array[keep]) for array in (points, surface.normals, surface.sensors)))
