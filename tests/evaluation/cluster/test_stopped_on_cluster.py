"""`trundle evaluate --ray auto` as a process that is stopped."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from support.processes import are_gone, started_by
from trundle.evaluation import Evaluation

pytestmark = pytest.mark.ray

_END_S = 60.0


def _runs_episodes(pids: set[int]) -> bool:
    for pid in pids:
        try:
            if b"trundle.evaluation.pool" in Path(f"/proc/{pid}/cmdline").read_bytes():
                return True
        except OSError:
            continue
    return False


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_evaluation_ends_the_cluster_that_it_started(
    loopback: None, room: Any, tmp_path: Path, number: int
) -> None:
    room.save(tmp_path / "room.yaml")
    out = tmp_path / "out"
    given = ["--backends", "kinematic", "--planners", "astar", "--seeds", "0:40000", "--workers", "1"]
    driver = subprocess.Popen(
        [sys.executable, "-m", "trundle", "evaluate", tmp_path / "room.yaml", *given, "-o", out, "--ray", "auto"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    until = time.monotonic() + _END_S
    while not _runs_episodes(started := started_by(driver.pid)):
        assert driver.poll() is None, driver.communicate()
        assert time.monotonic() < until
        time.sleep(0.1)
    os.kill(driver.pid, number)
    _, errors = driver.communicate(timeout=_END_S)
    assert driver.returncode == 130
    assert f"of 40,000 episodes; to continue, give the same command with -o {out}" in errors
    assert "Traceback" not in errors
    assert len(Evaluation(out)) < 40000
    assert are_gone(started, _END_S)
