"""What a suite varies from episode to episode: distributions, and the values drawn from them by seed."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Annotated, Self, TypeAlias, TypeVar

import numpy as np
from pydantic import Field, ValidationInfo, field_validator, model_validator

from trundle.control.latency import Latency
from trundle.errors import InputError
from trundle.files.yaml_config import Config, build
from trundle.geometry import Pose2D, wrap_angle
from trundle.mission import Scenario
from trundle.sim.actuation import Actuation
from trundle.sim.lidar_errors import LidarErrors
from trundle.sim.odometry_errors import OdometryErrors


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


RANGES = {
    "friction": (0.05, 5.0),
    "mass": (0.1, 10.0),
    "wheel_radius": (0.5, 2.0),
    "track": (0.5, 2.0),
    "latency_s": (0.0, 2.0),
    "odometry_scale": (0.0, 0.5),
    "odometry_heading": (0.0, 1.0),
    "odometry_slip": (0.0, 0.2),
    "lidar_noise": (0.0, 10.0),
    "lidar_dropout": (0.0, 1.0),
}
"""The ranges that can be simulated; see `Actuation`, `OdometryErrors`, `LidarErrors` and `MujocoSimulator`."""


class Vary(Config):
    """What differs between what the robot's software believes and what it drives with; drawn by the mission's seed.

    Each is a fixed number, `{uniform: [lowest, highest]}` or `{normal: [mean, standard deviation]}`.

    Attributes:
        friction: Friction between the robot and everything else, relative to rubber on concrete, 0.05 to 5; needs the
            backend mujoco.
        mass: True mass of the robot over the one that its servos are tuned for, 0.1 to 10; needs the backend mujoco.
        wheel_radius: True wheel radius over the believed one, 0.5 to 2.
        track: True distance between the wheels over the believed one, 0.5 to 2.
        latency_s: Time [s] from a command until the wheels receive it, 0 to 2.
        odometry_scale: Bias of the odometry's distance, as a share of it, 0 to 0.5; its direction is drawn too.
        odometry_heading: Bias of the odometry's heading per metre driven [rad/m], 0 to 1; its direction is drawn too.
        odometry_slip: Random error of each wheel's counted travel [m/√m], 0 to 0.2.
        lidar_noise: Standard deviation of a range [m], 0 to 10, besides the lidars' own; needs lidars.
        lidar_dropout: Share of the beams that have no return, 0 to 1; needs lidars.
        start_pose: How far the robot stands from the start of its mission.
    """

    friction: Varied | None = None
    mass: Varied | None = None
    wheel_radius: Varied | None = None
    track: Varied | None = None
    latency_s: Varied | None = None
    odometry_scale: Varied | None = None
    odometry_heading: Varied | None = None
    odometry_slip: Varied | None = None
    lidar_noise: Varied | None = None
    lidar_dropout: Varied | None = None
    start_pose: StartPose | None = None

    @field_validator(*RANGES)
    @classmethod
    def _check_range(cls, value: Varied | None, info: ValidationInfo) -> Varied | None:
        if value is None:
            return None
        least, most = RANGES[str(info.field_name)]
        low, high = value.support if isinstance(value, Distribution) else (value, value)
        if low < least or high > most:
            reach = f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
            raise ValueError(f"{reach} is out of range: it must stay within {least:g} and {most:g}")
        return value

    def names(self) -> tuple[str, ...]:
        """Return the names of what is varied, as `draw` gives them, such as `friction` and `start_pose.x`."""
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


def draw(value: Varied, rng: np.random.Generator) -> float:
    """Return a fixed number itself, or draw one."""
    return value.draw(rng) if isinstance(value, Distribution) else float(value)


_OPTIONS = ("friction", "mass")
"""Options of the backend mujoco."""

_ACTUATION = {"wheel_radius": "wheel_radius", "track": "track_width"}

_LATENCY = {"latency_s": "command_delay_s"}

_LIDAR = {"lidar_noise": "noise", "lidar_dropout": "dropouts"}

_Errors = TypeVar("_Errors", Latency, OdometryErrors, LidarErrors)

_ODOMETRY = {f"odometry_{field}": field for field in OdometryErrors.model_fields}


def apply(scenario: Scenario, drawn: Mapping[str, float]) -> Scenario:
    """Put drawn values into a scenario; those of the start pose are for `move_start`.

    Raises:
        InputError: If the scenario's backend cannot simulate one of them, or has no lidars for errors of lidars.
    """
    options = {name: drawn[name] for name in _OPTIONS if name in drawn}
    actuation = {field: drawn[name] for name, field in _ACTUATION.items() if name in drawn}
    odometry = {field: drawn[name] for name, field in _ODOMETRY.items() if name in drawn}
    latency = {field: drawn[name] for name, field in _LATENCY.items() if name in drawn}
    lidar = {field: drawn[name] for name, field in _LIDAR.items() if name in drawn}
    backend = scenario.backend
    if lidar and not scenario.lidar and "lidar" not in backend.options:
        names = ", ".join(name for name in _LIDAR if name in drawn)
        raise InputError(f"vary: {names} can only be varied with simulated lidars: give lidar: true")
    if options:
        if backend.name != "mujoco":
            raise InputError(
                f"vary: {', '.join(options)} can only be varied with the backend mujoco, not {backend.name}"
            )
        backend = backend.model_copy(update={"options": {**backend.options, **options}})
    update = {
        "backend": backend,
        "actuation": Actuation(**actuation) if actuation else scenario.actuation,
        "latency": _replace(Latency, scenario.latency, latency),
        "odometry": _replace(OdometryErrors, scenario.odometry, odometry),
        "lidar_errors": _replace(LidarErrors, scenario.lidar_errors, lidar),
    }
    return scenario.model_copy(update=update)


def _replace(kind: type[_Errors], given: _Errors | None, drawn: Mapping[str, float]) -> _Errors | None:
    """Put drawn values in place of those that were given."""
    if not drawn:
        return given
    return build({**({} if given is None else given.model_dump()), **drawn}, kind)


def move_start(start: Pose2D, drawn: Mapping[str, float]) -> Pose2D:
    """Return the start that a robot really has, moved by the drawn values."""
    x, y, yaw = (drawn.get(f"start_pose.{axis}", 0.0) for axis in ("x", "y", "yaw"))
    return Pose2D(start.x + x, start.y + y, wrap_angle(start.yaw + yaw)) if x or y or yaw else start
