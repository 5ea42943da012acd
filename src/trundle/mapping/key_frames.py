"""Key frames: what odometry leaves open between two, what the last ones saw, and where enough of them were taken."""

from __future__ import annotations

import math
from collections import Counter, deque

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.mapping.nodes import Surface, step_length

# What the odometry leaves open: wheels slip by some per cent, and turn by some degrees per metre.
_DRIFT_M, _DRIFT_SHARE = 0.02, 0.05
_TURN_RAD, _TURN_SHARE, _TURN_PER_M = math.radians(0.5), 0.05, math.radians(3.0)

_GOOD_FIT, _MOST_DOUBT = 0.8, 100.0  # a match that fits like this is believed; the largest factor of any other


def motion_spread(moved: Pose2D) -> FloatArray:
    """Return the covariance of a motion by the odometry [m², rad²], shape (3, 3)."""
    far, turn = math.hypot(moved.x, moved.y), abs(wrap_angle(moved.yaw))
    metres = _DRIFT_M + _DRIFT_SHARE * far
    radians = _TURN_RAD + _TURN_SHARE * turn + _TURN_PER_M * far
    return np.diag((metres**2, metres**2, radians**2))


def doubt_of(fit: float) -> float:
    """Return by what to multiply the covariance of a match: what fits badly may be wrong by far more than it says."""
    return min(_MOST_DOUBT, max(1.0, _GOOD_FIT / max(fit, 1e-3)) ** 4)


def turned(covariance: FloatArray, yaw: float) -> FloatArray:
    """Return a covariance of (x, y, yaw), shape (3, 3), turned by an angle [rad]."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    turn = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
    return turn @ covariance @ turn.T


class Travel:
    """How far a robot has driven by its odometry.

    Args:
        metres: How far it had driven before; see `step_length`.

    Attributes:
        metres: How far it has driven.
    """

    def __init__(self, metres: float) -> None:
        self.metres = metres
        self._last: Pose2D | None = None

    def to(self, odometry: Pose2D) -> None:
        """Add the motion to where the robot is now."""
        if self._last is not None:
            self.metres += step_length(np.array((self._last.inverse() @ odometry).as_tuple()))
        self._last = odometry


_MOST = 6  # key frames whose surfaces are kept: 2.4 m of driving, as one is taken every 0.4 m


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
        """Return whether a place was seen from here often enough: the map does not get better by more of the same."""
        return self._counts[_place_of(pose)] >= _ENOUGH


def _place_of(pose: Pose2D) -> tuple[int, int, int]:
    sector = round(pose.yaw / (2.0 * math.pi) * _SECTORS) % _SECTORS
    return math.floor(pose.x / _PLACE_M), math.floor(pose.y / _PLACE_M), sector
