"""`Assumed`: what a robot's software takes the robot for, where that differs from the robot."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import Field, field_validator

from trundle.files.yaml_config import Config
from trundle.geometry import Footprint
from trundle.robots import Limits, Robot
from trundle.robots.parts import Acceleration, Coordinate, ReverseSpeed, Speed, TurningAcceleration, TurningSpeed


class AssumedLimits(Config):
    """Limits that the robot's software keeps to; the robot's own hold where they are lower.

    Attributes:
        linear_speed: Maximum forward speed [m/s]; none means the robot's.
        reverse_speed: Maximum reverse speed [m/s], as a positive number; none means the robot's.
        angular_speed: Maximum turning speed in both directions [rad/s]; none means the robot's.
        linear_acceleration: Maximum acceleration and deceleration [m/s²]; none means the robot's.
        angular_acceleration: Maximum angular acceleration and deceleration [rad/s²]; none means the robot's.
    """

    linear_speed: Speed | None = None
    reverse_speed: ReverseSpeed | None = None
    angular_speed: TurningSpeed | None = None
    linear_acceleration: Acceleration | None = None
    angular_acceleration: TurningAcceleration | None = None

    def within(self, own: Limits) -> Limits:
        """The lower of these limits and a robot's own."""
        back = own.linear_speed if own.reverse_speed is None else own.reverse_speed
        given = {name: value for name, value in self.model_dump().items() if value is not None}
        kept = {**own.model_dump(), "reverse_speed": back}
        return Limits(**{name: min(value, given.get(name, value)) for name, value in kept.items()})


class Assumed(Config):
    """What the robot's software takes the robot for: `{footprint: [[0.3, 0.2], …], limits: {linear_speed: 0.5}}`.

    The simulated robot keeps its own outline and its own limits.

    Attributes:
        footprint: Corners of the convex outline that it plans and drives with, base_link [m], clockwise or
            counter-clockwise; none means the robot's.
        limits: Speeds and accelerations that it keeps to; none means the robot's.
    """

    footprint: Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=64)] | None = None
    limits: AssumedLimits | None = None

    @field_validator("footprint")
    @classmethod
    def _check_footprint(
        cls, corners: tuple[tuple[float, float], ...] | None
    ) -> tuple[tuple[float, float], ...] | None:
        if corners is None:
            return None
        return tuple((float(x), float(y)) for x, y in Footprint(np.asarray(corners)).outline)

    def of(self, robot: Robot) -> Robot:
        """The robot as its software takes it."""
        changes: dict[str, object] = {}
        if self.footprint is not None:
            changes["footprint"] = self.footprint
        if self.limits is not None:
            changes["limits"] = self.limits.within(robot.limits)
        # Made from its fields: a copy would keep the outline that the robot has computed.
        return type(robot)(**{**{name: getattr(robot, name) for name in type(robot).model_fields}, **changes})
