"""What is left when the process that drives a pool is interrupted, ended or killed."""

import os
import signal
import subprocess
import sys
import time

import pytest

from support.processes import are_gone, kill, parent_of

DRIVER = """
import sys
from support.pool_tasks import Ask
from trundle.evaluation.pool import Pool

jobs = [("announce", sys.argv[1], k, True) for k in range(3)]
with Pool(Ask(), workers=3, deadline_s=600, memory_mb=None, fork=sys.argv[2] == "fork") as pool:
    for outcome in pool.run(jobs):
        print(outcome)
"""


def start_driver(folder, mode):
    """A driver whose three workers each hang in a job, and what ran then: those and their children."""
    driver = subprocess.Popen(
        [sys.executable, "-c", DRIVER, os.fspath(folder), mode],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    until = time.monotonic() + 60
    while len(files := list(folder.glob("*.pids"))) < 3:
        assert driver.poll() is None, driver.communicate()
        assert time.monotonic() < until
        time.sleep(0.02)
    return driver, [int(word) for file in files for word in file.read_text().split()]


@pytest.mark.parametrize("mode", ["fork", "spawn"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_nothing_is_left_of_a_driver_that_is_ended(tmp_path, number, mode):
    driver, pids = start_driver(tmp_path, mode)
    # As Ctrl-C in a terminal: the whole group of the driver.
    os.killpg(driver.pid, number)
    _, errors = driver.communicate(timeout=60)
    assert driver.returncode == -number, errors
    assert len(pids) == 6
    assert are_gone(pids)


def test_workers_end_with_their_server(tmp_path):
    driver, pids = start_driver(tmp_path, "fork")
    workers = [pids[k] for k in (0, 2, 4)]
    [server] = {parent_of(pid) for pid in workers}
    os.kill(driver.pid, signal.SIGSTOP)  # so that it starts no others
    os.kill(server, signal.SIGKILL)
    assert are_gone(workers)
    driver.kill()
    driver.communicate()
    kill(pids)
