import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.navigation.route_planner import free_ends, nearest_free_pose
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
START, GOAL = Pose2D(1.5, 3.0), Pose2D(4.0, 3.0, 0.0)


def costmap_with(*boxes):
    cells = np.zeros((120, 120), np.int8)
    for x0, y0, x1, y1 in boxes:
        cells[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = 100
    return Costmap.from_grid(OccupancyGrid(cells, 0.05), CARTER)


def goal_of(pose):
    return Goal(pose.x, pose.y, pose.yaw)


def test_a_free_pose_is_its_own_nearest():
    assert nearest_free_pose(costmap_with(), GOAL, 0.2) == GOAL


def test_the_nearest_free_pose_is_as_near_as_the_grid_allows():
    # The front edge is 0.14 m ahead: 6 cm of it are in the box.
    found = nearest_free_pose(costmap_with((4.1, 2.0, 5.0, 4.0)), GOAL, 0.3)
    assert (found.x, found.y, found.yaw) == pytest.approx((3.95, 3.0, 0.0))
    assert nearest_free_pose(costmap_with((3.5, 2.0, 5.0, 4.0)), GOAL, 0.3) is None


def test_any_yaw_will_do_where_it_may():
    walls = costmap_with((3.3, 2.0, 3.6, 4.0))  # 0.4 m behind: the tail of 0.6 m does not fit
    assert nearest_free_pose(walls, GOAL, 0.0) is None
    turned = nearest_free_pose(walls, GOAL, 0.0, any_yaw=True)
    assert (turned.x, turned.y) == (GOAL.x, GOAL.y)
    assert not walls.footprint_collides(turned.as_tuple())[0]


def test_ends_that_are_free_stay():
    assert free_ends(costmap_with(), costmap_with(), START, goal_of(GOAL), 0.25) == (START, goal_of(GOAL))


def test_a_start_that_is_touched_is_moved_a_little():
    start, _ = free_ends(costmap_with((1.6, 2.0, 1.8, 4.0)), costmap_with(), START, goal_of(GOAL), 0.25)
    assert 0.0 < start.distance_to(START) <= 0.15


def test_an_occupied_goal_is_moved_within_the_tolerance_or_refused():
    sensed = costmap_with((4.1, 2.0, 5.0, 4.0))
    _, goal = free_ends(sensed, costmap_with(), START, goal_of(GOAL), 0.25)
    assert 0.0 < goal.distance_to(GOAL) <= 0.2
    with pytest.raises(BlockedPoseError, match="occupied by something that is not on the map"):
        free_ends(costmap_with((3.5, 2.0, 5.0, 4.0)), costmap_with(), START, goal_of(GOAL), 0.25)


def test_a_goal_that_the_map_blocks_is_left_to_the_planner():
    walls = costmap_with((3.5, 2.0, 5.0, 4.0))
    assert free_ends(walls, walls, START, goal_of(GOAL), 0.25) == (START, goal_of(GOAL))
