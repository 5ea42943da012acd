"""What runs in a worker process: set-up once, then one job after the other, until its socket ends."""

from __future__ import annotations

import contextlib
import faulthandler
import os
import pickle
import signal
import socket
import sys
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NoReturn

from trundle.evaluation.pool import failures, framing
from trundle.evaluation.pool.failures import describe_error, frames_of
from trundle.guard.child import limit_growth

DUMP_SIGNAL = signal.SIGUSR1
"""Makes a worker write where its main thread is."""

_MOST_LEFT = 8
"""Threads or processes that jobs may leave behind before the worker is replaced."""

_SPARE_S = 30.0
"""How long after its deadline a worker ends itself [s]. The pool kills it at the deadline, unless it is stopped."""


@dataclass(frozen=True, slots=True)
class WorkerStart:
    """The settings of a worker.

    Attributes:
        task: The pickled task.
        memory_bytes: How much its address space may grow. If None, there is no limit.
        ends_itself_s: How long a job may take [s] before the worker ends by itself. If None, the server sees to that.
    """

    task: bytes
    memory_bytes: int | None
    ends_itself_s: float | None = None


def run_worker(sock: socket.socket, output: int, dump: int, start: WorkerStart) -> NoReturn:
    """Set up the task, and do jobs until the pool has no more.

    Args:
        sock: Socket to the pool.
        output: Pipe for what is printed.
        dump: Pipe for what faulthandler writes.
        start: Task and limits.
    """
    _redirect(output)
    _ready_for_the_worst(dump)
    if start.memory_bytes is not None:
        limit_growth(start.memory_bytes)
    try:
        try:
            task = pickle.loads(start.task)
            task.setup()
        except BaseException as error:  # noqa: BLE001 - whatever it is, the pool is told
            with failures.lifted_limit():
                _send(sock, framing.UNREADY, pickle.dumps((describe_error(error), frames_of(error.__traceback__))))
            os._exit(1)
        _Worker(sock, task, dump, start.ends_itself_s).work()
    except OSError:
        os._exit(1)  # the pool is gone
    os._exit(0)


class _Worker:
    """One task, and jobs for it."""

    def __init__(self, sock: socket.socket, task: Any, dump: int, ends_itself_s: float | None) -> None:
        self._sock = sock
        self._task = task
        self._dump = dump
        self._ends_itself_s = ends_itself_s
        self._pid = os.getpid()
        self._standard = _identify_standard()

    def work(self) -> None:
        """Run jobs until there are no more."""
        _send(self._sock, framing.READY, b"%d" % threading.get_ident())
        while True:
            message = framing.receive(self._sock)
            if message is None:
                return
            self._do(pickle.loads(message[1]))

    def _do(self, job: Any) -> None:
        if not faulthandler.is_enabled():  # a job before this one has disabled it
            faulthandler.enable(file=self._dump, all_threads=True)
        if self._ends_itself_s is not None:
            faulthandler.dump_traceback_later(self._ends_itself_s + _SPARE_S, exit=True, file=self._dump)
        begin, cpu = time.perf_counter(), time.process_time()
        try:
            value = self._task(job, self._note)
            times = time.perf_counter() - begin, time.process_time() - cpu
            reply = self._pack_value(value, times)
        except BaseException as error:  # noqa: BLE001 - whatever it is, the pool is told
            with failures.lifted_limit():
                reply = self._pack_error(error)
        finally:
            if os.getpid() != self._pid:
                os._exit(0)  # a child that the job forked and that came back from it
            if self._ends_itself_s is not None:
                faulthandler.cancel_dump_traceback_later()
        _flush()
        self._sock.sendall(reply)

    def _note(self, known: Mapping[str, Any]) -> None:
        if os.getpid() == self._pid:
            _send(self._sock, framing.NOTE, pickle.dumps(dict(known)))

    def _pack_value(self, value: Any, times: tuple[float, float]) -> bytes:
        content = pickle.dumps((_pickle_result(value), *times, self._is_worn()))
        if len(content) > framing.MOST_BYTES:
            raise ValueError(
                f"its result takes {len(content) / 1e6:.0f} MB; a job may return at most "
                f"{framing.MOST_BYTES / 1e6:.0f} MB: write larger things to files"
            )
        return framing.pack(framing.VALUE, content)

    def _pack_error(self, error: BaseException) -> bytes:
        exhausted, frames = failures.is_exhaustion(error), frames_of(error.__traceback__)
        return framing.pack(framing.FAULT, pickle.dumps((exhausted, describe_error(error), frames, self._is_worn())))

    def _is_worn(self) -> bool:
        """Return whether jobs have left so much behind that the worker should be replaced."""
        return (
            threading.active_count() > _MOST_LEFT
            or _count_children() > _MOST_LEFT
            or _identify_standard() != self._standard
        )


def _pickle_result(value: Any) -> bytes:
    try:
        return pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    except Exception as error:  # noqa: BLE001 - classes may refuse in any way
        # Of a class that came by cloudpickle, from a notebook.
        try:
            import cloudpickle

            return cloudpickle.dumps(value)
        except Exception:  # noqa: BLE001 - whatever that says, the first error says why
            raise TypeError(f"its result, of type {type(value).__name__}, cannot be pickled: {error}") from error


def _send(sock: socket.socket, kind: bytes, content: bytes) -> None:
    sock.sendall(framing.pack(kind, content))


def _redirect(output: int) -> None:
    """Send what is printed to the pool's pipe, and leave nothing to read."""
    nowhere = os.open(os.devnull, os.O_RDONLY)
    for number, target in ((0, nowhere), (1, output), (2, output)):
        os.dup2(target, number)
    for number in (nowhere, output):
        if number > 2:
            os.close(number)
    # Not those of the server, whose files could be sought.
    sys.stdout, sys.stderr = (os.fdopen(number, "w", 1, errors="replace", closefd=False) for number in (1, 2))


def _ready_for_the_worst(dump: int) -> None:
    faulthandler.enable(file=dump, all_threads=True)
    faulthandler.register(DUMP_SIGNAL, file=dump, all_threads=False)
    # Ctrl-C is for the pool, which kills its workers.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with contextlib.suppress(ImportError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):  # a job may have closed it
            stream.flush()


def _identify_standard() -> tuple[tuple[int, int] | None, ...]:
    """Identify the files of the first three descriptors, which a job may have replaced."""
    found: list[tuple[int, int] | None] = []
    for number in range(3):
        try:
            status = os.fstat(number)
            found.append((status.st_dev, status.st_ino))
        except OSError:
            found.append(None)
    return tuple(found)


def _count_children() -> int:
    """Count the child processes; 0 where the system does not say."""
    try:
        with open("/proc/thread-self/children", encoding="ascii") as file:  # noqa: PTH123 - of the system
            return len(file.read().split())
    except OSError:
        return 0
