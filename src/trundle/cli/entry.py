"""The entry point: the table of verbs, and how each error is shown."""

from __future__ import annotations

import io
import logging
import os
import sys
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn, get_args

from trundle.errors import InputError, TrundleError, UnknownNameError
from trundle.version import __version__

if TYPE_CHECKING:
    from cyclopts import App

DONE = 0
NOT_THERE = 1
BAD_INPUT = 2
PLUGIN_RAISED = 3
FAULT = 70  # EX_SOFTWARE of sysexits.h: a bug in trundle, distinct from "the robot did not reach the goal".
INTERRUPTED = 130  # 128 + SIGINT, as shells count.
PIPE_CLOSED = 141  # 128 + SIGPIPE.

Shell = Literal["bash", "zsh", "fish", "powershell"]
SHELLS: dict[str, Shell] = {shell: shell for shell in get_args(Shell)}

VERBS = {
    "demo": ("trundle.cli.demo:app", "Drive across the built-in warehouse: world, map, plan and run, in seconds."),
    "view": ("trundle.cli.view:app", "Show a robot, alone or in a world."),
    "joints": ("trundle.cli.joints:app", "List a robot's joints, and which ones drive it."),
    "drive": ("trundle.cli.drive:app", "Drive a robot by hand or by a list of commands."),
    "map": ("trundle.cli.map:app", "Make, check and convert occupancy maps."),
    "export": (
        "trundle.cli.export:app",
        "Write a world, a robot or a scenario as MJCF, USD, SDF, GLB, URDF, a map or a script.",
    ),
    "plan": ("trundle.cli.plan:app", "Plan a path on a map and draw it."),
    "run": ("trundle.cli.run:app", "Drive a robot through a map, a world or a scenario to its goal."),
    "serve": ("trundle.cli.serve:app", "Open a page in the browser, where runs are set up, watched and driven."),
    "replay": ("trundle.cli.replay:app", "Watch a run again, in the browser."),
    "report": ("trundle.cli.report:app", "Write the report of a run: replay, plots, figures, settings."),
    "evaluate": ("trundle.cli.evaluate:app", "Run thousands of missions, compare and judge them."),
    "scenario": ("trundle.cli.scenario:app", "Write the options of a run as a commented file."),
    "robot": ("trundle.cli.robot:app", "Write a robot file to edit."),
    "record": ("trundle.cli.record:app", "Look into recordings, complete them, and make runs of them."),
    "compare": ("trundle.cli.compare:app", "Compare two runs of the same commands, e.g. in two simulators."),
    "ros2": ("trundle.cli.ros2:app", "Put a robot on the network of ROS 2, and look at that network."),
    "doctor": ("trundle.cli.doctor:app", "Check this machine, a simulator, or a robot's wheels."),
}


class UsageError(InputError):
    """A command line that cannot be parsed."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run one command and exit. `arguments` excludes the program's name; None means the process's arguments."""
    given = sys.argv[1:] if arguments is None else arguments
    warnings.formatwarning = _format_warning
    _show_log(logging.WARNING if "--quiet" in given else logging.INFO)
    sys.exit(run_command(given))


def _show_log(level: int) -> None:
    """Print trundle's log on stderr, each message once."""
    shown: set[str] = set()

    def is_new(record: logging.LogRecord) -> bool:
        message = record.getMessage()
        new = message not in shown
        shown.add(message)
        return new

    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("trundle: %(message)s"))
    handler.addFilter(is_new)
    logging.getLogger("trundle").addHandler(handler)
    logging.getLogger("trundle").setLevel(level)


def run_command(arguments: Sequence[str]) -> int:
    """Run one command and return its exit code; expected errors become one message on stderr."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        code = _dispatch(arguments)
        sys.stdout.flush()
        return code
    except BaseException as error:  # noqa: BLE001 - each has its exit code
        return _show(error, json="--json" in arguments)


def _show(error: BaseException, *, json: bool) -> int:
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


def _dispatch(arguments: Sequence[str]) -> int:
    # Handled without importing libraries, so that they are instant.
    if not arguments or arguments[0] in ("--help", "-h", "help"):
        print(_overview())
        return DONE
    if arguments[0] in ("--version", "-V"):
        print(__version__)
        return DONE
    if arguments[0] == "--install-completion":
        return _install_completion(arguments[1:])
    verb = arguments[0]
    if verb not in VERBS:
        raise UnknownNameError("verb", verb, VERBS)
    from cyclopts import CycloptsError

    app = _make_app([verb])
    try:
        code = app(list(arguments), exit_on_error=False, print_error=False)
    except CycloptsError as error:
        refused = _explain(error)
        if refused is not None:
            raise refused from error
        from trundle.cli.shared.usage import describe_usage

        message, see = describe_usage(error, arguments)
        return _fail(UsageError(message), hint=see, json="--json" in arguments)
    if not {"--help", "-h"}.isdisjoint(arguments):
        from trundle.cli.shared.plugins import describe_plugins

        plugins = describe_plugins()
        print(plugins, end="\n" if plugins else "")
    return code if isinstance(code, int) else DONE


def _make_app(verbs: Iterable[str]) -> App:
    """Build the command line with these verbs; the others are not imported."""
    from cyclopts import App

    app = App(
        name="trundle",
        version_flags=[],
        help_format="plaintext",
        result_action="return_value",
        suppress_keyboard_interrupt=False,
    )
    for verb in verbs:
        target, summary = VERBS[verb]
        app.command(target, name=verb, help=summary)
    return app


def _install_completion(arguments: Sequence[str]) -> int:
    """Install shell completion, by default for the shell in use."""
    name = arguments[0] if arguments else Path(os.environ.get("SHELL", "")).name
    shell = SHELLS.get(name)
    if shell is None or len(arguments) > 1:
        raise InputError(f"--install-completion takes a shell: {', '.join(SHELLS)}; got {name!r}")
    path = _make_app(VERBS).install_completion(shell=shell)
    print(f"completion for {shell}: {path}; start a new shell to use it")
    return DONE


def _explain(error: Exception) -> TrundleError | None:
    """The error message of an option value that settings reject; None for other errors."""
    from pydantic import ValidationError

    from trundle.cli.shared import field_options

    return field_options.explain(error.__cause__) if isinstance(error.__cause__, ValidationError) else None


def _overview() -> str:
    width = max(map(len, VERBS))
    verbs = "\n".join(f"  {name:<{width}}  {summary}" for name, (_, summary) in VERBS.items())
    return (
        "Usage: trundle VERB [OPTIONS]\n\n"
        "From a map to a moving robot: occupancy maps, planning, control and simulation.\n\n"
        f"Verbs:\n{verbs}\n\n"
        "Examples:\n"
        "  trundle demo\n"
        "  trundle run warehouse --robot nova_carter --seed 3\n"
        "  trundle plan map.yaml --start 0,0 --goal 5,3 -o overlay.png\n"
        "  trundle evaluate smoke\n\n"
        "trundle VERB --help explains a verb; every verb prints JSON with --json, errors too.\n"
        "trundle --install-completion [bash|zsh|fish|powershell] lets the shell complete verbs and options.\n"
        "Exit codes: 0 done, 1 the robot did not reach the goal or a requirement was not met, 2 bad input,\n"
        "3 a plug-in raised an exception, 70 a fault of trundle itself."
    )


def _format_warning(
    message: Warning | str, category: type[Warning], filename: str, lineno: int, line: str | None = None
) -> str:
    """Format warnings; trundle's own are for the user, so they omit the line of code."""
    if category.__module__ == "trundle.errors":
        return f"trundle: warning: {message}\n"
    return f"{filename}:{lineno}: {category.__name__}: {message}\n"


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
