"""Exceptions in words, and places in the code as a traceback or faulthandler names them."""

from __future__ import annotations

import itertools
import os
import re
import sys
import sysconfig
import traceback
from collections.abc import Sequence
from types import TracebackType

from trundle.guard import start

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
