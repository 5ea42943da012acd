"""`trundle ros2 navigate` drives the robot of `trundle ros2 serve`, in two processes over Cyclone DDS."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2.domains import claim_domain, release_domain
from trundle.bags.bag_reader import BagReader
from trundle.maps import OccupancyGrid
from trundle.messages import Codec, Qos
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings

pytest.importorskip("rosbags", reason="rosbags is not installed")
pytest.importorskip("cyclonedds", reason="cyclonedds is not installed, or has no wheel here")

TWIST = "geometry_msgs/msg/Twist"
Start = Callable[..., subprocess.Popen[str]]


@pytest.fixture
def domain() -> Iterator[int]:
    """A domain that nobody else uses."""
    claimed = claim_domain()
    yield claimed
    release_domain(claimed)


@pytest.fixture
def start(domain: int) -> Iterator[Start]:
    """Starts `trundle ros2` on a domain of its own; what runs is ended after the test."""
    made: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> subprocess.Popen[str]:
        command = [
            sys.executable,
            "-m",
            "trundle",
            "ros2",
            *arguments,
            "--transport",
            "dds",
            "--domain",
            str(domain),
            "--json",
        ]
        made.append(subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
        return made[-1]

    yield start
    for process in made:
        process.kill()
        process.communicate()


def wait_until_commanded(domain: int) -> None:
    """Wait until the robot is commanded to drive fast."""
    node, codec, until = DdsTransport(Settings(domain=domain, distro="jazzy"), node="test"), Codec("jazzy"), 60.0
    until += time.monotonic()
    try:
        commands = node.subscription("/cmd_vel", TWIST, Qos(10))
        while not any(codec.decode(TWIST, one.data).linear.x > 0.3 for one in commands.take()):
            assert time.monotonic() < until, "the robot is not commanded"
            time.sleep(0.05)
    finally:
        node.close()


def end(process: subprocess.Popen[str], number: int = signal.SIGINT) -> dict[str, Any]:
    """End a process, and return how it says that it ended."""
    process.send_signal(number)
    out, _ = process.communicate(timeout=30)
    return json.loads(out.splitlines()[-1])


@pytest.fixture
def served(start: Start) -> subprocess.Popen[str]:
    """A robot whose odometry drifts."""
    serve = start(
        *("serve", "warehouse", "--robot", "nova_carter", "--start", "0,0,0", "--backend", "kinematic"),
        *("--odometry", "scale=0.01", "--odometry", "heading=1deg"),
    )
    assert serve.stdout is not None
    assert json.loads(serve.stdout.readline())["role"] == "simulator"
    return serve


NAVIGATE = ("navigate", "warehouse", "--robot", "nova_carter", "--start", "0,0,0")


def test_it_drives_there_and_exits_with_0(start: Start, served: subprocess.Popen[str]) -> None:
    navigate = start(*NAVIGATE, "--goal", "2,0")
    out, said = navigate.communicate(timeout=90)
    assert navigate.returncode == 0, out.splitlines()[-1] + said
    ended = json.loads(out.splitlines()[-1])
    assert ended["message"] == "arrived"
    assert end(served)["distance_m"] > 1.5


@pytest.mark.slow
def test_it_drives_without_a_map_and_saves_the_one_that_it_makes(
    start: Start, served: subprocess.Popen[str], tmp_path: Path
) -> None:
    made, wire = tmp_path / "made.yaml", tmp_path / "wire.mcap"
    navigate = start(
        *("navigate", "--localizer", "slam", "--robot", "nova_carter", "--goal", "2,0"),
        *("--save-map", str(made), "--record", "--out", str(wire)),
    )
    out, said = navigate.communicate(timeout=90)
    assert navigate.returncode == 0, out.splitlines()[-1] + said
    ended = json.loads(out.splitlines()[-1])
    assert ended["map"] == str(made)
    grid = OccupancyGrid.load(made)
    assert (grid.data == 0).sum() > 10_000
    row, col = grid.world_to_cell(2.0, 0.0)
    assert grid.data[row, col] == 0
    with BagReader(wire) as bag:
        counts = {topic.name: topic.count for topic in bag.topics}
    assert counts["/map"] >= 2
    assert min(counts[name] for name in ("/front/scan", "/back/scan", "/odom", "/cmd_vel", "/tf")) > 10


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.slow
def test_the_robot_stands_after_the_end(start: Start, served: subprocess.Popen[str], domain: int, number: int) -> None:
    navigate = start(*NAVIGATE, "--goal", "12,0")
    assert navigate.stdout is not None
    navigate.stdout.readline()
    wait_until_commanded(domain)
    time.sleep(1.0)
    navigate.send_signal(number)
    navigate.communicate(timeout=30)
    assert navigate.returncode == 1
    ended = end(served)
    assert ended["distance_m"] > 0.2
    assert "cmd_vel: timeout" not in ended["warnings"]


@pytest.mark.slow
def test_without_a_robot_it_says_what_is_missing(start: Start) -> None:
    navigate = start(*NAVIGATE, "--goal", "4,0")
    assert navigate.stdout is not None
    navigate.stdout.readline()
    time.sleep(3.0)
    stops = end(navigate)["stops"]
    assert "odometry missing" in stops
    assert "scans of front missing" in stops


@pytest.mark.slow
def test_kill_int_ends_a_server_that_was_started_in_the_background(domain: int) -> None:
    """A shell without job control lets background processes ignore SIGINT."""
    serve = f"{sys.executable} -m trundle ros2 serve warehouse --transport dds --domain {domain} --json"
    script = f"{serve} & echo $!; wait"
    shell = subprocess.Popen(["sh", "-c", script], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    assert shell.stdout is not None
    number = int(shell.stdout.readline())
    try:
        shell.stdout.readline()  # what is offered
        os.kill(number, signal.SIGINT)
        out, _ = shell.communicate(timeout=20)
        assert json.loads(out)["message"] == "stopped by Ctrl-C"
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
        shell.kill()
