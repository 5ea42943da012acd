"""`SeenPlaces`: from where, and in which directions, key frames were taken often enough."""

from __future__ import annotations

import math
from collections import Counter

from trundle.geometry import Pose2D

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
