"""The task and the jobs that a pool is given, and the outcomes that it gives back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol, runtime_checkable

from trundle.errors import TrundleError

Note = Callable[[Mapping[str, Any]], None]
"""Tells the pool what is known of a job so far; if the job fails, the last note is in its `Failed`."""

Kind = Literal["crashed", "hung", "out_of_memory", "error"]


class PoolSetupError(TrundleError):
    """The workers cannot be started, or the task's `setup` failed twice; the message has the reason."""


class Task(Protocol):
    """The work that workers do. A task is pickled once; each worker has its own copy."""

    def setup(self) -> None:
        """Called once in each worker, before its first job."""
        ...

    def __call__(self, job: Any, note: Note, /) -> Any:
        """Run a job; its result is pickled.

        Args:
            job: As drawn from the iterable that `Pool.run` was given.
            note: Tells the pool what is known so far.
        """
        ...


@runtime_checkable
class Jobs(Protocol):
    """Jobs, of which each worker gets those that suit it."""

    def take(self, worker: int) -> Any:
        """Return the next job for a worker that is free.

        Args:
            worker: Its number; a replacement has a new one.

        Raises:
            StopIteration: If there are no more jobs, for any worker.
        """
        ...


@dataclass(frozen=True, slots=True)
class Done:
    """A job that ended by itself.

    Attributes:
        job: As it was given.
        value: What the task returned.
        wall_s: Wall time in the worker [s].
        cpu_s: CPU time of the worker meanwhile, all threads [s].
        worker: Number of the worker; a replacement has a new one.
    """

    job: Any
    value: Any
    wall_s: float
    cpu_s: float
    worker: int


@dataclass(frozen=True, slots=True)
class Failed:
    """A job that did not end by itself.

    Attributes:
        job: As it was given.
        kind: `crashed`, `hung`, `out_of_memory`, or `error` for an exception.
        text: What happened, in one line.
        place: Where in the code: "file.py:12 in plan"; None if it is not known.
        noted: The task's last note on this job; None without one.
        attempts: How often it was tried.
        output: End of what the worker printed meanwhile.
    """

    job: Any
    kind: Kind
    text: str
    place: str | None
    noted: Mapping[str, Any] | None
    attempts: int
    output: str = ""
