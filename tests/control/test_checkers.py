import math

import pytest

from trundle.control import GoalChecker, ProgressChecker
from trundle.geometry import Pose2D, Twist2D

GOAL = Pose2D(1.0, 0.0, math.pi)
STAND = Twist2D()


@pytest.mark.parametrize(
    ("pose", "twist", "any_yaw", "reached"),
    [
        (Pose2D(1.0, 0.0, math.pi), STAND, False, True),
        (Pose2D(1.0, 0.24, -math.pi + 0.24), STAND, False, True),
        (Pose2D(1.0, 0.26, math.pi), STAND, False, False),
        (Pose2D(1.0, 0.0, math.pi - 0.26), STAND, False, False),
        (Pose2D(1.0, 0.0, 0.0), STAND, True, True),
        (Pose2D(1.0, 0.0, math.pi), Twist2D(0.1, 0.0), False, False),
        (Pose2D(1.0, 0.0, math.pi), Twist2D(0.0, 0.1), False, False),
    ],
)
def test_the_goal_is_reached_in_position_yaw_and_at_rest(pose, twist, any_yaw, reached):
    assert GoalChecker().is_reached(pose, twist, GOAL, any_yaw=any_yaw) is reached


def test_a_robot_that_stands_too_long_is_stuck():
    checker = ProgressChecker()
    assert checker.is_moving_on(Pose2D(0, 0), 0.0)
    assert checker.is_moving_on(Pose2D(0.49, 0), 10.0)
    assert not checker.is_moving_on(Pose2D(0.49, 0), 10.1)


def test_driving_or_turning_far_enough_restarts_the_timer():
    checker = ProgressChecker()
    checker.is_moving_on(Pose2D(0, 0), 0.0)
    assert checker.is_moving_on(Pose2D(0.5, 0), 9.0)
    assert checker.is_moving_on(Pose2D(0.5, 0, 0.5), 18.0)
    assert checker.is_moving_on(Pose2D(0.5, 0, 0.5), 28.0)
    assert not checker.is_moving_on(Pose2D(0.5, 0, 0.5), 28.1)
