"""Speed and acceleration limits of a robot."""

from __future__ import annotations

from trundle.files.yaml_config import Config
from trundle.geometry import Twist2D
from trundle.robots.sizes import Acceleration, ReverseSpeed, Speed, TurningAcceleration, TurningSpeed


class Limits(Config):
    """Maximum speeds and accelerations of the base.

    Attributes:
        linear_speed: Maximum forward speed [m/s].
        reverse_speed: Maximum reverse speed [m/s], as a positive number; none means the same as forward.
        angular_speed: Maximum turning speed in both directions [rad/s].
        linear_acceleration: Maximum acceleration and deceleration [m/s²].
        angular_acceleration: Maximum angular acceleration and deceleration [rad/s²].
    """

    linear_speed: Speed
    reverse_speed: ReverseSpeed | None = None
    angular_speed: TurningSpeed
    linear_acceleration: Acceleration
    angular_acceleration: TurningAcceleration

    def clamp(self, twist: Twist2D) -> Twist2D:
        """Clamp a twist to the maximum speeds, v and w independently."""
        back = self.linear_speed if self.reverse_speed is None else self.reverse_speed
        return Twist2D(
            min(self.linear_speed, max(-back, twist.v)),
            min(self.angular_speed, max(-self.angular_speed, twist.w)),
        )

    def approach(self, current: Twist2D, command: Twist2D, dt: float) -> Twist2D:
        """Return the twist after `dt` [s] of accelerating from `current` towards `command` within all limits."""
        target = self.clamp(command)
        linear, angular = self.linear_acceleration * dt, self.angular_acceleration * dt
        return Twist2D(
            current.v + min(linear, max(-linear, target.v - current.v)),
            current.w + min(angular, max(-angular, target.w - current.w)),
        )
