"""Cost to go in any direction: plain iteration on the same cells, and arguments that cannot be."""

from __future__ import annotations

import random

import numpy as np

from fuzz.loop import NUMBERS, attempt, rng_of, spoil
from support.eikonal_oracle import solve_eikonal
from trundle import _core

SIDES = (1, 2, 3, 7, 16, 33, 50)


def one_round(generator: random.Random) -> None:
    shape, rng = (generator.choice(SIDES), generator.choice(SIDES)), rng_of(generator)
    classes = rng.integers(0, generator.choice((2, 5, 256)), shape).astype(np.uint8)
    costs = (rng.uniform(1.0, generator.choice((1.5, 10.0, 500.0)), 256) * 0.05).astype(np.float32)
    costs[0] = np.inf
    count = generator.choice((0, 1, 1, 4))
    seeds = np.column_stack([rng.integers(0, side, count) for side in shape])
    values = rng.uniform(0.0, generator.choice((0.0, 1.0, 50.0)) + 1e-9, count)
    if generator.random() < 0.3:
        attempt(_core.eikonal_field, spoil(generator, (classes, costs, seeds, values, 0, 0, 5.0), NUMBERS))
        return
    field = _core.eikonal_field(classes, costs, seeds, values, 0, 0, np.inf)
    cells = [(int(row), int(col)) for row, col in seeds]
    expected = solve_eikonal(costs[classes].astype(np.float64), cells, values.tolist())
    assert np.array_equal(np.isfinite(field), np.isfinite(expected))
    reached = np.isfinite(expected)
    assert np.allclose(field[reached], expected[reached], rtol=2e-4, atol=2e-3)
