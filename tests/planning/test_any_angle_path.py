import itertools
import math
import threading

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.visibility import is_free_line, visibility_lengths
from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.planning import Cancellation, GridSearch, any_angle_path

ROOT_2 = math.sqrt(2.0)


def grid_of(picture):
    """Of '#' and '.', the first line being the highest row."""
    return np.array([[cell == "#" for cell in line] for line in picture.split()])[::-1]


def check_path(blocked, path, start, goal):
    """Its ends, its length, and that every part of it is free."""
    points = path.waypoints
    assert path.status == "found"
    assert points.dtype == np.float64
    assert tuple(points[0]) == tuple(start)
    assert tuple(points[-1]) == tuple(goal)
    assert path.length == pytest.approx(np.hypot(*np.diff(points, axis=0).T).sum(), rel=1e-13)
    for a, b in itertools.pairwise(points):
        assert not np.array_equal(a, b)
        assert is_free_line(blocked, a + 0.5, b + 0.5), (a, b)


def draw_cells(blocked, rng, count):
    free = [tuple(cell) for cell in np.argwhere(~blocked).tolist()]
    return [free[i] for i in rng.integers(len(free), size=count)] if free else []


def check_map(blocked, rng, goals=4):
    start, *chosen = draw_cells(blocked, rng, goals + 1) or [None]
    search = GridSearch(blocked)
    for goal, expected in zip(chosen, visibility_lengths(blocked, start, chosen) if chosen else [], strict=True):
        path = search.any_angle_path(start, goal)
        assert path.length == pytest.approx(expected, rel=1e-12), (blocked.astype(int).tolist(), start, goal)
        if path.status == "found":
            check_path(blocked, path, start, goal)


# Expected paths, by hand.


def test_an_empty_map_is_crossed_in_a_straight_line():
    path = any_angle_path(np.zeros((40, 90), bool), (0, 3), (39, 88))
    assert path.length == pytest.approx(math.hypot(39, 85))
    assert path.waypoints.tolist() == [[0, 3], [39, 88]]


def test_a_path_turns_at_the_corner_of_a_block_and_touches_it():
    path = any_angle_path(grid_of("... .#. ..."), (0, 0), (2, 2))
    assert path.waypoints[1].tolist() in ([0.5, 1.5], [1.5, 0.5])
    assert path.length == pytest.approx(2 * math.hypot(0.5, 1.5))
    assert path.waypoints.tolist()[::2] == [[0, 0], [2, 2]]


def test_a_line_through_the_corner_of_one_block_is_free():
    path = any_angle_path(grid_of(".. .#"), (0, 0), (1, 1))
    assert (path.length, len(path.waypoints)) == (ROOT_2, 2)


def test_there_is_no_path_between_diagonal_blocks():
    blocked = grid_of(".# #.")
    path = any_angle_path(blocked, (1, 0), (0, 1))
    assert (path.status, path.length, path.waypoints.shape) == ("unreachable", math.inf, (0, 2))
    around = grid_of(".... ..#. .#.. ....")
    # Round the outer corner of either, not through the middle where they touch.
    path = any_angle_path(around, (2, 1), (1, 2))
    assert path.length == pytest.approx(2.0 + ROOT_2, rel=1e-15)


def test_a_line_along_the_sides_of_blocks_on_both_hands_is_free():
    # Up the left side of one block and then the right side of another.
    blocked = grid_of("..#. ..#. .... #... #...")
    path = any_angle_path(blocked, (0, 1), (4, 1))
    assert path.length == 4.0
    slalom = grid_of(".#... .#... ..... ..... ...#. ...#.")
    check_path(slalom, any_angle_path(slalom, (5, 0), (0, 4)), (5, 0), (0, 4))


def test_a_path_through_two_corners_on_one_line_is_straight():
    # Corners of one block to the left and of one to the right, both on the line.
    blocked = np.zeros((6, 6), bool)
    blocked[2, 1] = blocked[3, 4] = True
    for start, goal in itertools.permutations([tuple(cell) for cell in np.argwhere(~blocked).tolist()], 2):
        if is_free_line(blocked, [i + 0.5 for i in start], [i + 0.5 for i in goal]):
            assert any_angle_path(blocked, start, goal).length == pytest.approx(math.dist(start, goal), rel=1e-15)
        else:
            assert any_angle_path(blocked, start, goal).length > math.dist(start, goal)


def test_a_spiral_is_followed_to_its_middle():
    blocked = grid_of("......... .#######. .#.....#. .#.###.#. .#.#...#. .#.#####. .#....... .########")
    start, goal = (7, 8), (3, 5)
    path = any_angle_path(blocked, start, goal)
    check_path(blocked, path, start, goal)
    assert path.length == pytest.approx(visibility_lengths(blocked, start, [goal])[0], rel=1e-13)
    assert len(path.waypoints) > 6


def test_start_and_goal_in_one_cell_give_a_path_of_length_0():
    path = GridSearch(np.zeros((1, 1), bool)).any_angle_path((0, 0), (0, 0))
    assert (path.status, path.length, path.waypoints.tolist()) == ("found", 0.0, [[0, 0]])


# Against an oracle.


@pytest.mark.parametrize("density", [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7])
def test_paths_are_those_of_the_visibility_graph(density):
    rng = np.random.default_rng(int(100 * density))
    for _ in range(120):
        check_map(rng.random(rng.integers(1, 7, 2)) < density, rng)


@pytest.mark.parametrize("shape", [(1, 12), (12, 1), (2, 9), (9, 2), (3, 3), (10, 10)])
def test_paths_are_those_of_the_visibility_graph_on_odd_shapes(shape):
    rng = np.random.default_rng(4)
    for density in (0.1, 0.3, 0.5):
        for _ in range(8 if min(shape) < 10 else 1):
            check_map(rng.random(shape) < density, rng)


@settings(max_examples=60, deadline=None)
@given(data=st.data(), rows=st.integers(1, 6), cols=st.integers(1, 6))
def test_paths_are_those_of_the_visibility_graph_on_maps_by_hypothesis(data, rows, cols):
    cells = data.draw(st.lists(st.booleans(), min_size=rows * cols, max_size=rows * cols))
    check_map(np.array(cells).reshape(rows, cols), np.random.default_rng(data.draw(st.integers(0, 2**32 - 1))))


def make_map(rows, cols, kind, seed):
    """Random cells, boxes that touch each other, or long walls with gaps."""
    rng = np.random.default_rng(seed)
    if kind == "cells":
        return rng.random((rows, cols)) < rng.choice([0.02, 0.1, 0.2, 0.35, 0.5])
    blocked = np.zeros((rows, cols), bool)
    if kind == "boxes":
        for _ in range(1 + rows * cols // 60):
            row, col, (height, width) = rng.integers(rows), rng.integers(cols), rng.integers(1, 7, 2)
            blocked[row : row + height, col : col + width] = True
        return blocked
    blocked[:: rng.integers(2, 9)] = True
    blocked[:, :: rng.integers(2, 9)] = True
    return blocked & (rng.random((rows, cols)) < 0.85)


@settings(max_examples=150, deadline=None)
@given(
    rows=st.sampled_from([1, 2, 62, 63, 64, 65]) | st.integers(1, 40),
    cols=st.sampled_from([1, 2, 61, 62, 63, 64, 65, 127, 130]) | st.integers(1, 40),
    kind=st.sampled_from(["cells", "boxes", "walls"]),
    seed=st.integers(0, 2**32 - 1),
)
def test_paths_are_free_symmetric_and_between_the_straight_and_the_octile_length(rows, cols, kind, seed):
    blocked = make_map(rows, cols, kind, seed)
    search, mirrored = GridSearch(blocked), GridSearch(blocked[::-1].T)
    cells = draw_cells(blocked, np.random.default_rng(seed), 8)
    for start, goal in itertools.pairwise(cells):
        octile = search.shortest_path(start, goal)
        path, back = search.any_angle_path(start, goal), search.any_angle_path(goal, start)
        assert path.status == back.status == octile.status
        assert back.length == path.length
        assert np.array_equal(back.waypoints, path.waypoints[::-1])
        turned = [(cell[1], rows - 1 - cell[0]) for cell in (start, goal)]
        assert mirrored.any_angle_path(*turned).length == pytest.approx(path.length, rel=1e-13)
        if path.status == "found":
            check_path(blocked, path, start, goal)
            assert math.dist(start, goal) * (1.0 - 1e-13) <= path.length
            assert path.length <= octile.length * (1.0 + 1e-13)


def test_a_line_that_touches_a_corner_differs_from_one_that_misses_it_by_a_30_000th_of_a_cell():
    blocked = np.zeros((3, 60_003), bool)
    blocked[0, 15_001:] = True
    straight = any_angle_path(blocked, (0, 0), (2, 60_002))
    assert straight.waypoints.tolist() == [[0, 0], [2, 60_002]]
    assert straight.length == math.hypot(2, 60_002)
    blocked[0, 15_000] = True
    assert any_angle_path(blocked, (0, 0), (2, 60_002)).waypoints.tolist() == [[0, 0], [0.5, 14_999.5], [2, 60_002]]


# How it is asked.


def test_a_map_or_its_search_may_be_given_and_a_changed_search_is_asked_as_it_is():
    blocked = np.zeros((5, 9), np.uint8)
    blocked[:, 4] = 255
    search = GridSearch(blocked)
    assert any_angle_path(search, (0, 0), (0, 8)).status == any_angle_path(blocked, (0, 0), (0, 8)).status
    search.update(2, 4, False)
    path = search.any_angle_path((0, 0), (0, 8))
    assert path.length == pytest.approx(1.0 + 2 * math.hypot(1.5, 3.5))
    assert path.waypoints.tolist() == [[0, 0], [1.5, 3.5], [1.5, 4.5], [0, 8]]
    assert any_angle_path(blocked[::-1].T, (0, 0), (3, 4)) == any_angle_path(blocked[::-1].T != 0, (0, 0), (3, 4))


def test_several_threads_may_ask_at_once():
    blocked = make_map(100, 100, "boxes", 1)
    search, cells = GridSearch(blocked), draw_cells(blocked, np.random.default_rng(2), 40)
    expected = [search.any_angle_path(a, b) for a, b in itertools.pairwise(cells)]
    right = []

    def ask():
        right.extend([search.any_angle_path(a, b) for a, b in itertools.pairwise(cells)] == expected for _ in range(5))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert right == [True] * 20


def test_a_search_is_stopped_by_its_deadline_and_by_hand():
    blocked = make_map(300, 300, "cells", 3)
    cells = draw_cells(blocked, np.random.default_rng(0), 100)
    search = GridSearch(blocked)
    start, goal = next(pair for pair in itertools.pairwise(cells) if search.shortest_path(*pair).length > 150)
    path = search.any_angle_path(start, goal, deadline_s=1e-9)
    assert (path.status, len(path.waypoints), math.isnan(path.length)) == ("timeout", 0, True)
    cancel = Cancellation()
    assert search.any_angle_path(start, goal, cancel=cancel, deadline_s=1e6).status == "found"
    cancel.cancel()
    assert search.any_angle_path(start, goal, cancel=cancel).status == "cancelled"


@pytest.mark.parametrize(
    ("start", "goal", "error", "cell", "words"),
    [
        ((3, 0), (0, 0), OutsideMapError, (3, 0), r"start \(3, 0\) lies outside"),
        ((0, 0), (0, -1), OutsideMapError, (0, -1), r"goal \(0, -1\) lies outside"),
        ((0, 0), (2**80, 0), OutsideMapError, (2**80, 0), "goal"),
        ((1, 1), (0, 0), BlockedPoseError, (1, 1), r"start \(1, 1\) is blocked"),
        ((0, 0), (1, 1), BlockedPoseError, (1, 1), r"goal \(1, 1\) is blocked"),
        ((0.5, 1), (0, 0), InputError, None, r"start must be a pair of integers"),
        ((0, 0), None, InputError, None, r"goal must be a pair of integers"),
    ],
)
def test_an_end_that_cannot_be_is_a_typed_error_with_its_cell(start, goal, error, cell, words):
    blocked = np.zeros((3, 4), bool)
    blocked[1, 1] = True
    with pytest.raises(error, match=words) as caught:
        GridSearch(blocked).any_angle_path(start, goal)
    assert getattr(caught.value, "cell", None) == cell


@pytest.mark.parametrize(
    ("blocked", "words"),
    [
        (np.zeros(5, bool), r"shape \(rows, cols\)"),
        (np.zeros((0, 5), bool), "at least one cell"),
        (np.zeros((2, 2)), "float64"),
    ],
)
def test_a_map_that_cannot_be_searched_is_an_input_error(blocked, words):
    with pytest.raises(InputError, match=words):
        any_angle_path(blocked, (0, 0), (0, 1))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"deadline_s": 0}, "positive number of seconds"),
        ({"cancel": 1}, "must be a Cancellation"),
    ],
)
def test_options_that_cannot_be_are_an_input_error(options, words):
    with pytest.raises(InputError, match=words):
        GridSearch(np.zeros((2, 2), bool)).any_angle_path((0, 0), (0, 1), **options)
