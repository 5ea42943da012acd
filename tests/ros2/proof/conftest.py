"""`trundle ros2 serve` as a process beside a real ROS 2, and programs in plain rclpy."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ros2.conftest import Ros, real_ros

CLIENTS = Path(__file__).parent / "clients"

QUICK_S = 40.0
"""Longer than anything waits here, on a loaded machine."""


class Lines:
    """What a process prints, line by line, without blocking for ever."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.errors: list[str] = []
        self._lines: queue.Queue[str | None] = queue.Queue()
        for stream, take in ((process.stdout, self._lines.put), (process.stderr, self.errors.append)):
            threading.Thread(target=self._read, args=(stream, take), daemon=True).start()

    def _read(self, stream: Any, take: Callable[[str], object]) -> None:
        with contextlib.suppress(ValueError):  # closed after the test
            for line in stream:
                take(line)
        if stream is self.process.stdout:
            self._lines.put(None)

    def next(self, within_s: float = QUICK_S) -> Any:
        """The next line, which is JSON."""
        try:
            line = self._lines.get(timeout=within_s)
        except queue.Empty:
            line = None
        assert line is not None, f"it said no more:\n{''.join(self.errors)}"
        return json.loads(line)

    def until(self, wanted: Callable[[Any], bool], within_s: float = QUICK_S) -> Any:
        """The first line that is wanted."""
        end = time.monotonic() + within_s
        while not wanted(found := self.next(max(0.1, end - time.monotonic()))):
            assert time.monotonic() < end, f"it said something else for {within_s:g} s, at last {str(found)[:200]}"
        return found

    def wait_for_error(self, words: str) -> None:
        """Wait until it complained so."""
        wait_for(lambda: any(words in line for line in self.errors), lambda: f"not said: {words}\n{self.errors}")


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


def wait_for(true: Callable[[], object], complaint: Callable[[], str] = lambda: "waited in vain") -> None:
    """Wait until something is true."""
    until = time.monotonic() + QUICK_S
    while not true():
        assert time.monotonic() < until, complaint()
        time.sleep(0.02)


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
