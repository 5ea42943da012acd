"""Maps of a `GridSearch` that change: labels, the choice of the method, and updates beside searches."""

import math
import threading

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from support.binary_maps import SIZES, make_map
from trundle.planning import GridSearch


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
    obstacles = scipy.ndimage.label(padded, np.ones((3, 3)))[1] - 1
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
        labels, _ = scipy.ndimage.label(~blocked)
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
        labels, count = scipy.ndimage.label(~blocked)
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
