"""Fuzz smoothing: of any path that is free, one that keeps the contract; of any other a typed error."""

from __future__ import annotations

import itertools
import math
import random
from typing import Any

import numpy as np

from fuzz.fuzz_hybrid_astar import EXTREME, make_costmap, make_pose
from fuzz.loop import attempt, rng_of, spoil
from support.smoothing import assert_contract
from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError
from trundle.path import Path
from trundle.planning import create_planner
from trundle.planning.constrained_smoother import ConstrainedSmoother, as_driven

NUMBERS = {
    "minimum_turning_radius": (0.01, 0.1, 0.4, 2.0, 1e4),
    "w_cost": (0.0, 4.0, 100.0),
    "w_smooth": (0.0, 0.1, 10.0),
    "cost_tolerance": (0.0, 0.02, 1.0),
    "reverse_penalty": (1.0, 2.0, 50.0),
    "change_penalty": (0.0, 0.3, 10.0),
    "turn_penalty": (0.0, 0.5, 10.0),
    "padding": (0.0, 0.001, 0.02, 0.2),
    "spacing": (0.01, 0.05, 1.0),
}
KERNEL = ("radius", "reverse_penalty", "change_cost", "turn_cost", "cost_weight", "curve_weight", "cost_tolerance",
          "step", "spacing")  # fmt: skip
SMOOTHER = _core.PathSmoother()
PLANNERS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("least_cost", {"max_replans": 2}),
    ("astar", {"max_replans": 2}),
    ("hybrid_astar", {"smooth": False, "max_expansions": 500}),
    ("hybrid_astar", {"smooth": False, "max_expansions": 500, "in_place": True}),
)


def make_smoother(generator: random.Random) -> ConstrainedSmoother | None:
    """A smoother of any options; none where these are refused."""
    options: dict[str, Any] = {}
    for name, values in NUMBERS.items():
        if generator.random() < 0.3:
            options[name] = generator.choice(values)
        if generator.random() < 0.02:
            options[name] = generator.choice(EXTREME)
    try:
        return ConstrainedSmoother(**options)
    except InputError:
        return None


def make_path(generator: random.Random, costmap: Costmap) -> Path | None:
    """A planner's path, or poses at random with legs driven either way; none where there is no plan."""
    if generator.random() < 0.5:
        name, options = generator.choice(PLANNERS)
        try:
            return create_planner(name, **options).plan(
                costmap, make_pose(generator, costmap), make_pose(generator, costmap)
            )
        except PlanningError:
            return None
    poses = [make_pose(generator, costmap).as_tuple() for _ in range(generator.choice((1, 2, 3, 10)))]
    if generator.random() < 0.5:  # looking where they lead
        for k, (here, there) in enumerate(itertools.pairwise(poses)):
            poses[k] = (here[0], here[1], math.atan2(there[1] - here[1], there[0] - here[0]))
    poses = [pose for pose in poses for _ in range(generator.choice((1, 1, 1, 2)))]
    backward = rng_of(generator).random(len(poses) - 1) < generator.choice((0.0, 0.0, 0.3, 1.0))
    return Path(np.array(poses), backward=backward)


def one_round(generator: random.Random) -> None:
    """One map, a path or two on it, and the kernel with an argument that it does not expect."""
    costmap, smoother = make_costmap(generator), make_smoother(generator)
    for _ in range(generator.randrange(1, 4)):
        path = make_path(generator, costmap)
        if path is None or smoother is None:
            continue
        try:
            done = smoother.explain(path, costmap)
        except PlanningError:
            continue
        settings = smoother.settings
        # With less padding than that poses are checked 5 mm apart, and something as thin may be between them.
        depth = 0.005 if settings.padding < 0.003 else 0.0
        assert_contract(costmap, as_driven(path), done, settings, depth=depth)
    if generator.random() < 0.5:
        call_kernel(generator, costmap)


def call_kernel(generator: random.Random, costmap: Costmap) -> None:
    size = np.array(costmap.shape)[::-1] * costmap.resolution
    count = generator.choice((1, 2, 5, 30))
    poses = rng_of(generator).uniform(-0.1, 1.1, (count, 3)) * np.array([*size, 6.0])
    backward = (rng_of(generator).random(count - 1) < 0.3).astype(np.uint8)
    arguments: list[Any] = [costmap.data, costmap.resolution, costmap.footprint, poses, backward]
    arguments += [0.4, 2.0, 0.3, 0.5, 4.0, 0.1, 0.02, 0.03, 0.05]
    attempt(_call, spoil(generator, arguments))


def _call(*arguments: Any) -> Any:
    return SMOOTHER.smooth(*arguments[:5], **dict(zip(KERNEL, arguments[5:], strict=True)))
