"""`trundle ros2 navigate` through the rclpy of a real ROS drives the robot of a server that does the same."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from ros2.conftest import JAZZY, Ros
from trundle.maps import OccupancyGrid

pytestmark = pytest.mark.ros2


def start(ros: Ros, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "trundle", "ros2", *arguments, "--transport", "rclpy", "--json"]
    return ros.start(command, TRUNDLE_ROS_PYTHON=ros.python)


@pytest.mark.parametrize("distro", JAZZY)
@pytest.mark.parametrize("localizer", ["amcl", "slam"])
@pytest.mark.slow
def test_it_drives_there_and_exits_with_0(ros: Ros, tmp_path: Path, localizer: str) -> None:
    served = start(ros, "serve", "warehouse", "--robot", "nova_carter", "--start", "0,0,0", "--backend", "kinematic")
    assert served.stdout is not None
    assert json.loads(served.stdout.readline())["transport"] == "rclpy"
    made = tmp_path / "made.yaml"
    more = (
        ("--localizer", "slam", "--save-map", str(made)) if localizer == "slam" else ("warehouse", "--start", "0,0,0")
    )
    navigate = start(ros, "navigate", *more, "--robot", "nova_carter", "--goal", "2,0")
    out, said = navigate.communicate(timeout=120)
    assert navigate.returncode == 0, out[-2000:] + said
    offered, ended = (json.loads(line) for line in out.splitlines())
    assert "/navigate_to_pose" in [one["name"] for one in offered["actions"]]
    assert "/map_saver/save_map" in [one["name"] for one in offered["services"]]
    assert ended["message"] == "arrived"
    assert localizer != "slam" or (OccupancyGrid.load(made).data == 0).sum() > 10_000
    served.send_signal(signal.SIGINT)
    out, _ = served.communicate(timeout=120)
    assert json.loads(out.splitlines()[-1])["distance_m"] > 1.5
