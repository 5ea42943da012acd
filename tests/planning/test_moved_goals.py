"""A goal where the robot cannot arrive is moved within its tolerance to where it can."""

import math

import numpy as np
import pytest

from support.swept import CARTER, swept_area_blocked
from trundle.costmap import Costmap
from trundle.errors import NoPathError, PlanningStoppedError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import create_planner, planner_names

NAMES = [name for name in planner_names() if name != "manhattan_astar"]
GRID_PLANNERS = [name for name in NAMES if name not in ("auto", "hybrid_astar")]
START = Pose2D(1.5, 1.5)


def hall(*, wall=False):
    """8 x 12 m; with a thin wall across it at y = 4 m, whose two sides nothing joins."""
    cells = np.zeros((160, 240), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    if wall:
        cells[80] = 100
    return Costmap.from_grid(OccupancyGrid(cells, 0.05), CARTER)


def assert_arrives(path, costmap, goal, tolerance):
    assert path.status == "found"
    assert path.goal_snapped_m == pytest.approx(path.goal.distance_to(goal))
    assert 0.0 < path.goal_snapped_m <= tolerance
    assert swept_area_blocked(costmap, path) < 1e-6


@pytest.mark.parametrize("yaw", [0.0, math.pi / 2, None])
@pytest.mark.parametrize("name", NAMES)
def test_a_goal_in_a_wall_is_moved_to_the_side_that_can_be_reached(name, yaw):
    costmap, goal = hall(wall=True), Pose2D(6.0, 4.04, yaw or 0.0)
    planner = create_planner(name, goal_tolerance=1.0)
    assert_arrives(planner.plan(costmap, START, Goal(goal.x, goal.y, yaw)), costmap, goal, 1.0)


@pytest.mark.parametrize("name", NAMES)
def test_a_goal_with_no_reachable_place_near_it_has_no_path(name):
    with pytest.raises(NoPathError):
        create_planner(name, goal_tolerance=0.3).plan(hall(wall=True), START, Pose2D(6.0, 4.14, 0.0))


@pytest.mark.parametrize("name", GRID_PLANNERS)
def test_a_goal_that_cannot_be_turned_into_is_moved_to_where_there_is_room(name):
    costmap, goal = hall(), Pose2D(11.7, 4.0, math.pi)  # its tail to the wall, and no room to turn there
    assert not costmap.footprint_collides([(11.3, 4.0, math.pi)])[0]
    for tight in (Pose2D(11.3, 4.0, math.pi), goal):
        path = create_planner(name, goal_tolerance=0.8).plan(costmap, START, tight)
        assert_arrives(path, costmap, tight, 0.8)
        assert path.goal.yaw == pytest.approx(math.pi)
    with pytest.raises(PlanningStoppedError, match="none found within"):
        create_planner(name, goal_tolerance=0.0).plan(costmap, START, Pose2D(11.3, 4.0, math.pi))


@pytest.mark.parametrize("name", NAMES)
def test_with_a_free_yaw_a_goal_is_moved_to_where_the_footprint_fits(name):
    costmap, goal = hall(), Pose2D(11.97, 4.0)
    path = create_planner(name, goal_tolerance=0.9).plan(costmap, START, Goal(goal.x, goal.y))
    assert_arrives(path, costmap, goal, 0.9)


@pytest.mark.parametrize("name", NAMES)
def test_a_free_goal_beyond_a_wall_is_not_moved_through_it(name):
    with pytest.raises(NoPathError):
        create_planner(name, goal_tolerance=2.0).plan(hall(wall=True), START, Pose2D(6.0, 4.8, 0.0))
