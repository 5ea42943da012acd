"""The processes that run, and those that a process has started, read from /proc."""

import contextlib
import os
import signal
import time
from collections.abc import Iterable
from pathlib import Path


def _fields(stat: Path) -> list[str]:
    """The fields of a process from its state on; none if it has ended, also while they are read."""
    try:
        return stat.read_text().rpartition(")")[2].split()
    except OSError:
        return []


def parent_of(pid: int) -> int:
    return int(_fields(Path(f"/proc/{pid}/stat"))[1])


def is_alive(pid: int) -> bool:
    """Whether a process runs; one that ended and that nobody has collected does not."""
    return _fields(Path(f"/proc/{pid}/stat"))[:1] not in ([], ["Z"])


def running() -> dict[int, int]:
    """The parent of each process that runs."""
    found: dict[int, int] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        fields = _fields(stat)
        if fields[:1] not in ([], ["Z"]):
            found[int(stat.parent.name)] = int(fields[1])
    return found


def children_of(pid: int) -> list[int]:
    """The processes that one has started itself."""
    return [child for child, parent in running().items() if parent == pid]


def started_by(pid: int) -> set[int]:
    """The processes that one has started, and theirs."""
    parents, found = running(), {pid}
    while more := {child for child, parent in parents.items() if parent in found} - found:
        found |= more
    return found - {pid}


def kill(pids: Iterable[int]) -> None:
    """Kill processes, of which some may have ended."""
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)


def are_gone(pids: Iterable[int], within_s: float = 60.0) -> bool:
    """Whether processes have ended, or do within a time: far longer than it takes, on any machine."""
    until = time.monotonic() + within_s
    while (left := [pid for pid in pids if is_alive(pid)]) and time.monotonic() < until:
        time.sleep(0.02)
    return not left
