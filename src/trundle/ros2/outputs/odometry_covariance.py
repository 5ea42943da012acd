"""`OdometryCovariance`: how far odometry may be off, from the errors that it is simulated with."""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim.odometry_errors import OdometryErrors

EXACT = 1e-6
"""Variance [m², rad², …] of what has no error: it is not 0, as filters need one that can be inverted."""


class OdometryCovariance:
    """Propagates the errors of odometry along the odometry's own poses, to first order.

    Random errors add up as variances; a bias is the same for the whole run, and its effect adds up before it is
    squared. See Thrun, Burgard and Fox, Probabilistic Robotics, section 5.4, for the motion's Jacobians.

    Args:
        errors: What the odometry is simulated with. If None, it has no errors.
        robot: The robot, for its track.
    """

    def __init__(self, errors: OdometryErrors | None, robot: Robot) -> None:
        self._errors = errors
        self._track = robot.drive.track_width
        self.reset()

    def reset(self) -> None:
        """Begin where the odometry is exact."""
        self._random = np.zeros((3, 3))
        self._biased = np.zeros((3, 2))
        self._last: Pose2D | None = None
        self.pose = _whole(np.zeros((3, 3)))
        self.twist = _whole(np.zeros((3, 3)))

    def update(self, pose: Pose2D, twist: Twist2D, dt: float) -> None:
        """Take the odometry of the next control period.

        Args:
            pose: In the odometry's frame.
            twist: In the base.
            dt: Length of the period [s].
        """
        errors, last = self._errors, self._last
        self._last = pose
        if errors is None or last is None:
            return
        dx, dy = pose.x - last.x, pose.y - last.y
        driven = math.hypot(dx, dy)
        if driven == 0.0 and pose.yaw == last.yaw:
            return
        along, around = self._variances(driven, abs(pose.yaw - last.yaw))
        motion = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        cos, sin = math.cos(last.yaw), math.sin(last.yaw)
        self._random = motion @ self._random @ motion.T
        self._random[:2, :2] += along * np.array([[cos * cos, cos * sin], [cos * sin, sin * sin]])
        self._random[2, 2] += around
        self._biased = motion @ self._biased
        self._biased[:, 0] += (dx, dy, 0.0)
        self._biased[2, 1] += driven
        bias = np.square([errors.scale, errors.heading])
        self.pose = _whole(self._random + (self._biased * bias) @ self._biased.T)
        v_variance = along / dt**2 + (errors.scale * twist.v) ** 2
        w_variance = around / dt**2 + (errors.heading * twist.v) ** 2
        self.twist = _whole(np.diag([v_variance, 0.0, w_variance]))

    def _variances(self, driven: float, turned: float) -> tuple[float, float]:
        """Return the variances that a motion [m, rad] adds to the distance [m²] and to the heading [rad²]."""
        errors = self._errors or OdometryErrors()
        travels = max(2.0 * driven, turned * self._track)  # of both wheels
        along = errors.walk**2 * driven + errors.slip**2 * travels / 4.0
        around = errors.heading_walk**2 * driven + errors.slip**2 * travels / self._track**2
        if errors.slips is not None:
            slips = driven / errors.slips.every
            along += slips * errors.slips.distance**2
            around += slips * errors.slips.heading**2
        return along, around


def _whole(covariance: FloatArray) -> tuple[float, ...]:
    """Return a covariance of (x, y, yaw), shape (3, 3), as the 36 numbers of a message, with `EXACT` added."""
    whole = np.eye(6) * EXACT
    whole[np.ix_((0, 1, 5), (0, 1, 5))] += covariance
    return tuple(whole.ravel().tolist())
