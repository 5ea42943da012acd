"""`PursuitSettings`: every option of regulated pure pursuit, under Nav2's names where Nav2 has them."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.control.collision import FOOTPRINT_PADDING_M
from trundle.errors import InputError
from trundle.robots import Robot
from trundle.values import is_finite_number, show_value

_FULL_SPEED_IN_S = 0.5
"""Robots with strong motors drive off more gently than they can: a wheel that slips falsifies the odometry."""


@dataclass(frozen=True, slots=True)
class PursuitSettings:
    """Settings of `RegulatedPurePursuit`, under Nav2's names where Nav2 has them.

    Attributes:
        desired_linear_vel: Speed on a free straight [m/s]. If None, the robot's limit.
        lookahead_dist: Distance along the path to the point that is driven at [m].
        min_lookahead_dist: The same while the usual one is blocked, and along curves that it would cut too short [m].
        rotate_to_heading_min_angle: Above this angle to the path the robot turns in place [rad].
        rotate_to_heading_angular_vel: Speed of those turns [rad/s]; the robot's limit holds below it.
        regulated_linear_scaling_min_radius: Curves tighter than this are driven slower [m].
        regulated_linear_scaling_min_speed: But not slower than this [m/s].
        cost_scaling_dist: Nearer to obstacles than this the robot drives slower [m].
        approach_velocity_scaling_dist: Nearer to the end than this the robot drives slower [m].
        min_approach_linear_velocity: But not slower than this [m/s].
        approach_deceleration: Share of the robot's deceleration that is used to stop at the end of a section.
        max_linear_accel: Acceleration of each wheel when the robot drives off [m/s²]. If None, the robot's limit, or
            what reaches its top speed in half a second if that is less.
        footprint_padding: What the footprint is widened by in the check of each command [m]; where the path itself
            comes closer to something, half of what it keeps there.
    """

    desired_linear_vel: float | None = None
    lookahead_dist: float = 0.6
    min_lookahead_dist: float = 0.3
    rotate_to_heading_min_angle: float = 0.785
    rotate_to_heading_angular_vel: float = 1.8
    regulated_linear_scaling_min_radius: float = 0.9
    regulated_linear_scaling_min_speed: float = 0.25
    cost_scaling_dist: float = 0.6
    approach_velocity_scaling_dist: float = 0.6
    min_approach_linear_velocity: float = 0.05
    approach_deceleration: float = 0.5
    max_linear_accel: float | None = None
    footprint_padding: float = FOOTPRINT_PADDING_M

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if value is not None and not (is_finite_number(value) and value >= 0.0):
                raise InputError(
                    f"regulated_pure_pursuit: {name} must be a number of at least 0, got {show_value(value)}"
                )
        if self.max_linear_accel == 0.0:
            raise InputError(
                "regulated_pure_pursuit: max_linear_accel must be above 0, the robot would never drive off"
            )
        if self.min_lookahead_dist <= 0.0 or self.lookahead_dist < self.min_lookahead_dist:
            raise InputError(
                "regulated_pure_pursuit: lookahead_dist must be at least min_lookahead_dist, which must be above 0; "
                f"got {self.lookahead_dist} and {self.min_lookahead_dist}"
            )

    def acceleration_of(self, robot: Robot) -> float:
        """Return the acceleration of each wheel when the robot drives off [m/s²]."""
        limits, own = robot.limits, self.max_linear_accel
        return min(limits.linear_acceleration, limits.linear_speed / _FULL_SPEED_IN_S if own is None else own)
