"""The limits of a speed mask along a whole path before anything moves, and ahead of the robot."""

import itertools
import math

import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.navigation import Navigator
from trundle.navigation.command_check import SpeedLimiter, fastest_s, limits_along, slow_down
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
TOP = CARTER.limits.linear_speed


def test_the_time_counts_what_lies_between_the_poses_of_a_path():
    mask = SpeedMask(OccupancyGrid([[25]], 2.0, Pose2D(4.0, -1.0)))
    path = Path(np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 0.0, math.pi]]))
    assert fastest_s(path, CARTER, None) == pytest.approx(10.0 / TOP)
    assert fastest_s(path, CARTER, mask) == pytest.approx(8.0 / TOP + 2.0 / (0.25 * TOP), abs=0.05 * 4.0 / TOP)


def test_limits_along_are_the_least_at_a_pose_and_beside_it():
    mask = SpeedMask(OccupancyGrid([[30, 0]], 1.0))
    poses = np.array([[0.5, -0.09, 0.0], [0.5, -0.11, 0.0], [0.5, -0.09, math.pi / 2], [1.09, 0.5, -math.pi / 2]])
    limits = limits_along(poses, mask, 1.0)
    assert limits == pytest.approx([0.3, math.inf, math.inf, 0.3])


DT = 0.05
SLOW = 0.2
QUICK = CARTER.model_copy(update={"limits": CARTER.limits.model_copy(update={"linear_speed": 3.0})})
ZONE = SpeedMask(
    OccupancyGrid(np.full((2, 4), 20), 1.0, Pose2D(0.0, -1.0)), unit="absolute", base=0.0, multiplier=SLOW / 20.0
)


def braking_distance(speed, deceleration):
    """From this speed to the zone's, after one more control period at it [m]."""
    return speed * DT + (speed**2 - SLOW**2) / (2.0 * deceleration)


@pytest.mark.parametrize("follows", [False, True])
@pytest.mark.parametrize("distance", [0.2, 0.5, 1.0, 2.0, 3.0])
def test_a_limit_ahead_is_come_down_to_with_half_of_the_deceleration(distance, follows):
    limiter = SpeedLimiter(ZONE, QUICK)
    pose, twist = Pose2D(-distance, 0.0), Twist2D(1.0, 0.0)
    kept = 0.05  # what a limit ahead is looked for every [m], and the step that it is rounded to
    if follows:
        limiter.set_path(PathCheck(Path(np.array([[-distance, 0.0, 0.0], [3.0, 0.0, 0.0]]))))
        kept += 0.1  # beside the path, so also before it
    allowed = limiter.limit(pose, twist, 0, DT)
    half = 0.5 * CARTER.limits.linear_acceleration
    assert distance - kept <= braking_distance(allowed, half) <= distance


def test_a_robot_that_keeps_to_what_is_allowed_brakes_with_half_of_its_deceleration():
    limiter, x, speeds = SpeedLimiter(ZONE, QUICK), -4.0, [3.0]
    while x < 0.0:
        speeds.append(min(3.0, limiter.limit(Pose2D(x, 0.0), Twist2D(speeds[-1], 0.0), 0, DT)))
        x += speeds[-1] * DT
    assert speeds[-1] == pytest.approx(SLOW, abs=0.15)
    braking = [before for before, after in itertools.pairwise(speeds) if after < before]
    seconds = len(braking) * DT
    assert (braking[0] - speeds[-1]) / seconds == pytest.approx(0.5 * CARTER.limits.linear_acceleration, rel=0.1)


def test_within_a_zone_its_limit_holds():
    limiter = SpeedLimiter(ZONE, QUICK)
    assert limiter.limit(Pose2D(0.5, 0.0), Twist2D(SLOW, 0.0), 0, DT) == pytest.approx(SLOW)
    assert limiter.limit(Pose2D(-9.0, 0.0), Twist2D(1.0, 0.0), 0, DT) == math.inf


@pytest.mark.parametrize("v", [0.8, -0.8])
def test_a_slower_command_keeps_its_arc(v):
    slower = slow_down(Twist2D(v, 0.6), 0.2)
    assert (abs(slower.v), slower.w / slower.v) == pytest.approx((0.2, 0.6 / v))
    assert slow_down(slower, 0.2) == slower


def test_a_new_path_that_is_shorter_than_what_was_driven_is_looked_ahead_from_its_beginning():
    grid = OccupancyGrid(np.zeros((120, 400), np.int8), 0.05)
    everywhere = SpeedMask(OccupancyGrid(np.full(grid.shape, 50, np.int8), grid.resolution))
    navigator = Navigator(grid, CARTER, speed_mask=everywhere)
    navigator.set_goal(17.0, 3.0)
    for x in np.arange(1.5, 13.0, 0.4).tolist():
        navigator.update((x, 3.0, 0.0))
    navigator.static_costmap = navigator.static_costmap.update(slice(60, 62), slice(300, 302), 100)
    assert navigator.update((x, 3.0, 0.0)).v > 0.0
    assert (navigator.replans, navigator.speed_limit) == (1, pytest.approx(0.5 * TOP))
