"""Pools for tests."""

from __future__ import annotations

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
