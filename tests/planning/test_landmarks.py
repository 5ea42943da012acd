"""Landmarks change no length, and hold only as long as ways cannot have become shorter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle._core import BinaryGrid
from trundle.errors import InputError
from trundle.planning import GridSearch


def rooms(rows, cols, seed):
    """Rooms with doors, and now and then none; some cells within are blocked."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((rows, cols)) < rng.choice([0.0, 0.02, 0.1])
    for _ in range(rng.integers(0, 8)):
        if rng.random() < 0.5:
            blocked[rng.integers(rows)] = rng.random(cols) < 0.95
        else:
            blocked[:, rng.integers(cols)] = rng.random(rows) < 0.95
    return blocked


def lengths(search, pairs):
    return search.plan_many(pairs[:, :2], pairs[:, 2:], threads=1).length


def some_pairs(blocked, rng, count=40):
    free = np.argwhere(~blocked)
    return np.hstack([free[rng.integers(len(free), size=count)] for _ in range(2)])


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    rows=st.sampled_from([1, 2, 15, 16, 17, 63, 64, 100]),
    cols=st.sampled_from([1, 3, 14, 15, 31, 65, 130]),
    count=st.integers(1, 16),
    method=st.sampled_from(["jps", "jps_plus"]),
)
def test_lengths_are_those_of_astar_also_while_cells_are_blocked_and_freed(seed, rows, cols, count, method):
    rng = np.random.default_rng(seed)
    blocked = rooms(rows, cols, seed)
    blocked[rng.integers(rows), rng.integers(cols)] = False
    search, oracle = GridSearch(blocked, method=method, landmarks=count), GridSearch(blocked, method="astar")
    then = blocked.copy()
    assert search.landmarks > 0
    for _ in range(5):
        pairs = some_pairs(blocked, rng)
        assert np.array_equal(lengths(search, pairs), lengths(oracle, pairs))
        assert np.array_equal(lengths(search, pairs[:, [2, 3, 0, 1]]), lengths(oracle, pairs))
        row, col = int(rng.integers(rows)), int(rng.integers(cols))
        span = slice(row, min(rows, row + 9)), slice(col, min(cols, col + 9))
        values = rng.random(blocked[span].shape) < rng.choice([0.0, 0.5, 1.0])
        if rng.random() < 0.5:
            values |= then[span]  # frees nothing that was not free when it was measured
        blocked[span] = values
        had = search.landmarks
        for each in (search, oracle):
            each.update(*span, values)
        assert search.landmarks == (had if (then <= blocked)[span].all() else 0)
        if blocked.all():
            return


def test_what_moves_about_on_a_measured_map_keeps_the_landmarks_and_what_opens_it_does_not():
    blocked = np.zeros((200, 300), bool)
    blocked[50, :250] = True
    search = GridSearch(blocked, landmarks=4)
    for row in (60, 80, 100):
        search.update((row, row + 10), (20, 40), True)
        assert search.shortest_path((row - 1, 30), (row + 10, 30)).length > 20.0
        search.update((row, row + 10), (20, 40), False)
    assert search.landmarks == 4
    before = search.shortest_path((40, 10), (60, 10)).length
    search.update(50, (8, 12), False)
    assert search.landmarks == 0
    assert search.shortest_path((40, 10), (60, 10)).length == 20.0 < before


def test_parts_of_the_map_without_landmarks_are_searched_as_without_them():
    blocked = rooms(120, 200, 3)
    blocked[:, 60] = True  # the smaller part has none
    search, oracle = GridSearch(blocked, method="jps", landmarks=8), GridSearch(blocked, method="jps")
    pairs = some_pairs(blocked, np.random.default_rng(0), 400)
    assert np.array_equal(lengths(search, pairs), lengths(oracle, pairs))
    ends = np.isfinite(lengths(oracle, pairs)), pairs[:, 1] < 60
    assert (ends[0] & ends[1]).any()
    assert not ends[0].all()
    # Also where a cut parts what was measured together.
    for each in (search, oracle):
        each.update((0, 120), 130, True)
    assert search.landmarks == 8
    assert np.array_equal(lengths(search, pairs[:100]), lengths(oracle, pairs[:100]))


def test_a_landmark_takes_four_bytes_a_block():
    blocked = np.zeros((160, 320), bool)
    blocked[40, :300] = True
    plain, guided = (GridSearch(blocked, landmarks=count) for count in (0, 8))
    assert guided.landmarks == 8
    assert guided.nbytes - plain.nbytes == 8 * 4 * 11 * 21


def test_small_and_blocked_maps_have_as_many_landmarks_as_there_are_places():
    assert GridSearch(np.ones((5, 5), bool), method="jps", landmarks=4).landmarks == 0
    single = GridSearch(np.zeros((1, 1), bool), method="jps", landmarks=16)
    assert single.landmarks == 1
    assert single.shortest_path((0, 0), (0, 0)).length == 0.0


def test_where_astar_is_chosen_nothing_is_measured():
    cluttered = np.random.default_rng(0).random((100, 100)) < 0.2
    search = GridSearch(cluttered, landmarks=4)
    assert (search.method, search.landmarks) == ("astar", 0)


@pytest.mark.parametrize("landmarks", [-1, 17, 2.0, "4", True, None])
def test_a_number_that_is_none_is_refused(landmarks):
    with pytest.raises(InputError, match="whole number from 0 to 16"):
        GridSearch(np.zeros((3, 3), bool), landmarks=landmarks)


@pytest.mark.parametrize("options", [{"connectivity": 4}, {"method": "astar"}])
def test_a_search_that_does_not_use_them_refuses_them(options):
    with pytest.raises(InputError, match="of no use"):
        GridSearch(np.zeros((3, 3), bool), landmarks=2, **options)


def test_the_kernel_refuses_lengths_of_another_shape_and_survives_any():
    grid = BinaryGrid(np.zeros((40, 50), np.uint8), 8, "jps")
    cells = grid.begin_landmarks(3)
    assert cells.shape == (3, 2)
    with pytest.raises(ValueError, match="shape of the map"):
        grid.add_landmark((0, 0), np.zeros((50, 40), np.float32))
    with pytest.raises(ValueError, match="outside"):
        grid.add_landmark((40, 0), np.zeros((40, 50), np.float32))
    with pytest.raises(ValueError, match="1 to 64"):
        grid.begin_landmarks(0)
    for value in (np.nan, -np.inf, 3e38):
        grid.add_landmark((0, 0), np.full((40, 50), value, np.float32))
    grid.add_landmark((0, 0), np.zeros((40, 50), np.float32))
    assert grid.landmarks == 3
    assert grid.find_way((0, 0), (39, 49), None, None)[0] == 0
