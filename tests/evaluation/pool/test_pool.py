import itertools
import signal

import pytest

from support.pool_tasks import Echo, FailingSetup, Planted
from support.pools import make_pool, value_of
from support.processes import are_gone
from trundle.errors import InputError
from trundle.evaluation.pool import Done, Failed


def test_every_job_is_done_once():
    with make_pool(Echo(), workers=3) as pool:
        outcomes = list(pool.run(range(200)))
    assert sorted(outcome.value for outcome in outcomes) == list(range(200))
    assert all(isinstance(outcome, Done) and outcome.job == outcome.value for outcome in outcomes)


def test_a_pool_without_jobs_starts_no_worker():
    with make_pool(FailingSetup()) as pool:
        assert list(pool.run([])) == []


def test_jobs_are_drawn_only_when_a_worker_is_free():
    drawn = 0

    def count():
        nonlocal drawn
        while True:
            drawn += 1
            yield drawn

    with make_pool(Echo(), workers=2) as pool:
        for ended, _ in enumerate(pool.run(count()), 1):
            assert drawn <= ended + 4  # two in flight, and at most two that ended together
            if ended == 50:
                break


def test_no_more_workers_than_jobs():
    with make_pool(workers=8) as pool:
        assert {outcome.worker for outcome in pool.run(["pid", "pid"])} == {1, 2}


def test_a_pool_runs_again_with_the_same_workers():
    with make_pool() as pool:
        assert value_of(pool, "pid") == value_of(pool, "pid")


def test_a_closed_pool_starts_again():
    with make_pool() as pool:
        first = value_of(pool, "pid")
        pool.close()
        assert are_gone([first])
        assert value_of(pool, "pid") != first


def test_a_pool_runs_one_thing_at_a_time():
    with make_pool(Echo()) as pool:
        running = pool.run(itertools.count())
        next(running)
        with pytest.raises(InputError, match="running jobs already"):
            next(pool.run([1]))


def test_workers_use_one_thread_and_ignore_ctrl_c(pool):
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "TRUNDLE_THREADS"):
        assert value_of(pool, "environment", name) == "1"
    assert value_of(pool, "signal_of", signal.SIGINT) == str(signal.SIG_IGN)


def test_the_environment_can_be_added_to():
    with make_pool(environment={"PLANTED": "yes"}) as pool:
        assert value_of(pool, "environment", "PLANTED") == "yes"


@pytest.mark.parametrize("fork", [True, False])
def test_a_batch_with_planted_failures_loses_no_other_job(fork):
    planted = {5: "segfault", 11: "sleep", 17: "hog", 23: "raise"}
    with make_pool(Planted(planted), workers=3, deadline_s=1.0, memory_mb=200, fork=fork) as pool:
        outcomes = {outcome.job: outcome for outcome in pool.run(range(60))}
    assert {job: outcome.kind for job, outcome in outcomes.items() if isinstance(outcome, Failed)} == {
        5: "crashed",
        11: "hung",
        17: "out_of_memory",
        23: "error",
    }
    assert all(outcomes[job].noted == {"job": job} for job in planted)
    assert {job: outcome.value for job, outcome in outcomes.items() if isinstance(outcome, Done)} == {
        job: job * job for job in range(60) if job not in planted
    }


def test_closing_the_iterator_kills_the_workers():
    with make_pool(workers=2) as pool:
        running = pool.run([("pid",), ("sleep", 1000)])
        pid = next(running).value
        running.close()
        assert are_gone([pid])


def test_a_fault_of_the_jobs_passes_through_and_ends_the_workers():
    def jobs():
        yield ("pid",)
        raise RuntimeError("planted")

    with make_pool() as pool:
        running = pool.run(jobs())
        with pytest.raises(RuntimeError, match="planted"):
            list(running)
        assert value_of(pool, "return", 5) == 5
