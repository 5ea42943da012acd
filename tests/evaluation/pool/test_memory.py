import os

import pytest

from trundle.evaluation.pool.memory import is_exhaustion, resident_bytes


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
