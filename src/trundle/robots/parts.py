"""What a robot is made of: its differential drive with kinematics and limits, chassis, casters, lidars.

Wheel commands are clipped as in Isaac Sim. Each type of number has a plausible range: a value outside is a wrong unit
or a misplaced point.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from trundle.files.yaml_config import Angle, Config, read_angle
from trundle.geometry import FloatArray, Twist2D

WheelRadius = Annotated[float, Field(ge=0.001, le=5.0, json_schema_extra={"unit": "m"})]
WheelWidth = Annotated[float, Field(gt=0.0, le=5.0, json_schema_extra={"unit": "m"})]
TrackWidth = Annotated[float, Field(ge=0.005, le=20.0, json_schema_extra={"unit": "m"})]
Trail = Annotated[float, Field(ge=0.0, le=5.0, json_schema_extra={"unit": "m"})]
Coordinate = Annotated[float, Field(ge=-50.0, le=50.0, json_schema_extra={"unit": "m"})]
"""Coordinate in base_link [m]."""

Height = Annotated[float, Field(gt=0.0, le=50.0, json_schema_extra={"unit": "m"})]
Clearance = Annotated[float, Field(ge=0.0, le=50.0, json_schema_extra={"unit": "m"})]
WheelMass = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "kg"})]
BodyMass = Annotated[float, Field(gt=0.0, le=1e6, json_schema_extra={"unit": "kg"})]
Inertia = Annotated[float, Field(gt=0.0, le=1e9, json_schema_extra={"unit": "kg·m²"})]
RockAngle = Annotated[
    float,
    BeforeValidator(read_angle, json_schema_input_type=float | str),
    Field(gt=0.0, le=math.pi / 4.0, json_schema_extra={"unit": "rad"}),
]
Stiffness = Annotated[float, Field(ge=0.0, le=1e7, json_schema_extra={"unit": "N·m/rad"})]
Damping = Annotated[float, Field(ge=0.0, le=1e7, json_schema_extra={"unit": "N·m·s/rad"})]
JointFriction = Annotated[float, Field(ge=0.0, le=1e5, json_schema_extra={"unit": "N·m"})]
Speed = Annotated[float, Field(gt=0.0, le=100.0, json_schema_extra={"unit": "m/s"})]
ReverseSpeed = Annotated[float, Field(ge=0.0, le=100.0, json_schema_extra={"unit": "m/s"})]
TurningSpeed = Annotated[float, Field(gt=0.0, le=1e3, json_schema_extra={"unit": "rad/s"})]
WheelSpeed = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "rad/s"})]
Acceleration = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "m/s²"})]
TurningAcceleration = Annotated[float, Field(gt=0.0, le=1e5, json_schema_extra={"unit": "rad/s²"})]
LeastRange = Annotated[float, Field(ge=0.0, le=1e4, json_schema_extra={"unit": "m"})]
LargestRange = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "m"})]
RangeNoise = Annotated[float, Field(ge=0.0, le=100.0, json_schema_extra={"unit": "m"})]
ScanRate = Annotated[float, Field(gt=0.0, le=1e4, json_schema_extra={"unit": "Hz"})]
Brightness = Annotated[float, Field(ge=0.0, le=1.0)]
FieldOfView = Annotated[
    float,
    BeforeValidator(read_angle, json_schema_input_type=float | str),
    Field(gt=0.0, le=math.tau + 1e-9, json_schema_extra={"unit": "rad"}),
]


class Body(Config):
    """The chassis as one rigid body.

    Attributes:
        mass: Mass of the chassis alone, without wheels and casters [kg].
        height: Top of the robot above the floor [m].
        clearance: Underside of the chassis above the floor [m].
        center_of_mass: Centre of mass in base_link [m]. If None, the middle of the footprint at 40 % of the height.
        inertia: Principal moments about the centre of mass along base_link's axes [kg·m²]. If None, they are those of
            a solid box of the footprint's extent.
        color: Red, green and blue, each 0 to 1.
    """

    mass: BodyMass
    height: Height
    clearance: Clearance = 0.03
    center_of_mass: tuple[Coordinate, Coordinate, Coordinate] | None = None
    inertia: tuple[Inertia, Inertia, Inertia] | None = None
    color: tuple[Brightness, Brightness, Brightness] = (0.25, 0.27, 0.30)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.clearance >= self.height:
            raise ValueError(f"clearance {self.clearance} must be below height {self.height}")
        return self


class Caster(Config):
    """A passive wheel: a frictionless ball without joint names, a swivel caster with them.

    Attributes:
        x: Position of the swivel axis, or of a ball's contact point, in base_link [m].
        y: As `x`, to the left [m].
        radius: Radius of the wheel or ball [m].
        trail: Distance of the wheel's axle behind the swivel axis [m].
        width: Width of the wheel [m].
        mass: Mass of wheel and fork together [kg].
        swivel_joint: Name of the swivel joint (about z). If None, the caster is a ball.
        wheel_joint: Name of the wheel joint. If None, the caster is a ball.
    """

    x: Coordinate
    y: Coordinate
    radius: WheelRadius
    trail: Trail = 0.0
    width: WheelWidth = 0.025
    mass: WheelMass = 0.1
    swivel_joint: str | None = None
    wheel_joint: str | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.swivel_joint is None) != (self.wheel_joint is None):
            raise ValueError("name both swivel_joint and wheel_joint (a swivel caster) or neither (a ball)")
        if self.swivel_joint is not None and self.trail == 0.0:
            raise ValueError("a swivel caster needs a trail above 0")
        return self

    @property
    def is_swivel(self) -> bool:
        """Whether this is a swivel caster and not a ball."""
        return self.swivel_joint is not None


class CasterFrame(Config):
    """A beam across the robot that carries its casters and rocks about x, so that all of them touch an uneven floor.

    A spring holds it level. It has no visual: it lies inside the chassis.

    Attributes:
        joint: Name of its joint (about x).
        x: Position of the joint in base_link [m].
        z: Height of the joint above the floor [m].
        mass: Mass of the frame, without the casters [kg].
        limit: Largest angle to either side [rad].
        stiffness: Stiffness of the spring [N·m/rad].
        damping: Damping of the spring [N·m·s/rad].
        friction: Dry friction of the joint [N·m].
    """

    joint: str
    x: Coordinate
    z: Height
    mass: BodyMass
    limit: RockAngle
    stiffness: Stiffness
    damping: Damping
    friction: JointFriction = 0.0


class Lidar(Config):
    """A planar lidar on the robot. Beams run counter-clockwise from −fov/2 to +fov/2 about the mount's x axis.

    Attributes:
        x, y, z: Mount in base_link [m].
        yaw: Yaw of the mount [rad].
        beams: Number of beams.
        fov: Field of view [rad].
        range_min, range_max: Shortest and longest range [m]; a beam without a return reads infinity.
        rate: Scans per second of simulated time [Hz].
        noise: Standard deviation of a range [m].
        inf_is_valid: Whether a beam without a return says that all of its range is free (Nav2's name).
    """

    x: Coordinate
    y: Coordinate
    z: Height
    yaw: Angle = 0.0
    beams: Annotated[int, Field(ge=1, le=100_000)] = 720
    fov: FieldOfView = 2.0 * math.pi
    range_min: LeastRange = 0.05
    range_max: LargestRange = 12.0
    rate: ScanRate = 20.0
    noise: RangeNoise = 0.0
    inf_is_valid: bool = True

    @property
    def angles(self) -> FloatArray:
        """Directions of the beams in the lidar's own frame [rad], shape (beams,), counter-clockwise.

        They include both ends of the field of view, except on a full turn, whose ends are one direction.
        """
        full_turn = self.fov > 2.0 * math.pi - 1e-6
        return np.linspace(-self.fov / 2.0, self.fov / 2.0, self.beams, endpoint=not full_turn)


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
