"""What the odometry of a motion leaves open, and covariances in another frame."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose2D, wrap_angle

# What the odometry leaves open: wheels slip by some per cent, and turn by some degrees per metre.
_DRIFT_M, _DRIFT_SHARE = 0.02, 0.05
_TURN_RAD, _TURN_SHARE, _TURN_PER_M = math.radians(0.5), 0.05, math.radians(3.0)


def motion_spread(moved: Pose2D) -> FloatArray:
    """Return the covariance of a motion by the odometry [m², rad²], shape (3, 3)."""
    far, turn = math.hypot(moved.x, moved.y), abs(wrap_angle(moved.yaw))
    metres = _DRIFT_M + _DRIFT_SHARE * far
    radians = _TURN_RAD + _TURN_SHARE * turn + _TURN_PER_M * far
    return np.diag((metres**2, metres**2, radians**2))


def turned(covariance: FloatArray, yaw: float) -> FloatArray:
    """Return a covariance of (x, y, yaw), shape (3, 3), turned by an angle [rad]."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    turn = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
    return turn @ covariance @ turn.T
