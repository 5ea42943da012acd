"""Starting and killing worker processes: forked from a warm server, or each started on its own."""

from __future__ import annotations

import contextlib
import json
import logging
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import IO, Any

from trundle.evaluation.pool.failures import describe_status
from trundle.evaluation.pool.outcome import PoolSetupError
from trundle.guard import process as processes

logger = logging.getLogger(__name__)

CAN_FORK = sys.platform == "linux"
"""Workers are forked from a warm server on Linux; elsewhere system libraries do not survive a fork."""

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "BLIS_NUM_THREADS": "1",
    "NUMEXPR_NUM_THREADS": "1",
    "VECLIB_MAXIMUM_THREADS": "1",
    "PXR_WORK_THREAD_LIMIT": "1",
    "TRUNDLE_THREADS": "1",
    "MALLOC_ARENA_MAX": "2",
}
"""Variables that are set before anything is imported: there is a worker for each core already."""

_SAME_HASHES = {"PYTHONHASHSEED": "0"}
"""With the same hashes, code that depends on the order of a set does the same in every worker."""

_END_S = 1.5
"""How long the server has to kill all workers and end [s], three times as long as it sweeps."""
_TAIL = 4096


@dataclass(frozen=True, slots=True)
class WorkerEnds:
    """A worker's ends of its socket and pipes."""

    sock: socket.socket
    output: int
    dump: int

    def numbers(self) -> tuple[int, int, int]:
        """Return their descriptors."""
        return self.sock.fileno(), self.output, self.dump

    def close(self) -> None:
        """Close them in this process."""
        self.sock.close()
        os.close(self.output)
        os.close(self.dump)


@dataclass(frozen=True, slots=True)
class Ended:
    """A worker process that has ended: its exit code, or minus the signal that killed it."""

    worker: int
    status: int


class LauncherGoneError(Exception):
    """The server has ended, and all workers with it; a new one has to be started."""


def describe_start(
    task: bytes, preload: Sequence[str], memory_bytes: int | None, ends_itself_s: float | None
) -> dict[str, Any]:
    """Return the start message of the server or of a worker, without what its launcher adds."""
    return {
        "preload": list(preload),
        "task": task,
        "memory_bytes": memory_bytes,
        "ends_itself_s": ends_itself_s,
    }


class ForkServer:
    """A process that only imports, and forks workers from what it has imported."""

    def __init__(self, start: Mapping[str, Any], environment: Mapping[str, str]) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the server
        try:
            with theirs:
                self._process = _start_python("serve", start, (theirs.fileno(),), environment, self._said.fileno())
        except BaseException:
            self._control.close()
            self._said.close()
            raise
        processes.close_input(self._process)
        self._ready = False

    def fileno(self) -> int:
        """Return what becomes readable when there is something to `collect`: the socket to the server."""
        return self._control.fileno()

    def start(self, worker: int, ends: WorkerEnds) -> None:
        """Fork a worker, which takes over its ends; it comes once the server has imported everything."""
        try:
            self._request({"do": "start", "worker": worker}, ends.numbers())
        finally:
            ends.close()

    def send_signal(self, worker: int, number: int) -> None:
        """Ask the server to signal a worker that has not ended; SIGKILL goes to its process group."""
        self._request({"do": "signal", "worker": worker, "signal": int(number)}, ())

    def collect(self) -> list[Ended]:
        """Return the workers that have ended since the last call.

        Raises:
            LauncherGoneError: If the server itself has.
            PoolSetupError: If it cannot import what it should.
        """
        found: list[Ended] = []
        while True:
            try:
                content = self._control.recv(1 << 16, socket.MSG_DONTWAIT)
            except (BlockingIOError, InterruptedError):
                return found
            except OSError:
                content = b""
            if not content:
                self._judge_end()
                raise LauncherGoneError
            message = json.loads(content)
            if "failed" in message:
                raise PoolSetupError(f"the workers cannot be started: {message['failed']}")
            if "ended" in message:
                found.append(Ended(message["ended"], message["status"]))
            elif message["threads"] > 1:
                logger.warning("preloading started %d threads, which forked workers lack", message["threads"] - 1)
            self._ready = True

    def processes(self) -> Mapping[int, int]:
        """Return nothing: only the server knows the processes."""
        return {}

    def close(self) -> None:
        """Ask the server to kill all workers with what they started, and to end."""
        self._control.close()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()  # the workers end with it
            self._process.wait()
        self._said.close()

    def _request(self, request: Mapping[str, Any], descriptors: tuple[int, ...]) -> None:
        # A server that is gone is found by collect.
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):
            socket.send_fds(self._control, [json.dumps(request).encode()], descriptors)

    def _judge_end(self) -> None:
        """Raise an error if the server ended by what it imported."""
        if self._ready:
            return
        try:
            status = self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            return
        if status == -signal.SIGKILL:  # by somebody else: a new one may do better
            return
        self._said.seek(0)
        said = processes.last_line(self._said.read()[-_TAIL:].decode(errors="replace"))
        reason = f"their server ended with {describe_status(status)} before it was ready"
        raise PoolSetupError(f"the workers cannot be started: {reason}{': ' if said else ''}{said}")


class Spawner:
    """Starts each worker as a new process, which imports what it needs."""

    def __init__(self, start: Mapping[str, Any], environment: Mapping[str, str]) -> None:
        self._start = start
        self._environment = environment
        self._workers: dict[int, subprocess.Popen[bytes]] = {}

    def fileno(self) -> None:
        """Return None: processes that have ended are found by asking."""
        return

    def start(self, worker: int, ends: WorkerEnds) -> None:
        """Start a worker, which takes over its ends."""
        try:
            # Its input stays open: the worker ends when that does.
            process = _start_python("work", self._start, ends.numbers(), self._environment, ends.output)
        finally:
            ends.close()
        self._workers[worker] = process

    def send_signal(self, worker: int, number: int) -> None:
        """Signal a worker, if it has not ended; one that is to be killed with its process group."""
        process = self._workers.get(worker)
        if process is None or process.poll() is not None:
            return
        if number == signal.SIGKILL:
            processes.kill_group(process)
        else:
            process.send_signal(number)

    def collect(self) -> list[Ended]:
        """Return the workers that have ended since the last call."""
        ended = [Ended(worker, process.returncode) for worker, process in self._workers.items() if _has_ended(process)]
        for each in ended:
            processes.close_input(self._workers.pop(each.worker))
        return ended

    def processes(self) -> Mapping[int, int]:
        """Return the process numbers by worker."""
        return {worker: process.pid for worker, process in self._workers.items()}

    def close(self) -> None:
        """Kill all workers at once."""
        for worker, process in self._workers.items():
            self.send_signal(worker, signal.SIGKILL)
            process.wait()
            processes.close_input(process)
        self._workers.clear()


Launcher = ForkServer | Spawner
"""Starts and kills worker processes."""


def _start_python(
    function: str, start: Mapping[str, Any], descriptors: tuple[int, ...], environment: Mapping[str, str], output: int
) -> subprocess.Popen[bytes]:
    try:
        return processes.start_python(
            f"trundle.evaluation.pool.child:{function}",
            {**start, "descriptors": descriptors},
            path=[entry or os.getcwd() for entry in sys.path],  # noqa: PTH109 - a string is what the path holds
            environ={**ONE_THREAD, **_SAME_HASHES, **environment},
            stdout=output,
            stderr=output,
            pass_fds=descriptors,
        )
    except OSError as error:
        raise PoolSetupError(f"the workers cannot be started: {error.strerror or error}") from error


def _has_ended(process: subprocess.Popen[bytes]) -> bool:
    if process.poll() is None:
        return False
    processes.kill_group(process)  # what it started may be left
    return True
