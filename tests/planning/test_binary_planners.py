import gc
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import NoPathError, PlanningError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning import GridSearch, create_planner
from trundle.planning.grid_planners.binary_planner import KeptSearch

METHODS = ("auto", "jps", "astar")
SMALL = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))


def costmap_of(costs, footprint=SMALL):
    return Costmap(np.asarray(costs, np.uint8), 0.05, Pose2D(0.0, 0.0), footprint, 0.5)


def make_costs(seed):
    """A room with boxes, their border of 253, and lower costs everywhere."""
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 253, (120, 160)).astype(np.uint8)
    for _ in range(12):
        row, col = rng.integers(10, 100), rng.integers(10, 140)
        costs[row - 3 : row + 11, col - 3 : col + 9] = np.maximum(costs[row - 3 : row + 11, col - 3 : col + 9], 253)
        costs[row : row + 8, col : col + 6] = 254
    costs[[0, 1, 2, -3, -2, -1]] = costs[:, [0, 1, 2, -3, -2, -1]] = 254
    costs[4:9, 4:9] = costs[-9:-4, -9:-4] = 0
    return costs


START, GOAL = Pose2D(0.325, 0.325, 0.0), Pose2D(7.675, 5.675, 0.0)


@pytest.mark.parametrize("seed", range(8))
def test_all_methods_find_a_shortest_path_whatever_the_free_cells_cost(seed):
    costs = make_costs(seed)
    flat = np.where(costs < 253, 0, costs)
    planners = [create_planner("astar", method=method) for method in METHODS]
    paths = [planner.plan(costmap_of(costs), START, GOAL) for planner in planners]
    for planner, path in zip(planners, paths, strict=True):
        assert path.planner == "astar"
        assert path.cost == pytest.approx(path.length)
        assert np.array_equal(path.poses, planner.plan(costmap_of(flat), START, GOAL).poses)
        centres = costmap_of(costs).cost_at(path.poses[:, 0], path.poses[:, 1])
        assert (centres < 253).all()
    # Each shortens a grid path of the same length; which one of several is the method's.
    lengths = [path.length for path in paths]
    assert max(lengths) <= 1.06 * min(lengths)


@pytest.mark.parametrize("method", METHODS)
def test_cells_of_253_block_and_those_of_252_do_not(method):
    costs = np.zeros((40, 60), np.uint8)
    costs[[0, -1]] = costs[:, [0, -1]] = 254
    costs[:, 30] = 253
    start, goal = Pose2D(0.5, 1.0), Pose2D(2.5, 1.0)
    with pytest.raises(NoPathError):
        create_planner("astar", method=method).plan(costmap_of(costs), start, goal)
    costs[:, 30] = 252
    assert create_planner("astar", method=method).plan(costmap_of(costs), start, goal).length == pytest.approx(2.0)


@pytest.mark.parametrize("method", METHODS)
def test_each_costmap_is_searched_as_it_is_and_none_is_kept_alive(method):
    planner = create_planner("astar", method=method)
    first, second = costmap_of(make_costs(1)), costmap_of(make_costs(2))
    alone = [create_planner("astar", method=method).plan(costmap, START, GOAL).poses for costmap in (first, second)]
    for turn in (0, 1, 1, 0):
        assert np.array_equal(planner.plan((first, second)[turn], START, GOAL).poses, alone[turn])
    forgotten = weakref.ref(first)
    del first
    gc.collect()
    assert forgotten() is None


@pytest.mark.parametrize("method", METHODS)
def test_a_changed_costmap_is_planned_on_as_if_it_were_new(method):
    """The search is updated by the rectangles that `Costmap.update` changed, and labels stay right."""
    rng = np.random.default_rng(5)
    grid = OccupancyGrid(np.where(rng.random((120, 160)) < 0.002, 100, 0).astype(np.int8), 0.05)
    costmap = Costmap.from_grid(grid, SMALL, 0.3)
    planner = create_planner("astar", method=method, start_tolerance=2.0, goal_tolerance=2.0)
    attempt(planner, costmap)
    outcomes = set()
    for round_ in range(30):
        for _ in range(rng.integers(1, 4)):  # several changes between two plans, too
            row, col = int(rng.integers(0, 110)), int(rng.integers(0, 150))
            wall = rng.random() < 0.3
            size = (slice(0, 120), slice(col, col + 2)) if wall else (slice(row, row + 9), slice(col, col + 9))
            costmap = costmap.update(*size, int(rng.choice([0, 100])))
        fresh = create_planner("astar", method=method, start_tolerance=2.0, goal_tolerance=2.0)
        assert costmap.changes_since(costmap.version) == []
        answers = [attempt(one, costmap) for one in (planner, fresh)]
        outcomes.add(type(answers[1]))
        if isinstance(answers[1], str):
            assert answers[0] == answers[1]
        else:
            assert np.array_equal(answers[0].poses, answers[1].poses), round_
    assert outcomes == {str, Path}


def attempt(planner, costmap):
    try:
        return planner.plan(costmap, START, GOAL)
    except PlanningError as error:
        return str(error)


def test_the_search_of_a_changed_costmap_is_not_rebuilt_while_nobody_uses_it():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((60, 80), np.int8), 0.05), SMALL, 0.3)
    kept = KeptSearch(INSCRIBED, "jps")
    with kept.of(costmap) as first:
        pass
    changed = costmap.update(slice(20, 22), slice(0, 80), 100)
    with kept.of(changed) as second:
        assert second is first
        assert second.shortest_path((2, 2), (50, 2)).status == "unreachable"
        with kept.of(costmap) as third:  # the old one is asked for while the new one is in use
            assert third is not second
            assert third.shortest_path((2, 2), (50, 2)).status == "found"
        assert second.shortest_path((2, 2), (50, 2)).status == "unreachable"
    with kept.of(Costmap.from_grid(OccupancyGrid(np.zeros((60, 80), np.int8), 0.05), SMALL, 0.3)) as other:
        assert other is not third


@pytest.mark.parametrize("method", METHODS)
def test_detours_are_searched_on_what_is_blocked_for_them_alone(method):
    costmap, rng = costmap_of(make_costs(3)), np.random.default_rng(3)
    kept = KeptSearch(INSCRIBED, method)
    used = set()
    for turn in range(30):
        costs = costmap.data.copy()
        for row, col in rng.integers(20, 100, (rng.integers(1, 4), 2)).tolist():
            costs[row : row + 3, col : col + 3] = 254
        if turn % 10 == 9:
            costs[:, 80] = 254  # a change of the whole map
        with kept.around(costmap, costs) as search, kept.of(costmap) as own:
            used.add(id(search))
            assert search is not own
            for goal in ((114, 154), (8, 8)):
                want = GridSearch(costs >= INSCRIBED, method=method).shortest_path((5, 5), goal)
                found = search.shortest_path((5, 5), goal)
                assert (found.status, found.length) == (want.status, want.length)
                assert np.array_equal(found.waypoints, want.waypoints)
    assert len(used) < 30
    with kept.around(costmap, costs) as one, kept.around(costmap, costs) as other:
        assert one is not other
    fresh = costmap_of(np.zeros((120, 160), np.uint8))
    with kept.around(fresh, fresh.data) as search:
        assert search.shortest_path((0, 0), (0, 159)).length == 159.0


def test_threads_with_costmaps_of_their_own_do_not_disturb_each_other():
    base = Costmap.from_grid(OccupancyGrid(np.zeros((120, 160), np.int8), 0.05), SMALL, 0.3)
    costmaps = [base]
    for k in range(7):
        costmaps.append(costmaps[-1].update(slice(10 + 10 * k, 20 + 10 * k), slice(40 + 5 * k, 60 + 5 * k), 100))
    want = [create_planner("astar").plan(costmap, START, GOAL).poses for costmap in costmaps]
    planner = create_planner("astar")

    def ask(k):
        return np.array_equal(planner.plan(costmaps[k % 8], START, GOAL).poses, want[k % 8])

    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(ask, np.random.default_rng(0).integers(0, 8, 200).tolist()))
