"""Ends that may be moved, partial paths to near a goal, and batches of any-angle paths."""

import math

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.planning import Cancellation, GridSearch, PointPaths


def make_map(seed):
    rng = np.random.default_rng(seed)
    shape = rng.choice([1, 2, 5, 17, 63, 64, 65, 90], 2)
    return rng.random(shape) < rng.choice([0.1, 0.3, 0.5, 0.7, 0.95])


def nearest(cells, to):
    """Of cells (row, col) the one nearest to `to`, of the lowest row, then column, and its squared distance."""
    best = min(((r - to[0]) ** 2 + (c - to[1]) ** 2, r, c) for r, c in cells)
    return best[1:], best[0]


def cells_of(mask):
    return [tuple(cell) for cell in np.argwhere(mask).tolist()]


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), method=st.sampled_from(["jps", "astar"]))
def test_a_partial_path_ends_at_the_reachable_cell_nearest_to_the_goal(seed, method):
    blocked = make_map(seed)
    free = cells_of(~blocked)
    if not free:
        return
    rng = np.random.default_rng(seed)
    search = GridSearch(blocked, method=method)
    labels, _ = scipy.ndimage.label(~blocked)
    for _ in range(5):
        start = free[rng.integers(len(free))]
        goal = tuple(int(rng.integers(size)) for size in blocked.shape)
        want, squared = nearest(cells_of(labels == labels[start]), goal)
        assert search.nearest_reachable(start, goal) == want
        path = search.shortest_path(start, goal, partial=True)
        assert path.status == ("found" if squared == 0 else "partial")
        assert path.remaining == pytest.approx(math.sqrt(squared))
        assert path.goal_snapped == path.start_snapped == 0.0
        assert path.waypoints[0].tolist() == list(start)
        assert path.waypoints[-1].tolist() == list(want)
        assert path.length == path.cost == search.shortest_path(start, want).length
        point = search.any_angle_path(start, goal, partial=True)
        assert (point.status, point.remaining) == (path.status, path.remaining)
        assert point.length <= path.length + 1e-9


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), start_tolerance=st.floats(0, 6), goal_tolerance=st.floats(0, 6))
def test_blocked_ends_are_moved_within_their_tolerance(seed, start_tolerance, goal_tolerance):
    blocked = make_map(seed)
    free = cells_of(~blocked)
    search = GridSearch(blocked)
    labels, _ = scipy.ndimage.label(~blocked)
    rng = np.random.default_rng(seed)
    options = {"start_tolerance": start_tolerance, "goal_tolerance": goal_tolerance}
    for _ in range(5):
        start, goal = (tuple(int(rng.integers(size)) for size in blocked.shape) for _ in range(2))
        begin = start
        if blocked[start]:
            begin, squared = nearest(free, start) if free else (None, math.inf)
            if squared > start_tolerance**2 + 1e-6:  # √2 given as a float reaches a diagonal neighbour
                with pytest.raises(BlockedPoseError, match="the start") as caught:
                    search.shortest_path(start, goal, **options)
                assert caught.value.cell == start
                continue
        end = goal
        if blocked[goal]:
            end, squared = nearest(cells_of(labels == labels[begin]), goal)
            if squared > goal_tolerance**2 + 1e-6:
                end, squared = nearest(free, goal)
            if squared > goal_tolerance**2 + 1e-6:
                with pytest.raises(BlockedPoseError, match="the goal") as caught:
                    search.shortest_path(start, goal, **options)
                assert caught.value.cell == goal
                continue
        path = search.shortest_path(start, goal, **options)
        assert path.start_snapped == pytest.approx(math.dist(begin, start))
        assert path.goal_snapped == pytest.approx(math.dist(end, goal))
        assert path.status == ("found" if labels[begin] == labels[end] else "unreachable")
        if path.status == "found":
            assert path.cells[[0, -1]].tolist() == [list(begin), list(end)]


def test_many_queries_are_moved_as_one_is():
    blocked = np.random.default_rng(3).random((80, 120)) < 0.45
    search = GridSearch(blocked)
    rng = np.random.default_rng(4)
    starts, goals = (np.column_stack([rng.integers(80, size=300), rng.integers(120, size=300)]) for _ in range(2))
    options = {"start_tolerance": 20, "goal_tolerance": 1.5, "partial": True}
    paths = search.plan_many(starts, goals, **options)
    points = search.any_angle_paths(starts, goals, **options, threads=3)
    assert isinstance(points, PointPaths)
    assert set(paths.status) == {"found", "partial"}
    for i, (start, goal) in enumerate(zip(starts, goals, strict=True)):
        assert paths[i] == search.shortest_path(start, goal, **options)
        assert points[i] == search.any_angle_path(start, goal, **options)
    assert np.array_equal(paths.remaining, [path.remaining for path in paths])
    assert np.array_equal(paths.start_snapped, points.start_snapped)
    assert (paths.cost == paths.length).all()
    assert (points.length <= paths.length + 1e-9).all()
    with pytest.raises(BlockedPoseError, match=r"query \d+: the goal"):
        search.plan_many(starts, goals, start_tolerance=20)


def test_a_batch_of_any_angle_paths_equals_single_queries():
    blocked = np.random.default_rng(5).random((64, 65)) < 0.25
    free = np.argwhere(~blocked)
    rng = np.random.default_rng(6)
    starts, goals = free[rng.integers(len(free), size=(2, 120))]
    search = GridSearch(blocked)
    paths = search.any_angle_paths(starts, goals, threads=4)
    assert {"found", "unreachable"} == set(paths.status)
    for path, start, goal in zip(paths, starts, goals, strict=True):
        assert path == search.any_angle_path(start, goal)
    assert paths[-1] == paths[119]
    assert paths[3:5] == [paths[3], paths[4]]
    assert len(search.any_angle_paths(np.zeros((0, 2), int), [])) == 0


def test_a_batch_of_any_angle_paths_stops_as_one_does():
    blocked = np.random.default_rng(7).random((900, 900)) < 0.2
    ends = np.argwhere(~blocked)
    starts, goals = ends[:200], ends[::-1][:200]
    search = GridSearch(blocked)
    paths = search.any_angle_paths(starts, goals, deadline_s=0.02)
    late = paths.status == "timeout"
    assert late.any()
    assert np.isnan(paths.length[late]).all()
    cancel = Cancellation()
    cancel.cancel()
    cancelled = search.any_angle_paths(starts, goals, cancel=cancel)
    assert set(cancelled.status[paths.status != "unreachable"]) == {"cancelled"}


def test_a_goal_in_a_wall_between_two_rooms_is_moved_to_the_start_s_side():
    blocked = np.zeros((9, 21), bool)
    blocked[:, 9:12] = True
    search = GridSearch(blocked)
    path = search.shortest_path((4, 2), (4, 11), goal_tolerance=3)
    assert (path.status, path.goal_snapped) == ("found", 3.0)
    assert path.waypoints[-1].tolist() == [4, 8]
    across = search.shortest_path((4, 2), (4, 11), goal_tolerance=1)
    assert (across.status, across.goal_snapped) == ("unreachable", 1.0)
    assert search.shortest_path((4, 2), (4, 11), goal_tolerance=1, partial=True).remaining == 3.0


def test_after_an_update_the_nearest_is_that_of_the_new_map():
    blocked = np.zeros((50, 50), bool)
    blocked[25] = True
    search = GridSearch(blocked)
    assert search.nearest_reachable((3, 3), (40, 40)) == (24, 40)
    search.update(25, 10, False)
    assert search.nearest_reachable((3, 3), (40, 40)) == (40, 40)
    search.update(25, 10, True)
    assert search.nearest_reachable((30, 3), (20, 7)) == (26, 7)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start_tolerance": -1}, "start_tolerance must be a number of 0 or more cells, got -1"),
        ({"goal_tolerance": math.nan}, "goal_tolerance must be"),
        ({"goal_tolerance": "3"}, "goal_tolerance must be"),
        ({"goal_tolerance": True}, "goal_tolerance must be"),
        ({"partial": "yes"}, "partial must be true or false"),
    ],
)
def test_bad_options_are_refused(options, message):
    search = GridSearch(np.zeros((4, 4), bool))
    for ask in (search.shortest_path, search.any_angle_path):
        with pytest.raises(InputError, match=message):
            ask((0, 0), (3, 3), **options)
    for ask in (search.plan_many, search.any_angle_paths):
        with pytest.raises(InputError, match=message):
            ask([(0, 0)], [(3, 3)], **options)


@pytest.mark.parametrize("cell", [(0, 2**70), (-1, 0), (4, 0), (0, 4)])
def test_an_end_outside_is_an_error_whatever_the_tolerance(cell):
    search = GridSearch(np.zeros((4, 4), bool))
    for start, goal in ((cell, (0, 0)), ((0, 0), cell)):
        with pytest.raises(OutsideMapError):
            search.shortest_path(start, goal, start_tolerance=9, goal_tolerance=9, partial=True)
