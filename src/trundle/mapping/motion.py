"""What the odometry of a motion leaves open, and covariances in another frame."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.mapping.nodes import step_length

# What the odometry leaves open: wheels slip by some per cent, and turn by some degrees per metre.
_DRIFT_M, _DRIFT_SHARE = 0.02, 0.05
_TURN_RAD, _TURN_SHARE, _TURN_PER_M = math.radians(0.5), 0.05, math.radians(3.0)

_GOOD_FIT, _MOST_DOUBT = 0.8, 100.0


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
        """Take where it has come to."""
        if self._last is not None:
            self.metres += step_length(np.array((self._last.inverse() @ odometry).as_tuple()))
        self._last = odometry
