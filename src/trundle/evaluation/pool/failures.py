"""Why jobs fail: the causes that a pool tells apart by how a worker ends."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.evaluation.pool import memory
from trundle.evaluation.pool.outcome import Kind
from trundle.evaluation.pool.tracebacks import describe_place, frames_of_dump
from trundle.guard.process import last_line, says_out_of_memory, signal_name

MOST_KILLS = 3
"""How often a job is repeated after somebody killed its worker: that is not the job's fault."""


@dataclass(frozen=True, slots=True)
class Cause:
    """Why a job failed.

    Attributes:
        kind: The kind of failure, as in `Failed`.
        text: What happened, in one line.
        place: Where in the code; None if that is not known.
        killed: Whether somebody else killed the worker.
    """

    kind: Kind
    text: str
    place: str | None = None
    killed: bool = False


class FailureClassifier:
    """Finds the causes of failures. It keeps how many processes the kernel has killed for want of memory.

    Args:
        deadline_s: Wall time that a job may take [s].
        memory_mb: How much a worker may grow [MB].
    """

    def __init__(self, deadline_s: float | None, memory_mb: float | None) -> None:
        self._deadline_s = deadline_s
        self._memory_mb = memory_mb
        self._oom_kills = memory.count_oom_kills()

    def of_exception(self, text: str, frames: Sequence[tuple[str, int, str]], *, exhausted: bool) -> Cause:
        """Return the cause for an exception that a worker has sent."""
        if exhausted:
            return Cause("out_of_memory", f"{self.describe_limit()} ({text})", describe_place(frames))
        return Cause("error", text, describe_place(frames))

    def of_hang(self, dump: str, main_thread: int) -> Cause:
        """Return the cause for a job that was not done by its deadline."""
        place = describe_place(frames_of_dump(dump, main_thread))
        return Cause("hung", f"took longer than {self._deadline_s:g} s", place)

    def of_growth(self) -> Cause:
        """Return the cause for a worker whose resident memory was above the limit."""
        return Cause("out_of_memory", self.describe_limit())

    def of_end(self, status: int | None, dump: str, main_thread: int, output: str) -> Cause:
        """Return the cause for a worker that ended during a job; its status is None if its server ended too."""
        place = describe_place(frames_of_dump(dump, main_thread))
        if status is None:
            return Cause("crashed", "the worker was killed with the server that it was forked from", killed=True)
        if status == -signal.SIGKILL:
            if self._has_system_killed():
                return Cause("out_of_memory", "killed by the system, which was out of memory", place)
            return Cause("crashed", "killed from outside (SIGKILL)", place, killed=True)
        line = last_line(output)[:200]
        words = f": {line}" if line else ""
        if status >= 0:
            return Cause("crashed", f"the process ended by itself with {describe_status(status)}{words}", place)
        if says_out_of_memory(output):
            return Cause("out_of_memory", f"{self.describe_limit()} ({describe_status(status)}{words})", place)
        return Cause("crashed", f"{describe_status(status)}{words}", place)

    def describe_limit(self) -> str:
        """Return the memory limit in words."""
        if self._memory_mb is None:
            return "out of memory"
        return f"needed more than {self._memory_mb:g} MB above the worker's size at its start"

    def _has_system_killed(self) -> bool:
        before, self._oom_kills = self._oom_kills, memory.count_oom_kills()
        return before is None or self._oom_kills is None or self._oom_kills > before


def describe_status(status: int) -> str:
    """Return an exit code in words."""
    if status >= 0:
        return f"status {status}"
    name = signal_name(-status)
    meaning = signal.strsignal(-status) if name.startswith("SIG") else None
    return f"{name} ({meaning.lower()})" if meaning else name
