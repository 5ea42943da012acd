import itertools
import os
import signal
import time
from pathlib import Path

import pytest

from support.pool_tasks import Ask, CrashingSetup, Echo, FailingSetup, FailingSetupOnce, Planted
from trundle.errors import InputError
from trundle.evaluation.pool import Done, Failed, Pool, PoolSetupError


def make_pool(task=None, *, workers=1, deadline_s=60.0, memory_mb=2000.0, **options):
    return Pool(task or Ask(), workers=workers, deadline_s=deadline_s, memory_mb=memory_mb, **options)


@pytest.fixture(scope="module")
def pool():
    """Of one worker: what a job breaks would show in the next."""
    with make_pool() as pool:
        yield pool


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
        assert has_ended(first)
        assert value_of(pool, "pid") != first


def test_a_pool_runs_one_thing_at_a_time():
    with make_pool(Echo()) as pool:
        running = pool.run(itertools.count())
        next(running)
        with pytest.raises(InputError, match="running jobs already"):
            next(pool.run([1]))


@pytest.mark.parametrize("options", [{"workers": 0}, {"deadline_s": 0.0}, {"memory_mb": float("nan")}, {"retries": -1}])
def test_bad_arguments_are_refused(options):
    with pytest.raises(InputError, match=next(iter(options))):
        make_pool(**options)


@pytest.mark.parametrize(
    ("job", "text"),
    [
        (("raise", "planted"), "RuntimeError: planted"),
        (("interrupt",), "KeyboardInterrupt"),
        (("exit",), "SystemExit: 3"),
        (("return_unpicklable",), "TypeError: its result, of type lock, cannot be pickled"),
        (("return_bytes", 70 << 20), "its result takes 73 MB; a job may return at most 67 MB"),
    ],
)
def test_an_exception_is_an_error_of_its_job_alone(pool, job, text):
    outcome = ask(pool, *job)
    assert (outcome.kind, outcome.attempts) == ("error", 1)
    assert text in outcome.text
    assert value_of(pool, "return", 5) == 5


def test_the_place_is_the_frame_outside_the_standard_library(pool):
    place = ask(pool, "raise_library").place
    assert place.startswith("support/pool_tasks.py:")
    assert place.endswith(" in do_raise_library")


@pytest.mark.parametrize(
    ("job", "text", "function"),
    [
        ("segfault", "SIGSEGV (segmentation fault)", "do_segfault"),
        ("abort", "SIGABRT (aborted): terminate called: planted", "do_abort"),
        ("exit_hard", "the process ended by itself with status 0", None),
        ("leave_fork_with_socket", "SIGSEGV (segmentation fault)", "do_leave_fork_with_socket"),
    ],
)
def test_a_crash_says_what_and_where(pool, job, text, function):
    outcome = ask(pool, job)
    assert (outcome.kind, outcome.text) == ("crashed", text)
    assert function is None or outcome.place.endswith(f" in {function}")
    assert value_of(pool, "return", 5) == 5


def test_a_crash_in_a_used_worker_is_tried_in_a_fresh_one():
    with make_pool() as pool:
        assert ask(pool, "segfault").attempts == 1
        assert value_of(pool, "return") is None
        assert ask(pool, "segfault").attempts == 2


def test_the_last_note_is_kept(pool):
    assert ask(pool, "segfault_noted").noted == {"stage": "drive", "seed": 4}
    assert ask(pool, "note_often").noted == {"k": 999}
    assert ask(pool, "segfault").noted is None


@pytest.mark.parametrize(
    ("job", "function"),
    [("sleep", "do_sleep"), ("hold_gil", "do_hold_gil"), ("stop", None), ("ignore_signals", None)],
)
def test_a_hang_is_ended_and_tried_again(job, function, monkeypatch):
    monkeypatch.setattr("trundle.evaluation.pool.pool._DUMP_S", 0.3 if function is None else 10.0)
    with make_pool(deadline_s=0.3) as pool:
        outcome = ask(pool, job)
        assert (outcome.kind, outcome.text, outcome.attempts) == ("hung", "took longer than 0.3 s", 2)
        assert function is None or outcome.place.endswith(f" in {function}")
        assert value_of(pool, "return", 5) == 5


def test_what_hangs_once_is_done_the_second_time(tmp_path):
    with make_pool(deadline_s=0.5) as pool:
        assert value_of(pool, "hang_once", str(tmp_path / "tried")) == "second"


@pytest.mark.parametrize("job", ["hog", "hog_like_mujoco"])
def test_too_much_memory_is_told_apart(job):
    with make_pool(memory_mb=200) as pool:
        outcome = ask(pool, job)
        assert (outcome.kind, outcome.attempts) == ("out_of_memory", 2)
        assert outcome.text.startswith("needed more than 200 MB above the worker's size at its start")
        assert outcome.place.endswith(f" in do_{job}")
        assert value_of(pool, "return", 5) == 5


def test_the_limit_on_memory_holds_after_an_exception():
    with make_pool(memory_mb=200) as pool:
        assert ask(pool, "raise").kind == "error"
        assert ask(pool, "hog").kind == "out_of_memory"


def test_memory_is_watched_where_the_system_has_no_limit(monkeypatch):
    monkeypatch.setattr("trundle.evaluation.pool.memory.HAS_LIMIT", False)
    with make_pool(memory_mb=100, fork=False, retries=0) as pool:
        outcome = ask(pool, "grow_slowly", 400)
        assert (outcome.kind, outcome.attempts) == ("out_of_memory", 1)
        assert value_of(pool, "return", 5) == 5


def test_a_job_whose_worker_somebody_killed_is_done_again(pool, tmp_path):
    assert value_of(pool, "kill_once", str(tmp_path / "tried")) == "second"
    outcome = ask(pool, "kill_itself")
    assert (outcome.kind, outcome.text, outcome.attempts) == ("crashed", "killed from outside (SIGKILL)", 4)


def test_a_kill_by_the_system_is_out_of_memory(monkeypatch):
    kills = itertools.count()
    monkeypatch.setattr("trundle.evaluation.pool.memory.count_oom_kills", lambda: next(kills))
    with make_pool() as pool:
        outcome = ask(pool, "kill_itself")
    assert (outcome.kind, outcome.attempts) == ("out_of_memory", 2)


def test_the_end_of_the_server_costs_no_job(tmp_path):
    with make_pool(workers=2) as pool:
        jobs = [("kill_server_once", str(tmp_path / "tried")), *(("sleep", 0.05) for _ in range(6))]
        outcomes = list(pool.run(jobs))
    assert [type(outcome) for outcome in outcomes] == [Done] * 7


def test_a_worker_with_closed_descriptors_is_replaced(pool):
    first = value_of(pool, "pid")
    assert value_of(pool, "close_standard") is None
    assert value_of(pool, "pid") != first
    outcome = ask(pool, "close_all")
    assert (outcome.kind, "lost its connection" in outcome.text) == ("crashed", True)


def test_a_worker_that_collects_threads_is_replaced(pool):
    assert value_of(pool, "leave_threads", 20) != value_of(pool, "pid")


def test_a_child_that_comes_back_from_a_job_sends_nothing(pool):
    assert value_of(pool, "fork_through") == "parent"
    assert value_of(pool, "return", 5) == 5


@pytest.mark.parametrize("new_session", [False, True])
def test_children_of_jobs_end_with_the_pool(new_session):
    with make_pool() as pool:
        child = value_of(pool, "leave_child", new_session)
        assert Path(f"/proc/{child}").exists()
    assert has_ended(child)


def test_children_of_a_crashed_worker_end_with_it(pool):
    child = value_of(pool, "leave_child")
    assert ask(pool, "exit_hard").kind == "crashed"
    assert has_ended(child)


def test_what_jobs_print_is_kept_for_messages_and_goes_nowhere_else(pool, capfd):
    value_of(pool, "print", "hello")
    outcome = ask(pool, "print_and_crash", "last words")
    assert (outcome.text, outcome.output) == ("SIGSEGV (segmentation fault): last words", "last words\n")
    assert value_of(pool, "flood", 10_000_000) is None
    assert capfd.readouterr() == ("", "")


def test_workers_use_one_thread_and_ignore_ctrl_c(pool):
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "TRUNDLE_THREADS"):
        assert value_of(pool, "environment", name) == "1"
    assert value_of(pool, "signal_of", signal.SIGINT) == str(signal.SIG_IGN)


def test_the_environment_can_be_added_to():
    with make_pool(environment={"PLANTED": "yes"}) as pool:
        assert value_of(pool, "environment", "PLANTED") == "yes"


def test_a_set_up_that_fails_twice_is_refused():
    with make_pool(FailingSetup(), workers=4) as pool, pytest.raises(PoolSetupError) as caught:
        list(pool.run(range(10)))
    assert "OSError: no such map: planted.yaml (support/pool_tasks.py:" in str(caught.value)


def test_a_set_up_that_crashes_twice_is_refused():
    with (
        make_pool(CrashingSetup()) as pool,
        pytest.raises(PoolSetupError, match=r"SIGSEGV .*pool_tasks\.py:\d+ in setup"),
    ):
        list(pool.run(range(10)))


def test_a_set_up_that_fails_once_costs_no_job(tmp_path):
    with make_pool(FailingSetupOnce(tmp_path / "tried")) as pool:
        assert [outcome.value for outcome in pool.run(range(3))] == [0, 1, 2]


def test_a_set_up_that_hangs_is_refused(monkeypatch):
    monkeypatch.setattr("trundle.evaluation.pool.pool.SETUP_S", 1.0)
    with make_pool(Ask(hang=True)) as pool, pytest.raises(PoolSetupError, match="it took longer than 1 s"):
        list(pool.run(["return"]))


@pytest.mark.parametrize(("name", "reason"), [("no_such_module", "ModuleNotFoundError"), ("planted_crash", "SIGSEGV")])
def test_a_module_that_cannot_be_preloaded_is_refused(name, reason, tmp_path, monkeypatch):
    (tmp_path / "planted_crash.py").write_text("import ctypes\nctypes.string_at(0)\n")
    monkeypatch.syspath_prepend(tmp_path)
    with make_pool(preload=[name]) as pool, pytest.raises(PoolSetupError, match=reason):
        list(pool.run(["return"]))


def test_a_task_that_cannot_be_pickled_is_refused():
    with pytest.raises(PoolSetupError, match="the task cannot be sent to workers"):
        make_pool(Planted({1: (value for value in ())}))


def test_a_function_of_a_test_travels_by_value():
    class Task(Echo):
        def __call__(self, job, note):
            return job + os.getpid() * 0

    with make_pool(Task()) as pool:
        assert [outcome.value for outcome in pool.run([4])] == [4]


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
        assert has_ended(pid)


def test_a_fault_of_the_jobs_passes_through_and_ends_the_workers():
    def jobs():
        yield ("pid",)
        raise RuntimeError("planted")

    with make_pool() as pool:
        running = pool.run(jobs())
        with pytest.raises(RuntimeError, match="planted"):
            list(running)
        assert value_of(pool, "return", 5) == 5
