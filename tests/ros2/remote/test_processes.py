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

TWIST, ODOMETRY = "geometry_msgs/msg/Twist", "nav_msgs/msg/Odometry"
PATIENCE_S = 120.0
"""Until a test gives up waiting: far longer than it takes, on any machine."""
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


class Listener:
    """Hears the commands to the robot, and its odometry."""

    def __init__(self, domain: int) -> None:
        self._node, self._codec = DdsTransport(Settings(domain=domain, distro="jazzy"), node="test"), Codec("jazzy")
        self._readers = {
            kind: self._node.subscription(topic, kind, Qos(100))
            for topic, kind in (("/cmd_vel", TWIST), ("/odom", ODOMETRY))
        }

    def close(self) -> None:
        self._node.close()

    def wait_until(self, kind: str, true: Callable[[Any], bool]) -> None:
        """Wait until this is true of the newest message of a type."""
        until, newest = time.monotonic() + PATIENCE_S, None
        while newest is None or not true(newest):
            assert time.monotonic() < until, f"waited in vain, at last for {newest}"
            time.sleep(0.05)
            newest = next((self._codec.decode(kind, one.data) for one in self._readers[kind].take()[-1:]), newest)


def end(process: subprocess.Popen[str], number: int = signal.SIGINT) -> dict[str, Any]:
    """End a process, and return how it says that it ended."""
    process.send_signal(number)
    out, _ = process.communicate(timeout=PATIENCE_S)
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
    out, said = navigate.communicate(timeout=PATIENCE_S)
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
    out, said = navigate.communicate(timeout=PATIENCE_S)
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
    assert min(counts[name] for name in ("/front/scan", "/back/scan", "/odom", "/cmd_vel", "/tf")) > 3


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.slow
def test_the_robot_stands_after_the_end(start: Start, served: subprocess.Popen[str], domain: int, number: int) -> None:
    navigate = start(*NAVIGATE, "--goal", "12,0")
    assert navigate.stdout is not None
    navigate.stdout.readline()
    with contextlib.closing(Listener(domain)) as listener:
        listener.wait_until(ODOMETRY, lambda odometry: odometry.pose.pose.position.x > 0.3)
        navigate.send_signal(number)
        navigate.communicate(timeout=PATIENCE_S)
        assert navigate.returncode == 1
        listener.wait_until(TWIST, lambda command: command.linear.x == command.angular.z == 0.0)
    assert end(served)["distance_m"] > 0.2


@pytest.mark.slow
def test_without_a_robot_it_says_what_is_missing(start: Start) -> None:
    navigate = start(*NAVIGATE, "--goal", "4,0")
    assert navigate.stderr is not None
    assert any("scans of front: nothing has come yet" in line for line in navigate.stderr)
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
        out, _ = shell.communicate(timeout=PATIENCE_S)
        assert json.loads(out)["message"] == "stopped by Ctrl-C"
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)
        shell.kill()
