import itertools
import json
import os
import shutil
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import trundle
from support.pools import ask, make_pool, value_of
from support.processes import are_gone
from trundle.errors import InputError
from trundle.evaluation.pool import Done
from trundle.evaluation.pool.failures import (
    _ask_ps,
    describe_place,
    frames_of,
    frames_of_dump,
    is_exhaustion,
    resident_bytes,
)
from trundle.planning import plan_many


@pytest.mark.parametrize(
    ("job", "text"),
    [
        (("raise", "planted"), "RuntimeError: planted"),
        (("interrupt",), "KeyboardInterrupt"),
        (("exit",), "SystemExit: 3"),
        (("raise_unspeakable",), "UnspeakableError"),
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
    monkeypatch.setattr("trundle.evaluation.pool.failures.HAS_LIMIT", False)
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
    monkeypatch.setattr("trundle.evaluation.pool.failures.count_oom_kills", lambda: next(kills))
    with make_pool() as pool:
        outcome = ask(pool, "kill_itself")
    assert (outcome.kind, outcome.attempts) == ("out_of_memory", 2)


def test_the_end_of_the_server_costs_no_job(tmp_path):
    with make_pool(workers=2) as pool:
        jobs = [("kill_server_once", str(tmp_path / "tried")), *(("sleep", 0.05) for _ in range(6))]
        outcomes = list(pool.run(jobs))
    assert [type(outcome) for outcome in outcomes] == [Done] * 7


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
    assert are_gone([child])


def test_children_of_a_crashed_worker_end_with_it(pool):
    child = value_of(pool, "leave_child")
    assert ask(pool, "exit_hard").kind == "crashed"
    assert are_gone([child])


def test_what_jobs_print_is_kept_for_messages_and_goes_nowhere_else(pool, capfd):
    value_of(pool, "print", "hello")
    outcome = ask(pool, "print_and_crash", "last words")
    assert (outcome.text, outcome.output) == ("SIGSEGV (segmentation fault): last words", "last words\n")
    assert value_of(pool, "flood", 10_000_000) is None
    assert capfd.readouterr() == ("", "")


def test_a_worker_with_closed_descriptors_is_replaced(pool):
    first = value_of(pool, "pid")
    assert value_of(pool, "close_standard") is None
    assert value_of(pool, "pid") != first
    outcome = ask(pool, "close_all")
    assert (outcome.kind, "lost its connection" in outcome.text) == ("crashed", True)


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        ValueError("Could not allocate memory"),
        RuntimeError("std::bad_alloc"),
        OSError(12, "Cannot allocate memory"),
    ],
)
def test_errors_of_libraries_that_mean_that_there_is_no_memory(error):
    assert is_exhaustion(error)
    wrapped = RuntimeError("the simulator could not be made")
    wrapped.__cause__ = error
    assert is_exhaustion(wrapped)


def test_other_errors_do_not():
    error = ValueError("the map is empty")
    error.__context__ = error
    assert not is_exhaustion(error)


def test_resident_memory_of_processes_that_run():
    assert list(resident_bytes([os.getpid(), 2**22 + 1])) == [os.getpid()]
    assert resident_bytes([os.getpid()])[os.getpid()] > 10e6
    assert resident_bytes([]) == {}


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no /proc: ps is asked there")
def test_resident_memory_needs_no_program_where_there_is_proc(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert list(resident_bytes([os.getpid()])) == [os.getpid()]


@pytest.mark.skipif(shutil.which("ps") is None, reason="there is no ps")
def test_ps_agrees_with_proc():
    asked = _ask_ps([os.getpid(), 2**22 + 1])
    assert asked == {os.getpid(): pytest.approx(resident_bytes([os.getpid()])[os.getpid()], rel=0.2)}
    assert _ask_ps([]) == {}


HERE = __file__
TRUNDLE = trundle.__file__.removesuffix("__init__.py")
LIBRARY = json.__file__
INSTALLED = np.__file__


def frames_raised_by(call):
    try:
        call()
    except (RuntimeError, InputError) as error:
        return frames_of(error.__traceback__)
    raise RuntimeError("nothing was raised")


def test_frames_of_a_traceback_start_with_the_innermost():
    def inner():
        raise RuntimeError("planted")

    assert [frame[2] for frame in frames_raised_by(lambda: inner())][:2] == ["inner", "<lambda>"]


@pytest.mark.parametrize(
    ("frames", "place"),
    [
        ([], None),
        ([("/plug/my.py", 3, "plan")], "/plug/my.py:3 in plan"),
        ([(LIBRARY, 3, "loads"), ("/plug/my.py", 7, "plan")], "/plug/my.py:7 in plan"),
        ([(LIBRARY, 3, "loads")], "json/__init__.py:3 in loads"),
        ([("<frozen os>", 3, "open"), ("/plug/my.py", 7, "plan")], "/plug/my.py:7 in plan"),
        (
            [
                (f"{TRUNDLE}path.py", 3, "length"),
                ("/plug/my.py", 7, "plan"),
                (f"{TRUNDLE}navigation/a.py", 9, "update"),
            ],
            "trundle/path.py:3 in length, called from /plug/my.py:7 in plan",
        ),
        (
            [
                (INSTALLED, 3, "dot"),
                ("/plug/sums.py", 5, "add"),
                ("/plug/my.py", 7, "plan"),
                (f"{TRUNDLE}a.py", 9, "update"),
            ],
            "numpy/__init__.py:3 in dot, called from /plug/my.py:7 in plan",
        ),
        ([(f"{TRUNDLE}path.py", 3, "length"), (f"{TRUNDLE}a.py", 9, "update")], "trundle/path.py:3 in length"),
        (
            [("/plug/my.py", 7, "plan"), (f"{TRUNDLE}evaluation/pool/worker.py", 9, "work")],
            "/plug/my.py:7 in plan",
        ),
        ([(f"{TRUNDLE}evaluation/pool/worker.py", 9, "work")], None),
    ],
)
def test_the_place_is_where_a_plug_in_can_be_blamed(frames, place):
    assert describe_place(frames) == place


def test_the_place_of_an_error_of_the_library_names_its_caller_too():
    def plan():
        return plan_many("astar", None, [(0, 0, 0)], [], threads=1)

    with pytest.raises(InputError):
        plan()
    place = describe_place(frames_raised_by(plan))
    assert place.startswith("trundle/planning/")


DUMP = f"""Fatal Python error: Segmentation fault

Thread 0x00000000000000ab (most recent call first):
  File "/plug/beside.py", line 5 in wait
{{}} 0x00000000000000cd (most recent call first):
  File "{LIBRARY}", line 346 in loads
  File "/plug/a (copy), b.py", line 12 in plan
  File "/plug/my.py", line ??? in call

Extension modules: numpy._core._multiarray_umath (total: 1)
"""


@pytest.mark.parametrize(("head", "main"), [("Current thread", 0xAB), ("Thread", 0xCD)])
def test_frames_of_a_dump_are_those_of_the_thread_that_failed_or_the_main_one(head, main):
    assert frames_of_dump(DUMP.format(head), main) == [
        (LIBRARY, 346, "loads"),
        ("/plug/a (copy), b.py", 12, "plan"),
        ("/plug/my.py", 0, "call"),
    ]


def test_a_dump_of_one_thread_has_no_number():
    assert frames_of_dump('Stack (most recent call first):\n  File "/plug/my.py", line 3 in plan\n', 1) == [
        ("/plug/my.py", 3, "plan")
    ]


@pytest.mark.parametrize("dump", ["", "Fatal Python error: Aborted\n\n<no Python frame>\n", "\x00\n  File"])
def test_a_dump_without_frames_names_no_place(dump):
    assert frames_of_dump(dump, threading.get_ident()) == []
