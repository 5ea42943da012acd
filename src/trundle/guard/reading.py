"""`read_guarded`: a function that reads a file is called in a child, with limits on its time and memory; the limits."""

from __future__ import annotations

import importlib
import io
import logging
import math
import os
import pickle
import selectors
import subprocess
import sys
import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Self, cast

from trundle.errors import InputError
from trundle.guard import child as code
from trundle.guard import process as processes

SECONDS = 20.0
GIGABYTES = 2.0
"""The usual limits. Higher ones let a bad file hang a program for longer, or fill the memory of a small machine; lower
ones refuse more of the large scenes that people do use, on a busy machine first."""

SECONDS_VARIABLE = "TRUNDLE_READ_SECONDS"
GIGABYTES_VARIABLE = "TRUNDLE_READ_GIGABYTES"
TRUSTED_VARIABLE = "TRUNDLE_TRUSTED"


@dataclass(frozen=True, slots=True)
class ReadLimits:
    """Limits on reading a file.

    Attributes:
        seconds: Time limit, counted from when the child is ready [s].
        gigabytes: Address space in addition to what the child uses before it reads [GB].
        trusted: Whether to read in this process, without limits.
    """

    seconds: float = SECONDS
    gigabytes: float = GIGABYTES
    trusted: bool = False


def read_limits(
    *, trusted: bool | None = None, time_limit_s: float | None = None, memory_limit_gb: float | None = None
) -> ReadLimits:
    """Return the limits that are given, or else those of the environment, or else the defaults.

    Args:
        trusted: Whether to read in this process; by default TRUNDLE_TRUSTED says so (0 or 1).
        time_limit_s: Time limit [s]; by default TRUNDLE_READ_SECONDS, or else 20.
        memory_limit_gb: Limit of the added memory [GB]; by default TRUNDLE_READ_GIGABYTES, or else 2.

    Raises:
        InputError: If a value is invalid.
    """
    if trusted is None:
        text = os.environ.get(TRUSTED_VARIABLE, "").strip()
        if text not in ("", "0", "1"):
            raise InputError(f"{TRUSTED_VARIABLE} is {text!r}; it must be 0 or 1")
        trusted = text == "1"
    given: object = trusted  # from --set it may have any type
    if not isinstance(given, bool):
        raise InputError(f"trusted is {given!r}; it must be true or false")
    return ReadLimits(
        _pick("time_limit_s", time_limit_s, SECONDS_VARIABLE, SECONDS),
        _pick("memory_limit_gb", memory_limit_gb, GIGABYTES_VARIABLE, GIGABYTES),
        trusted,
    )


def _pick(name: str, given: object, variable: str, usual: float) -> float:
    if given is None:
        name, given = variable, os.environ.get(variable, "").strip() or usual
    try:
        number = float(given) if isinstance(given, int | float | str) and not isinstance(given, bool) else math.nan
    except ValueError:
        number = math.nan
    if not 0.0 < number <= 1e6:
        raise InputError(f"{name} is {given!r}; it must be a number above 0 and at most 1,000,000")
    return number


logger = logging.getLogger(__name__)

START_SECONDS = 60.0
"""Time limit for the child's own start, generous for a busy machine."""

_ENDED_SECONDS = 5.0
_TAIL_BYTES = 4096
_CHUNK = 1 << 20

# One thread per library: the limit is on address space, which threads use for stacks and arenas.
_ENVIRONMENT = {
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "PXR_WORK_THREAD_LIMIT": "1",
    "MALLOC_ARENA_MAX": "2",
    "MUJOCO_GL": "disable",
    # USD writes crash reports there: without the folder, no report.
    "TMPDIR": "/dev/null/none",
}


class _TooLateError(Exception):
    """The child did not answer in time."""


class _GoneError(Exception):
    """The child ended without an answer."""


def in_kit() -> bool:
    """Return whether this is Isaac Sim's Kit, whose own USD is available in no other process."""
    return "omni.kit.app" in sys.modules or "omni.kit_app" in sys.modules or "carb" in sys.modules


@dataclass(frozen=True, slots=True)
class ReadCall:
    """A call of a function of trundle that reads a file.

    Attributes:
        target: The function, as `"module:function"`.
        args: Its arguments, plain values.
        what: The file, for messages.
        error: Type of the exception if the child fails.
        limits: Limits of time and memory.
        kwargs: As `args`.
        imports: Libraries loaded before the limits apply; they may be missing.
    """

    target: str
    args: tuple[Any, ...]
    what: str
    error: type[InputError]
    limits: ReadLimits
    kwargs: Mapping[str, Any] = field(default_factory=dict[str, Any])
    imports: tuple[str, ...] = ()


def read_guarded(call: ReadCall, *, stacklevel: int = 1) -> Any:
    """Make a call in a child, or in this process if it is trusted or runs in Kit.

    Args:
        call: The call.
        stacklevel: Stack level of warnings; 1 is the caller.

    Returns:
        The function's result; its arrays are read-only.

    Raises:
        InputError: Of the type `call.error`, if the file takes too much time or memory, or crashes the reader.
        Exception: Whatever the function raises.

    Warns:
        As the function.
    """
    if call.limits.trusted or in_kit():
        module, _, name = call.target.partition(":")
        return getattr(importlib.import_module(module), name)(*call.args, **call.kwargs)
    with Child() as child:
        return child.read(call, stacklevel=stacklevel + 1)


class Child:
    """A process that reads files, one after the other; it starts when it is first needed, and again after a crash."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: _Pipe | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def read(self, call: ReadCall, *, stacklevel: int = 1) -> Any:
        """Make a call in the child; see `read_guarded`."""
        what, error, limits = call.what, call.error, call.limits
        request = {
            "target": call.target,
            "args": call.args,
            "kwargs": dict(call.kwargs),
            "imports": call.imports,
            "seconds": limits.seconds,
            "bytes": int(limits.gigabytes * 1e9),
            "log_level": logging.getLogger("trundle").getEffectiveLevel(),
        }
        try:
            kind, content = self._ask(_pickled(what, request, error), limits.seconds)
        except _TooLateError:
            self.close()
            raise error(
                f"{what}: reading it took longer than {limits.seconds:g} s; raise the limit with time_limit_s=… or "
                f"{SECONDS_VARIABLE}=…, or use trusted=True if you trust the file"
            ) from None
        except _GoneError:
            raise error(f"{what}: {self._describe_end(limits)}") from None
        except OSError as problem:
            self.close()
            raise error(
                f"{what}: the process that reads it cannot be started: {problem.strerror or problem}; trusted=True "
                "reads it here"
            ) from problem
        except BaseException:
            self.close()
            raise
        value, remarks, records = content
        _repeat(remarks, records, stacklevel + 1)
        match kind:
            case code.RESULT:
                return value
            case code.NO_MEMORY:
                raise error(f"{what}: {_too_much(limits)}")
            case code.TOO_DEEP:
                raise error(f"{what}: it is nested too deeply to be read")
            case code.ERROR:
                problem, text = cast("tuple[Exception, str]", value)
                if isinstance(problem, InputError) and processes.says_out_of_memory(str(problem)):
                    raise error(f"{what}: {_too_much(limits)}") from problem
                if not isinstance(problem, InputError | ImportError):
                    problem.add_note(f"In the process that read {what}:\n{text}")
                raise problem
            case _:
                raise RuntimeError(f"In the process that read {what}:\n{value}")

    def close(self) -> None:
        """Kill the child."""
        process, self._process = self._process, None
        pipe, self._pipe = self._pipe, None
        if process is None:
            return
        if process.poll() is None:
            processes.kill_group(process)
        processes.close_input(process)
        if pipe is not None:
            pipe.close()
        process.wait()

    def _ask(self, request: bytes, seconds: float) -> tuple[str, Any]:
        pipe = self._pipe or self._start()
        process = cast("subprocess.Popen[bytes]", self._process)
        requests = processes.input_of(process)
        pipe.deadline = time.monotonic() + START_SECONDS
        try:
            requests.write(request)
            requests.flush()
        except BrokenPipeError:
            raise _GoneError from None
        for wait in (None, seconds):
            if wait is not None:
                pipe.deadline = time.monotonic() + wait
            try:
                reply = pickle.load(pipe.buffered)
            except (EOFError, pickle.UnpicklingError) as problem:
                raise _GoneError from problem
        return reply

    def _start(self) -> _Pipe:
        package = Path(__file__).parent.parent
        self._process = processes.start_python(
            "trundle.guard.child:main",
            {},
            # Without the empty entry, which is the current folder: that may be the one of the file.
            path=[*filter(None, sys.path), os.fspath(package.parent)],
            environ=_ENVIRONMENT,
        )
        self._pipe = _Pipe(self._process)
        return self._pipe

    def _describe_end(self, limits: ReadLimits) -> str:
        """Describe why the child ended."""
        process, pipe = cast("subprocess.Popen[bytes]", self._process), cast("_Pipe", self._pipe)
        try:
            status = process.wait(_ENDED_SECONDS)
        except subprocess.TimeoutExpired:
            status = 0
        pipe.drain()
        said = pipe.tail.decode(errors="replace")
        self.close()
        logger.debug("the process that reads files ended with %d: %s", status, said)
        if processes.says_out_of_memory(said):
            return _too_much(limits)
        if status < 0:
            name = processes.signal_name(-status)
            return f"the reader crashed on it ({name}): the file is damaged, or nested too deeply"
        return f"the process that reads it ended: {processes.last_line(said) or f'status {status}'}"


class _Pipe(io.RawIOBase):
    """The child's replies, read until a deadline; the end of its printed output is kept separately.

    Attributes:
        deadline: In terms of time.monotonic() [s].
        tail: The end of what the child printed.
        buffered: Buffered reader of this, for `pickle`.
    """

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        super().__init__()
        self._files = [cast("io.BufferedReader", file) for file in (process.stdout, process.stderr)]
        self._replies, self._prints = (file.fileno() for file in self._files)
        self._selector = selectors.DefaultSelector()
        for number in (self._replies, self._prints):
            self._selector.register(number, selectors.EVENT_READ)
        self.deadline = time.monotonic() + START_SECONDS
        self.tail = b""
        self.buffered = io.BufferedReader(self, _CHUNK)

    def readable(self) -> bool:
        """Always."""
        return True

    def readinto(self, buffer: Any) -> int:
        """Read some bytes.

        Raises:
            _TooLateError: If there are none by the deadline.
        """
        while True:
            left = self.deadline - time.monotonic()
            ready = {key.fd for key, _ in self._selector.select(max(0.0, left))}
            if self._prints in ready:
                self._keep_print()
            if self._replies in ready:
                return os.readv(self._replies, [buffer])
            if left <= 0.0:
                raise _TooLateError

    def drain(self) -> None:
        """Keep the rest of what an ended child printed."""
        while self._prints in {key.fd for key, _ in self._selector.select(0.0)}:
            self._keep_print()

    def close(self) -> None:
        """Close both pipes."""
        if not self.closed:
            self._selector.close()
            for file in self._files:
                file.close()
        super().close()

    def _keep_print(self) -> None:
        text = os.read(self._prints, _CHUNK)
        if not text:
            self._selector.unregister(self._prints)
        self.tail = (self.tail + text)[-_TAIL_BYTES:]


def _pickled(what: str, request: dict[str, Any], error: type[InputError]) -> bytes:
    try:
        return pickle.dumps(request, processes.PROTOCOL)
    except (pickle.PicklingError, TypeError, AttributeError) as problem:
        raise error(f"{what}: its options must be plain values: {problem}") from problem


def _repeat(remarks: Any, records: Any, stacklevel: int) -> None:
    """Repeat the child's warnings and log records here."""
    for name, level, text in records:
        logging.getLogger(name).log(level, "%s", text)
    for message, category, filename, line in remarks:
        if category.__module__ == "trundle.errors":
            warnings.warn(message, category, stacklevel=stacklevel + 1)
        else:
            warnings.warn_explicit(message, category, filename, line)


def _too_much(limits: ReadLimits) -> str:
    return (
        f"reading it takes more than {limits.gigabytes:g} GB of memory; raise the limit with memory_limit_gb=… or "
        f"{GIGABYTES_VARIABLE}=…, or use trusted=True if you trust the file"
    )
