"""Minimum-cost paths: free, with the right cost, symmetric, and never above the optimum through cells' centres.

What they cost is held against `line_costs`, and the best by centres is SciPy's.
"""

from __future__ import annotations

import math
import random

import numpy as np

from fuzz.fuzz_weighted_grid import make_costs, make_weights
from fuzz.loop import attempt, rng_of, spoil
from support.grid_graph import cheapest_costs
from trundle import _core

LEAST = 1.002
"""How far a path's cost may exceed the optimum through centres: rounding, and what blocks of cells hide."""


def make_map(generator: random.Random) -> np.ndarray:
    """Costs that change from cell to cell, or slowly, on maps of a few blocks or some hundreds."""
    costs = make_costs(generator)
    if generator.random() < 0.3:
        costs = np.tile(costs, (generator.choice((1, 4)), generator.choice((1, 5))))
    if generator.random() < 0.5:
        hills = np.cumsum(np.cumsum(rng_of(generator).normal(size=costs.shape), 0), 1)
        costs = np.where(costs < 253, np.minimum(252, 3 * np.abs(hills)), costs).astype(np.uint8)
    return costs


def one_round(generator: random.Random) -> None:
    costs, weights = make_map(generator), make_weights(generator)
    kernel = _core.LeastCost(weights)
    wall = weights[costs] == 0
    for _ in range(generator.choice((1, 3))):
        start, goal = (tuple(generator.randrange(count) for count in costs.shape) for _ in range(2))
        ends = np.array([start[::-1], goal[::-1]]) + 0.5
        if generator.random() < 0.3:
            shift = generator.choice((rng_of(generator).uniform(-0.5, 0.5, (2, 2)), -0.5, 0.5))
            ends = np.ascontiguousarray(ends + shift)
        limits = generator.choice((None, None, None, 1e-9, 1e3)), generator.choice((None, np.zeros(1, np.uint8)))
        if generator.random() < 0.2:
            bad = spoil(
                generator, (costs, start, goal, ends, *limits), (None, (0,), (-1, 0), (0, 2**31), 0.5, math.nan)
            )
            attempt(kernel.find, bad)
            attempt(_core.LeastCost, spoil(generator, (weights,)))
            continue
        status, points, cost = kernel.find(costs, start, goal, ends, *limits)
        if wall[start] or wall[goal]:
            assert status == 1
            continue
        if status == 2:
            assert limits[0] is not None
            continue
        best = float(cheapest_costs(weights[costs], wall, [start])[goal])
        assert (status == 0) == math.isfinite(best)
        if status != 0:
            continue
        pieces = _core.line_costs(costs, weights, points[:-1].copy(), points[1:].copy())
        assert np.allclose(points[[0, -1]], ends, atol=1e-5)
        # Where a line ends within 1e-9 of a border, which cell that much of it counts to depends on its direction.
        assert math.isclose(cost, pieces.sum(), rel_tol=1e-12, abs_tol=1e-9 + 2e-9 * weights.max() * len(pieces))
        to_centres = sum(
            math.dist(end, (col + 0.5, row + 0.5)) * weights[costs[row, col]]
            for end, (row, col) in zip(ends.tolist(), (start, goal), strict=True)
        )
        assert cost <= best * LEAST + 1.01 * to_centres
        assert cost >= math.dist(points[0], points[-1]) * weights[0] * (1 - 1e-9)
        _, back, same = kernel.find(costs, goal, start, ends[::-1].copy())
        assert np.array_equal(back[::-1], points)
        assert same == cost
