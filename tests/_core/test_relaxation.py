import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import dijkstra

from trundle import _core


def make_weights(neutral=50.0, factor=0.8):
    weights = neutral + factor * np.arange(256)
    weights[253:] = 0.0
    return weights


WEIGHTS = make_weights()


def line_costs(costs, points):
    points = np.asarray(points, float)
    return _core.line_costs(costs, WEIGHTS, np.ascontiguousarray(points[:-1]), np.ascontiguousarray(points[1:]))


def smooth_costs(rows, cols, seed, blocks=4):
    """Costs that fall off around blocked places, as inflation makes them."""
    rng = np.random.default_rng(seed)
    ys, xs = np.mgrid[0:rows, 0:cols]
    away = np.full((rows, cols), np.inf)
    for _ in range(blocks):
        y, x, radius = rng.uniform(0, rows), rng.uniform(0, cols), rng.uniform(0.5, 3)
        away = np.minimum(away, np.hypot(ys - y, xs - x) - radius)
    return np.where(away <= 0, 254, 252 * np.exp(-0.2 * np.maximum(away, 0))).astype(np.uint8)


def cheapest_by_brute_force(costs, start, goal, parts=6):
    """Cost of the cheapest chain of straight lines within cells between points of their borders, `parts` to an edge.

    Lines along a border take the dearer cell, blocked cells are left out, and so are the corners: this is a little
    dearer than the optimum, and never cheaper.
    """
    rows, cols = costs.shape
    ts = (np.arange(parts) + 0.5) / parts
    points = [start, goal]
    on_cell = {(r, c): [] for r in range(rows) for c in range(cols)}
    for r in range(rows):
        for c in range(cols):
            for t in ts:
                for point, other in (((c + 1, r + t), (r, c + 1)), ((c + t, r + 1), (r + 1, c))):
                    if other in on_cell:
                        on_cell[r, c].append(len(points))
                        on_cell[other].append(len(points))
                        points.append(point)
    for index, (x, y) in ((0, start), (1, goal)):
        on_cell[int(y), int(x)].append(index)
    points = np.array(points)

    edges = []
    for cell, members in on_cell.items():
        if WEIGHTS[costs[cell]] == 0:
            continue
        a, b = (grid.ravel() for grid in np.meshgrid(members, members))
        keep = a != b
        a, b = a[keep], b[keep]
        edges.append((a, b, WEIGHTS[costs[cell]] * np.hypot(*(points[a] - points[b]).T)))
    a, b, lengths = (np.concatenate(column) for column in zip(*edges, strict=True))
    # Two points of one border are joined through both cells: the dearer counts.
    order = np.lexsort((lengths, b, a))
    last = np.append((np.diff(a[order]) != 0) | (np.diff(b[order]) != 0), True)
    graph = coo_matrix((lengths[order][last], (a[order][last], b[order][last])), shape=(len(points),) * 2).tocsr()
    return float(dijkstra(graph, indices=0)[1])


def planned(costs, start, goal):
    """Grid path (x, y), its shortcut, and that relaxed with what it costs."""
    search = np.floor(WEIGHTS).astype(np.uint16)
    cells = _core.grid_search(costs, search, start, goal)[0]
    if len(cells) == 0:
        return None
    points = cells[:, ::-1].astype(np.float64) + 0.5
    chosen, cost = _core.shortcut(costs, WEIGHTS, points)
    return points, points[chosen], cost, *_core.relax(costs, WEIGHTS, points[chosen])


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rough=st.booleans())
def test_the_line_gets_no_dearer_stays_free_and_keeps_its_ends(seed, rough):
    rng = np.random.default_rng(seed)
    rows, cols = rng.integers(3, 40, 2)
    costs = rng.integers(0, 256, (rows, cols)).astype(np.uint8) if rough else smooth_costs(rows, cols, seed)
    free = np.argwhere(costs < 253)
    if len(free) < 2:
        return
    start, goal = (tuple(int(v) for v in cell) for cell in rng.choice(free, 2, replace=False))
    plan = planned(costs, start, goal)
    if plan is None:
        return
    grid_path, straight, before, relaxed, cost = plan
    assert cost <= before * (1 + 1e-12)
    assert cost <= line_costs(costs, grid_path).sum() * (1 + 1e-12)
    assert cost == pytest.approx(line_costs(costs, relaxed).sum(), rel=1e-12)
    assert math.isfinite(cost)
    assert np.array_equal(relaxed[[0, -1]], straight[[0, -1]])
    again, same = _core.relax(costs, WEIGHTS, straight)
    assert np.array_equal(again, relaxed)
    assert same == cost


@pytest.mark.parametrize("seed", range(8))
def test_a_small_map_is_crossed_nearly_as_cheaply_as_brute_force_finds(seed):
    costs = smooth_costs(24, 24, seed, blocks=3)
    start, goal = (2, 2), (21, 20)
    costs[start] = costs[goal] = 0
    plan = planned(costs, start, goal)
    assert plan is not None
    _, straight, before, _, cost = plan
    best = cheapest_by_brute_force(costs, (start[1] + 0.5, start[0] + 0.5), (goal[1] + 0.5, goal[0] + 0.5))
    assert cost <= before
    assert cost <= best * 1.004
    _, back = _core.relax(costs, WEIGHTS, np.ascontiguousarray(straight[::-1]))
    assert back == pytest.approx(cost, rel=0.002)


def test_a_straight_line_where_all_costs_are_alike_stays_one():
    costs = np.full((30, 50), 7, np.uint8)
    line = np.array([(1.5, 2.5), (47.5, 25.5)])
    relaxed, cost = _core.relax(costs, WEIGHTS, line)
    assert np.array_equal(relaxed, line)
    assert cost == pytest.approx(WEIGHTS[7] * math.hypot(46, 23))


def test_a_detour_through_even_ground_is_pulled_straight():
    costs = np.zeros((40, 40), np.uint8)
    bent = np.array([(1.5, 20.5), (20.5, 23.5), (38.5, 20.5)])
    relaxed, cost = _core.relax(costs, WEIGHTS, bent)
    assert cost <= 50.0 * 37.0 * (1 + 1e-4)
    assert np.abs(relaxed[:, 1] - 20.5).max() < 0.5


def test_a_cheap_lane_is_found_from_beside_it():
    ys = np.arange(41)
    costs = np.repeat(np.minimum(8 * np.abs(ys - 20), 200).astype(np.uint8)[:, None], 101, axis=1)
    straight = np.array([(2.5, 24.5), (98.5, 24.5)])
    relaxed, cost = _core.relax(costs, WEIGHTS, straight)
    before = line_costs(costs, straight).sum()
    middle = relaxed[(relaxed[:, 0] > 40) & (relaxed[:, 0] < 60)]
    assert cost < 0.8 * before
    assert (np.abs(middle[:, 1] - 20.5) < 0.6).all()


def test_a_vertex_at_a_corner_of_a_wall_does_not_enter_it():
    costs = np.zeros((30, 30), np.uint8)
    costs[0:15, 15] = 254
    around = np.array([(4.5, 4.5), (15.5, 18.5), (26.5, 4.5)])
    relaxed, cost = _core.relax(costs, WEIGHTS, around)
    by_corners = math.dist((4.5, 4.5), (15, 15)) + 1.0 + math.dist((16, 15), (26.5, 4.5))
    assert np.isfinite(line_costs(costs, relaxed)).all()
    assert 50.0 * by_corners <= cost <= 50.0 * by_corners * 1.02


def test_a_blocked_line_is_given_back_as_it_was():
    costs = np.zeros((10, 10), np.uint8)
    costs[:, 5] = 253
    line = np.array([(1.5, 1.5), (8.5, 8.5)])
    relaxed, cost = _core.relax(costs, WEIGHTS, line)
    assert np.array_equal(relaxed, line)
    assert math.isinf(cost)


def test_one_point_costs_nothing_and_none_is_refused():
    costs = np.zeros((4, 4), np.uint8)
    relaxed, cost = _core.relax(costs, WEIGHTS, np.array([(1.5, 1.5)]))
    assert relaxed.tolist() == [[1.5, 1.5]]
    assert cost == 0.0
    with pytest.raises(ValueError, match="a path needs a point"):
        _core.relax(costs, WEIGHTS, np.empty((0, 2)))
    with pytest.raises(ValueError, match="finite"):
        _core.relax(costs, WEIGHTS, np.array([(1.5, math.nan), (2.0, 2.0)]))
    with pytest.raises(ValueError, match="256"):
        _core.relax(costs, WEIGHTS[:5].copy(), np.array([(1.5, 1.5)]))
