"""The entry point: the table of verbs, and how a command line is run."""

from __future__ import annotations

import io
import logging
import os
import sys
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NoReturn, get_args

from trundle.cli.shared.termination import DONE, show_error, show_usage_error
from trundle.errors import InputError, TrundleError, UnknownNameError
from trundle.version import __version__

if TYPE_CHECKING:
    from cyclopts import App

Shell = Literal["bash", "zsh", "fish", "powershell"]
SHELLS: dict[str, Shell] = {shell: shell for shell in get_args(Shell)}

VERBS = {
    "demo": ("trundle.cli.demo:app", "Drive across the built-in warehouse: world, map, plan and run, in seconds."),
    "view": ("trundle.cli.view:app", "Show a robot, alone or in a world."),
    "joints": ("trundle.cli.joints:app", "List a robot's joints, and which ones drive it."),
    "drive": ("trundle.cli.drive:app", "Drive a robot by hand or by a list of commands."),
    "map": ("trundle.cli.map:app", "Make, check and convert occupancy maps, of worlds and of recorded drives."),
    "export": (
        "trundle.cli.export:app",
        "Write a world, a robot or a scenario as MJCF, USD, SDF, GLB, URDF, a map or a script.",
    ),
    "plan": ("trundle.cli.plan:app", "Plan a path on a map and draw it."),
    "run": ("trundle.cli.run:app", "Drive a robot through a map, a world or a scenario to its goal."),
    "explore": ("trundle.cli.explore:app", "Explore an unknown world, and make its map."),
    "serve": ("trundle.cli.serve:app", "Open a page in the browser, where runs are set up, watched and driven."),
    "replay": ("trundle.cli.report:replay_app", "Watch a run again, in the browser."),
    "report": ("trundle.cli.report:app", "Write the report of a run: replay, plots, figures, settings."),
    "evaluate": ("trundle.cli.evaluate:app", "Run thousands of missions, and report and compare the results."),
    "scenario": ("trundle.cli.scenario:app", "Write the options of a run as a commented file."),
    "robot": ("trundle.cli.robot:app", "Write a robot file to edit."),
    "record": ("trundle.cli.record:app", "Inspect recordings, complete them, and turn them into runs."),
    "compare": ("trundle.cli.compare:app", "Compare two runs of the same commands, e.g. in two simulators."),
    "ros2": ("trundle.cli.ros2:app", "Put a robot on a ROS 2 network, and check that network."),
    "doctor": ("trundle.cli.doctor:app", "Check this machine, a simulator, or a robot's wheels."),
}

PLUGIN_GROUPS = {
    "robots": "trundle.robots",
    "worlds": "trundle.worlds",
    "planners": "trundle.planners",
    "controllers": "trundle.controllers",
    "smoothers": "trundle.smoothers",
    "agents": "trundle.agents",
    "localizers": "trundle.localizers",
    "simulators": "trundle.simulators",
    "behaviors": "trundle.behaviors",
}
"""Kinds of plug-ins, each with its entry-point group."""


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Run one command and exit. `arguments` excludes the program's name; by default they are the process's."""
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
        return show_error(error, json="--json" in arguments)


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
        raise UnknownNameError("verb", verb, VERBS, hint=_hint_at_verb(verb, arguments))
    from cyclopts import CycloptsError

    app = _make_app([verb])
    try:
        code = app(list(arguments), exit_on_error=False, print_error=False)
    except CycloptsError as error:
        refused = _explain(error)
        if refused is not None:
            raise refused from error
        return show_usage_error(error, arguments, json="--json" in arguments)
    if not {"--help", "-h"}.isdisjoint(arguments):
        plugins = _describe_plugins()
        print(plugins, end="\n" if plugins else "")
    return code if isinstance(code, int) else DONE


def _hint_at_verb(verb: str, arguments: Sequence[str]) -> str | None:
    """Return what to write where the words of a command are in another order; None where that is not clear."""
    first = next((argument for argument in arguments if argument in VERBS), None)
    if first is None:
        return None
    if verb.startswith("-"):
        return f"is an option, and options come after the verb: trundle {first} … {verb}"
    return f"is not one; write the verb first: trundle {first} {verb} …" if first == arguments[1] else None


def _describe_plugins() -> str:
    """List the plug-ins that packages add, a line for each kind, from their metadata: no plug-in is imported."""
    from importlib.metadata import entry_points

    names = {kind: sorted(entry_points(group=group).names) for kind, group in PLUGIN_GROUPS.items()}
    lines = [f"  {kind}: {', '.join(found)}" for kind, found in names.items() if found]
    return "\n".join(["Plug-ins installed:", *lines]) if lines else ""


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
    """Return the error that names the option whose value settings reject; for any other error return None."""
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
