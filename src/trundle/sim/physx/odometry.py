"""`WheelOdometry`: how far the wheels have turned since a reset, and where that leads."""

from __future__ import annotations

import math

from trundle.geometry import Pose2D, integrate_twist, wrap_angle
from trundle.robots import Robot, WheelSpeeds

_LARGEST_TURN = 1.5
"""Largest rotation of a wheel [rad] between two readings: angles are wrapped at a full turn."""

_MOST_STEPS = 10
"""Physics steps between two readings, whose odometry is an arc in between: in 50 ms that is 0.01 mm off."""


class WheelOdometry:
    """Follows the angles of the two wheels.

    Args:
        robot: The robot.
        timestep: Length of a physics step [s].

    Attributes:
        steps_between: Physics steps after which the angles must be read again, at most.
        turned: Rotation of the wheels since the reset [rad].
    """

    def __init__(self, robot: Robot, timestep: float) -> None:
        self._drive = robot.drive
        limits = robot.limits
        fastest = limits.linear_speed / robot.drive.wheel_radius
        fastest += limits.angular_speed * robot.drive.track_width / (2.0 * robot.drive.wheel_radius)
        self.steps_between = max(1, min(_MOST_STEPS, math.floor(_LARGEST_TURN / (fastest * timestep))))
        self.turned = WheelSpeeds(0.0, 0.0)
        self._place = (0.0, 0.0, 0.0)
        self._angles = (0.0, 0.0)

    @property
    def pose(self) -> Pose2D:
        """Pose in the odom frame, which starts at the reset's pose."""
        x, y, yaw = self._place
        return Pose2D(x, y, wrap_angle(yaw))

    def reset(self, pose: Pose2D) -> None:
        """Begin at a pose."""
        self.turned = WheelSpeeds(0.0, 0.0)
        self._place = pose.as_tuple()

    def skip_to(self, angles: tuple[float, float]) -> None:
        """Go on from other angles [rad], without a motion."""
        self._angles = angles

    def follow(self, angles: tuple[float, float]) -> None:
        """Add the rotation since the last reading; angles that are wrapped at a full turn are unwrapped."""
        left, right = (math.remainder(new - old, math.tau) for new, old in zip(angles, self._angles, strict=True))
        self._angles = angles
        self.turned = WheelSpeeds(self.turned.left + left, self.turned.right + right)
        radius, track = self._drive.wheel_radius, self._drive.track_width
        x, y, yaw = integrate_twist(*self._place, radius * (left + right) / 2.0, radius * (right - left) / track, 1.0)
        self._place = (float(x), float(y), float(yaw))
