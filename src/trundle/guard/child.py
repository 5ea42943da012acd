"""The child that reads untrusted files: it calls functions by name, one after the other, until its input ends.

Requests and replies are pickles, on standard input and on the original standard output.
"""

from __future__ import annotations

import contextlib
import faulthandler
import importlib
import io
import logging
import os
import pickle
import sys
import traceback
import warnings
from collections.abc import Iterator
from typing import Any

from trundle.guard.process import PROTOCOL

READY, RESULT, ERROR, FAULT, NO_MEMORY, TOO_DEEP = "ready", "result", "error", "fault", "no memory", "too deep"

_SPARE_SECONDS = 5.0
_KILL = 9
_PR_SET_PDEATHSIG, _PR_SET_DUMPABLE = 1, 4


class _Notes(logging.Handler):
    """Collects log records for the parent to log."""

    def __init__(self) -> None:
        super().__init__()
        self.records: list[tuple[str, int, str]] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.records.append((record.name, record.levelno, record.getMessage()))


def main(start: dict[str, Any]) -> None:
    """Answer requests until there are no more.

    Args:
        start: The start message of `process.start_python`.
    """
    _die_with(start["parent"])
    requests = os.fdopen(os.dup(0), "rb")
    replies = os.fdopen(os.dup(1), "wb")
    # Readers may print, which must not mix with the replies.
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(2, 1)
    while True:
        try:
            request = pickle.load(requests)
        except EOFError:
            return
        for name in request["imports"]:
            with contextlib.suppress(ImportError):  # the function reports what is missing
                importlib.import_module(name)
        module, _, function = request["target"].partition(":")
        call = getattr(importlib.import_module(module), function)
        _send(replies, (READY, None))
        _send(replies, _answer(call, request, nowhere))


def _send(replies: io.BufferedWriter, reply: tuple[str, Any]) -> None:
    pickle.dump(reply, replies, protocol=PROTOCOL)
    replies.flush()


def _answer(call: Any, request: dict[str, Any], nowhere: int) -> tuple[str, Any]:
    notes = _Notes()
    log = logging.getLogger("trundle")
    log.handlers[:] = [notes]
    log.setLevel(request["log_level"])
    # Ends this process from a C thread, because Python threads may never run.
    faulthandler.dump_traceback_later(request["seconds"] + _SPARE_SECONDS, exit=True, file=nowhere)
    try:
        with warnings.catch_warnings(record=True) as caught, _limited_memory(request["bytes"]):
            warnings.simplefilter("always")
            kind, value = _call(call, request["args"], request["kwargs"])
    finally:
        faulthandler.cancel_dump_traceback_later()
    remarks = [(str(item.message), item.category, item.filename, item.lineno) for item in caught]
    return kind, (value, remarks, notes.records)


def _call(call: Any, args: Any, kwargs: Any) -> tuple[str, Any]:
    try:
        return RESULT, call(*args, **kwargs)
    except MemoryError:
        return NO_MEMORY, None
    except RecursionError:
        return TOO_DEEP, None
    except Exception as error:  # noqa: BLE001 - the parent raises it again
        text = traceback.format_exc()
        error.__traceback__ = error.__cause__ = error.__context__ = None
        try:
            pickle.loads(pickle.dumps(error, PROTOCOL))
        except Exception:  # noqa: BLE001 - library errors may fail to pickle in any way
            return FAULT, text
        return ERROR, (error, text)


@contextlib.contextmanager
def _limited_memory(limit: int) -> Any:
    """Limit the additional address space of this process [bytes], if the system supports it."""
    before = limit_growth(limit)
    try:
        yield
    finally:
        if before is not None:
            import resource

            resource.setrlimit(resource.RLIMIT_AS, before)


def limit_growth(size: int) -> tuple[int, int] | None:
    """Limit the additional address space of this process [bytes].

    Returns:
        The limits, soft and hard, that held before; None if the system has no such limit.
    """
    taken = _address_space()
    if taken is None:
        return None
    import resource

    before = resource.getrlimit(resource.RLIMIT_AS)
    most = taken + size if before[1] == resource.RLIM_INFINITY else min(taken + size, before[1])
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    return before


@contextlib.contextmanager
def uncounted_growth() -> Iterator[None]:
    """Leave out of the limit what the block adds to the address space: a library may reserve far more than it uses.

    A limit that somebody set for good, with `ulimit -v`, stays.
    """
    taken = _address_space()
    if taken is None:
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    if soft == resource.RLIM_INFINITY:
        yield
        return
    resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
    try:
        yield
    finally:
        most = soft + max(0, (_address_space() or 0) - taken)
        resource.setrlimit(resource.RLIMIT_AS, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def _address_space() -> int | None:
    """Return the address space of this process [bytes]; None if the system does not limit it."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123 - pathlib is not imported yet
            return int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return None


def _die_with(parent: int) -> None:
    """End with the parent, however it ends; and write no core file."""
    with contextlib.suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if sys.platform != "linux":
        return  # it ends when its input does
    import ctypes

    control = ctypes.CDLL(None).prctl
    control(_PR_SET_PDEATHSIG, _KILL, 0, 0, 0)
    # Also if the system pipes core dumps to a program, which the limit does not prevent.
    control(_PR_SET_DUMPABLE, 0, 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)
