import math
import random

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzz.fuzz_least_cost import one_round
from support.grid_graph import cheapest_costs
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

    Lines along a border take the higher cost of both cells; blocked cells and the corners are left out. So the result
    is slightly above the optimum, and never below.
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
    # Two points of one border are joined through both cells: the higher cost counts.
    order = np.lexsort((lengths, b, a))
    last = np.append((np.diff(a[order]) != 0) | (np.diff(b[order]) != 0), True)
    graph = scipy.sparse.coo_matrix(
        (lengths[order][last], (a[order][last], b[order][last])), shape=(len(points),) * 2
    ).tocsr()
    return float(scipy.sparse.csgraph.dijkstra(graph, indices=0)[1])


def find(costs, start, goal, weights=WEIGHTS, ends=None, **limits):
    """Status, points and cost of the path between the centres of two cells, or between points in them."""
    if ends is None:
        ends = np.array([(start[1] + 0.5, start[0] + 0.5), (goal[1] + 0.5, goal[0] + 0.5)])
    return _core.LeastCost(weights).find(costs, start, goal, ends, *limits.values())


def octile_optimum(costs, start, goal, weights=WEIGHTS):
    wall = weights[costs] == 0.0
    return cheapest_costs(weights[costs], wall, [start])[goal]


@settings(max_examples=150, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    rows=st.integers(1, 40),
    cols=st.integers(1, 40),
    rough=st.booleans(),
    neutral_and_factor=st.sampled_from([(50.0, 0.8), (1.0, 0.0), (1.0, 39.0), (10_000.0, 0.0)]),
)
def test_the_path_is_free_its_cost_is_right_and_no_higher_than_by_centres(seed, rows, cols, rough, neutral_and_factor):
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 256, (rows, cols)).astype(np.uint8) if rough else smooth_costs(rows, cols, seed)
    weights = make_weights(*neutral_and_factor)
    free = np.argwhere(costs < 253)
    if len(free) == 0:
        return
    start, goal = (tuple(int(v) for v in cell) for cell in rng.choice(free, 2))
    status, points, cost = find(costs, start, goal, weights)
    expected = octile_optimum(costs, start, goal, weights)
    assert (status == 0) == math.isfinite(expected)
    if status != 0:
        assert (status, len(points), cost) == (1, 0, 0.0)
        return
    assert points[0].tolist() == [start[1] + 0.5, start[0] + 0.5]
    assert points[-1].tolist() == [goal[1] + 0.5, goal[0] + 0.5]
    pieces = _core.line_costs(costs, weights, points[:-1].copy(), points[1:].copy())
    assert cost == pytest.approx(pieces.sum(), rel=1e-12)
    assert cost <= expected * 1.002
    assert cost >= math.dist(points[0], points[-1]) * weights[0] * (1 - 1e-12)
    _, back, same = find(costs, goal, start, weights)
    assert np.array_equal(back[::-1], points)
    assert same == cost


@pytest.mark.parametrize("seed", range(12))
def test_a_small_map_is_crossed_nearly_as_cheaply_as_brute_force_finds(seed):
    costs = smooth_costs(24, 24, seed, blocks=3)
    start, goal = (2, 2), (21, 20)
    costs[start] = costs[goal] = 0
    _, _, cost = find(costs, start, goal)
    best = cheapest_by_brute_force(costs, (start[1] + 0.5, start[0] + 0.5), (goal[1] + 0.5, goal[0] + 0.5))
    # Costs fall by a fifth from cell to cell here, and paths are short: the wavefront is at its worst.
    assert cost <= best * 1.012


def test_of_two_detours_the_shorter_is_taken_where_octile_lengths_take_the_longer():
    # On the left it is 300 cells up and 124 across, at 22.5°; the gap on the right costs 2 % more than that.
    costs = np.zeros((320, 420), np.uint8)
    costs[150, 100:384] = 254
    start, goal = (20, 250), (280, 242)
    _, points, cost = find(costs, start, goal)
    left = (math.dist((250.5, 20.5), (100, 150)) + 1.0 + math.dist((100, 151), (242.5, 280.5))) * 50.0
    right = (math.dist((250.5, 20.5), (384, 150)) + 1.0 + math.dist((384, 151), (242.5, 280.5))) * 50.0
    assert min(left, right) <= cost <= min(left, right) * 1.003
    assert (points[:, 0].max() > 380) == (right < left)


def test_a_straight_line_where_all_costs_are_alike_is_one():
    costs = np.full((30, 50), 7, np.uint8)
    _, points, cost = find(costs, (2, 1), (25, 47))
    assert cost == pytest.approx(WEIGHTS[7] * math.hypot(46, 23), rel=1e-4)
    assert np.abs((points[:, 1] - 2.5) * 46 - (points[:, 0] - 1.5) * 23).max() < 0.5 * math.hypot(46, 23)


def test_a_cheap_lane_is_used_from_beside_it():
    ys = np.arange(41)
    costs = np.repeat(np.minimum(8 * np.abs(ys - 20), 200).astype(np.uint8)[:, None], 101, axis=1)
    _, points, cost = find(costs, (24, 2), (24, 98))
    middle = points[(points[:, 0] > 40) & (points[:, 0] < 60)]
    assert cost < 0.8 * line_costs(costs, [(2.5, 24.5), (98.5, 24.5)]).sum()
    assert (np.abs(middle[:, 1] - 20.5) < 0.6).all()


def test_a_path_round_the_end_of_a_wall_does_not_enter_it():
    costs = np.zeros((30, 30), np.uint8)
    costs[0:15, 15] = 254
    _, points, cost = find(costs, (4, 4), (4, 26))
    by_corners = math.dist((4.5, 4.5), (15, 15)) + 1.0 + math.dist((16, 15), (26.5, 4.5))
    assert np.isfinite(line_costs(costs, points)).all()
    assert 50.0 * by_corners <= cost <= 50.0 * by_corners * 1.01


def test_a_gap_of_one_cell_is_found_in_a_wall_of_one_cell():
    costs = np.zeros((200, 200), np.uint8)
    costs[100, :] = 254
    costs[100, 171] = 252
    status, points, cost = find(costs, (10, 10), (190, 10))
    straight = math.dist((10.5, 10.5), (171.5, 100.5)) + math.dist((171.5, 100.5), (10.5, 190.5))
    assert status == 0
    assert cost <= 50.0 * straight + WEIGHTS[252] * 2
    assert (np.abs(points[:, 0] - 171.5) < 0.5).any()


def test_a_gap_that_coarse_blocks_hide_is_found():
    # A diagonal wall that is two cells thick: every block of 4 x 4 beside it has open cells.
    costs = np.zeros((240, 240), np.uint8)
    rows = np.arange(240)
    for off in (0, 1):
        costs[rows, np.clip(rows + off, 0, 239)] = 254
    costs[230, 225:240] = 0
    costs[230, 230:232] = 254
    status, _, cost = find(costs, (10, 30), (30, 10))
    assert (status == 0) == math.isfinite(octile_optimum(costs, (10, 30), (30, 10)))
    costs[120, 118:124] = 0
    status, points, cost = find(costs, (10, 30), (30, 10))
    assert status == 0
    assert cost <= octile_optimum(costs, (10, 30), (30, 10))
    assert np.isfinite(line_costs(costs, points)).all()


def test_ends_are_points_in_their_cells():
    costs = np.zeros((20, 20), np.uint8)
    ends = np.array([(2.0, 3.9), (15.25, 17.0)])
    status, points, cost = find(costs, (3, 2), (17, 15), ends=ends)
    assert status == 0
    assert np.array_equal(points[[0, -1]], ends)
    assert cost == pytest.approx(50.0 * math.dist(*ends), rel=1e-3)
    same_cell = np.array([(2.25, 3.5), (2.75, 3.5)])
    assert find(costs, (3, 2), (3, 2), ends=same_cell)[2] == 25.0


def test_weights_so_different_that_single_precision_would_not_do():
    costs = np.full((300, 300), 252, np.uint8)
    costs[150:, :] = 0
    weights = make_weights(1.0, 0.0)
    weights[252] = 1e6
    start, goal = (0, 10), (280, 290)
    status, _, cost = find(costs, start, goal, weights)
    assert status == 0
    assert cost <= octile_optimum(costs, start, goal, weights) * (1 + 1e-5)


def test_a_blocked_end_has_no_path_and_a_cell_to_itself_costs_nothing():
    costs = np.zeros((4, 4), np.uint8)
    costs[2, 2] = 253
    assert find(costs, (0, 0), (2, 2))[0] == 1
    assert find(costs, (2, 2), (0, 0))[0] == 1
    status, points, cost = find(costs, (1, 1), (1, 1))
    assert (status, cost) == (0, 0.0)
    assert points.tolist() == [[1.5, 1.5], [1.5, 1.5]]


def test_it_stops_by_a_deadline_and_by_a_flag():
    costs = np.zeros((300, 300), np.uint8)
    assert find(costs, (0, 0), (299, 299), seconds=1e-9)[0] == 2
    flag = np.ones(1, np.uint8)
    assert find(costs, (0, 0), (299, 299), seconds=None, cancel=flag)[0] == 3
    flag[0] = 0
    assert find(costs, (0, 0), (299, 299), seconds=1e3, cancel=flag)[0] == 0


def test_memory_is_kept_from_one_map_to_another():
    kernel = _core.LeastCost(WEIGHTS)
    assert kernel.bytes == 0
    rng = np.random.default_rng(5)
    for rows, cols in ((30, 200), (200, 30), (7, 7), (90, 90)):
        costs = smooth_costs(rows, cols, rows)
        start, goal = (tuple(int(v) for v in cell) for cell in rng.choice(np.argwhere(costs < 253), 2))
        ends = np.array([start[::-1], goal[::-1]]) + 0.5
        kept, fresh = kernel.find(costs, start, goal, ends), find(costs, start, goal)
        assert kept[0] == fresh[0]
        assert np.array_equal(kept[1], fresh[1])
    assert kernel.bytes > 0


def test_bad_arguments_are_refused():
    costs = np.zeros((3, 4), np.uint8)
    with pytest.raises(IndexError):
        find(costs, (0, 0), (3, 0))
    with pytest.raises(IndexError):
        find(costs, (0, -1), (0, 0))
    with pytest.raises(ValueError, match="256"):
        _core.LeastCost(WEIGHTS[:255].copy())
    with pytest.raises(ValueError, match=r"0\.001"):
        _core.LeastCost(-WEIGHTS)
    with pytest.raises(ValueError, match="finite"):
        find(costs, (0, 0), (0, 1), ends=np.full((2, 2), math.nan))
    with pytest.raises(ValueError, match=r"\(2, 2\)"):
        find(costs, (0, 0), (0, 1), ends=np.zeros((3, 2)))


def test_the_descent_reaches_the_start_where_triangles_point_in_a_ring():
    one_round(random.Random(10605))
