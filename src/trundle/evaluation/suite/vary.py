"""What a suite varies from episode to episode: distributions, and the values drawn from them by seed."""

from __future__ import annotations

import zlib
from collections.abc import Callable, Mapping
from typing import Annotated, Self, TypeAlias

import numpy as np
from pydantic import Field, field_validator, model_validator

from trundle.errors import InputError
from trundle.files.yaml_config import Config
from trundle.mission import Scenario


class Distribution(Config):
    """Where a number is drawn from: `{uniform: [0.5, 1.0]}` or `{normal: [0.14, 0.002]}`.

    Attributes:
        uniform: Lowest and highest value.
        normal: Mean and standard deviation; cut off at four standard deviations.
    """

    uniform: Annotated[tuple[float, ...], Field(min_length=2, max_length=2)] | None = None
    normal: Annotated[tuple[float, ...], Field(min_length=2, max_length=2)] | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.uniform is None) == (self.normal is None):
            raise ValueError("give either uniform: [lowest, highest] or normal: [mean, standard deviation]")
        if self.uniform is not None and self.uniform[0] > self.uniform[1]:
            raise ValueError(f"uniform: the lowest value, {self.uniform[0]:g}, is above the highest")
        if self.normal is not None and self.normal[1] < 0.0:
            raise ValueError(f"normal: the standard deviation, {self.normal[1]:g}, is below 0")
        return self

    def draw(self, rng: np.random.Generator) -> float:
        """Draw one value."""
        if self.uniform is not None:
            return float(rng.uniform(self.uniform[0], self.uniform[1]))
        if self.normal is not None:
            return float(np.clip(rng.normal(self.normal[0], self.normal[1]), *self.support))
        raise InputError("a distribution is uniform or normal")

    @property
    def support(self) -> tuple[float, float]:
        """Lowest and highest value that can be drawn."""
        if self.uniform is not None:
            return self.uniform[0], self.uniform[1]
        mean, deviation = self.normal or (0.0, 0.0)
        return mean - 4.0 * deviation, mean + 4.0 * deviation


Varied: TypeAlias = float | Distribution
"""A fixed number, or where it is drawn from."""


class StartPose(Config):
    """How far the robot stands from the start of its mission.

    Attributes:
        x: Along the map's x axis [m].
        y: Along the map's y axis [m].
        yaw: Turned [rad].
    """

    x: Varied = 0.0
    y: Varied = 0.0
    yaw: Varied = 0.0


class Vary(Config):
    """What differs between what the robot was designed for and what it drives with; drawn by the mission's seed.

    Each is a fixed number, `{uniform: [lowest, highest]}` or `{normal: [mean, standard deviation]}`.

    Attributes:
        friction: Sliding friction between wheels and floor.
        mass: True mass of the chassis over the one that the robot's description has.
        wheel_radius: True radius of the drive wheels over the one that the robot's description has.
        track: True track width over the one that the robot's description has.
        latency_s: Time [s] from a command until the robot acts on it.
        start_pose: How far the robot stands from the start of its mission.
    """

    friction: Varied | None = None
    mass: Varied | None = None
    wheel_radius: Varied | None = None
    track: Varied | None = None
    latency_s: Varied | None = None
    start_pose: StartPose | None = None

    @field_validator("friction", "mass", "wheel_radius", "track")
    @classmethod
    def _check_positive(cls, value: Varied | None) -> Varied | None:
        low = _lowest(value)
        if low is not None and low <= 0.0:
            raise ValueError(f"must stay above 0, and would reach {low:.3g}")
        return value

    @field_validator("latency_s")
    @classmethod
    def _check_not_negative(cls, value: Varied | None) -> Varied | None:
        low = _lowest(value)
        if low is not None and low < 0.0:
            raise ValueError(f"must stay at 0 or more, and would reach {low:.3g}")
        return value

    def names(self) -> tuple[str, ...]:
        """What is varied, in the names that `draw` gives, such as `friction` and `start_pose.x`."""
        return tuple(name for name, _ in self._parts())

    def draw(self, seed: int) -> dict[str, float]:
        """Draw a value of each; the same seed gives the same values, whatever else is varied."""
        return {
            name: draw(value, np.random.default_rng([seed, zlib.crc32(name.encode())])) for name, value in self._parts()
        }

    def _parts(self) -> list[tuple[str, Varied]]:
        parts: list[tuple[str, Varied]] = []
        for name in type(self).model_fields:
            value = getattr(self, name)
            if isinstance(value, StartPose):
                parts += [(f"{name}.{axis}", getattr(value, axis)) for axis in ("x", "y", "yaw")]
            elif value is not None:
                parts.append((name, value))
        return [(name, value) for name, value in parts if value != 0.0]


def _lowest(value: Varied | None) -> float | None:
    return value.support[0] if isinstance(value, Distribution) else value


def draw(value: Varied, rng: np.random.Generator) -> float:
    """A fixed number itself, or one drawn."""
    return value.draw(rng) if isinstance(value, Distribution) else float(value)


APPLIED: Mapping[str, Callable[[Scenario, float], Scenario]] = {}
"""How a drawn value becomes part of a scenario, by name."""


def apply(scenario: Scenario, drawn: Mapping[str, float]) -> Scenario:
    """Put drawn values into a scenario.

    Raises:
        InputError: If a scenario cannot express one of them.
    """
    for name, value in drawn.items():
        if name not in APPLIED:
            raise InputError(
                f"vary: {name} cannot be varied by this version; there are: {', '.join(APPLIED) or 'none'}"
            )
        scenario = APPLIED[name](scenario, value)
    return scenario
