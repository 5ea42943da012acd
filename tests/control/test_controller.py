"""What a controller means to command next, and what a collision monitor makes of it."""

import math

import numpy as np
import pytest

from support.scan_scenes import scan_scene
from trundle.control import CollisionMonitor, Intent, MonitorSettings
from trundle.geometry import Pose2D, Twist2D, integrate_twist
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
DT = 0.05


def test_poses_follow_the_twists_one_after_the_other():
    intent = Intent(np.array([[1.0, 0.0], [0.5, 1.0]]), 0.1)
    poses = intent.poses(np.array([0.0, 0.05, 0.1, 0.3]))
    assert poses[:3] == pytest.approx(np.array([[0, 0, 0], [0.05, 0, 0], [0.1, 0, 0]]))
    assert poses[3] == pytest.approx(integrate_twist(0.1, 0.0, 0.0, 0.5, 1.0, 0.2))


def test_it_begins_with_its_own_command_only():
    intent = Intent(np.array([[0.5, 0.1]]), 0.1)
    assert intent.begins_with(Twist2D(0.5, 0.1))
    assert not intent.begins_with(Twist2D(0.25, 0.05))
    assert not Intent(np.zeros((0, 2)), 0.1).begins_with(Twist2D())


def watch(intent, command, *, disc=None, wall=None, settings=None):
    """The last report of a robot that stands in a scene for a second."""
    monitor = CollisionMonitor(CARTER, settings)
    report = None
    for tick in range(20):
        time = tick * DT
        discs = [] if disc is None else [disc(time)]
        scan = scan_scene(discs, [] if wall is None else [wall], time=time)
        monitor.set_intent(intent)
        report = monitor.check(command, Twist2D(), [scan], time, Pose2D(0.0, 0.0))
    return report


def test_a_curve_that_passes_a_wall_is_not_slowed_down():
    wall = (0.9, -3.0, 0.9, 3.0)
    command = Twist2D(0.8, 0.3)
    turning = Intent(np.array([[0.8, 0.3], *[[0.1, 0.7]] * 40]), DT)
    assert watch(None, command, wall=wall).action == "approach"
    assert watch(turning, command, wall=wall).action == "none"
    assert watch(turning, Twist2D(0.8, 0.2), wall=wall).action == "approach"  # not the command that it begins with


def test_braking_in_time_counts_whatever_is_intended():
    wall = (CARTER.outline[:, 0].max() + 0.03, -3.0, CARTER.outline[:, 0].max() + 0.03, 3.0)
    hopeful = Intent(np.array([[0.8, 0.0], *[[-1.0, 0.0]] * 40]), DT)
    assert watch(hopeful, Twist2D(0.8, 0.0), wall=wall).command.v < 0.05


def test_it_lets_the_robot_leave_the_place_that_something_comes_to():
    coming = lambda time: (-0.6, -2.8 + 1.2 * time, 0.3)  # noqa: E731
    command = Twist2D(0.1, 0.0)
    away = Intent(np.array([[min(0.1 + 0.1 * step, 1.0), 0.0] for step in range(40)]), DT)
    assert watch(None, command, disc=coming).action == "stop"
    assert watch(away, command, disc=coming).action == "none"


def test_it_stops_what_means_to_drive_into_something_that_moves():
    crossing = lambda time: (1.6, -2.0 + 1.0 * time, 0.3)  # noqa: E731
    ahead = Intent(np.full((40, 2), [0.8, 0.0]), DT)
    report = watch(ahead, Twist2D(0.8, 0.0), disc=crossing)
    assert report.action == "stop"
    assert math.isfinite(report.time_to_contact)
    off = MonitorSettings(moving_padding=0.0)
    assert watch(ahead, Twist2D(0.8, 0.0), disc=crossing, settings=off).action == "approach"
