"""Pools for tests."""

from __future__ import annotations

import time
from pathlib import Path

from support.pool_tasks import Ask
from trundle.evaluation.pool import Done, Pool


def make_pool(task=None, *, workers=1, deadline_s=60.0, memory_mb=2000.0, **options):
    return Pool(task or Ask(), workers=workers, deadline_s=deadline_s, memory_mb=memory_mb, **options)


def ask(pool, *job):
    [outcome] = pool.run([job])
    return outcome


def value_of(pool, *job):
    outcome = ask(pool, *job)
    assert isinstance(outcome, Done), outcome
    return outcome.value


def has_ended(pid):
    """Whether a process has ended or ends soon."""
    for _ in range(500):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except FileNotFoundError:
            return True
        if state == "Z":
            return True
        time.sleep(0.01)
    return False
