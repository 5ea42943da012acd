"""A program of a real ROS that looks up transforms, by the calls of tf2_ros: where the robot and its lidars are."""

from __future__ import annotations

import math

import pytest

from ros2.proof.conftest import Bench
from trundle.robots import Robot


def test_programs_find_the_robot_at_the_times_of_poses_and_scans(bench: Bench) -> None:
    lidar = Robot.load("nova_carter").lidars["front"]
    server = bench.serve("warehouse", "--role", "navigator", "--robot", "nova_carter", "--start", "0,0,0")
    client = bench.client("transforms.py", "base_link", "lidar_front", "6", "0")
    found = client.next()
    server.end()
    assert found["moved"] > 0.5
    assert found["off"] < 0.01
    assert found["mounts"] == pytest.approx([math.hypot(lidar.x, lidar.y)] * 2, abs=1e-6)
    assert 0.0 < found["past"] < found["moved"]
    assert (found["ahead"], found["before"]) == ("ExtrapolationException", "ExtrapolationException")
    assert found["unknown"] == "LookupException"
