"""Memory of processes: what they take, a limit on it, and whether the system killed one for it."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from trundle.evaluation.pool.tracebacks import describe_error
from trundle.guard.process import says_out_of_memory

HAS_LIMIT = sys.platform == "linux"
"""Whether the system keeps RLIMIT_AS; elsewhere the pool watches resident memory."""


@contextlib.contextmanager
def lifted_limit() -> Iterator[None]:
    """Lift the limit for a while, so that an error can be reported."""
    if not HAS_LIMIT:
        yield
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def is_exhaustion(error: BaseException) -> bool:
    """Whether an exception, or what caused it, means that there was no memory left."""
    return any(isinstance(each, MemoryError) or says_out_of_memory(describe_error(each)) for each in _chain(error))


def count_oom_kills() -> int | None:
    """Return how many processes the kernel has killed for want of memory; None where it does not say."""
    with contextlib.suppress(OSError), open("/proc/vmstat", encoding="ascii") as lines:  # noqa: PTH123 - of the system
        for line in lines:
            if line.startswith("oom_kill "):
                return int(line.split()[1])
    return None


def resident_bytes(pids: Iterable[int]) -> dict[int, int]:
    """Return the resident memory of processes [bytes], by number; those that have ended are left out."""
    return _read_statm(pids) if Path("/proc/self/statm").exists() else _ask_ps(pids)


def _read_statm(pids: Iterable[int]) -> dict[int, int]:
    page = os.sysconf("SC_PAGE_SIZE")
    found = {}
    for pid in pids:
        with contextlib.suppress(OSError):
            found[pid] = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]) * page
    return found


def _ask_ps(pids: Iterable[int]) -> dict[int, int]:
    """Ask `ps` for the same, on a system without /proc."""
    wanted = ",".join(str(pid) for pid in pids)
    if not wanted:
        return {}
    try:
        said = subprocess.run(
            ["ps", "-o", "pid=,rss=", "-p", wanted], capture_output=True, text=True, timeout=10, check=False
        ).stdout
    except (OSError, subprocess.TimeoutExpired):
        return {}
    rows = [line.split() for line in said.splitlines()]
    return {int(row[0]): int(row[1]) * 1024 for row in rows if len(row) == 2}


def _chain(error: BaseException) -> Iterator[BaseException]:
    seen: set[int] = set()
    link: BaseException | None = error
    while link is not None and id(link) not in seen:
        seen.add(id(link))
        yield link
        link = link.__cause__ or link.__context__
