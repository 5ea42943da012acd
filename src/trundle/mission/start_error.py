"""`StartError`: what a localizer is told of the start, where that is not the truth."""

from __future__ import annotations

import math
import zlib
from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from trundle.files.config_fields import Angle, NotNegative
from trundle.files.yaml_config import Config
from trundle.geometry import FloatArray, Pose2D, wrap_angle

_STREAM = zlib.crc32(b"start error")
_LEAST_M, _LEAST_RAD = 1e-3, 1e-3
"""The least standard deviations that are told: with one of 0 the covariance would not be positive definite."""


class StartError(Config):
    """How far the pose that the localizer is told is from the true start: `{distance: 0.5, heading: 10deg}`.

    The seed of the run decides in which direction. `unknown` alone says that it is told no pose, and has to find out.

    Attributes:
        distance: From the true position [m].
        heading: From the true yaw [rad], 0 to π; text may be degrees.
        covariance: Whether it is told how uncertain the pose is; if not, it has to take it for exact.
        unknown: Whether it is told no pose at all.
    """

    distance: NotNegative = 0.0
    heading: Annotated[Angle, Field(ge=0.0, le=math.pi)] = 0.0
    covariance: bool = True
    unknown: bool = False

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.unknown and (self.distance > 0.0 or self.heading > 0.0 or not self.covariance):
            raise ValueError("a start that is unknown has no distance, heading or covariance: give either")
        return self

    def draw(self, start: Pose2D, seed: int) -> tuple[Pose2D | None, FloatArray | None]:
        """Draw what the localizer is told.

        Args:
            start: Where the robot is, map frame.
            seed: The same seed gives the same pose.

        Returns:
            The pose, or None for no pose; and its covariance of (x, y, yaw) [m², rad²], shape (3, 3), or None for a
            pose that is told as exact.
        """
        if self.unknown:
            return None, None
        rng = np.random.default_rng([seed, _STREAM])
        direction, sign = float(rng.uniform(-math.pi, math.pi)), float(rng.choice((-1.0, 1.0)))
        told = Pose2D(
            start.x + self.distance * math.cos(direction),
            start.y + self.distance * math.sin(direction),
            wrap_angle(start.yaw + sign * self.heading),
        )
        if not self.covariance or self.distance == self.heading == 0.0:
            return told, None
        # A distance d in any direction is a variance of d²/2 along each axis.
        along = max(self.distance / math.sqrt(2.0), _LEAST_M)
        return told, np.diag(np.square([along, along, max(self.heading, _LEAST_RAD)]))


def read_unknown(value: object) -> object:
    """Take `unknown` alone as a start that is not told."""
    return {"unknown": True} if value == "unknown" else value
