"""`trundle evaluate` as a process: what it prints, and what is left when it is stopped."""

import io
import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from support.processes import are_gone, started_by
from trundle.cli.evaluate.execution import ProgressLine
from trundle.evaluation import Evaluation
from trundle.evaluation.engine import Progress

# The bound is 2 s; a machine that does other things too gets more.
END_S = 60.0


def command(room_map: str, out: Path, *more: str, seeds: int) -> list[str]:
    given = [
        "--planners",
        "astar",
        "--backends",
        "kinematic",
        "--seeds",
        f"0:{seeds}",
        "--workers",
        "2",
        "-o",
        str(out),
    ]
    return [sys.executable, "-m", "trundle", "evaluate", room_map, *given, *more]


def count_rows(out: Path) -> int:
    journal = out / "journal.jsonl"
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_evaluation_that_is_stopped_says_how_to_continue_it(room_map, tmp_path, number):
    out = tmp_path / "out"
    driver = subprocess.Popen(
        command(room_map, out, seeds=40),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while count_rows(out) < 3:
        assert driver.poll() is None, driver.communicate()
        time.sleep(0.02)
    started = started_by(driver.pid)
    assert len(started) >= 3  # two workers and the server that they are forked from
    os.kill(driver.pid, number)
    _, errors = driver.communicate(timeout=END_S)
    assert driver.returncode == 130
    assert f"of 40 episodes; to continue, give the same command with -o {out}" in errors
    assert "Traceback" not in errors
    assert are_gone(started, END_S)
    kept = {row.id for row in Evaluation(out).rows()}
    assert 3 <= len(kept) < 40
    done = subprocess.run(command(room_map, out, "--json", seeds=40), capture_output=True, text=True, check=True)
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    assert lines[0]["resumed"] == lines[0]["done"] == len(kept)
    assert (lines[-2]["done"], lines[-1]["episodes"]) == (40, 40)
    assert kept <= {row.id for row in Evaluation(out).rows()}


def test_json_lines_come_also_while_no_episode_ends(monkeypatch):
    printed = threading.Event()

    class Stream(io.StringIO):
        def flush(self):
            if self.getvalue().count("\n") >= 4:
                printed.set()

    monkeypatch.setattr("sys.stdout", Stream())
    with ProgressLine(json=True, every_s=0.01) as line:
        line.show(Progress("out", 10))
        assert printed.wait(30)
        lines = [json.loads(text) for text in sys.stdout.getvalue().splitlines()]
    assert {(each["done"], each["total"]) for each in lines} == {(0, 10)}


def test_a_reader_that_is_gone_ends_the_evaluation(monkeypatch):
    class Closed(io.StringIO):
        def write(self, text):
            raise BrokenPipeError

    monkeypatch.setattr("sys.stdout", Closed())
    with ProgressLine(json=True, every_s=0.01) as line:
        line._last = Progress("out", 10)
        line._thread.join(30)
        with pytest.raises(BrokenPipeError):
            line.show(Progress("out", 10))
