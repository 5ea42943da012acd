import math

import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import Localizer, create_localizer, localizer_names
from trundle.observation import Observation
from trundle.robots import Robot


def _see(time, odometry):
    return Observation(time, Twist2D(), odometry)


def _make():
    return create_localizer("odometry", None, Robot.load("jackal"))


def test_it_is_made_by_name():
    assert "odometry" in localizer_names()
    assert isinstance(_make(), Localizer)
    with pytest.raises(UnknownNameError, match="odometry"):
        create_localizer("odometri", None, Robot.load("jackal"))


def test_the_robot_is_where_odometry_says_from_the_start_pose_on():
    localizer = _make()
    localizer.reset(Pose2D(2.0, 3.0, math.pi / 2))
    first = localizer.update(_see(0.0, Pose2D(1.0, 0.0, 0.0)))
    assert first.pose.as_tuple() == pytest.approx((2.0, 3.0, math.pi / 2))
    moved = localizer.update(_see(0.1, Pose2D(2.0, 0.0, 0.5)))
    assert moved.pose.as_tuple() == pytest.approx((2.0, 4.0, math.pi / 2 + 0.5))
    assert moved.T_map_odom == first.T_map_odom
    assert moved.odom_pose.as_tuple() == pytest.approx((2.0, 0.0, 0.5))


def test_a_reset_forgets_the_odometry_so_far():
    localizer = _make()
    localizer.reset(Pose2D(0.0, 0.0))
    localizer.update(_see(5.0, Pose2D(4.0, 0.0)))
    localizer.reset(Pose2D(1.0, 1.0))
    assert localizer.update(_see(0.0, Pose2D(9.0, 9.0))).pose.as_tuple() == pytest.approx((1.0, 1.0, 0.0))


def test_times_that_do_not_increase_are_refused():
    localizer = _make()
    localizer.reset(Pose2D(0.0, 0.0))
    localizer.update(_see(1.0, Pose2D(0.0, 0.0)))
    with pytest.raises(InputError, match="times must increase"):
        localizer.update(_see(1.0, Pose2D(0.1, 0.0)))
