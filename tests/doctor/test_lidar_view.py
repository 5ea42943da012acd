import math

import pytest

from trundle.doctor import view_of_lidars
from trundle.robots import Robot


def test_the_scans_of_nova_carter_miss_pallets_forks_and_low_boxes():
    front, back = view_of_lidars(Robot.load("nova_carter"))
    assert (front.lidar, back.lidar) == ("front", "back")
    assert front.height == 0.418
    assert front.below == (0.06, 0.418)
    assert front.above == (0.418, 0.62)
    assert {"a EUR pallet", "the forks of a forklift", "a low box"} <= set(front.missed)
    assert "its beams are 0.418 m above the floor; it does not see what is between 0.06 and 0.418 m" in front.message


def test_a_lower_lidar_misses_less():
    (front,) = view_of_lidars(Robot.load("jackal"))
    assert front.below[1] == 0.297
    assert "a low box" not in front.missed
    assert "a EUR pallet" in front.missed
    assert front.field_of_view == pytest.approx(math.radians(270.0))
    assert "it covers 270°" in front.message


def test_what_the_robot_drives_over_is_not_missed():
    robot = Robot.load("nova_carter")
    high = robot.model_copy(update={"body": robot.body.model_copy(update={"clearance": 0.25})})
    assert view_of_lidars(high)[0].missed == ("a low box", "a pallet truck's body")


def test_a_lidar_on_top_of_a_low_robot_misses_nothing_above():
    robot = Robot.load("turtlebot3_waffle")
    low = robot.model_copy(update={"body": robot.body.model_copy(update={"height": 0.12})})
    assert view_of_lidars(low)[0].above is None


def test_a_lidar_below_the_underside_misses_nothing_below():
    robot = Robot.load("nova_carter")
    lidar = robot.lidars["front"].model_copy(update={"z": 0.05})
    (view,) = view_of_lidars(robot.model_copy(update={"lidars": {"floor": lidar}}))
    assert view.below is None
    assert view.missed == ()
    assert "it does not see what hangs between 0.05 and 0.62 m" in view.message
