import math
import threading

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from support.binary_maps import SIZES, make_map
from support.grid_steps import DIAGONAL, STRAIGHT, count_steps, path_costs_from
from trundle.planning import Cancellation, GridSearch

METHODS = {8: ("jps", "astar"), 4: ("astar",)}


def check_queries(blocked, connectivity, seed, count=25):
    """Check paths from one cell to many, of every method, against Dijkstra's."""
    free = np.argwhere(~blocked)
    if len(free) == 0:
        return
    rng = np.random.default_rng(seed)
    start = tuple(free[rng.integers(len(free))].tolist())
    goals = [tuple(cell) for cell in free[rng.integers(len(free), size=count)].tolist()]
    costs = path_costs_from(blocked, start, connectivity)
    for method in METHODS[connectivity]:
        search = GridSearch(blocked, connectivity, method=method)
        assert search.method == method
        for goal in goals:
            path, back = search.shortest_path(start, goal), search.shortest_path(goal, start)
            assert back.length == path.length
            if np.isinf(costs[goal]):
                assert (path.status, path.length, len(path.cells)) == ("unreachable", math.inf, 0)
                continue
            straight, diagonal = count_steps(blocked, path, start, goal, connectivity)
            assert straight * STRAIGHT + diagonal * DIAGONAL == costs[goal]
            assert path.length == pytest.approx(straight + diagonal * math.sqrt(2.0), abs=1e-9)
            assert np.array_equal(back.waypoints, path.waypoints[::-1])


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(
    rows=st.sampled_from(SIZES) | st.integers(1, 40),
    cols=st.sampled_from(SIZES) | st.integers(1, 40),
    kind=st.sampled_from(["cells", "boxes", "rooms", "coarse"]),
    connectivity=st.sampled_from([8, 8, 4]),
    seed=st.integers(0, 2**32 - 1),
)
def test_path_costs_are_dijkstras_in_both_directions(rows, cols, kind, connectivity, seed):
    check_queries(make_map(rows, cols, kind, seed), connectivity, seed)


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (300, 1), (2, 257), (63, 64), (65, 62), (64, 127), (190, 190)])
def test_path_costs_are_dijkstras_on_odd_sizes(shape):
    for seed in range(6):
        for kind in ("cells", "boxes", "rooms", "coarse"):
            check_queries(make_map(*shape, kind, seed), 8, seed, count=10)


@pytest.mark.slow
def test_path_costs_from_and_to_every_corner_and_border_cell():
    blocked = make_map(9, 70, "boxes", 3)
    border = [(r, c) for r in range(9) for c in range(70) if (r in (0, 8) or c in (0, 69)) and not blocked[r, c]]
    searches = [GridSearch(blocked, method=method) for method in METHODS[8]]
    for start in border[::5]:
        costs = path_costs_from(blocked, start)
        for search in searches:
            for goal in border:
                expected = costs[goal]
                path = search.shortest_path(start, goal)
                if np.isinf(expected):
                    assert path.status == "unreachable"
                else:
                    straight, diagonal = count_steps(blocked, path, start, goal)
                    assert straight * STRAIGHT + diagonal * DIAGONAL == expected


def test_an_empty_map_is_crossed_by_the_octile_distance():
    path = GridSearch(np.zeros((100, 300), bool)).shortest_path((0, 0), (99, 299))
    assert path.status == "found"
    assert path.length == pytest.approx(200 + 99 * math.sqrt(2.0))
    assert len(path.waypoints) == 3
    assert path.cells.shape == (300, 2)


def test_corners_are_not_cut_nor_diagonal_blocks_passed():
    search = GridSearch(np.array([[0, 1], [0, 0]], np.uint8))
    assert search.shortest_path((0, 0), (1, 1)).waypoints.tolist() == [[0, 0], [1, 0], [1, 1]]
    assert GridSearch(np.array([[0, 1], [1, 0]], np.uint8)).shortest_path((0, 0), (1, 1)).status == "unreachable"


@pytest.mark.parametrize("connectivity", [4, 8])
def test_start_is_goal(connectivity):
    for method in METHODS[connectivity]:
        path = GridSearch(np.zeros((3, 4), bool), connectivity, method=method).shortest_path((2, 1), (2, 1))
        assert (path.status, path.length) == ("found", 0.0)
        assert path.waypoints.tolist() == path.cells.tolist() == [[2, 1]]


def test_a_path_cost_above_32_bits_is_exact():
    blocked = np.zeros((1201, 1501), bool)
    blocked[1::4, :-1] = blocked[3::4, 1:] = True
    lengths = [GridSearch(blocked, method=method).shortest_path((0, 0), (1200, 0)).length for method in METHODS[8]]
    assert lengths == [601 * 1500 + 1200 - 1500] * len(METHODS[8])
    assert lengths[0] * STRAIGHT > 2**32


def test_views_and_masks_are_read_as_they_lie():
    rng = np.random.default_rng(5)
    base = (rng.random((150, 260)) < 0.1).astype(np.uint8) * 200
    frozen = base.copy()
    frozen.flags.writeable = False
    for view in (base, base[::-1, ::-1], base.T, base[::2, 1::3], np.asfortranarray(base), frozen, base != 0):
        plain = np.ascontiguousarray(view != 0)
        start, goal = (tuple(cell) for cell in np.argwhere(~plain)[[0, -1]].tolist())
        expected = GridSearch(plain).shortest_path(start, goal)
        assert GridSearch(view).shortest_path(start, goal) == expected
        search = GridSearch(np.ones(view.shape, bool))
        search.update(slice(None), slice(None), view)
        assert search.shortest_path(start, goal) == expected


def test_the_map_is_not_kept():
    blocked = np.zeros((4, 4), bool)
    search = GridSearch(blocked)
    blocked[:, 2] = True
    assert search.shortest_path((0, 0), (0, 3)).length == 3


def test_many_queries_are_the_single_ones():
    blocked = make_map(190, 129, "rooms", 11)
    free = np.argwhere(~blocked)
    starts, goals = free[np.random.default_rng(1).integers(len(free), size=(2, 300))]
    search = GridSearch(blocked)
    single = [search.shortest_path(start, goal) for start, goal in zip(starts, goals, strict=True)]
    for threads in (1, 2, 5):
        many = search.plan_many(starts, goals, threads=threads)
        assert list(many) == single
        assert [many[i] for i in range(-300, 0)] == single
        assert many[7:11] == single[7:11]
        assert many.status.tolist() == [path.status for path in single]
    assert len(search.plan_many(np.empty((0, 2), int), [])) == 0
    with pytest.raises(IndexError, match="300"):
        many[300]


def test_a_search_is_stopped_by_its_deadline_and_by_hand():
    rng = np.random.default_rng(0)
    blocked = rng.random((1500, 1500)) < 0.3
    labels, _ = scipy.ndimage.label(~blocked)
    component = np.argwhere(labels == np.bincount(labels[labels > 0]).argmax())
    start, goal = component[0], component[-1]
    for method in METHODS[8]:
        search = GridSearch(blocked, method=method)
        path = search.shortest_path(start, goal, deadline_s=1e-9)
        assert (path.status, len(path.waypoints)) == ("timeout", 0)
        assert math.isnan(path.length)
        assert math.isnan(search.plan_many([start], [goal], deadline_s=1e-9).length[0])
        cancel = Cancellation()
        assert search.shortest_path(start, goal, deadline_s=1e6, cancel=cancel).status == "found"
        cancel.cancel()
        assert cancel.cancelled
        assert search.shortest_path(start, goal, cancel=cancel).status == "cancelled"
        assert search.plan_many([start, start], [goal, goal], cancel=cancel).status.tolist() == ["cancelled"] * 2


def test_a_running_batch_is_cancelled_from_another_thread():
    rng = np.random.default_rng(0)
    blocked = rng.random((600, 600)) < 0.2
    free = np.argwhere(~blocked)
    starts, goals = free[rng.integers(len(free), size=(2, 200_000))]
    cancel = Cancellation()
    timer = threading.Timer(0.05, cancel.cancel)
    timer.start()
    paths = GridSearch(blocked).plan_many(starts, goals, cancel=cancel)
    timer.join()
    assert "cancelled" in paths.status
