"""What tests/guard has the child call."""

from __future__ import annotations

import ctypes
import logging
import os
import signal
import sys
import time
import warnings
from pathlib import Path

import numpy as np

from trundle.errors import PlanningError, UnknownNameError, WorldWarning


def make_arrays():
    frozen = np.arange(6.0).reshape(2, 3)
    frozen.flags.writeable = False
    return {"frozen": frozen, "large": np.ones((1000, 1000)), "words": ("a", 1)}


def remark():
    warnings.warn("half of it", WorldWarning, stacklevel=1)
    logging.getLogger("trundle.some.reader").warning("one %s", "note")


def chatter():
    """Disturb whoever shares the standard streams."""
    os.write(1, b"to standard output")
    sys.stdout.write("to standard output")
    return sys.stdin.read(), os.read(0, 10)


def unknown_name():
    raise UnknownNameError("robot", "nova_cartr", ["nova_carter"])


def planning_error():
    raise PlanningError("there is none", pose=(1.0, 2.0, 3.0), cell=(4, 5))


def fault():
    return {}["a key that is not there"]


class StubbornError(Exception):
    def __reduce__(self):
        raise TypeError("not me")


def stubborn():
    raise StubbornError("whatever")


def crash(number=signal.SIGSEGV):
    os.kill(os.getpid(), number)


def run_out_in_native_code():
    os.write(2, b"terminate called after throwing an instance of 'std::bad_alloc'\n")
    os.abort()


def hang_in_native_code():
    """Keeps the interpreter's lock, as a parser does."""
    ctypes.PyDLL(None).sleep(600)


def nap(folder):
    (Path(folder) / "child").write_text(str(os.getpid()))
    time.sleep(600)


def take(gigabytes):
    return len(bytearray(int(gigabytes * 1e9)))


def recurse():
    return recurse()


def state():
    import resource

    return {
        "pid": os.getpid(),
        "core": resource.getrlimit(resource.RLIMIT_CORE)[0],
        "leads": os.getpgid(0) == os.getpid(),
        "modules": [name for name in ("mujoco", "pxr", "trimesh") if name in sys.modules],
    }
