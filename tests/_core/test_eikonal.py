"""The cost to go in any direction, against plain iteration and straight distances."""

import math

import numpy as np
import pytest

from support.eikonal_oracle import solve_eikonal
from trundle import _core


def solve(classes, costs, seeds, values=None):
    values = np.zeros(len(seeds)) if values is None else np.array(values, np.float64)
    return _core.eikonal_field(classes, costs, np.array(seeds, np.int64).reshape(-1, 2), values, 0, 0, math.inf)


def costs_of(*first):
    costs = np.ones(256, np.float32)
    costs[: len(first)] = first
    return costs


@pytest.mark.parametrize("seed", range(12))
def test_it_is_what_plain_iteration_converges_to(seed):
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 40, 2).tolist())
    classes = rng.integers(0, 6, shape).astype(np.uint8)
    costs = costs_of(math.inf, 1.0, 1.7, 3.0, 0.4, 9.0) * np.float32(rng.choice([1.0, 0.05, 30.0]))
    seeds = [tuple(rng.integers(0, shape).tolist()) for _ in range(rng.integers(1, 5))]
    values = rng.uniform(0.0, 20.0 * float(costs[1]), len(seeds)).tolist()
    expected = solve_eikonal(costs[classes].astype(np.float64), seeds, values)
    field = solve(classes, costs, seeds, values)
    assert np.array_equal(np.isfinite(field), np.isfinite(expected))
    reached = np.isfinite(expected)
    assert np.allclose(field[reached], expected[reached], rtol=1e-4, atol=float(costs[4]) * 1e-2)


def test_in_the_open_it_is_close_to_the_straight_distance():
    field = solve(np.ones((101, 101), np.uint8), costs_of(), [(50, 50)])
    rows, cols = np.indices(field.shape)
    straight = np.hypot(rows - 50, cols - 50)
    assert (field >= straight - 1e-3).all()
    assert (field - straight).max() < 0.03 * 50 * math.sqrt(2) + 1.0


def test_it_does_not_pass_between_walls_that_touch_at_a_corner():
    classes = np.array([[1, 0], [0, 1]], np.uint8)
    assert solve(classes, costs_of(math.inf), [(0, 0)]).tolist() == [[0.0, math.inf], [math.inf, math.inf]]


def test_a_seed_in_a_wall_leads_nowhere():
    classes = np.array([[0, 1, 1]], np.uint8)
    assert np.isinf(solve(classes, costs_of(math.inf), [(0, 0)])).all()


def test_the_answer_does_not_depend_on_the_order_of_the_seeds():
    rng = np.random.default_rng(1)
    classes = rng.integers(0, 4, (30, 50)).astype(np.uint8)
    seeds = rng.integers(0, 30, (9, 2))
    values = rng.uniform(0, 9, 9)
    costs = costs_of(math.inf, 1.0, 2.0)
    order = rng.permutation(9)
    assert np.array_equal(solve(classes, costs, seeds, values), solve(classes, costs, seeds[order], values[order]))


@pytest.mark.parametrize("seed", range(6))
def test_cells_beyond_are_left_out_and_the_others_stay(seed):
    rng = np.random.default_rng(seed)
    classes = rng.integers(0, 5, (40, 60)).astype(np.uint8)
    costs = costs_of(math.inf, 1.0, 2.0, 5.0)
    classes[20, 30] = classes[5, 5] = 1
    whole = _core.eikonal_field(classes, costs, np.array([[20, 30]]), np.zeros(1), 5, 5, math.inf)
    part = _core.eikonal_field(classes, costs, np.array([[20, 30]]), np.zeros(1), 5, 5, 6.0)
    near = whole <= whole[5, 5] + 6.0
    assert np.isinf(part[whole > whole[5, 5] + 6.1]).all()
    assert np.allclose(part[near & np.isfinite(part)], whole[near & np.isfinite(part)], atol=1e-2)
    assert np.isfinite(part[whole <= whole[5, 5] + 5.9]).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"costs": np.ones(255, np.float32)}, "256"),
        ({"costs": costs_of(0.0)}, "positive"),
        ({"costs": costs_of(math.nan)}, "positive"),
        ({"costs": costs_of(1e-6)}, "10,000"),
        ({"seeds": np.array([[0, 9]])}, "outside"),
        ({"seeds": np.array([[0, 1, 2]])}, "shape"),
        ({"values": np.zeros(2)}, "value"),
        ({"values": np.array([-1.0])}, "from 0"),
        ({"values": np.array([math.nan])}, "from 0"),
        ({"row": 3}, "outside"),
        ({"col": -1}, "outside"),
        ({"beyond": math.nan}, "0 or more"),
    ],
)
def test_it_refuses_what_it_cannot_solve(change, message):
    given = {
        "classes": np.ones((3, 4), np.uint8),
        "costs": costs_of(),
        "seeds": np.array([[0, 0]]),
        "values": np.zeros(1),
        "row": 0,
        "col": 0,
        "beyond": math.inf,
    } | change
    with pytest.raises((ValueError, IndexError), match=message):
        _core.eikonal_field(**given)
