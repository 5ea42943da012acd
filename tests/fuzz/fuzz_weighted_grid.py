"""Paths and lines over weighted cells: SciPy's Dijkstra for the paths, shapely's lengths per cell for the lines."""

from __future__ import annotations

import itertools
import math
import random

import numpy as np
import shapely

from fuzz.loop import attempt, rng_of, spoil
from support.grid_graph import cheapest_costs
from trundle import _core
from trundle.geometry import FloatArray

SIDES = (1, 2, 3, 8, 13, 20, 33)
STRAIGHT, DIAGONAL = 70, 99


def make_costs(generator: random.Random) -> np.ndarray:
    shape, rng = (generator.choice(SIDES), generator.choice(SIDES)), rng_of(generator)
    costs = rng.integers(0, generator.choice((1, 253)), shape).astype(np.uint8)
    costs[rng.random(shape) < generator.choice((0.0, 0.05, 0.2, 0.45))] = generator.choice((253, 254, 255))
    return costs


def make_weights(generator: random.Random) -> FloatArray:
    neutral, factor = generator.choice(((50.0, 0.8), (1.0, 0.0), (10_000.0, 200.0), (1.0, 1.0)))
    weights = neutral + factor * np.arange(256.0)
    weights[253:] = 0.0
    return weights


def check_path(generator: random.Random, costs: np.ndarray, weights: FloatArray) -> None:
    whole = np.minimum(np.floor(weights), 65535).astype(np.uint16)
    start, goal = ([generator.randrange(count) for count in costs.shape] for _ in range(2))
    connectivity = generator.choice((4, 8))
    arguments = (costs, whole, tuple(start), tuple(goal), connectivity)
    if generator.random() < 0.3:
        attempt(_core.grid_search, spoil(generator, arguments, (None, (0,), (-1, 0), (0, 2**31), (2**63, 0), 0.5, 6)))
        return
    cells, cost = _core.grid_search(*arguments)
    wall = whole[costs] == 0
    expected = math.inf
    if not (wall[tuple(start)] or wall[tuple(goal)]):
        prices = whole[costs].astype(np.float64)
        expected = cheapest_costs(prices, wall, [tuple(start)], connectivity, (2 * STRAIGHT, 2 * DIAGONAL))[tuple(goal)]
    if math.isinf(expected):
        assert len(cells) == 0
        return
    expected /= 2 * STRAIGHT
    assert cost == (0.0 if start == goal else expected)
    assert cells[[0, -1]].tolist() == [start, goal]
    total = 0
    for (r0, c0), (r1, c1) in itertools.pairwise(cells.tolist()):
        assert max(abs(r1 - r0), abs(c1 - c0)) == 1
        assert not (wall[r0, c1])
        assert not (wall[r1, c0])
        total += (int(whole[costs[r0, c0]]) + int(whole[costs[r1, c1]])) * (
            DIAGONAL if r0 != r1 and c0 != c1 else STRAIGHT
        )
    assert total / (2 * STRAIGHT) == cost


def integral(costs: np.ndarray, weights: FloatArray, a: FloatArray, b: FloatArray) -> float:
    """By shapely: the length in each cell's square times its weight."""
    here = weights[costs]
    rows, cols = np.indices(costs.shape)
    boxes = shapely.box(cols, rows, cols + 1, rows + 1)
    lengths = shapely.length(shapely.intersection(shapely.LineString([a, b]), boxes))
    return math.inf if (lengths[here == 0] > 1e-6).any() else float((lengths * here).sum())


def check_lines(generator: random.Random, costs: np.ndarray, weights: FloatArray) -> None:
    rng = rng_of(generator)
    rows, cols = costs.shape
    points = rng.uniform((0, 0), (cols, rows), (generator.choice((2, 5, 9)), 2))
    kind = generator.choice(("anywhere", "centres", "halves"))
    if kind == "centres":
        points = np.floor(points) + 0.5
    if kind == "halves":
        points = np.floor(points * 2.0) / 2.0  # centres, corners and borders
    if generator.random() < 0.3:
        attempt(_core.line_costs, spoil(generator, (costs, weights, points[:-1].copy(), points[1:].copy())))
        attempt(_core.shortcut, spoil(generator, (costs, weights, points)))
        return
    found = _core.line_costs(costs, weights, points[:-1].copy(), points[1:].copy())
    back = _core.line_costs(costs, weights, points[1:].copy(), points[:-1].copy())
    assert np.allclose(found, back, rtol=1e-9, atol=1e-6)
    for cost, a, b in zip(found.tolist(), points[:-1], points[1:], strict=True):
        on_border = np.abs(points - np.round(points)).min() < 1e-6
        if on_border or min(abs(a - b).min(), 1.0) < 1e-6:
            continue
        expected = integral(costs, weights, a, b)
        # A line that passes a corner within rounding may be refused; none that is blocked may pass.
        assert math.isinf(cost) or math.isclose(cost, expected, rel_tol=1e-8, abs_tol=1e-3), (cost, expected)
        assert not (math.isfinite(cost) and math.isinf(expected))
    if kind == "halves":  # a line may end at the corner of a blocked cell, but not pass it: parts are not the whole
        return
    chosen, cost = _core.shortcut(costs, weights, points)
    direct = float(found.sum())
    assert cost <= direct * (1.0 + 1e-12)
    if len(chosen):
        assert (chosen[0], chosen[-1]) == (0, len(points) - 1)
        kept = points[chosen]
        again = _core.line_costs(costs, weights, kept[:-1].copy(), kept[1:].copy()).sum()
        assert math.isclose(again, cost, rel_tol=1e-9, abs_tol=1e-6)


def one_round(generator: random.Random) -> None:
    costs, weights = make_costs(generator), make_weights(generator)
    generator.choice((check_path, check_lines))(generator, costs, weights)
