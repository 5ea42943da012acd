"""Child processes: how they are started, told what to do, and killed, and what their end and their output mean.

Used by the child that reads untrusted files, the workers of an evaluation, and the child in the user's ROS.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import IO, Any

from trundle.guard import start as script

PROTOCOL = 5
"""The pickle protocol of messages: the first that keeps arrays read-only."""

_OUT_OF_MEMORY = ("bad_alloc", "MemoryError", "llocate memory", "Unable to allocate")


def start_process(
    command: Sequence[str],
    *,
    environ: Mapping[str, str] | None = None,
    stdin: int = subprocess.DEVNULL,
    stdout: int = subprocess.DEVNULL,
    stderr: int = subprocess.DEVNULL,
    pass_fds: Sequence[int] = (),
) -> subprocess.Popen[bytes]:
    """Start a program as the leader of a session of its own.

    So Ctrl-C is for this process alone, which ends its children in order, and `kill_group` kills what a child started
    with it.

    Args:
        command: The program and its arguments.
        environ: The environment; by default that of this process.
        stdin: As for `subprocess.Popen`; by default it is at its end.
        stdout: As for `subprocess.Popen`; by default it is dropped.
        stderr: As for `subprocess.Popen`; by default it is dropped.
        pass_fds: File descriptors that the program inherits.

    Raises:
        OSError: If the program cannot be started.
    """
    return subprocess.Popen(
        command, stdin=stdin, stdout=stdout, stderr=stderr, pass_fds=pass_fds, env=environ, start_new_session=True
    )


def start_python(
    run: str,
    message: Mapping[str, Any],
    *,
    path: Sequence[str],
    environ: Mapping[str, str],
    stdout: int = subprocess.PIPE,
    stderr: int = subprocess.PIPE,
    pass_fds: Sequence[int] = (),
) -> subprocess.Popen[bytes]:
    """Start a child with this Python, which calls a function of trundle.

    Args:
        run: The function, as `"module:function"`. It is called with the start message.
        message: The start message; `path` and `parent` (the id of this process) are added to it.
        path: The child's search path.
        environ: Variables of the environment besides those of this process.
        stdout: As for `subprocess.Popen`.
        stderr: As for `subprocess.Popen`.
        pass_fds: File descriptors that the child inherits.

    Returns:
        The child; its standard input is a pipe, which stays open after the start message.

    Raises:
        OSError: If the child cannot be started.
    """
    if not sys.executable:
        raise OSError("this Python does not say where it is (sys.executable)")
    process = start_process(
        # With -P the folder of the script is not on the search path: its modules are not those of the same names.
        [sys.executable, "-P", os.fspath(Path(script.__file__)), run],
        environ={**os.environ, **environ},
        stdin=subprocess.PIPE,
        stdout=stdout,
        stderr=stderr,
        pass_fds=pass_fds,
    )
    content = pickle.dumps({**message, "path": list(path), "parent": os.getpid()}, PROTOCOL)
    requests = input_of(process)
    with contextlib.suppress(BrokenPipeError):  # the child has ended, which whoever waits for it finds
        requests.write(len(content).to_bytes(script.LENGTH_BYTES, "big") + content)
        requests.flush()
    return process


def input_of(process: subprocess.Popen[bytes]) -> IO[bytes]:
    """Return this end of a child's standard input, which must be a pipe."""
    if process.stdin is None:
        raise RuntimeError("the child has no standard input")
    return process.stdin


def close_input(process: subprocess.Popen[bytes]) -> None:
    """Close a child's standard input; what it has not read of it is lost if it has ended."""
    with contextlib.suppress(OSError):
        input_of(process).close()


def kill_group(process: subprocess.Popen[bytes]) -> None:
    """Kill a child and what it has started; also what it has left behind, if it has ended itself."""
    with contextlib.suppress(ProcessLookupError, PermissionError):
        if hasattr(os, "killpg"):
            os.killpg(process.pid, signal.SIGKILL)
        else:
            process.kill()


def signal_name(number: int) -> str:
    """Return a signal's name ("SIGSEGV"), or "signal 77" for one that has none."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def last_line(output: str) -> str:
    """Return the last line of an output that is not blank: of a traceback, the error; "" without one."""
    lines = output.strip().splitlines()
    return lines[-1].strip() if lines else ""


def says_out_of_memory(text: str) -> bool:
    """Return whether a library's message means that it ran out of memory."""
    return any(sign in text for sign in _OUT_OF_MEMORY)
