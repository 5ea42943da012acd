"""`RecentSurfaces` and `SeenPlaces`: what the last key frames saw, and where enough of them were taken."""

from __future__ import annotations

import math
from collections import Counter, deque

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.nodes import Surface

_MOST = 6


class RecentSurfaces:
    """The surfaces of the last key frames, with the poses that they were seen from, in one frame."""

    def __init__(self) -> None:
        self._seen: deque[tuple[Pose2D, Surface]] = deque(maxlen=_MOST)

    def clear(self) -> None:
        """Forget them."""
        self._seen.clear()

    def add(self, pose: Pose2D, surface: Surface) -> None:
        """Add what was seen from a pose."""
        self._seen.append((pose, surface))

    def together(self) -> Surface:
        """Return all of them, seen from the newest pose; there must be one."""
        here = self._seen[-1][0].inverse()
        seen = [(here @ pose, one) for pose, one in self._seen]
        parts = [
            (_moved(one.points, pose), _turned(one.normals, pose), _moved(one.sensors, pose)) for pose, one in seen
        ]
        points, normals, sensors = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        return Surface(points, normals, sensors)


def _turned(points: FloatArray, pose: Pose2D) -> FloatArray:
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return points @ np.array(((cos, sin), (-sin, cos)))


def _moved(points: FloatArray, pose: Pose2D) -> FloatArray:
    return _turned(points, pose) + np.array((pose.x, pose.y))


# So many key frames from one place and in one direction are enough; a robot that circles adds no more.
_PLACE_M, _SECTORS, _ENOUGH = 1.0, 8, 8


class SeenPlaces:
    """Counts key frames by square metre and direction."""

    def __init__(self) -> None:
        self._counts: Counter[tuple[int, int, int]] = Counter()

    def add(self, pose: Pose2D) -> None:
        """Count a key frame."""
        self._counts[_place_of(pose)] += 1

    def is_known(self, pose: Pose2D) -> bool:
        """Whether a place was seen from here often enough: the map does not get better by more of the same."""
        return self._counts[_place_of(pose)] >= _ENOUGH


def _place_of(pose: Pose2D) -> tuple[int, int, int]:
    sector = round(pose.yaw / (2.0 * math.pi) * _SECTORS) % _SECTORS
    return math.floor(pose.x / _PLACE_M), math.floor(pose.y / _PLACE_M), sector
