"""Kernels release the GIL: several threads that call them, beside one that runs Python, get what one alone gets."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.kernel_calls import CALLS_OF, KERNELS
from trundle import _core

TESTS = Path(__file__).parents[1]


def kernels():
    """Functions, classes, and what can be called or read of the classes."""
    for name in KERNELS:
        yield name
        kernel = getattr(_core, name)
        if isinstance(kernel, type):
            yield from (f"{name}.{member}" for member in vars(kernel) if not member.startswith("_"))


@pytest.fixture(scope="module")
def ends():
    """How the calls of each kernel ended, in a child process that goes on with the next one after a crash."""
    found = {}
    while missing := [name for name in CALLS_OF if name not in found]:
        child = subprocess.run(
            [sys.executable, "-X", "faulthandler", "-m", "support.kernel_calls", *missing],
            env=os.environ | {"PYTHONPATH": str(TESTS)},
            capture_output=True,
            text=True,
            timeout=300,
        )
        found |= dict.fromkeys(child.stdout.split(), "same")
        if child.returncode != 0:
            crashed = next(name for name in missing if name not in found)
            found[crashed] = f"ended with {child.returncode}: {child.stderr[-2000:]}"
        else:
            found |= {name: "answers differ" for name in missing if name not in found}
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", list(CALLS_OF))
def test_a_kernel_may_be_called_from_several_threads(ends, name):
    assert ends[name] == "same"


def test_every_kernel_is_called_from_threads():
    assert set(CALLS_OF) == set(kernels())
