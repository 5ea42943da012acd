"""What a robot can do at most, in speed and in acceleration."""

from __future__ import annotations

from trundle.files.yaml_config import Config
from trundle.geometry import Twist2D
from trundle.robots.sizes import Acceleration, ReverseSpeed, Speed, TurningAcceleration, TurningSpeed


class Limits(Config):
    """Largest speeds and accelerations of the base.

    Attributes:
        linear_speed: Largest speed forward [m/s].
        reverse_speed: Largest speed backward [m/s], as a positive number; none means as forward.
        angular_speed: Largest turning speed, in both directions [rad/s].
        linear_acceleration: Largest acceleration and deceleration [m/s²].
        angular_acceleration: Largest angular acceleration and deceleration [rad/s²].
    """

    linear_speed: Speed
    reverse_speed: ReverseSpeed | None = None
    angular_speed: TurningSpeed
    linear_acceleration: Acceleration
    angular_acceleration: TurningAcceleration

    def clamp(self, twist: Twist2D) -> Twist2D:
        """Cut a twist to the largest speeds, each on its own."""
        back = self.linear_speed if self.reverse_speed is None else self.reverse_speed
        return Twist2D(
            min(self.linear_speed, max(-back, twist.v)),
            min(self.angular_speed, max(-self.angular_speed, twist.w)),
        )

    def approach(self, current: Twist2D, command: Twist2D, dt: float) -> Twist2D:
        """Return the twist after `dt` [s] of going from `current` towards `command` within all limits."""
        target = self.clamp(command)
        linear, angular = self.linear_acceleration * dt, self.angular_acceleration * dt
        return Twist2D(
            current.v + min(linear, max(-linear, target.v - current.v)),
            current.w + min(angular, max(-angular, target.w - current.w)),
        )
