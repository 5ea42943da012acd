"""`trundle ros2 serve` as a process beside a real ROS 2, and programs in plain rclpy."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2.conftest import Ros, real_ros
from ros2.lines import QUICK_S, Lines

CLIENTS = Path(__file__).parent / "clients"


class Server:
    """A `trundle ros2 serve`, which has said what it offers."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.lines = Lines(process)
        self.offer: dict[str, Any] = self.lines.next()

    @property
    def pid(self) -> int:
        return self.process.pid

    def end(self, signal_: int = signal.SIGINT) -> dict[str, Any]:
        """Interrupt it; what it says at the end."""
        self.process.send_signal(signal_)
        ended = self.lines.next()
        assert self.process.wait(QUICK_S) == 0, "".join(self.lines.errors)
        return ended


def asked(offered: Iterable[dict[str, Any]]) -> str:
    """What a listener asks for, who wants each topic as it is offered."""
    return json.dumps({one["topic"]: {key: one[key] for key in one if key != "topic"} for one in offered})


_LONG = pytest.mark.ros2
PAIRS = [
    pytest.param(("jazzy", "rclpy"), id="jazzy-rclpy"),
    pytest.param(("kilted", "dds"), id="kilted-dds"),
    pytest.param(("jazzy", "dds"), id="jazzy-dds", marks=_LONG),
    pytest.param(("kilted", "rclpy"), id="kilted-rclpy", marks=_LONG),
]
"""Distributions and transports: two for every run, the others for `make test-ros2`."""


class Bench:
    """`trundle ros2 serve` over a transport, beside programs of a real ROS 2."""

    def __init__(self, ros: Ros, transport: str) -> None:
        self.ros, self.transport = ros, transport

    @property
    def distro(self) -> str:
        return self.ros.distro

    def serve(self, *options: object, backend: str = "kinematic") -> Server:
        """Start `trundle ros2 serve` with options, and wait for what it offers; it is killed after the test."""
        command = [sys.executable, "-m", "trundle", "ros2", "serve", *map(str, options)]
        command += ["--backend", backend, "--transport", self.transport, "--json"]
        if self.transport == "rclpy":
            return Server(self.ros.start(command, TRUNDLE_ROS_PYTHON=self.ros.python))
        # Without ROS in sight.
        hidden = {"LD_LIBRARY_PATH": os.environ.get("LD_LIBRARY_PATH", ""), "AMENT_PREFIX_PATH": ""}
        return Server(self.ros.start(command, **hidden))

    def client(self, name: str, *arguments: object) -> Lines:
        """Start one of the programs in clients/; it is killed after the test."""
        return Lines(self.ros.script(CLIENTS / name, *arguments))


@contextlib.contextmanager
def bench_of(pair: tuple[str, str], folder: Path) -> Iterator[Bench]:
    """Both sides, for a distribution and a transport."""
    distro, transport = pair
    if transport == "dds":
        pytest.importorskip("cyclonedds", reason="no cyclonedds here: no transport dds")
    with real_ros(distro, folder) as ros:
        yield Bench(ros, transport)


@pytest.fixture(params=PAIRS)
def bench(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Bench]:
    """Both sides, for each pair of distribution and transport."""
    with bench_of(request.param, tmp_path) as bench:
        yield bench
