"""`Variation`: what differs from episode to episode, by the names that a suite's `vary` has."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from pydantic import ValidationError

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.suite.vary import RANGES as RANGES_OF_SUITES
from trundle.evaluation.suite.vary import Distribution
from trundle.geometry import FloatArray

_NEUTRAL = {"wheel_radius": 1.0, "track": 1.0, "lidar_noise": 0.0, "lidar_dropout": 0.0}

RANGES = {name: RANGES_OF_SUITES[name] for name in _NEUTRAL}
"""What a kinematic environment varies, and its least and largest value; noise in metres, dropouts as a share."""

_ELSEWHERE = {
    "friction": "it needs physics: vary it in a suite with the backend mujoco",
    "mass": "it needs physics: vary it in a suite with the backend mujoco",
    "odometry_scale": "the environment observes the true pose; vary it in a suite",
    "odometry_heading": "the environment observes the true pose; vary it in a suite",
    "odometry_slip": "the environment observes the true pose; vary it in a suite",
    "start_pose": "each episode has another start anyway",
    "latency_s": "the environment has no latency yet; vary it in a suite",
}


class Variation:
    """Distributions by name, drawn for an episode by its robot's seed and the number of the episode.

    Args:
        distributions: For each name, one of `RANGES`, a number or a distribution.

    Raises:
        UnknownNameError: If a name is not known.
        InputError: If a name needs more than a kinematic model, or a value is out of range.
    """

    def __init__(self, distributions: Mapping[str, float | Distribution]) -> None:
        self._distributions = dict(distributions)

    @classmethod
    def of(cls, vary: Mapping[str, Any] | Variation) -> Self:
        """Create from a mapping as a suite's `vary` is: numbers, `{uniform: [low, high]}` or `{normal: […]}`."""
        if isinstance(vary, cls):
            return vary
        if not isinstance(vary, Mapping):
            raise InputError(f"vary must be a mapping from names to distributions, got {vary!r}")
        read: dict[str, float | Distribution] = {}
        for name, value in vary.items():
            if name in _ELSEWHERE:
                raise InputError(f"vary: {name} cannot be varied in an environment: {_ELSEWHERE[name]}")
            if name not in RANGES:
                raise UnknownNameError("name to vary", str(name), RANGES)
            read[name] = _read(name, value)
        return cls(read)

    def __bool__(self) -> bool:
        return bool(self._distributions)

    def draw(self, seed: int, episode: int) -> dict[str, float]:
        """Draw every value of an episode; what is not varied is neutral."""
        drawn = dict(_NEUTRAL)
        for name, value in self._distributions.items():
            if isinstance(value, Distribution):
                value = value.draw(np.random.default_rng([seed, episode, zlib.crc32(name.encode())]))
            drawn[name] = value
        return drawn

    def draw_many(self, seeds: Any, episodes: Any) -> dict[str, FloatArray]:
        """Draw for many robots, shape (n,) of each name."""
        if not self._distributions:
            return {name: np.full(len(seeds), value) for name, value in _NEUTRAL.items()}
        rows = [self.draw(int(seed), int(episode)) for seed, episode in zip(seeds, episodes, strict=True)]
        return {name: np.array([row[name] for row in rows]) for name in _NEUTRAL}


def _read(name: str, value: object) -> float | Distribution:
    if isinstance(value, Mapping):
        try:
            value = Distribution.model_validate(dict(value))
        except ValidationError as error:
            raise InputError(f"vary: {name}: {error.errors()[0]['msg']}") from None
    if isinstance(value, Distribution):
        low, high = value.support
    elif isinstance(value, int | float) and not isinstance(value, bool):
        low = high = float(value)
    else:
        raise InputError(f"vary: {name} must be a number, {{uniform: [low, high]}} or {{normal: […]}}, got {value!r}")
    least, most = RANGES[name]
    if not (least <= low <= high <= most):
        raise InputError(
            f"vary: {name} {low:.4g} to {high:.4g} is out of range: it must stay within {least:g} and {most:g}"
        )
    return value if isinstance(value, Distribution) else low
