import os
import shutil
import sys

import pytest

from trundle.evaluation.pool.memory import _ask_ps, is_exhaustion, resident_bytes


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
