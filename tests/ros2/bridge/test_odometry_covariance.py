"""The covariance of odometry is that of its errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.ros2.outputs.motion import EXACT, OdometryCovariance
from trundle.sim.odometry_errors import OdometryErrors


def drive(errors, meters=10.0, steps=500, turn=0.0):
    made = OdometryCovariance(errors, Robot.load("nova_carter"))
    pose, step = Pose2D(0.0, 0.0), meters / steps
    for _ in range(steps + 1):
        made.update(pose, Twist2D(step / 0.02, 0.0), 0.02)
        pose = pose @ Pose2D(step, 0.0, turn / steps)
    return np.reshape(made.pose, (6, 6)), np.reshape(made.twist, (6, 6))


def test_odometry_without_errors_is_exact():
    pose, twist = drive(None)
    assert np.array_equal(pose, np.eye(6) * EXACT)
    assert np.array_equal(twist, np.eye(6) * EXACT)


def test_a_bias_of_the_distance_grows_with_the_distance():
    pose, twist = drive(OdometryErrors(scale=0.01))
    assert math.sqrt(pose[0, 0]) == pytest.approx(0.1, rel=1e-3)
    assert pose[1, 1] == pytest.approx(EXACT)
    assert math.sqrt(twist[0, 0]) == pytest.approx(0.01, rel=0.01)


def test_a_bias_of_the_heading_bends_the_path():
    pose, _ = drive(OdometryErrors(heading=0.02))
    assert math.sqrt(pose[5, 5]) == pytest.approx(0.2, rel=1e-2)
    assert math.sqrt(pose[1, 1]) == pytest.approx(0.02 * 10.0**2 / 2.0, rel=1e-2)
    assert pose[1, 5] > 0.0


def test_random_errors_add_up_as_variances():
    pose, _ = drive(OdometryErrors(walk=0.01, heading_walk=0.01))
    assert pose[0, 0] == pytest.approx(1e-4 * 10.0, rel=1e-2)
    assert pose[5, 5] == pytest.approx(1e-4 * 10.0, rel=1e-2)
    assert pose[1, 1] == pytest.approx(1e-4 * 10.0**3 / 3.0, rel=0.02)


def test_a_covariance_can_be_inverted():
    pose, _ = drive(OdometryErrors(scale=0.01, heading=0.02, slip=0.01), turn=3.0)
    assert np.linalg.eigvalsh(pose).min() > 0.0
    assert np.allclose(pose, pose.T)
