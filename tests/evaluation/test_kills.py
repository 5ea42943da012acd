"""An evaluation whose processes are killed gives the rows of one that nobody interrupted; benchmarks/ has 100 kills."""

import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from support.processes import children_of, kill
from trundle.evaluation import Suite
from trundle.evaluation.engine import run_suite
from trundle.evaluation.store import Results

EPISODES = 16


@pytest.fixture(scope="module")
def suite_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("suite") / "suite.yaml"
    worlds = [{"name": "cylinders", "seed": 1}, {"name": "office", "seed": 1}]
    Suite.make(name="killed", worlds=worlds, backends="kinematic", seeds=EPISODES // 2).save(path)
    return path


@pytest.fixture(scope="module")
def uninterrupted(suite_file):
    folder = suite_file.parent / "uninterrupted"
    run_suite(Suite.load(suite_file), folder, workers=1)
    return rows_of(folder)


def rows_of(folder):
    return [row.unmeasured() for row in Results.open(folder).rows()]


def start(suite_file, folder):
    return subprocess.Popen(
        [sys.executable, "-m", "trundle", "evaluate", suite_file, "-o", folder, "--workers", "2", "--quiet"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )


def count_rows(folder):
    journal = folder / "journal.jsonl"
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


def wait_for_rows(process, folder, count):
    """False if the evaluation ends before it has so many rows."""
    while count_rows(folder) < count:
        if process.poll() is not None:
            return False
        time.sleep(0.005)
    return process.poll() is None


@pytest.mark.skipif(not Path("/proc").exists(), reason="finds processes in /proc")
@pytest.mark.parametrize("victim", ["driver", "server", "worker"])
def test_rows_after_kills_are_those_of_an_uninterrupted_evaluation(suite_file, uninterrupted, tmp_path, victim):
    folder = tmp_path / "killed"
    process = start(suite_file, folder)
    for count in sorted(random.Random(victim).sample(range(EPISODES - 2), 2)):
        if wait_for_rows(process, folder, count):
            below = children_of(process.pid)
            chosen = {"driver": [process.pid], "server": below, "worker": [w for s in below for w in children_of(s)]}
            kill(chosen[victim])
        if victim == "driver":
            process.communicate(timeout=120)
            process = start(suite_file, folder)
    _, said = process.communicate(timeout=120)
    assert process.returncode == 0, said
    assert rows_of(folder) == uninterrupted
