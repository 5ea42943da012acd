"""A run with a lidar beside a busy thread, in a child process: a kernel without the GIL where it needs it ends that."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_busy_thread_changes_no_scan(backend):
    child = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-m", "support.lidar_beside_thread", backend],
        env=os.environ | {"PYTHONPATH": str(TESTS)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert child.returncode == 0, child.stderr[-2000:]
    count, answer = child.stdout.split()
    assert int(count) > 100
    assert answer == "same"
