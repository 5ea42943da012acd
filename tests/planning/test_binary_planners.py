import gc
import weakref

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import NoPathError
from trundle.geometry import Pose2D
from trundle.planning import create_planner

NAMES = ("astar", "jps", "jps_plus")
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
def test_all_three_go_the_shortest_way_whatever_the_free_cells_cost(seed):
    costs = make_costs(seed)
    flat = np.where(costs < 253, 0, costs)
    paths = {name: create_planner(name).plan(costmap_of(costs), START, GOAL) for name in NAMES}
    for name, path in paths.items():
        assert path.planner == name
        assert path.cost == pytest.approx(path.length)
        assert np.array_equal(path.poses, create_planner(name).plan(costmap_of(flat), START, GOAL).poses)
        centres = costmap_of(costs).cost_at(path.poses[:, 0], path.poses[:, 1])
        assert (centres < 253).all()
    # Each shortens a grid path of the same length; which one of several is the method's.
    lengths = [path.length for path in paths.values()]
    assert max(lengths) <= 1.06 * min(lengths)


@pytest.mark.parametrize("name", NAMES)
def test_cells_of_253_block_and_those_of_252_do_not(name):
    costs = np.zeros((40, 60), np.uint8)
    costs[[0, -1]] = costs[:, [0, -1]] = 254
    costs[:, 30] = 253
    start, goal = Pose2D(0.5, 1.0), Pose2D(2.5, 1.0)
    with pytest.raises(NoPathError):
        create_planner(name).plan(costmap_of(costs), start, goal)
    costs[:, 30] = 252
    assert create_planner(name).plan(costmap_of(costs), start, goal).length == pytest.approx(2.0)


@pytest.mark.parametrize("name", NAMES)
def test_each_costmap_is_searched_as_it_is_and_none_is_kept_alive(name):
    planner = create_planner(name)
    first, second = costmap_of(make_costs(1)), costmap_of(make_costs(2))
    alone = [create_planner(name).plan(costmap, START, GOAL).poses for costmap in (first, second)]
    for turn in (0, 1, 1, 0):
        assert np.array_equal(planner.plan((first, second)[turn], START, GOAL).poses, alone[turn])
    forgotten = weakref.ref(first)
    del first
    gc.collect()
    assert forgotten() is None
