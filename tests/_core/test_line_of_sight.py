import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle import _core


def make_weights(neutral=50.0, factor=0.8):
    weights = neutral + factor * np.arange(256)
    weights[253:] = 0.0
    return weights


def make_costs(rows, cols, density, seed):
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 253, (rows, cols)).astype(np.uint8)
    costs[rng.random((rows, cols)) < density] = 254
    return costs


def line_cost(costs, a, b, weights=None):
    weights = make_weights() if weights is None else weights
    return _core.line_costs(costs, weights, np.array([a], float), np.array([b], float))[0]


def oracle(costs, a, b):
    """The integral by shapely: the length in each cell's square times its weight."""
    weights = make_weights()[costs]
    line = shapely.LineString([a, b])
    rows, cols = np.mgrid[0 : costs.shape[0], 0 : costs.shape[1]]
    lengths = shapely.length(shapely.intersection(line, shapely.box(cols, rows, cols + 1, rows + 1)))
    if (lengths[weights == 0] > 1e-9).any():
        return math.inf
    return float((lengths * weights).sum())


@settings(max_examples=150, deadline=None)
@given(
    points=st.tuples(*[st.floats(0.1, 11.9)] * 4),
    density=st.sampled_from([0.0, 0.02, 0.1]),
    seed=st.integers(0, 10_000),
)
def test_line_costs_are_the_integral(points, density, seed):
    costs = make_costs(12, 12, density, seed)
    a, b = points[:2], points[2:]
    if any(abs(value - round(value)) < 1e-6 for value in points):
        return
    expected = oracle(costs, a, b)
    cost = line_cost(costs, a, b)
    # A line that passes a corner within rounding may be refused; none that is blocked may pass.
    if not (math.isinf(cost) and math.isfinite(expected)):
        assert cost == pytest.approx(expected, rel=1e-9, abs=1e-6)
    assert line_cost(costs, b, a) == pytest.approx(cost, rel=1e-9, abs=1e-6)


@settings(max_examples=150, deadline=None)
@given(cells=st.tuples(*[st.integers(0, 11)] * 4), density=st.sampled_from([0.0, 0.05, 0.2]), seed=st.integers(0, 999))
def test_line_costs_between_centres(cells, density, seed):
    costs = make_costs(12, 12, density, seed)
    a, b = (cells[0] + 0.5, cells[1] + 0.5), (cells[2] + 0.5, cells[3] + 0.5)
    costs[cells[1], cells[0]] = costs[cells[3], cells[2]] = 0
    line = shapely.LineString([a, b])
    rows, cols = np.nonzero(costs == 254)
    touched = shapely.intersects(shapely.box(cols, rows, cols + 1, rows + 1), line).any()
    cost = line_cost(costs, a, b)
    assert math.isinf(cost) == bool(touched)
    if not touched:
        assert cost == pytest.approx(oracle(costs, a, b), rel=1e-9, abs=1e-6)


def test_a_line_through_a_corner_needs_all_four_cells():
    costs = np.zeros((2, 2), np.uint8)
    assert line_cost(costs, (0.5, 0.5), (1.5, 1.5)) == pytest.approx(50 * math.sqrt(2))
    costs[0, 1] = 254
    assert math.isinf(line_cost(costs, (0.5, 0.5), (1.5, 1.5)))
    assert math.isinf(line_cost(costs, (1.5, 1.5), (0.5, 0.5)))


def test_a_line_along_a_border_takes_the_cell_of_higher_cost():
    costs = np.zeros((2, 3), np.uint8)
    costs[1, 1] = 100
    assert line_cost(costs, (0.0, 1.0), (3.0, 1.0)) == pytest.approx(50 + 130 + 50)
    assert line_cost(costs.T.copy(), (1.0, 0.5), (1.0, 3.0)) == pytest.approx(25 + 130 + 50)
    costs[0, 2] = 254
    assert math.isinf(line_cost(costs, (3.0, 1.0), (0.0, 1.0)))


def test_a_point_costs_nothing_and_outside_is_blocked():
    costs = np.zeros((2, 3), np.uint8)
    assert line_cost(costs, (1.5, 0.5), (1.5, 0.5)) == 0.0
    assert math.isinf(line_cost(costs, (0.5, 0.5), (3.5, 0.5)))
    assert math.isinf(line_cost(costs, (-0.5, 0.5), (1.5, 0.5)))
    assert math.isinf(line_cost(costs, (0.0, 0.0), (3.0, 0.0)))


def chain_cost(costs, points):
    return sum(line_cost(costs, a, b) for a, b in itertools.pairwise(points.tolist()))


@pytest.mark.parametrize("seed", range(30))
def test_shortcut_is_the_cheapest_chain(seed):
    rng = np.random.default_rng(seed)
    costs = make_costs(14, 14, 0.08, seed)
    points = rng.integers(0, 14, (8, 2)) + 0.5
    costs[np.floor(points[:, 1]).astype(int), np.floor(points[:, 0]).astype(int)] = 0
    chosen, cost = _core.shortcut(costs, make_weights(), points)
    best = min(
        chain_cost(costs, points[[0, *inner, 7]])
        for count in range(7)
        for inner in itertools.combinations(range(1, 7), count)
    )
    if math.isinf(best):
        assert len(chosen) == 0
        assert math.isinf(cost)
    else:
        assert cost == pytest.approx(best)
        assert chain_cost(costs, points[chosen]) == pytest.approx(best)
        assert (chosen[0], chosen[-1]) == (0, 7)


def test_a_free_staircase_becomes_one_line():
    costs = np.zeros((20, 40), np.uint8)
    cells, _ = _core.grid_search(costs, make_weights().astype(np.uint16), (2, 3), (15, 37))
    points = np.ascontiguousarray(cells[:, ::-1] + 0.5)
    chosen, cost = _core.shortcut(costs, make_weights(), points)
    assert chosen.tolist() == [0, len(points) - 1]
    assert cost == pytest.approx(50 * math.hypot(13, 34))


def test_points_on_a_straight_line_are_left_out():
    points = np.column_stack([np.arange(0.5, 30.0), np.full(30, 0.5)])
    chosen, _ = _core.shortcut(np.zeros((1, 30), np.uint8), make_weights(), points)
    assert chosen.tolist() == [0, 29]


def test_a_path_there_and_back_keeps_its_turning_point():
    costs = np.zeros((3, 9), np.uint8)
    costs[1, :8] = 254
    points = np.array([(0.5, 0.5), (4.5, 0.5), (8.5, 0.5), (8.5, 1.5), (8.5, 2.5), (4.5, 2.5), (0.5, 2.5)])
    chosen, cost = _core.shortcut(costs, make_weights(), points)
    assert chosen.tolist() == [0, 2, 4, 6]
    assert cost == pytest.approx(50 * 18)


def test_a_path_there_and_back_to_the_same_point_on_the_maps_edge_keeps_its_turning_point():
    # A line of no length along the edge is blocked, as one of any length is.
    points = np.array([(0.5, 0.0), (0.5, 0.5), (0.5, 0.0)])
    chosen, cost = _core.shortcut(np.zeros((1, 1), np.uint8), make_weights(), points)
    assert chosen.tolist() == [0, 1, 2]
    assert cost == pytest.approx(50.0)


def test_a_single_point_is_a_chain():
    chosen, cost = _core.shortcut(np.zeros((2, 2), np.uint8), make_weights(), np.array([[0.5, 0.5]]))
    assert chosen.tolist() == [0]
    assert cost == 0.0


def test_bad_arguments_are_refused():
    costs, weights = np.zeros((3, 4), np.uint8), make_weights()
    with pytest.raises(ValueError, match="finite"):
        _core.shortcut(costs, weights, np.array([[0.5, math.nan], [0.5, 0.5]]))
    with pytest.raises(ValueError, match="needs a point"):
        _core.shortcut(costs, weights, np.empty((0, 2)))
    with pytest.raises(ValueError, match="256"):
        _core.shortcut(costs, weights[:3].copy(), np.array([[0.5, 0.5]]))
    with pytest.raises(ValueError, match="as many"):
        _core.line_costs(costs, weights, np.array([[0.5, 0.5]]), np.empty((0, 2)))
