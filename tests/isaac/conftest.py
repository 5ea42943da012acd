"""The runner of scripts for Isaac Sim; where there is no environment for it, the tests that need one are skipped."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from trundle.testing.isaac import environment

HERE = Path(__file__).parent
COMMAND = [sys.executable, "-m", "trundle.testing.isaac"]


def start(*arguments: object, cwd: Path | None = None, **env: str) -> subprocess.CompletedProcess[str]:
    """Run `python -m trundle.testing.isaac`."""
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(
        command, cwd=cwd, env=os.environ | env, capture_output=True, text=True, check=False, timeout=500
    )


@cache
def reason() -> str:
    """Why there is no environment; empty if there is one."""
    try:
        environment.find()
    except environment.UnavailableError as error:
        return str(error)
    return ""


@pytest.fixture(scope="session")
def isaac() -> Callable[..., subprocess.CompletedProcess[str]]:
    """The runner, on NVIDIA's packages."""
    if reason():
        pytest.skip(f"no Python with NVIDIA's packages (make test-isaac): {reason()}")
    return start


@pytest.fixture(scope="session")
def program(isaac: Callable[..., Any]) -> Callable[..., Any]:
    """Runs one of `programs`, and gives what it prints as its last line of JSON."""

    def run(name: str, *arguments: object, **options: Any) -> Any:
        done = isaac("--seconds", 2000, HERE / "programs" / f"{name}.py", *arguments, **options)
        assert done.returncode == 0, done.stdout + done.stderr
        return json.loads(done.stdout.splitlines()[-1])

    return run
