"""`Workers`: the worker processes of a pool, started, listened to and killed; and `Deadlines` for them."""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import socket
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from trundle.evaluation.pool.handle import Handle, State
from trundle.evaluation.pool.launch import ForkServer, Launcher, LauncherGoneError, Spawner, WorkerEnds
from trundle.evaluation.pool.outcome import PoolSetupError
from trundle.evaluation.pool.worker import DUMP_SIGNAL

_ASK_S = 0.25
"""Time between two looks for workers that have ended, where no descriptor says so [s]."""


@dataclass(frozen=True, slots=True)
class Message:
    """A message that a worker has sent."""

    handle: Handle
    kind: bytes
    content: bytes


@dataclass(frozen=True, slots=True)
class Lost:
    """The socket of a worker has ended."""

    handle: Handle


@dataclass(frozen=True, slots=True)
class Dumped:
    """A worker has written where it is."""

    handle: Handle


@dataclass(frozen=True, slots=True)
class Gone:
    """A worker has ended.

    Attributes:
        handle: The worker.
        status: Its exit code, or minus the signal; None if the server that it was forked from ended.
    """

    handle: Handle
    status: int | None


Event = Message | Lost | Dumped | Gone


class Workers:
    """The worker processes of a pool, and what happens to them.

    Args:
        start: What each is told at its start; see `describe_start`.
        environment: Variables for the workers.
        fork: Whether they are forked from a server.
    """

    def __init__(self, start: Mapping[str, Any], environment: Mapping[str, str], *, fork: bool) -> None:
        self._start = start
        self._environment = environment
        self._fork = fork
        self._selector = selectors.DefaultSelector()
        self._launcher: Launcher | None = None
        self._count = 0
        self.handles: dict[int, Handle] = {}

    def start(self) -> Handle:
        """Start a worker.

        Raises:
            PoolSetupError: If no process can be started.
        """
        launcher = self._launcher or self._launch()
        self._count += 1
        pipes: list[int] = []
        try:
            pipes += os.pipe()
            pipes += os.pipe()
            sock, their_sock = socket.socketpair()
        except OSError as error:
            for number in pipes:
                os.close(number)
            reason = f"{error.strerror}, after {len(self.handles)} of them; give the pool fewer workers"
            raise PoolSetupError(f"the workers cannot be started: {reason}") from error
        output, their_output, dump, their_dump = pipes
        handle = Handle(self._count, sock, output, dump)
        self.handles[handle.number] = handle
        for number, what in ((sock.fileno(), "message"), (output, "output"), (dump, "dump")):
            self._selector.register(number, selectors.EVENT_READ, (handle, what))
        launcher.start(handle.number, WorkerEnds(their_sock, their_output, their_dump))
        return handle

    @property
    def next_number(self) -> int:
        """The number that the next worker will have."""
        return self._count + 1

    def wait(self, until: float | None) -> list[Event]:
        """Wait for something to happen, at most until a time.

        Raises:
            PoolSetupError: If the server cannot import what it should.
        """
        timeout = None if until is None else max(0.0, until - time.monotonic())
        if self._launcher is not None and self._launcher.fileno() is None:
            timeout = _ASK_S if timeout is None else min(timeout, _ASK_S)
        events: list[Event] = []
        ready = [key.data for key, _ in self._selector.select(timeout)]
        for handle, what in ready:
            if what == "output" and not handle.read_output():
                self._forget(handle.output)
            elif what == "dump":
                if not handle.read_dump():
                    self._forget(handle.dump)
                events.append(Dumped(handle))
        for handle, what in ready:
            if what == "message":
                self._receive(handle, events)
        if self._launcher is not None and (self._launcher.fileno() is None or (None, "ended") in ready):
            self._collect(self._launcher, events)
        return events

    def ask_where(self, handle: Handle) -> None:
        """Make a worker write where its main thread is."""
        if self._launcher is not None:
            self._launcher.send_signal(handle.number, DUMP_SIGNAL)

    def kill(self, handle: Handle) -> None:
        """Kill a worker, with its process group, and forget it."""
        if self._launcher is not None:
            self._launcher.send_signal(handle.number, signal.SIGKILL)
        handle.state = State.KILLED
        self._remove(handle)

    def processes(self) -> Mapping[int, int]:
        """Return the process numbers by worker, where they are known here."""
        return {} if self._launcher is None else self._launcher.processes()

    def close(self) -> None:
        """Kill all workers at once."""
        launcher, self._launcher = self._launcher, None
        try:
            if launcher is not None:
                launcher.close()
        finally:
            for handle in list(self.handles.values()):
                self._remove(handle)
            self._selector.close()
            self._selector = selectors.DefaultSelector()

    def _launch(self) -> Launcher:
        launcher = (ForkServer if self._fork else Spawner)(self._start, self._environment)
        number = launcher.fileno()
        if number is not None:
            self._selector.register(number, selectors.EVENT_READ, (None, "ended"))
        self._launcher = launcher
        return launcher

    def _receive(self, handle: Handle, events: list[Event]) -> bool:
        """Take some of what a worker has sent; False if there is nothing more for now."""
        messages, size = handle.receive()
        events.extend(Message(handle, kind, content) for kind, content in messages)
        if size is None:
            self._forget(handle.sock.fileno())
            events.append(Lost(handle))
        return bool(size)

    def _collect(self, launcher: Launcher, events: list[Event]) -> None:
        try:
            ended = [(self.handles.get(each.worker), each.status) for each in launcher.collect()]
        except LauncherGoneError:
            self._forget(launcher.fileno())
            self._launcher = None
            launcher.close()
            ended = [(handle, None) for handle in self.handles.values()]
        for handle, status in ended:
            if handle is not None:
                self._read_rest(handle, events)
                events.append(Gone(handle, status))
                self._remove(handle)

    def _read_rest(self, handle: Handle, events: list[Event]) -> None:
        """Read what a worker that has ended had sent before."""
        handle.read_output()
        handle.read_dump()
        if handle.sock.fileno() not in self._selector.get_map():
            return
        while self._receive(handle, events):
            pass

    def _remove(self, handle: Handle) -> None:
        if self.handles.pop(handle.number, None) is not None:
            for number in (handle.sock.fileno(), handle.output, handle.dump):
                self._forget(number)
            handle.close()

    def _forget(self, number: int | None) -> None:
        if number is not None:
            with contextlib.suppress(KeyError):
                self._selector.unregister(number)


class Deadlines:
    """The times by which workers must have done what they do: at most one for each.

    Times of the same length are kept in the order in which they were set, which is the order in which they pass; so
    nothing here takes longer with more workers.
    """

    def __init__(self) -> None:
        self._times: dict[float, dict[int, float]] = {}
        self._length_of: dict[int, float] = {}

    def set(self, worker: int, seconds: float | None) -> None:
        """Replace the deadline of a worker by one so many seconds from now, or by none."""
        self.clear(worker)
        if seconds is not None:
            self._times.setdefault(seconds, {})[worker] = time.monotonic() + seconds
            self._length_of[worker] = seconds

    def clear(self, worker: int) -> None:
        """Remove a worker's deadline."""
        length = self._length_of.pop(worker, None)
        if length is not None:
            del self._times[length][worker]

    def soonest(self) -> float | None:
        """Return the next deadline, in terms of `time.monotonic`; None if there is none."""
        return min((next(iter(times.values())) for times in self._times.values() if times), default=None)

    def take_passed(self) -> list[int]:
        """Return the workers whose deadline has passed, and take it away."""
        soonest, now = self.soonest(), time.monotonic()
        if soonest is None or soonest > now:
            return []
        passed = [worker for times in self._times.values() for worker, due in times.items() if due <= now]
        for worker in passed:
            self.clear(worker)
        return passed
