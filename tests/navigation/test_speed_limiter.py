"""What a speed mask makes of a whole path, before anything moves."""

import math

import numpy as np
import pytest

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.navigation.speed_limiter import fastest_s, limits_along
from trundle.path import Path
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
