import math
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from support.grid_steps import DIAGONAL, STRAIGHT, count_steps, path_costs_from
from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.planning import Cancellation, GridSearch

METHODS = {8: ("jps", "astar"), 4: ("astar",)}
SIZES = (1, 2, 3, 7, 20, 61, 62, 63, 64, 65, 66, 126, 127, 128, 129, 190)


def make_map(rows, cols, kind, seed):
    """Random cells, boxes, rooms with doors, or clutter of 4 x 4 cells."""
    rng = np.random.default_rng(seed)
    if kind == "cells":
        return rng.random((rows, cols)) < rng.choice([0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7])
    blocked = np.zeros((rows, cols), bool)
    if kind == "boxes":
        for _ in range(rng.integers(1, max(2, rows * cols // 100))):
            row, col, (height, width) = rng.integers(rows), rng.integers(cols), rng.integers(1, 12, 2)
            blocked[row : row + height, col : col + width] = True
    elif kind == "rooms":
        for _ in range(rng.integers(0, 6)):
            blocked[rng.integers(rows)] = blocked[:, rng.integers(cols)] = True
        blocked &= rng.random((rows, cols)) < 0.93
    else:
        coarse = rng.random(((rows + 3) // 4, (cols + 3) // 4)) < rng.choice([0.1, 0.3, 0.45])
        blocked = np.kron(coarse, np.ones((4, 4)))[:rows, :cols].astype(bool)
    return blocked


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


def test_the_method_is_chosen_by_the_map():
    rng = np.random.default_rng(0)
    assert GridSearch(rng.random((200, 200)) < 0.2).method == "astar"
    assert GridSearch(rng.random((200, 200)) < 0.01).method == "jps"
    maze = np.zeros((200, 200), bool)
    maze[::2] = True
    maze[::2, 0] = False
    assert GridSearch(maze).method == "jps"
    assert GridSearch(np.zeros((5, 5), bool), 4).method == "astar"
    search = GridSearch(np.zeros((200, 200), bool))
    search.update(slice(None), slice(None), rng.random((200, 200)) < 0.2)
    assert search.method == "astar"
    search.update(slice(None), slice(None), False)
    assert search.method == "jps"
    assert search.shortest_path((0, 0), (0, 199)).length == 199


@settings(max_examples=60, deadline=None)
@given(
    rows=st.sampled_from(SIZES),
    cols=st.sampled_from(SIZES),
    kind=st.sampled_from(["cells", "boxes", "rooms"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_clutter_is_by_the_number_of_free_standing_obstacles_and_of_corners(rows, cols, kind, seed):
    blocked = make_map(rows, cols, kind, seed)
    assert GridSearch(blocked).clutter == pytest.approx(clutter_of(blocked))


def clutter_of(blocked):
    padded = np.pad(blocked, 1, constant_values=True)
    obstacles = ndimage.label(padded, np.ones((3, 3)))[1] - 1
    return np.sqrt(obstacles * corners_of(padded)) / max(1, (~blocked).sum())


def corners_of(padded):
    return (padded[1:, 1:] + 0 + padded[1:, :-1] + padded[:-1, 1:] + padded[:-1, :-1] == 1).sum()


@pytest.mark.parametrize("share", [0.06, 0.1, 0.2, 0.3, 0.35, 0.4, 0.45])
def test_random_cells_are_cluttered_also_where_obstacles_merge(share):
    assert GridSearch(np.random.default_rng(0).random((256, 256)) < share).method == "astar"


def test_a_maze_is_not_cluttered_however_many_its_corners():
    cells = 60
    blocked = np.ones((2 * cells + 1,) * 2, bool)
    blocked[1::2, 1::2] = False
    # From every cell one opening, to the row before or to the column before: a tree.
    up = np.random.default_rng(0).random((cells, cells)) < 0.5
    up[0], up[1:, 0] = False, True
    rows, cols = np.nonzero(up)
    blocked[2 * rows, 2 * cols + 1] = False
    rows, cols = np.nonzero(~up)
    blocked[2 * rows + 1, 2 * cols] = False
    padded = np.pad(blocked, 1, constant_values=True)
    assert corners_of(padded) > 0.2 * (~blocked).sum()
    assert GridSearch(blocked).method == "jps"


@settings(max_examples=60, deadline=None)
@given(
    rows=st.sampled_from(SIZES),
    cols=st.sampled_from(SIZES),
    kind=st.sampled_from(["cells", "boxes", "rooms"]),
    method=st.sampled_from(["auto", "jps", "astar"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_an_updated_search_is_a_new_one(rows, cols, kind, method, seed):
    rng = np.random.default_rng(seed)
    blocked = make_map(rows, cols, kind, seed)
    search = GridSearch(blocked, method=method)
    for _ in range(4):
        row, col = int(rng.integers(rows)), int(rng.integers(cols))
        height, width = int(rng.integers(0, rows - row + 1)), int(rng.integers(0, cols - col + 1))
        values = rng.random((height, width)) < rng.choice([0.0, 0.1, 0.5, 1.0])
        blocked[row : row + height, col : col + width] = values
        search.update(slice(row, row + height), (col, col + width), values)
        rebuilt = GridSearch(blocked, method=method)
        assert (search.clutter, search.method) == (rebuilt.clutter, rebuilt.method)
        free = np.argwhere(~blocked)
        if len(free) == 0:
            continue
        starts, goals = free[rng.integers(len(free), size=(2, 20))]
        found, expected = search.plan_many(starts, goals), rebuilt.plan_many(starts, goals)
        assert found.length.tolist() == expected.length.tolist()
        labels, _ = ndimage.label(~blocked)
        joined = labels[tuple(starts.T)] == labels[tuple(goals.T)]
        assert (found.status == "found").tolist() == joined.tolist()


@settings(max_examples=15, deadline=None)
@given(
    shape=st.sampled_from([(40, 64), (66, 30), (1, 130), (63, 63)]),
    kind=st.sampled_from(["cells", "boxes", "rooms", "coarse"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_labels_stay_right_over_many_small_changes(shape, kind, seed):
    rng = np.random.default_rng(seed)
    blocked = make_map(*shape, kind, seed)
    search = GridSearch(blocked, method="jps")
    for _ in range(60):
        row, col = (int(rng.integers(count)) for count in shape)
        place = blocked[row : row + int(rng.integers(1, 4)), col : col + int(rng.integers(1, 4))]
        place[:] = rng.random(place.shape) < rng.choice([0.0, 0.5, 1.0])
        search.update((row, row + place.shape[0]), (col, col + place.shape[1]), place)
        labels, count = ndimage.label(~blocked)
        if count == 0:
            continue
        free = np.argwhere(~blocked)
        starts, goals = free[rng.integers(len(free), size=(2, 60))]
        # From around the change, too, where labels were mended.
        near = free[np.abs(free - (row, col)).max(axis=1).argsort()[:40]]
        starts, goals = (
            np.concatenate([starts, near]),
            np.concatenate([goals, free[rng.integers(len(free), size=len(near))]]),
        )
        joined = labels[tuple(starts.T)] == labels[tuple(goals.T)]
        assert (search.plan_many(starts, goals, threads=1).status == "found").tolist() == joined.tolist()
        assert search.clutter == pytest.approx(clutter_of(blocked))


def test_a_door_that_shuts_and_opens_again():
    blocked = np.zeros((5, 9), bool)
    blocked[:, 4] = True
    search = GridSearch(blocked)
    assert search.shortest_path((0, 0), (0, 8)).status == "unreachable"
    search.update(2, 4, False)
    assert search.shortest_path((0, 0), (0, 8)).length == pytest.approx(4 + 4 * math.sqrt(2.0))
    search.update((2, 3), (4, 5), np.array([[True]]))
    assert search.shortest_path((0, 0), (0, 8)).status == "unreachable"


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


def test_searches_and_updates_from_several_threads():
    blocked = make_map(128, 200, "boxes", 2)
    free = np.argwhere(~blocked)
    starts, goals = free[np.random.default_rng(1).integers(len(free), size=(2, 200))]
    # The updates open and close a blocked cell that is walled in: no path leads there.
    blocked[10:13, 10:13] = True
    keep = ~(blocked[tuple(starts.T)] | blocked[tuple(goals.T)])
    starts, goals = starts[keep], goals[keep]
    search = GridSearch(blocked)
    expected = search.plan_many(starts, goals).length.tolist()
    wrong = []

    def ask():
        for _ in range(10):
            wrong.extend([True] * (search.plan_many(starts, goals).length.tolist() != expected))

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for turn in range(100):
        search.update(11, 11, turn % 2 == 0)
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_search_is_stopped_by_its_deadline_and_by_hand():
    rng = np.random.default_rng(0)
    blocked = rng.random((1500, 1500)) < 0.3
    labels, _ = ndimage.label(~blocked)
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


@pytest.mark.parametrize(
    ("start", "goal", "error", "cell", "words"),
    [
        ((3, 0), (0, 0), OutsideMapError, (3, 0), r"start \(3, 0\) lies outside.*rows are 0 to 2, columns 0 to 3"),
        ((0, 0), (0, -1), OutsideMapError, (0, -1), r"goal \(0, -1\) lies outside"),
        ((0, 0), (2**80, 0), OutsideMapError, (2**80, 0), "goal"),
        ((1, 1), (0, 0), BlockedPoseError, (1, 1), r"start \(1, 1\) is blocked"),
        ((0, 0), (1, 1), BlockedPoseError, (1, 1), r"goal \(1, 1\) is blocked"),
    ],
)
def test_an_end_that_cannot_be_is_a_typed_error_with_its_cell(start, goal, error, cell, words):
    blocked = np.zeros((3, 4), bool)
    blocked[1, 1] = True
    search = GridSearch(blocked)
    with pytest.raises(error, match=words) as caught:
        search.shortest_path(start, goal)
    assert caught.value.cell == cell
    if max(*start, *goal) < 2**62:
        with pytest.raises(error, match=f"query 1: the {words}") as caught:
            search.plan_many([(0, 0), start], [(0, 0), goal])
        assert caught.value.cell == cell


@pytest.mark.parametrize("cell", [(0.5, 1), "ab", (1,), (1, 2, 3), None, 7, {0, 1}, (None, 0), np.array([0.0, 1.0])])
def test_an_end_that_is_no_cell_is_an_input_error(cell):
    search = GridSearch(np.zeros((3, 4), bool))
    with pytest.raises(InputError, match="start must be a pair of integers"):
        search.shortest_path(cell, (0, 0))
    with pytest.raises(InputError, match="goal must be a pair of integers"):
        search.shortest_path((0, 0), cell)


@pytest.mark.parametrize(
    ("blocked", "options", "words"),
    [
        (np.zeros(5, bool), {}, r"shape \(rows, cols\)"),
        (np.zeros((2, 2, 2), bool), {}, r"shape \(rows, cols\)"),
        (np.zeros((0, 5), bool), {}, "at least one cell"),
        (np.zeros((2, 2)), {}, "float64"),
        (np.zeros((2, 2), np.int8), {}, "int8"),
        (np.array([["a"]]), {}, "bool or uint8"),
        ([[True], [True, False]], {}, r"shape \(rows, cols\)"),
        (np.zeros((2, 2), bool), {"connectivity": 6}, "connectivity is 4 or 8"),
        (np.zeros((2, 2), bool), {"method": "jsp"}, "method is one of"),
        (np.zeros((2, 2), bool), {"method": "jps", "connectivity": 4}, "for connectivity 8"),
        (np.zeros((2, 2), bool), {"method": "jps_plus"}, "'jps_plus' was removed; use 'jps'"),
        (np.zeros((2, 2), bool), {"landmarks": 8}, "'landmarks' was removed; leave it out"),
    ],
)
def test_a_map_that_cannot_be_searched_is_an_input_error(blocked, options, words):
    with pytest.raises(InputError, match=words):
        GridSearch(blocked, **options)


def test_a_map_of_more_than_32_bits_of_cells_is_refused():
    huge = np.broadcast_to(np.zeros(1, bool), (70_000, 70_000))
    with pytest.raises(InputError, match="2\\^32 cells"):
        GridSearch(huge)


@pytest.mark.parametrize(
    ("rows", "cols", "values", "error", "words"),
    [
        (slice(0, 4), 0, True, OutsideMapError, "rows 0:4"),
        (slice(2, 1), 0, True, OutsideMapError, "rows 2:1"),
        ((-1, 1), 0, True, OutsideMapError, "rows -1:1"),
        (0, 4, True, OutsideMapError, "cols 4:5"),
        (0, slice(0, 4, 2), True, InputError, "without gaps"),
        (0, (1, 2, 3), True, InputError, "pair"),
        (0.5, 0, True, InputError, "all whole"),
        (0, "ab", True, InputError, "cols is a slice"),
        (slice(0, 2), slice(0, 2), np.zeros((2, 3), bool), InputError, r"shape \(2, 2\), got \(2, 3\)"),
        (0, 0, 1.5, InputError, "float64"),
    ],
)
def test_an_update_that_cannot_be_is_an_error(rows, cols, values, error, words):
    with pytest.raises(error, match=words):
        GridSearch(np.zeros((3, 4), bool)).update(rows, cols, values)


@pytest.mark.parametrize(
    ("starts", "goals", "options", "words"),
    [
        ([(0, 0)], [(0, 0), (0, 1)], {}, "1 starts and 2 goals"),
        ([(0.0, 0)], [(0, 0)], {}, "starts must be integers"),
        ([(0, 0)], [(0, 0, 0)], {}, "goals must be integers"),
        ([(0, 0), (1,)], [(0, 0)], {}, "starts must be integers"),
        ([()], [], {}, "starts must be integers"),
        ([(0, 0)], [(0, 0)], {"threads": 0}, "threads"),
        ([(0, 0)], [(0, 0)], {"deadline_s": 0.0}, "deadline_s"),
        ([(0, 0)], [(0, 0)], {"deadline_s": math.nan}, "deadline_s"),
    ],
)
def test_queries_that_cannot_be_are_an_input_error(starts, goals, options, words):
    with pytest.raises(InputError, match=words):
        GridSearch(np.zeros((3, 4), bool)).plan_many(starts, goals, **options)


@pytest.mark.parametrize("options", [{"deadline_s": "soon"}, {"cancel": threading.Event()}, {"deadline_s": -1}])
def test_limits_that_are_none_are_an_input_error(options):
    with pytest.raises(InputError, match="must be a"):
        GridSearch(np.zeros((3, 4), bool)).shortest_path((0, 0), (0, 1), **options)


def test_a_deadline_of_zero_is_an_input_error():
    with pytest.raises(InputError, match="positive number of seconds, got 0"):
        GridSearch(np.zeros((3, 4), bool)).shortest_path((0, 0), (0, 1), deadline_s=0)
