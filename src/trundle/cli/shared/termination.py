"""How a command ends: its exit code, the message of its error, and SIGTERM as by Ctrl-C."""

from __future__ import annotations

import os
import re
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from trundle.errors import InputError, TrundleError

if TYPE_CHECKING:
    from cyclopts import CoercionError, CycloptsError

DONE = 0
NOT_THERE = 1
BAD_INPUT = 2
PLUGIN_RAISED = 3
FAULT = 70  # EX_SOFTWARE of sysexits.h: a bug in trundle, distinct from "the robot did not reach the goal".
INTERRUPTED = 130  # 128 + SIGINT, as shells count.
PIPE_CLOSED = 141  # 128 + SIGPIPE.

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_WITH_UNIT = re.compile(rf"({_NUMBER})\s*(mm|cm|m|s|ms|Hz)")
_SCALE = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "s": 1.0, "ms": 1e-3, "Hz": 1.0}
_KINDS = {float: "a number", int: "an integer"}


class UsageError(InputError):
    """A command line that cannot be parsed."""


def show_error(error: BaseException, *, json: bool) -> int:
    """Show what ended a command, and return its exit code."""
    if isinstance(error, KeyboardInterrupt):
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    from trundle.fault import is_of_plugin

    if is_of_plugin(error):
        return _fail_of_plugin(error, json=json)
    if isinstance(error, BrokenPipeError):
        _drop_output()
        return PIPE_CLOSED
    if isinstance(error, TrundleError):
        return _fail(error, json=json)
    if isinstance(error, OSError):
        return _fail_of_system(error, json=json)
    if not isinstance(error, Exception):
        raise error
    import traceback  # any other exception is a bug: shown in full, with its own exit code

    traceback.print_exception(error)
    return FAULT


def _fail(error: Exception, *, hint: str = "", json: bool = False) -> int:
    """Print an error on stderr; with --json also as the single JSON value on stdout."""
    print(f"trundle: {error}" + (f"\n{hint}" if hint else ""), file=sys.stderr)
    if json:
        from trundle.cli.shared.output import print_error

        print_error(error, hint=hint)
    return BAD_INPUT


def _fail_of_plugin(error: BaseException, *, json: bool) -> int:
    """Name the plug-in that raised, in five lines; with --json also as the single JSON value on stdout."""
    from trundle.fault import find_fault, folder_of, one_line

    fault, folder = find_fault(error), folder_of(error)
    said = one_line(fault.message)
    where = f"{fault.function}, {fault.place}" if fault.file else fault.function
    kept = "nothing was recorded" if folder is None else f"the run ended with the outcome error: {folder}"
    whole = "--json prints" if folder is None else "episode.json has"
    lines = (
        f"trundle: the {fault.kind} {fault.plugin} raised {fault.type}" + (f": {said}" if said else ""),
        f"  where   {where}",
        f"  line    {one_line(fault.source) or 'its code cannot be read'}",
        f"  record  {kept}",
        f"  do      correct the plug-in, and give the command again; {whole} the whole traceback",
    )
    print("\n".join(lines), file=sys.stderr)
    if json:
        from trundle.cli.shared.output import print_json

        fields = ("type", "message", "kind", "plugin", "function", "file", "line", "traceback")
        print_json({"error": {**{name: getattr(fault, name) for name in fields}, "run_dir": folder}})
    return PLUGIN_RAISED


def _fail_of_system(error: OSError, *, json: bool) -> int:
    """Report a system error; a stdout that cannot be written to gets no JSON."""
    from trundle.files.writing import DISK_FULL, cannot_write

    try:
        is_full = error.errno in DISK_FULL
        code = _fail(cannot_write(error.filename or "the output", error) if is_full else error, json=json)
        sys.stdout.flush()
        return code
    except OSError:
        return BAD_INPUT
    finally:
        _drop_output()


def _drop_output() -> None:
    """Discard buffered output, so that the interpreter does not fail on it again at exit."""
    try:
        descriptor = sys.stdout.fileno()
    except (OSError, ValueError):
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, descriptor)
    os.close(nowhere)


def show_usage_error(error: CycloptsError, arguments: Sequence[str], *, json: bool) -> int:
    """Print what is wrong with a command line, and how to get its help; return the exit code."""
    from cyclopts import CoercionError, UnusedCliTokensError

    if isinstance(error, CoercionError):
        message = _describe_value(error)
    elif isinstance(error, UnusedCliTokensError):
        message = _describe_unused(list(error.unused_tokens or ()), list(arguments))
    else:
        message = str(error).rstrip(".")
    verb = " ".join(("trundle", *(error.command_chain or ())))
    return _fail(UsageError(message), hint=f"See: {verb} --help", json=json)


def _describe_value(error: CoercionError) -> str:
    token, kind = error.token, _KINDS.get(error.target_type or object)
    if token is None or kind is None or token.keyword is None:
        return str(error).rstrip(".")
    found = _WITH_UNIT.fullmatch(token.value)
    message = f"{token.keyword} {token.value}: must be {kind}"
    if found is None:
        return message
    return f"{message}; write it without a unit, in metres, seconds or Hz: {float(found[1]) * _SCALE[found[2]]:g}"


def _describe_unused(unused: list[str], arguments: list[str]) -> str:
    first = arguments.index(unused[0]) if unused and unused[0] in arguments else 0
    start, end = first, first
    while start > 0 and re.fullmatch(_NUMBER, arguments[start - 1].strip(",")):
        start -= 1
    while end < len(arguments) and re.fullmatch(_NUMBER, arguments[end].strip(",")):
        end += 1
    given = [arguments[start - 1], *arguments[start:end]]
    if start > 0 and given[0].startswith("--") and len(given) > 2:
        numbers = ",".join(number.strip(",") for number in given[1:])
        return f"{' '.join(given)}: write numbers with commas, without spaces: {given[0]} {numbers}"
    return f"unexpected argument {' '.join(unused)!r}"


@contextmanager
def ends_as_by_ctrl_c() -> Iterator[None]:
    """Let SIGTERM end what runs in the block as Ctrl-C does, if this is the main thread.

    So does SIGINT, where a shell has it ignored, as it does for what it starts in the background of a script.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = [signal.SIGTERM]
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        numbers.append(signal.SIGINT)
    before = {number: signal.signal(number, _interrupt) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt
