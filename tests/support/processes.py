"""The processes that a process has started, read from /proc."""

import time
from pathlib import Path


def running() -> dict[int, int]:
    """The parent of each process that runs."""
    found: dict[int, int] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if fields[0] != "Z":
            found[int(stat.parent.name)] = int(fields[1])
    return found


def started_by(pid: int) -> set[int]:
    """The processes that one has started, and theirs."""
    parents, found = running(), {pid}
    while more := {child for child, parent in parents.items() if parent in found} - found:
        found |= more
    return found - {pid}


def are_gone(pids: set[int], within_s: float) -> bool:
    """Whether processes have ended, or do within a time."""
    until = time.monotonic() + within_s
    while (left := pids & set(running())) and time.monotonic() < until:
        time.sleep(0.02)
    return not left
