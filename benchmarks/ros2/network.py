"""What the benchmarks share: the real ROS on the other side, a domain of their own, and the load of the machine."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from ros2.domains import claim_domain, release_domain
from trundle.messages.codec import Distro
from trundle.ros2.transport.domain import read_settings
from trundle.ros2.transport.opening import open_transport
from trundle.ros2.transport.transport import Transport

ROOT = Path(__file__).parents[2]
PEER = Path(__file__).with_name("peer.py")

_domains: list[int] = []
"""The one that this program uses."""


def ros(distro: str) -> tuple[str, Mapping[str, str]]:
    """The Python of a real ROS 2 and its environment; ends the program with the reason where there is none."""
    described = subprocess.run(
        [sys.executable, ROOT / "scripts" / "ros2_env.py", "--describe", distro],
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(described.stdout)[distro]
    if "reason" in found:
        raise SystemExit(found["reason"])
    return found["python"], found["env"]


def own_domain() -> int:
    """A domain that no test and no other benchmark uses; it is put into the environment."""
    if _domains:
        release_domain(_domains.pop())
    _domains.append(claim_domain())
    os.environ["ROS_DOMAIN_ID"] = str(_domains[-1])
    return _domains[-1]


def join(transport: Literal["dds", "rclpy"], distro: Distro) -> Transport:
    """A node of trundle's in the domain of the environment; rclpy is that of the real ROS 2."""
    python = None
    if transport == "rclpy":
        python, variables = ros(distro)
        os.environ.update(variables)
    return open_transport(transport, settings=read_settings(distro=distro), python=python)


class Peer:
    """A running peer.py, whose JSON lines are read one after another."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def read(self) -> dict[str, Any]:
        """The next line."""
        line = self.process.stdout.readline() if self.process.stdout else ""
        if not line:
            raise SystemExit("the other side has ended")
        return json.loads(line)


@contextmanager
def peer(distro: str, *arguments: object) -> Iterator[Peer]:
    """Start peer.py in the domain of the environment; it is ended with the block."""
    python, variables = ros(distro)
    environment = {**os.environ, **variables, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    with subprocess.Popen(
        [python, str(PEER), *map(str, arguments)], stdout=subprocess.PIPE, text=True, env=environment
    ) as process:
        try:
            yield Peer(process)
        finally:
            process.kill()


@contextmanager
def started(transport: str, distro: str, *arguments: str) -> Iterator[tuple[subprocess.Popen[str], dict[str, Any]]]:
    """`trundle ros2` with these arguments, and the line with which it says what it offers."""
    command = [sys.executable, "-m", "trundle", "ros2", *arguments, "--json", "--quiet"]
    command += ["--transport", transport, "--distro", distro]
    environment = dict(os.environ)
    if transport == "rclpy":
        python, variables = ros(distro)
        command += ["--ros-python", python]
        environment |= variables
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            line = process.stdout.readline() if process.stdout else ""
            if not line.rstrip().endswith("}"):
                raise SystemExit(f"trundle ros2 {arguments[0]} has ended")
            yield process, json.loads(line)
        finally:
            process.kill()


@contextmanager
def served(transport: str, distro: str, *arguments: str) -> Iterator[tuple[subprocess.Popen[str], dict[str, Any]]]:
    """`trundle ros2 serve warehouse` with these arguments, and the line with which it says what it offers."""
    with started(transport, distro, "serve", "warehouse", *arguments, "--profile", "turtlebot3") as running:
        yield running


def ended(process: subprocess.Popen[str], timeout_s: float) -> dict[str, Any]:
    """How a started program says that it ended; it is interrupted first if it still runs."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=timeout_s)
    return json.loads(out.splitlines()[-1])


def load() -> str:
    """How busy the machine is, to stand beside a figure."""
    return f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"


def percentile(values: Sequence[float], share: float) -> float:
    """The value below which this share of the values lies."""
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]
