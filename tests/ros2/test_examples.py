"""The examples for ROS 2, and `trundle ros2 check`, against a real ROS 2 on the other side of `trundle ros2 serve`."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from ros2.conftest import JAZZY, KILTED

EXAMPLES = Path(__file__).parents[2] / "examples" / "ros2"

GOALS = (6.975, 3.875, 2.425, -3.425)
"""A place in the office, and where the robot starts with seed 3."""

STAND_IN = Path(__file__).parent / "navigator_role" / "stand_in"
"""What takes the place of nav2_simple_commander, of which there are no wheels."""


@contextmanager
def served(ros, *arguments: str, **variables: str) -> Iterator[subprocess.Popen[str]]:
    """`trundle ros2 serve` in the domain of a real ROS 2; it has to end well on Ctrl-C."""
    command = [sys.executable, "-m", "trundle", "ros2", "serve", *arguments, "--json"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(ros.domain), **variables}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment, cwd=ros.folder) as process:
        try:
            assert process.stdout is not None
            assert json.loads(process.stdout.readline())["domain"] == ros.domain
            yield process
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=120) == 0
        finally:
            process.kill()


@pytest.mark.parametrize("distro", JAZZY)
def test_drive_by_scan_drives_the_robot_and_check_sees_both(ros) -> None:
    pytest.importorskip("cyclonedds")
    arguments = ("warehouse", "--profile", "turtlebot3", "--backend", "kinematic", "--speed", "5")
    with served(ros, *arguments, "--transport", "dds", "--distro", ros.distro):
        example = ros.script(EXAMPLES / "drive_by_scan.py", 10)
        check = [sys.executable, "-m", "trundle", "ros2", "check", "--transport", "dds", "--distro", ros.distro]
        looked = subprocess.run(
            [*check, "--domain", str(ros.domain), "--wait", "1", "--json"], capture_output=True, text=True, check=False
        )
        out, err = example.communicate(timeout=120)
    assert example.returncode == 0, err
    assert out.startswith("drove "), err
    assert float(out.split()[1]) > 0.5
    found = {one["about"]: one for one in json.loads(looked.stdout)["findings"]}
    assert "/trundle" in found["nodes"]["detail"]
    assert found["clock"]["status"] == "ok", found
    assert "x real time" in found["clock"]["detail"]


@pytest.mark.parametrize("distro", KILTED)
def test_drive_to_goals_sends_the_navigator_there_and_lets_it_spin(ros) -> None:
    arguments = ("office", "--role", "navigator", "--backend", "kinematic", "--seed", "3", "--speed", "max")
    with served(ros, *arguments, "--transport", "rclpy", "--ros-python", ros.python, **ros.env):
        example = ros.script(EXAMPLES / "drive_to_goals.py", *GOALS, PYTHONPATH=str(STAND_IN))
        out, err = example.communicate(timeout=180)
    assert example.returncode == 0, out + err
    lines = out.replace("\r", "\n").split("\n")
    assert sum(line.strip().endswith(": succeeded") for line in lines if line.startswith("to (")) == 2
    assert "spin: succeeded" in out
