"""`Pool`: gives jobs to worker processes, one each, and watches over them."""

from __future__ import annotations

import importlib.util
import pickle
import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

from trundle.errors import InputError
from trundle.evaluation.pool import failures, framing
from trundle.evaluation.pool.failures import MOST_KILLS, Cause, FailureClassifier, describe_place
from trundle.evaluation.pool.handle import Handle, State
from trundle.evaluation.pool.launch import CAN_FORK, describe_start
from trundle.evaluation.pool.outcome import Done, Failed, Jobs, PoolSetupError, Task
from trundle.evaluation.pool.workers import Deadlines, Dumped, Event, Gone, Message, Workers
from trundle.extras import missing_extra
from trundle.values import check_count, check_number

MOST_WORKERS = 4096

SETUP_S = 300.0
"""Time limit for starting a worker and for the task's `setup` [s]: it imports and builds, on a busy machine."""

_DUMP_S = 2.0
"""How long a worker past its deadline has to write where it is [s]: native code may keep it from that."""
_DUMPED_S = 0.05
"""How long the rest of that may take once some of it has come [s]."""
_LOST_S = 1.0
"""How long a worker whose socket has ended has to end itself [s], so that its exit code says why."""
_WATCH_S = 0.25
"""Time between two looks at the memory of workers, where the system does not limit it [s]."""
_MOST_UNREADY = 2
"""Set-ups in a row that fail: one failure may be by chance, two are the task's."""


@dataclass(slots=True)
class _Try:
    """A job, how often it was tried, and how often somebody killed its worker."""

    job: Any
    attempts: int = 0
    kills: int = 0


class Pool:
    """Runs jobs in its own worker processes, one in flight each.

    On Linux workers are forked from a server that has only imported, so that another one costs little time and memory;
    elsewhere each is started on its own. BLAS and kernels use one thread in them, and what they print is kept for
    messages. A job that crashes, hangs, takes too much memory or raises costs no other one. Jobs that hang or take too
    much memory are repeated in a fresh worker; so is one that crashes a worker which has done others, as the cause may
    be theirs.

    Args:
        task: What to do with each job. It is pickled, by cloudpickle where that is installed.
        workers: How many at most; no more are started than there are jobs.
        deadline_s: Wall time of a job [s]. If None, a job may take for ever.
        memory_mb: How much a worker may grow after its start [MB]. If None, there is no limit.
        preload: Modules that the server imports.
        retries: How often a job that hangs or takes too much memory is repeated.
        environment: Variables for the workers, besides those of this process.
        fork: Whether workers are forked from a server; by default they are on Linux.

    Raises:
        InputError: If an argument is out of bounds.
        PoolSetupError: If the task cannot be pickled, or no process can be started.
    """

    def __init__(
        self,
        task: Task,
        *,
        workers: int,
        deadline_s: float | None,
        memory_mb: float | None,
        preload: Sequence[str] = (),
        retries: int = 1,
        environment: Mapping[str, str] | None = None,
        fork: bool | None = None,
    ) -> None:
        self._most = check_count("workers", workers, 1, MOST_WORKERS)
        self._deadline_s = None if deadline_s is None else check_number("deadline_s", deadline_s, 1e-3, 1e9, "s")
        self._memory_bytes = (
            None if memory_mb is None else int(check_number("memory_mb", memory_mb, 1, 1e9, "MB") * 1e6)
        )
        self._retries = check_count("retries", retries, 0, 100)
        watched = self._memory_bytes is not None and not failures.HAS_LIMIT
        fork = CAN_FORK if fork is None else fork
        start = describe_start(
            _pickle_task(task),
            preload,
            memory_bytes=None if watched else self._memory_bytes,
            ends_itself_s=None if fork else self._deadline_s,
        )
        self._workers = Workers(start, dict(environment or {}), fork=fork)
        self._causes = FailureClassifier(self._deadline_s, memory_mb)
        self._deadlines = Deadlines()
        self._next_watch = 0.0 if watched else None
        self._source: Jobs | None = None
        self._idle: list[Handle] = []
        self._again: deque[_Try] = deque()
        self._outcomes: list[Done | Failed] = []
        self._in_flight = 0
        self._unready = 0
        self._is_running = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def run(self, jobs: Iterable[Any] | Jobs, *, until: float | None = None) -> Iterator[Done | Failed]:
        """Run jobs, and yield the outcome of each as it ends.

        A job is drawn when a worker is free for it. If the iterator is closed, or an exception such as
        KeyboardInterrupt passes through it, the workers are killed at once.

        Args:
            jobs: What to do.
            until: When to end in the same way, in terms of `time.monotonic` [s]; by default when all is done.

        Raises:
            PoolSetupError: If workers cannot be started, or the task's `setup` failed twice.
            InputError: If the pool is running already.
        """
        if self._is_running:
            raise InputError("this pool is running jobs already; let those end first, or make another pool")
        self._is_running, is_finished = True, False
        self._source = jobs if isinstance(jobs, Jobs) else _InOrder(jobs)
        try:
            self._give_out()
            while self._in_flight:
                if until is not None and time.monotonic() >= until:
                    return
                for event in self._workers.wait(_earliest(self._deadlines.soonest(), self._next_watch, until)):
                    self._attend(event)
                self._end_late_ones()
                self._watch_memory()
                self._give_out()
                outcomes, self._outcomes = self._outcomes, []
                yield from outcomes
            is_finished = True
        finally:
            self._source, self._is_running = None, False
            if not is_finished:
                self.close()

    def close(self) -> None:
        """Kill the workers; the pool can be used again, with new ones."""
        self._workers.close()
        self._deadlines = Deadlines()
        self._idle.clear()
        self._again.clear()
        self._outcomes.clear()
        self._in_flight = self._unready = 0

    def _give_out(self) -> None:
        """Give jobs to free workers, and start workers for more."""
        while self._again and self._make_room():
            self._start_worker(self._again.popleft())
        while self._source is not None and (self._idle or len(self._workers.handles) < self._most):
            worker = self._idle[-1].number if self._idle else self._workers.next_number
            try:
                job = self._source.take(worker)
            except StopIteration:
                self._source = None
                return
            if self._idle:
                self._give(self._idle.pop(), _Try(job))
            else:
                self._start_worker(_Try(job))

    def _make_room(self) -> bool:
        """Return whether there can be one more worker; an idle one is killed for it."""
        if len(self._workers.handles) < self._most:
            return True
        if not self._idle:
            return False
        self._workers.kill(self._idle.pop())
        return True

    def _start_worker(self, attempt: _Try) -> None:
        handle = self._workers.start()
        self._in_flight += 1
        self._send(handle, attempt)
        self._deadlines.set(handle.number, SETUP_S)

    def _give(self, handle: Handle, attempt: _Try) -> None:
        self._in_flight += 1
        handle.state = State.BUSY
        self._send(handle, attempt)
        self._deadlines.set(handle.number, self._deadline_s)

    def _send(self, handle: Handle, attempt: _Try) -> None:
        attempt.attempts += 1
        handle.job = attempt
        handle.send(attempt.job)

    def _attend(self, event: Event) -> None:
        handle = event.handle
        if handle.state is State.KILLED:
            return
        if isinstance(event, Message):
            self._take_message(handle, event.kind, event.content)
        elif isinstance(event, Gone):
            self._take_end(handle, event.status)
        elif isinstance(event, Dumped):
            if handle.state is State.LATE:
                self._deadlines.set(handle.number, _DUMPED_S)
        elif handle.state is not State.STARTING:
            if handle in self._idle:
                self._idle.remove(handle)
            handle.state = State.LOST
            self._deadlines.set(handle.number, _LOST_S)

    def _take_message(self, handle: Handle, kind: bytes, content: bytes) -> None:
        attempt: _Try = handle.job
        if handle.state is State.LATE:  # perhaps the question where it is has woken it
            self._conclude_hang(handle)
        elif kind == framing.READY:
            handle.main_thread, handle.state, self._unready = int(content), State.BUSY, 0
            self._deadlines.set(handle.number, self._deadline_s)
        elif kind == framing.UNREADY:
            text, frames = pickle.loads(content)
            self._workers.kill(handle)
            self._take_unready(handle, _join(text, describe_place(frames)))
        elif kind == framing.VALUE:
            self._take_value(handle, attempt, content)
        else:
            exhausted, text, frames, is_worn = pickle.loads(content)
            cause = self._causes.of_exception(text, frames, exhausted=exhausted)
            self._release(handle, is_worn=is_worn or exhausted)
            self._conclude(handle, attempt, cause)

    def _take_value(self, handle: Handle, attempt: _Try, content: bytes) -> None:
        pickled, wall_s, cpu_s, is_worn = pickle.loads(content)
        self._release(handle, is_worn=is_worn)
        try:
            value = pickle.loads(pickled)
        except Exception as error:  # noqa: BLE001 - classes may refuse in any way
            text = f"its result cannot be read here: {type(error).__name__}: {error}"
            self._conclude(handle, attempt, Cause("error", text))
            return
        self._outcomes.append(Done(attempt.job, value, wall_s, cpu_s, handle.number))

    def _release(self, handle: Handle, *, is_worn: bool) -> None:
        """Let a worker that has done its job take another one, or replace it."""
        self._in_flight -= 1
        self._deadlines.clear(handle.number)
        handle.job, handle.has_served = None, True
        if is_worn:
            self._workers.kill(handle)
        else:
            handle.state = State.IDLE
            self._idle.append(handle)

    def _take_end(self, handle: Handle, status: int | None) -> None:
        """Conclude the job of a worker process that has ended by itself, or that somebody killed."""
        state, attempt = handle.state, handle.job
        handle.state = State.KILLED
        self._deadlines.clear(handle.number)
        if handle in self._idle:
            self._idle.remove(handle)
        if attempt is None:
            return
        cause = self._causes.of_end(status, handle.describe_dump(), handle.main_thread, handle.describe_output())
        if state is State.STARTING:
            self._take_unready(handle, _join(cause.text, cause.place), killed=cause.killed)
        else:
            self._in_flight -= 1
            self._conclude(handle, attempt, cause)

    def _take_unready(self, handle: Handle, reason: str, *, killed: bool = False) -> None:
        """Hand the job of a worker that failed before its first job to another one."""
        self._in_flight -= 1
        self._deadlines.clear(handle.number)
        attempt: _Try = handle.job
        attempt.attempts -= 1
        attempt.kills += killed
        self._unready += not killed
        if self._unready >= _MOST_UNREADY or attempt.kills > MOST_KILLS:
            raise PoolSetupError(f"the workers cannot be set up: {reason}")
        self._again.append(attempt)

    def _end_late_ones(self) -> None:
        for number in self._deadlines.take_passed():
            handle = self._workers.handles[number]
            if handle.state is State.BUSY:
                handle.state = State.LATE
                self._workers.ask_where(handle)
                self._deadlines.set(number, _DUMP_S)
            elif handle.state is State.STARTING:
                self._workers.kill(handle)
                self._take_unready(handle, f"it took longer than {SETUP_S:g} s")
            elif handle.state is State.LATE:
                self._conclude_hang(handle)
            else:
                text = "the worker lost its connection to the pool: something closed its file descriptors"
                self._kill_and_conclude(handle, Cause("crashed", text))

    def _watch_memory(self) -> None:
        """Look at the memory of workers now and then, where the system does not limit it."""
        if self._next_watch is None or self._memory_bytes is None or time.monotonic() < self._next_watch:
            return
        numbers = {pid: number for number, pid in self._workers.processes().items()}
        for pid, size in failures.resident_bytes(numbers).items():
            handle = self._workers.handles.get(numbers[pid])
            if handle is None or handle.state is not State.BUSY:
                continue
            handle.base_bytes = min(size, handle.base_bytes or size)
            if size > handle.base_bytes + self._memory_bytes:
                self._kill_and_conclude(handle, self._causes.of_growth())
        self._next_watch = time.monotonic() + _WATCH_S

    def _conclude_hang(self, handle: Handle) -> None:
        handle.read_dump()
        self._kill_and_conclude(handle, self._causes.of_hang(handle.describe_dump(), handle.main_thread))

    def _kill_and_conclude(self, handle: Handle, cause: Cause) -> None:
        self._in_flight -= 1
        self._deadlines.clear(handle.number)
        handle.read_output()
        self._workers.kill(handle)
        if handle.job is not None:
            self._conclude(handle, handle.job, cause)

    def _conclude(self, handle: Handle, attempt: _Try, cause: Cause) -> None:
        """Try a job again, or say that it failed."""
        attempt.kills += cause.killed
        if cause.killed:
            repeat = attempt.kills <= MOST_KILLS
        elif cause.kind == "crashed":
            repeat = handle.has_served  # what it did before may be the cause
        else:
            repeat = cause.kind != "error" and attempt.attempts - attempt.kills <= self._retries
        if repeat:
            self._again.append(attempt)
            return
        self._outcomes.append(
            Failed(
                job=attempt.job,
                kind=cause.kind,
                text=cause.text,
                place=cause.place,
                noted=handle.noted(),
                attempts=attempt.attempts,
                output=handle.describe_output(),
            )
        )


class _InOrder:
    """Jobs that go to whichever worker is free first."""

    def __init__(self, jobs: Iterable[Any]) -> None:
        self._jobs = iter(jobs)

    def take(self, worker: int) -> Any:
        return next(self._jobs)


def _earliest(*times: float | None) -> float | None:
    return min((each for each in times if each is not None), default=None)


def _pickle_task(task: Task) -> bytes:
    """Pickle a task, by value where workers cannot import it."""
    has_cloudpickle = importlib.util.find_spec("cloudpickle") is not None
    try:
        if has_cloudpickle:
            import cloudpickle

            return cloudpickle.dumps(task)
        content = pickle.dumps(task)
    except Exception as error:
        raise PoolSetupError(f"the task cannot be sent to workers: {type(error).__name__}: {error}") from error
    if b"__main__" in content:
        purpose = "what is defined in a script or a notebook, in worker processes,"
        raise missing_extra(purpose, "cloudpickle", "evaluate")
    return content


def _join(text: str, place: str | None) -> str:
    return text if place is None else f"{text} ({place})"
