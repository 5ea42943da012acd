"""The costmap of a map that grows, and a navigator that drives on it."""

import math

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, room
from trundle.costmap import LETHAL, CostmapSettings
from trundle.costmap.growing_map import GrowingMap
from trundle.errors import InputError, MapError, OutsideMapError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator
from trundle.observation import Estimate
from trundle.sim import simulate

SETTINGS = CostmapSettings(unknown="costly")
EDGE = 0.05


def grid_at(x, y, cells):
    return OccupancyGrid(np.asarray(cells, np.int8), EDGE, Pose2D(x, y))


def random_cells(seed, shape):
    return np.random.default_rng(seed).choice([-1, 0, 30, 80, 100], shape, p=[0.3, 0.6, 0.04, 0.03, 0.03])


def costs_in(costmap, grid):
    """Costs of the cells of a map, by their places."""
    rows, cols = np.indices(grid.shape)
    return costmap.cost_at(*grid.cell_to_world(rows, cols))


def test_cells_are_read_by_the_thresholds_of_map_files():
    grid = grid_at(0.0, 0.0, [[100, 80, 65], [64, 21, -1], [20, 5, 0]])
    costmap = GrowingMap(ROBOT, SETTINGS).take(grid)
    assert (costs_in(costmap, grid) == LETHAL).tolist() == [[True] * 3, [False] * 3, [False] * 3]
    row, col = costmap.world_to_cell(*grid.cell_to_world(*np.indices(grid.shape)))
    assert costmap.unknown_cells[row, col].tolist() == [[False] * 3, [True] * 3, [False] * 3]


@pytest.mark.parametrize("seed", range(4))
def test_what_has_grown_step_by_step_is_what_is_made_at_once(seed):
    rng = np.random.default_rng(seed)
    grown, last = GrowingMap(ROBOT, SETTINGS), None
    for step in range(5):
        low = (-10 * step * int(rng.integers(0, 3)), -7 * step)
        grid = grid_at(low[1] * EDGE, low[0] * EDGE, random_cells(10 * seed + step, (60 + 20 * step, 80 + 9 * step)))
        last = grown.take(grid)
    fresh = GrowingMap(ROBOT, SETTINGS)
    made = fresh.take(grid)
    # A map without what the others have had around it.
    np.testing.assert_array_equal(costs_in(last, grid), costs_in(made, grid))


def test_a_goal_outside_is_contained_and_the_map_stays():
    grid = grid_at(0.0, 0.0, random_cells(1, (40, 40)))
    grown = GrowingMap(ROBOT, SETTINGS)
    before = grown.take(grid)
    after = grown.contain(np.array([(30.0, -20.0)]))
    assert after is not None
    assert after.contains(*after.world_to_cell(30.0, -20.0))
    np.testing.assert_array_equal(costs_in(before, grid), costs_in(after, grid))
    assert grown.contain(np.array([(30.0, -20.0)])) is None


def test_a_turned_map_and_one_beyond_memory_are_refused():
    grown = GrowingMap(ROBOT, SETTINGS)
    with pytest.raises(InputError, match="cannot be turned"):
        grown.take(OccupancyGrid(np.zeros((4, 4), np.int8), EDGE, Pose2D(0.0, 0.0, 0.3)))
    grown.take(grid_at(0.0, 0.0, np.zeros((4, 4))))
    with pytest.raises(MapError, match="too large"):
        grown.contain(np.array([(1e6, 0.0)]))


# A navigator ----------------------------------------------------------------------------------------------------------


def test_a_wall_on_the_map_alone_is_driven_round():
    """The lidar is not used: what the navigator knows is the map that it was given on the way."""
    cells = np.zeros((120, 200), np.int8)
    cells[[0, -1], :] = cells[:, [0, -1]] = 100
    navigator = Navigator(None, ROBOT)
    navigator.set_map(OccupancyGrid(cells, EDGE))
    navigator.set_goal(9.0, 3.0)
    straight = navigator.plan((1.5, 3.0, 0.0))
    cells[:80, 100] = 100
    navigator.set_map(OccupancyGrid(cells, EDGE))
    around = navigator.plan((1.5, 3.0, 0.0))
    assert straight.length < 7.6 < around.length


def test_a_navigator_with_a_map_keeps_it():
    navigator = Navigator(OccupancyGrid(np.zeros((40, 60), np.int8), EDGE), ROBOT)
    before = navigator.costmap
    navigator.set_map(OccupancyGrid(np.full((90, 90), 100, np.int8), EDGE))
    assert navigator.costmap is before


def contains(navigator, x, y):
    costmap = navigator.costmap
    return bool(costmap.contains(*costmap.world_to_cell(x, y)))


def test_goal_path_and_robot_stay_in_the_costmap_when_a_first_small_map_arrives():
    """A map of a square metre far from all of them, as where nothing was met yet."""
    navigator = Navigator(None, ROBOT)
    navigator.set_goal(-4.0, -28.0)
    path = navigator.plan((-8.0, -8.0, 0.0))
    navigator.update((-8.0, -8.0, 0.0), Twist2D(), time=0.05)
    navigator.set_map(grid_at(0.0, 0.0, np.full((20, 20), -1)))
    assert contains(navigator, -4.0, -28.0)
    assert all(contains(navigator, x, y) for x, y in path.poses[:, :2])
    assert contains(navigator, -8.0, -8.0)
    navigator.update((-8.0, -45.0, 0.0), Twist2D(), time=0.1)
    navigator.set_map(grid_at(0.01, 0.0, np.full((20, 20), -1)))  # its cells lie elsewhere, so nothing of it is kept
    assert contains(navigator, -8.0, -45.0)
    assert contains(navigator, -4.0, -28.0)


def test_a_goal_that_is_set_on_the_way_is_planned_to_though_it_lies_outside_of_the_costmap():
    navigator = Navigator(None, ROBOT)
    navigator.set_map(grid_at(0.0, 0.0, np.zeros((40, 40))))
    navigator.set_goal(30.0, -20.0)
    navigator.update((1.0, 1.0, 0.0), Twist2D(), time=0.05)
    assert navigator.path is not None
    assert (navigator.path.goal.x, navigator.path.goal.y) == pytest.approx((30.0, -20.0))


@pytest.mark.parametrize("with_map", [True, False])
def test_a_goal_that_is_too_far_away_is_outside_of_the_map(with_map):
    navigator = Navigator(None, ROBOT)
    if with_map:
        navigator.set_map(grid_at(0.0, 0.0, np.zeros((40, 40))))
    navigator.set_goal(1e4, 9e3)
    with pytest.raises(OutsideMapError, match=r"too large.*nearer goal"):
        navigator.plan((1.0, 1.0, 0.0))
    assert navigator.update((1.0, 1.0, 0.0), Twist2D(), time=0.05) == Twist2D()
    assert navigator.status is NavigationStatus.NO_PATH


def test_another_run_begins_without_the_map():
    navigator = Navigator(None, ROBOT)
    navigator.set_map(OccupancyGrid(np.full((90, 90), 100, np.int8), EDGE))
    navigator.reset()
    assert not (navigator.costmap.data == LETHAL).any()


@pytest.mark.parametrize("corrected", [True, False])
def test_marks_are_forgotten_only_where_the_map_has_moved(corrected):
    world = room(block("box", 4.6, 2.5, 5.4, 3.5))
    navigator = Navigator(None, ROBOT)
    navigator.set_goal(GOAL)
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(12):
            navigator.update(state.observation, Estimate(state.time, state.pose))
            state = sim.step(navigator.robot.limits.clamp(type(state.twist)(0.0, 0.0)), navigator.dt)
    assert (navigator.costmap.data == LETHAL).any()
    navigator.set_map(grid_at(-1.0, -1.0, np.full((200, 260), -1)), corrected=corrected)
    assert (navigator.costmap.data == LETHAL).any() != corrected
    assert math.isclose(navigator.costmap.resolution, EDGE)
