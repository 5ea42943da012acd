"""Why jobs fail: by how a worker ends, by its exception and the place in the code, and by the memory that it takes."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
import signal
import subprocess
import sys
import sysconfig
import traceback
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from trundle.evaluation.pool.outcome import Kind
from trundle.guard import start
from trundle.guard.process import last_line, says_out_of_memory, signal_name

Frame = tuple[str, int, str]
"""The file, the line and the function."""

_LINE = re.compile(r'^  File "(.*)", line (\d+|\?\?\?) in (.*)$')
_THREAD = re.compile(r"^(Current thread|Thread) 0x([0-9a-f]+)")
_PACKAGE = os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))), "")  # noqa: PTH118, PTH120, PTH100
_OF_POOL = (os.path.join(os.path.dirname(os.path.abspath(__file__)), ""), os.path.abspath(start.__file__))  # noqa: PTH118, PTH120, PTH100


def frames_of(trace: TracebackType | None) -> list[Frame]:
    """Return the frames of a traceback, the innermost first."""
    found = [(frame.f_code.co_filename, line, frame.f_code.co_name) for frame, line in traceback.walk_tb(trace)]
    return found[::-1]


def frames_of_dump(dump: str, main_thread: int) -> list[Frame]:
    """Return the frames in a dump of the thread that failed, or else of the main thread; the innermost first."""
    threads: dict[str, list[Frame]] = {}
    current = "current"  # where only one thread is named
    for line in dump.splitlines():
        if head := _THREAD.match(line):
            current = "current" if head[1] == "Current thread" else f"{int(head[2], 16)}"
            if int(head[2], 16) == main_thread:
                threads["main"] = threads.setdefault(current, [])
            threads.setdefault(current, [])
        elif found := _LINE.match(line):
            threads.setdefault(current, []).append((found[1], int(found[2]) if found[2].isdigit() else 0, found[3]))
    return threads.get("current") or threads.get("main") or []


def describe_place(frames: Sequence[Frame]) -> str | None:
    """Name the innermost frame outside the standard library, and the plug-in's frame that trundle called, if another.

    Args:
        frames: The innermost first.

    Returns:
        For example "trundle/path.py:12 in length, called from my_planner.py:7 in plan"; None without a frame.
    """
    frames = [frame for frame in frames if not frame[0].startswith("<frozen")]
    own = [frame for frame in frames if not frame[0].startswith(_OF_POOL)]
    if not own:
        return None
    first = next((frame for frame in own if not _is_of_python(frame[0])), own[0])
    if not (first[0].startswith(_PACKAGE) or _is_installed(first[0])):
        return _format(first)
    plugin = _find_plugin([frame for frame in frames if not _is_of_python(frame[0])])
    if plugin is None or plugin == first:
        return _format(first)
    return f"{_format(first)}, called from {_format(plugin)}"


def _find_plugin(frames: Sequence[Frame]) -> Frame | None:
    """Return the innermost frame of code outside trundle that trundle called."""
    for frame, caller in itertools.pairwise(frames):
        if caller[0].startswith(_PACKAGE) and not frame[0].startswith(_PACKAGE):
            return frame
    return None


def _format(frame: Frame) -> str:
    return f"{_shorten(frame[0])}:{frame[1]} in {frame[2]}"


def _shorten(file: str) -> str:
    """Return a file's path as it is imported: without the entry of the search path that it is in."""
    roots = [os.path.join(os.path.abspath(root), "") for root in sys.path if root]  # noqa: PTH118, PTH100
    inside = [root for root in roots if file.startswith(root)]
    return file.removeprefix(max(inside, key=len)) if inside else file


def _is_of_python(file: str) -> bool:
    if _is_installed(file):
        return False
    return any(file.startswith(sysconfig.get_path(name)) for name in ("stdlib", "platstdlib"))


def _is_installed(file: str) -> bool:
    return "site-packages" in file or "dist-packages" in file


_MOST_TEXT = 2000


def describe_error(error: BaseException) -> str:
    """Return an exception in one line, which every file can hold, however odd the bytes that it was made of."""
    try:
        said = str(error)
    except Exception:  # noqa: BLE001 - classes of other people may do anything
        said = ""
    text = " ".join(said[:_MOST_TEXT].split()).encode(errors="replace").decode()
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


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
    """Return whether an exception, or what caused it, means that there was no memory left."""
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
        self._oom_kills = count_oom_kills()

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
        before, self._oom_kills = self._oom_kills, count_oom_kills()
        return before is None or self._oom_kills is None or self._oom_kills > before


def describe_status(status: int) -> str:
    """Return an exit code in words."""
    if status >= 0:
        return f"status {status}"
    name = signal_name(-status)
    meaning = signal.strsignal(-status) if name.startswith("SIG") else None
    return f"{name} ({meaning.lower()})" if meaning else name
