"""What `Mppi.step` takes and answers, by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle import _core

Floats = npt.NDArray[np.float32]
Doubles = npt.NDArray[np.float64]


@dataclass
class Request:
    """The arguments of a step, by name."""

    samples: int
    steps: int
    knot_steps: int
    state: Doubles
    controls: Floats
    model: Doubles
    noise: Doubles
    discs: Doubles
    nearness: npt.NDArray[np.uint8]
    to_go: Floats
    resolution: float
    unit: float
    goal: Doubles
    movers: Doubles
    weights: Doubles
    bounds: Doubles

    def numbers(self) -> tuple[Any, ...]:
        """What `arguments_of` takes; the controls are a copy."""
        own = self.state, self.controls.copy(), self.model, self.noise, self.discs, self.nearness, self.to_go
        return *own, self.resolution, self.unit, self.goal, self.movers, self.weights, self.bounds

    def arguments(self) -> tuple[Any, ...]:
        """Those of the kernel's `step`; the controls are a copy."""
        return arguments_of(*self.numbers())


STATE = ("x", "y", "yaw", "v", "w", "v_rate", "w_rate")
MODEL = ("dt", "v_min", "v_max", "w_max", "acceleration", "deceleration", "angular_acceleration")
NOISE = ("v_std", "w_std", "share", "seed", "shift")
GOAL = ("x", "y", "yaw", "has_yaw", "reach", "fade", "direction")
WEIGHTS = (
    *("collision", "contact", "to_go", "to_go_end", "heading", "yaw", "overshoot", "obstacle", "obstacle_speed"),
    *("mover", "direction", "twirl", "acceleration", "jerk", "speed"),
)
BOUNDS = ("obstacle_reach", "mover_margin", "mover_sigmas", "free_heading", "speed_limit")


def named(names: tuple[str, ...], numbers: Any) -> dict[str, Any]:
    return dict(zip(names, np.asarray(numbers, float).tolist(), strict=True))


def arguments_of(
    state: Any,
    controls: Any,
    model: Any,
    noise: Any,
    discs: Any,
    nearness: Any,
    to_go: Any,
    resolution: Any,
    unit: Any,
    goal: Any,
    movers: Any,
    weights: Any,
    bounds: Any,
) -> tuple[Any, ...]:
    """The arguments of the kernel's `step`, of numbers in the order of the oracle."""
    bound, aim = named(BOUNDS, bounds), named(GOAL, goal)
    limits = _core.MppiLimits(**named(MODEL, model), speed_limit=bound.pop("speed_limit"))
    window = _core.MppiWindow(nearness=nearness, to_go=to_go, resolution=resolution, unit=unit)
    target = _core.MppiAim(**{**aim, "has_yaw": aim["has_yaw"] > 0.0})
    critics = _core.MppiCritics(**named(WEIGHTS, weights), **bound)
    state, noise = _core.MppiState(**named(STATE, state)), _core.MppiNoise(**named(NOISE, noise))
    return state, controls, limits, noise, discs, window, target, movers, critics


@dataclass
class Courses:
    """Where samples are at the end of each step, shape (samples, steps) each, x and y in cells; `room` to obstacles."""

    x: Floats
    y: Floats
    cos: Floats
    sin: Floats
    v: Floats
    w: Floats
    room: Floats
    alive: npt.NDArray[np.bool_]  # before the step
    hit_step: npt.NDArray[np.int64]


def knots_of(request: Request) -> int:
    return -(-request.steps // request.knot_steps) + 1
