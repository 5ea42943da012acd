import json
import threading

import numpy as np
import pytest

import trundle
from trundle.errors import InputError
from trundle.evaluation.pool.tracebacks import describe_place, frames_of, frames_of_dump
from trundle.planning import plan_many

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
