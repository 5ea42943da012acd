import numpy as np

from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.navigation.route_planner import goal_in_window
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")


def make_window(blocked=None):
    cells = np.zeros((200, 200), np.int8)
    if blocked is not None:
        cells[blocked] = 100
    return Costmap.from_grid(OccupancyGrid(cells, 0.05), CARTER)


def test_a_goal_in_the_window_stays_as_it_is():
    goal = Goal(8.0, 5.0, 0.3)
    assert goal_in_window(make_window(), Pose2D(2.0, 5.0), goal) is goal


def test_a_goal_outside_gives_the_nearest_place_that_the_robot_fits_into():
    goal = goal_in_window(make_window(), Pose2D(2.0, 5.0), Goal(30.0, 5.0, 0.3))
    assert goal.yaw_free
    assert abs(goal.y - 5.0) < 0.1
    assert 9.0 < goal.x < 10.0 - CARTER.circumscribed_radius


def test_places_behind_a_wall_are_not_taken():
    wall = (slice(None), slice(120, 124))
    costmap = make_window(wall)
    goal = goal_in_window(costmap, Pose2D(2.0, 5.0), Goal(30.0, 5.0))
    assert goal.x < 6.0
    assert costmap.cost_at(goal.x, goal.y) < INSCRIBED


def test_a_robot_that_cannot_get_anywhere_keeps_its_goal():
    goal = Goal(30.0, 5.0)
    costmap = make_window((slice(None), slice(None)))
    assert goal_in_window(costmap, Pose2D(2.0, 5.0), goal) is goal
    assert goal_in_window(make_window(), Pose2D(-20.0, 5.0), goal) is goal


def test_a_robot_drives_beyond_a_window_that_moves_with_it():
    scenario = Scenario.make(
        world={"name": "warehouse", "seed": 3, "options": {"size": [16, 12], "low_objects": False}},
        backend="kinematic",
        lidar=True,
        known_map=False,
        layers={"rolling_window": True, "width": 8.0, "height": 8.0},
        seed=3,
    )
    with scenario.build() as mission:
        episode = mission.run()
        assert mission.navigator.costmap.shape == (160, 160)
    assert episode.arrived, episode.message
    assert np.hypot(*(episode.trajectory.poses[-1, :2] - episode.trajectory.poses[0, :2])) > 4.0


def test_so_does_one_with_a_map():
    scenario = Scenario.make(
        world={"name": "warehouse", "seed": 3, "options": {"low_objects": False}},
        backend="kinematic",
        lidar=True,
        layers={"rolling_window": True, "width": 12.0, "height": 12.0},
        seed=3,
    )
    with scenario.build() as mission:
        episode = mission.run()
    assert episode.arrived, episode.message
