"""What a planner makes of a goal: any yaw, or one that is wanted, in each form in which a goal can be given."""

import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import create_planner, plan_many, planner_names
from trundle.robots import Robot

START = Pose2D(2.0, 2.0, 0.0)
ARRIVAL = math.atan2(1.5, 2.0)  # of the straight line from the start to (4.0, 3.5)


@pytest.fixture(scope="module")
def room():
    data = np.zeros((100, 140), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05), Robot.load("nova_carter"))


@pytest.mark.parametrize("name", sorted({*planner_names()} - {"manhattan_astar", "hybrid_astar"}))
@pytest.mark.parametrize(
    ("goal", "yaw"),
    [
        (Goal(4.0, 3.5), ARRIVAL),
        ((4.0, 3.5), ARRIVAL),
        (np.array([4.0, 3.5]), ARRIVAL),
        (Goal(4.0, 3.5, 0.0), 0.0),
        ((4.0, 3.5, -2.0), -2.0),
        (Pose2D(4.0, 3.5), 0.0),
    ],
)
def test_a_goal_says_by_itself_whether_its_yaw_is_wanted(name, goal, yaw, room):
    path = create_planner(name).plan(room, START, goal)
    assert path.goal.as_tuple() == pytest.approx((4.0, 3.5, yaw), abs=1e-6)


def test_hybrid_astar_ends_with_the_yaw_it_arrives_with_only_where_any_will_do(room):
    planner = create_planner("hybrid_astar")
    assert planner.plan(room, START, Goal(4.0, 3.5, -2.0)).goal.yaw == pytest.approx(-2.0)
    path = planner.plan(room, START, Goal(4.0, 3.5))
    assert abs(path.goal.yaw - ARRIVAL) < 0.5


def test_each_of_many_goals_says_by_itself_whether_its_yaw_is_wanted(room):
    goals = [(4.0, 3.5), Goal(4.0, 3.5), Pose2D(4.0, 3.5), (4.0, 3.5, -2.0)]
    yaws = [path.goal.yaw for path in plan_many("least_cost", room, [START] * 4, goals)]
    assert yaws == pytest.approx([ARRIVAL, ARRIVAL, 0.0, -2.0])


@pytest.mark.parametrize("goal", [None, 3.0, "here", (1.0,), (1.0, 2.0, 3.0, 4.0), (1.0, math.nan)])
@pytest.mark.parametrize("make", ["least_cost", "manhattan_astar", lambda costmap, start, goal: [(0.0, 0.0)]])
def test_what_is_no_goal_is_refused_by_every_planner(make, goal, room):
    with pytest.raises(InputError, match="the goal must be"):
        create_planner(make).plan(room, START, goal)


def test_a_function_gets_a_goal_and_a_pose_whatever_is_given(room):
    given = []

    def mine(costmap, start, goal):
        given.append((start, goal))
        return [start.as_tuple(), goal.as_tuple()]

    planner = create_planner(mine)
    for goal in ((4.0, 3.5), Goal(4.0, 3.5), (4.0, 3.5, 1.0), Pose2D(4.0, 3.5, 1.0)):
        planner.plan(room, (2.0, 2.0), goal)
    assert all(isinstance(start, Pose2D) and isinstance(goal, Goal) for start, goal in given)
    assert [goal.yaw_free for _, goal in given] == [True, True, False, False]
