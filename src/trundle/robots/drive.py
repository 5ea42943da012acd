"""Differential drive: kinematics both ways, wheel commands clipped as in Isaac Sim, and the limits of the base."""

from __future__ import annotations

from typing import Literal, NamedTuple, Self

from pydantic import model_validator

from trundle.files.yaml_config import Config
from trundle.geometry import Twist2D
from trundle.robots.parts import (
    Acceleration,
    Coordinate,
    ReverseSpeed,
    Speed,
    TrackWidth,
    TurningAcceleration,
    TurningSpeed,
    WheelMass,
    WheelRadius,
    WheelSpeed,
    WheelWidth,
)


class WheelSpeeds(NamedTuple):
    """Angular speeds of the drive wheels [rad/s]; positive drives forward."""

    left: float
    right: float


class Axle(Config):
    """The left and right wheel of one axle, for drives with several axles.

    Attributes:
        x: Position of the axle in base_link [m].
        left_joint: Name of the left wheel's joint.
        right_joint: Name of the right wheel's joint.
    """

    x: Coordinate
    left_joint: str
    right_joint: str


class DriveWheel(NamedTuple):
    """One wheel: its joint, +1 on the left and −1 on the right, and the x of its axle in base_link [m]."""

    joint: str
    side: int
    x: float


class DifferentialDrive(Config):
    """Driven wheels on the left and on the right, with base_link on the ground midway between them.

    With several wheels per side, as on skid-steer robots, all wheels of a side turn at the same speed. The robot turns
    about base_link as commanded; skid is not modelled.

    Attributes:
        wheel_radius: Radius of a wheel [m].
        track_width: Distance between the two contact points [m] (`wheel_base` in Isaac Sim's controllers).
        left_joint: Name of the left wheel's joint.
        right_joint: Name of the right wheel's joint.
        wheel_width: Width of a wheel [m], for pictures and masses.
        wheel_mass: Mass of one wheel [kg].
        axles: The axles of a robot with several. By default there is one axle at x = 0.
        max_wheel_speed: Maximum speed of one wheel [rad/s]. If None, only the robot's limits apply.
    """

    type: Literal["differential"] = "differential"
    wheel_radius: WheelRadius
    track_width: TrackWidth
    left_joint: str
    right_joint: str
    wheel_width: WheelWidth = 0.05
    wheel_mass: WheelMass = 1.0
    axles: tuple[Axle, ...] = ()
    max_wheel_speed: WheelSpeed | None = None

    @model_validator(mode="after")
    def _check_axles(self) -> Self:
        names = [wheel.joint for wheel in self.wheels]
        if self.axles and (len(self.axles) < 2 or self.left_joint not in names or self.right_joint not in names):
            raise ValueError("give at least two axles, one with left_joint and right_joint; leave axles out for one")
        if len(set(names)) < len(names):
            raise ValueError("each wheel needs its own joint")
        return self

    @property
    def wheels(self) -> tuple[DriveWheel, ...]:
        """All wheels, the left one of each axle first."""
        axles = self.axles or (Axle(x=0.0, left_joint=self.left_joint, right_joint=self.right_joint),)
        return tuple(
            wheel
            for axle in axles
            for wheel in (DriveWheel(axle.left_joint, 1, axle.x), DriveWheel(axle.right_joint, -1, axle.x))
        )

    def wheel_speeds(self, twist: Twist2D) -> WheelSpeeds:
        """Return the wheel speeds [rad/s] that drive `twist` without slip: (2v ∓ w·track) / (2·radius)."""
        across = twist.w * self.track_width
        return WheelSpeeds(
            (2.0 * twist.v - across) / (2.0 * self.wheel_radius),
            (2.0 * twist.v + across) / (2.0 * self.wheel_radius),
        )

    def twist(self, wheels: WheelSpeeds) -> Twist2D:
        """Return the twist that wheel speeds [rad/s] drive without slip; the inverse of `wheel_speeds`."""
        left, right = wheels
        return Twist2D(
            self.wheel_radius * (left + right) / 2.0,
            self.wheel_radius * (right - left) / self.track_width,
        )

    def wheel_command(
        self, twist: Twist2D, *, max_linear_speed: float | None = None, max_angular_speed: float | None = None
    ) -> WheelSpeeds:
        """Return the wheel speeds [rad/s] with the clipping of Isaac Sim's DifferentialController.

        v and w are clipped independently, then each wheel at `max_wheel_speed`: the curvature is not preserved.
        """
        clipped = Twist2D(_clip(twist.v, max_linear_speed), _clip(twist.w, max_angular_speed))
        left, right = self.wheel_speeds(clipped)
        return WheelSpeeds(_clip(left, self.max_wheel_speed), _clip(right, self.max_wheel_speed))


def _clip(value: float, limit: float | None) -> float:
    return value if limit is None else max(-limit, min(limit, value))


class Limits(Config):
    """Maximum speeds and accelerations of the base.

    Attributes:
        linear_speed: Maximum forward speed [m/s].
        reverse_speed: Maximum reverse speed [m/s], as a positive number. If None, it is the same as forward.
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
