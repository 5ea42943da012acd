"""Real ROS 2 environments, built by scripts/ros2_env.py; where there is none, the tests that need one are skipped."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from ros2.domains import claim_domain, release_domain
from trundle.ros2.transport.domain import read_settings
from trundle.ros2.transport.rclpy.relay import RclpyTransport, open_rclpy

DISTROS = ("jazzy", "kilted")


def _mostly(usual: str) -> list[Any]:
    return [one if one == usual else pytest.param(one, marks=pytest.mark.ros2) for one in DISTROS]


JAZZY, KILTED = _mostly("jazzy"), _mostly("kilted")
"""`distro` of long tests that are much the same with each: every run takes this one, `make test-ros2` both."""

ROOT = Path(__file__).parents[2]


@cache
def described() -> dict[str, dict[str, object]]:
    """What scripts/ros2_env.py says of each distribution."""
    command = [sys.executable, str(ROOT / "scripts" / "ros2_env.py"), "--describe"]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


@dataclass
class Ros:
    """A real ROS 2 of one distribution, on a domain that nobody else uses, on this machine alone."""

    distro: str
    python: str
    env: dict[str, str]
    """What to add to a process's environment."""
    folder: Path
    started: list[subprocess.Popen[str]] = field(default_factory=list)

    @property
    def domain(self) -> int:
        return int(self.env["ROS_DOMAIN_ID"])

    def script(self, code: str | Path, *args: object, **env: str) -> subprocess.Popen[str]:
        """Start a script in ROS's Python, with pipes for what it reads and prints; it is killed after the test."""
        if isinstance(code, str):
            path = self.folder / f"script_{len(self.started)}.py"
            path.write_text(code, encoding="utf-8")
            code = path
        return self.start([self.python, "-u", str(code), *map(str, args)], **env)

    def start(self, command: list[str], **env: str) -> subprocess.Popen[str]:
        """Start any command with ROS's environment variables; it is killed after the test, with all that it started."""
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **self.env, **env},
            start_new_session=True,
        )
        self.started.append(process)
        return process

    def close(self) -> None:
        """Kill what still runs, and read what it said."""
        for process in self.started:
            if process.poll() is None:
                os.killpg(process.pid, 9)
            process.communicate()


def hashes(ros: Ros) -> dict[str, str]:
    """The hash of each type that an environment has."""
    found: dict[str, str] = {}
    for path in Path(ros.env["AMENT_PREFIX_PATH"], "share").glob("*/*/*.json"):
        if path.parent.name not in ("msg", "srv", "action"):
            continue
        for entry in json.loads(path.read_text())["type_hashes"]:
            found[entry["type_name"]] = entry["hash_string"].removeprefix("RIHS01_")
    return found


@contextmanager
def real_ros(distro: str, folder: Path) -> Iterator[Ros]:
    """A real ROS 2; the test is skipped where there is none."""
    if "reason" in (found := described()[distro]):
        pytest.skip(str(found["reason"]))
    env: dict[str, str] = {
        **found["env"],  # pyright: ignore[reportGeneralTypeIssues]
        "ROS_DOMAIN_ID": str(domain := claim_domain()),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_LOG_DIR": str(folder / "ros_log"),
        "PYTHONUNBUFFERED": "1",
    }
    real = Ros(distro, str(found["python"]), env, Path(tempfile.mkdtemp(dir=folder)))
    try:
        yield real
    finally:
        real.close()
        release_domain(domain)


@pytest.fixture(params=DISTROS)
def distro(request: pytest.FixtureRequest) -> str:
    """Each distribution."""
    return request.param


@pytest.fixture
def ros(distro: str, tmp_path: Path) -> Iterator[Ros]:
    """A real ROS 2, once for each distribution."""
    with real_ros(distro, tmp_path) as real:
        yield real


@pytest.fixture
def relay(ros: Ros, monkeypatch: pytest.MonkeyPatch) -> Iterator[RclpyTransport]:
    """The transport through its rclpy."""
    for name, value in ros.env.items():
        monkeypatch.setenv(name, value)
    opened = open_rclpy(read_settings(), python=ros.python)
    yield opened
    opened.close()
