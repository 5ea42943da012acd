import math

import numpy as np
import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import Localizer, create_localizer, localizer_names
from trundle.localization.localizer import check_covariance
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


def test_it_needs_a_start():
    localizer = _make()
    with pytest.raises(InputError, match="'odometry' needs a start"):
        localizer.reset(None)
    with pytest.raises(InputError, match="give it a pose"):
        localizer.reinitialize_global()


class PoseAlone:
    """A localizer with the least that one must have."""

    def reset(self, pose):
        self.pose = pose

    def update(self, observation):
        return self.pose


class Searching(PoseAlone):
    """Takes a covariance and no seed, and finds its pose by itself."""

    covariance = None

    def reset(self, pose, *, covariance=None):
        self.pose, self.covariance = (Pose2D(5.0, 5.0) if pose is None else pose), covariance

    def reinitialize_global(self):
        self.pose = Pose2D(6.0, 6.0)


def test_one_of_another_package_gets_what_it_takes_of_a_start():
    plain, searching = PoseAlone(), Searching()
    localizer = create_localizer(plain, None, Robot.load("jackal"))
    localizer.reset(Pose2D(1.0, 2.0), covariance=np.eye(3), seed=4)
    assert localizer.update(_see(0.0, Pose2D(0.0, 0.0))).pose == Pose2D(1.0, 2.0)
    with pytest.raises(InputError, match=r"no reinitialize_global\(\): it needs a start"):
        localizer.reset(None)
    with pytest.raises(InputError, match=r"no reinitialize_global\(\): give it a pose"):
        localizer.reinitialize_global()
    localizer = create_localizer(searching, None, Robot.load("jackal"))
    localizer.reset(Pose2D(1.0, 2.0), covariance=np.eye(3), seed=4)
    assert np.array_equal(searching.covariance, np.eye(3))
    localizer.reset(None)
    assert localizer.update(_see(0.0, Pose2D(0.0, 0.0))).pose == Pose2D(5.0, 5.0)
    localizer.reinitialize_global()
    assert localizer.update(_see(0.1, Pose2D(0.0, 0.0))).pose == Pose2D(6.0, 6.0)


@pytest.mark.parametrize(
    ("covariance", "words"),
    [
        (np.eye(2), "3 x 3 finite numbers"),
        (np.full((3, 3), np.nan), "3 x 3 finite numbers"),
        ([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "not symmetric"),
        (np.diag([1.0, -1.0, 1.0]), "not positive semidefinite"),
        ("wide", "array of numbers"),
    ],
)
def test_a_covariance_that_is_none_is_refused(covariance, words):
    with pytest.raises(InputError, match=words):
        check_covariance(covariance, "the start")
