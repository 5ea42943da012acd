"""Cost fields: SciPy's Dijkstra on the same graph, for every type, number of threads and kind of goals."""

from __future__ import annotations

import random
from typing import Any

import numpy as np

from fuzz.loop import NUMBERS, attempt, rng_of, spoil
from support.grid_graph import cheapest_costs
from trundle import _core
from trundle.errors import InputError, PlanningError
from trundle.planning import cost_field

SIDES = (1, 2, 3, 5, 8, 16, 31, 32, 33, 40, 63, 64, 65, 66, 97)
WALLS = {"uint8": 255, "uint16": 65535, "float32": np.inf}


def make_costs(generator: random.Random) -> np.ndarray:
    shape, rng = (generator.choice(SIDES), generator.choice(SIDES)), rng_of(generator)
    dtype = generator.choice((np.uint8, np.uint16, np.float32))
    low, top = generator.choice((0, 0, 1, 60_000)), generator.choice((2, 50, 255, 65_535))
    if dtype == np.uint8:
        low, top = min(low, 1), min(top, 255)
    costs = rng.integers(low, max(top, low + 1), shape).astype(dtype)
    if dtype == np.float32:
        costs *= np.float32(generator.choice((1.0, 1e-3, 0.37, 1e6)))
    costs[rng.random(shape) < generator.choice((0.0, 0.1, 0.3, 0.45, 0.7))] = WALLS[costs.dtype.name]
    if generator.random() < 0.3:
        costs[:: generator.choice((2, 4))] = WALLS[costs.dtype.name]
        costs[:, :: generator.choice((5, 64))] = 1
    return costs


def ask_hostile(generator: random.Random, costs: np.ndarray, goals: Any, connectivity: int) -> None:
    """The kernel refuses what it cannot use; Python's side gives a field or a typed error."""
    arguments = (costs, np.asarray(goals, dtype=np.int64), connectivity, 1, None, None)
    attempt(_core.cost_field, spoil(generator, arguments, NUMBERS))
    try:
        field = cost_field(*spoil(generator, (costs, np.asarray(goals))), connectivity=connectivity, threads=1)
    except (InputError, PlanningError):
        return
    assert not np.isnan(field).any()


def one_round(generator: random.Random) -> None:
    costs = make_costs(generator)
    wall = costs == WALLS[costs.dtype.name]
    free = np.argwhere(~wall)
    if len(free) == 0:
        return
    goals = free[rng_of(generator).integers(0, len(free), generator.choice((1, 1, 2, 5, 40)))].tolist()
    connectivity, threads = generator.choice((4, 8)), generator.choice((1, 2, 3))
    if generator.random() < 0.3:
        ask_hostile(generator, costs, goals, connectivity)
        return
    given = generator.choice((costs, costs[::-1][::-1], np.asfortranarray(costs)))
    field = cost_field(given, goals, connectivity=connectivity, threads=threads)
    expected = cheapest_costs(costs.astype(np.float64), wall, [tuple(goal) for goal in goals], connectivity)
    assert np.array_equal(np.isfinite(field), np.isfinite(expected))
    reached = np.isfinite(expected)
    assert np.allclose(field[reached], expected[reached], rtol=6e-7, atol=1e-6)
