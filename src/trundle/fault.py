"""`Fault`: an exception in plain texts, with the plug-in that it came from."""

from __future__ import annotations

import inspect
import linecache
import os
import sys
import sysconfig
import traceback
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from types import FrameType
from typing import TypeVar, cast

from trundle.errors import InputError, PlanningError, SimulationError

LIBRARIES = frozenset(
    [
        "PIL",
        "av",
        "carb",
        "cloudpickle",
        "cyclonedds",
        "cyclopts",
        "docstring_parser",
        "duckdb",
        "glfw",
        "gymnasium",
        "isaacsim",
        "launch",
        "launch_ros",
        "mapbox_earcut",
        "mcap",
        "mujoco",
        "numpy",
        "omni",
        "ovphysx",
        "ovstage",
        "pandas",
        "physx_usd_schemas",
        "pxr",
        "pyarrow",
        "pydantic",
        "pydantic_core",
        "ray",
        "rclpy",
        "rich",
        "rosbags",
        "rsl_rl",
        "scipy",
        "stable_baselines3",
        "tensordict",
        "torch",
        "trimesh",
        "warp",
        "websockets",
        "yaml",
        "zstandard",
    ]
)
"""Top-level modules that trundle itself calls: what raises in them is no plug-in, unless one has called them."""

_MOST_TEXT, _MOST_TRACEBACK = 2_000, 20_000
_KNOWN = "__trundle_fault__"
_NOTE = "The folder of the run: "
_HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "")  # noqa: PTH118, PTH120, PTH100
_PYTHON = tuple({os.path.join(sysconfig.get_path(name), "") for name in ("stdlib", "platstdlib")})  # noqa: PTH118
_INSTALLED = ("site-packages", "dist-packages")

_KINDS = (
    ("plan", "planner"),
    ("compute_velocity", "controller"),
    ("smooth", "smoother"),
    ("set_goal", "agent"),
    ("step", "simulator"),
    ("paint", "layer"),
    ("check", "collision monitor"),
    ("is_moving_on", "progress checker"),
    ("xy_tolerance", "goal checker"),
    ("time_allowance", "behavior"),
    ("on_step", "observer"),
    ("update", "localizer"),
)
"""Kinds of plug-ins by a method that their classes have; the first that fits counts, so the most telling come first."""

_CALLERS = {
    "control": "controller",
    "costmap": "layer",
    "localization": "localizer",
    "planning": "planner",
    "sim": "simulator",
    "worlds": "world",
}
"""Kinds of plug-ins by the package of trundle that calls them, for functions."""

_Kind = TypeVar("_Kind")


@dataclass(frozen=True, slots=True)
class Fault:
    """An exception that ended a run.

    Attributes:
        type: Name of its class, such as "ValueError".
        message: What it says, up to 2,000 characters.
        kind: What the plug-in is that raised it: "planner", "controller", "agent", …, or "plug-in" where that is not
            known; empty where trundle itself raised it.
        plugin: Name of its class or function; empty where trundle itself raised it.
        function: The function that raised, such as "MyPlanner.plan".
        file: Where that is: the innermost place in the code of the plug-in.
        line: The line there.
        traceback: As Python prints it, up to 20,000 characters.
    """

    type: str
    message: str
    kind: str = ""
    plugin: str = ""
    function: str = ""
    file: str = ""
    line: int = 0
    traceback: str = ""

    @property
    def is_plugin(self) -> bool:
        """Whether a plug-in raised it, and not trundle itself."""
        return bool(self.plugin)

    @property
    def place(self) -> str:
        """File and line; empty where they are not known."""
        return f"{self.file}:{self.line}" if self.file else ""

    @property
    def source(self) -> str:
        """The line of code; empty where it cannot be read."""
        return linecache.getline(self.file, self.line).strip() if self.file else ""

    def __str__(self) -> str:
        """Return in one line which plug-in raised which exception, and where."""
        who = f"the {self.kind} {self.plugin}" if self.is_plugin else "trundle"
        said = one_line(self.message)
        where = f" ({self.place})" if self.file else ""
        return f"{who} raised {self.type}" + (f": {said}" if said else "") + where


def find_fault(error: BaseException, parts: Iterable[object] = ()) -> Fault:
    """Find out which plug-in an exception came from.

    That is the code of others that trundle called, by the frames of the traceback; trundle's dependencies do not count.
    Without such a frame it is the class of others whose inherited method raised, or a compiled one.

    Args:
        error: The exception, as it was caught: its traceback begins in trundle.
        parts: Objects of the run that may be plug-ins.
    """
    known = getattr(error, _KNOWN, None)
    if isinstance(known, Fault):
        return known if known.traceback else replace(known, traceback=_format(error))
    trace = list(traceback.walk_tb(error.__traceback__))
    found = _find_frame(trace) or _find_class([frame for frame, _ in trace], error, parts)
    fault = Fault(type(error).__name__, text_of(error), *found, traceback=_format(error))
    keep_fault(error, fault)
    return fault


def keep_fault(error: BaseException, fault: Fault) -> None:
    """Let `find_fault` return this fault for the exception from now on."""
    with suppress(Exception):
        setattr(error, _KNOWN, fault)


def is_of_plugin(error: BaseException) -> bool:
    """Return whether a plug-in raised this, whatever its type.

    A planner says by a PlanningError that there is no path, and a simulator by a SimulationError that it cannot go on:
    these are results. Ctrl-C is nobody's fault.
    """
    if isinstance(error, PlanningError | SimulationError | KeyboardInterrupt):
        return False
    return find_fault(error).is_plugin


def note_folder(error: BaseException, folder: str | os.PathLike[str]) -> None:
    """Add a note to an exception: the folder of the run that it ended, once."""
    note = f"{_NOTE}{os.fspath(folder)}"
    if note not in notes_of(error):
        with suppress(Exception):  # a class of others may refuse
            BaseException.add_note(error, note)


def folder_of(error: BaseException) -> str | None:
    """Return the folder that `note_folder` has noted last, or None."""
    return next((note.removeprefix(_NOTE) for note in reversed(notes_of(error)) if note.startswith(_NOTE)), None)


def notes_of(error: BaseException) -> list[str]:
    """Return the notes of an exception that are texts."""
    notes = getattr(error, "__notes__", None)
    return [note for note in cast("list[object]", notes) if isinstance(note, str)] if isinstance(notes, list) else []


def check_result(value: object, kind: type[_Kind], plugin: object, method: str) -> _Kind:
    """Return what a method of a plug-in returned, or refuse it where it is not of this kind.

    Raises:
        InputError: If it is not; `find_fault` then names the plug-in.
    """
    if isinstance(value, kind):
        return value
    message = f"{type(plugin).__name__}.{method} must return a {kind.__name__}, got {_short(value)}"
    raise wrong_result(message, plugin, method)


def wrong_result(message: str, plugin: object, method: str, *, kind: str = "") -> InputError:
    """Make the error for what a plug-in returned, with this message; `find_fault` then names the plug-in.

    Args:
        message: What it returned, and what it has to return.
        plugin: The object, or the function that does its work.
        method: The method of the object that returned it.
        kind: The kind of plug-in that a function is ("planner"); of an object, its class tells that.
    """
    error = InputError(message)
    made = type(plugin)
    if inspect.isfunction(plugin):
        fault = Fault("InputError", message, kind, plugin.__name__, plugin.__qualname__, *place_of(plugin))
        keep_fault(error, fault)
    elif is_plugin_class(made):
        function = inspect.unwrap(getattr(made, method, made))
        place = place_of(function if inspect.isfunction(function) else made)
        fault = Fault("InputError", message, _kind_of(made), made.__name__, f"{made.__name__}.{method}", *place)
        keep_fault(error, fault)
    return error


def is_plugin_class(kind: type) -> bool:
    """Return whether a class may be a plug-in's: not of trundle, of Python, or of what trundle depends on."""
    top = kind.__module__.partition(".")[0]
    if top in ("trundle", "builtins") or top in LIBRARIES:
        return False
    return not _is_of_python(getattr(sys.modules.get(kind.__module__), "__file__", None) or "")


def place_of(code: object) -> tuple[str, int]:
    """Return the file and first line of a class or a function; the line is 0 where Python does not know it."""
    try:
        return inspect.getsourcefile(code) or "", inspect.getsourcelines(code)[1]  # pyright: ignore[reportArgumentType]
    except (OSError, TypeError):
        module = sys.modules.get(getattr(code, "__module__", ""))
        return getattr(module, "__file__", None) or "", 0


def text_of(error: BaseException) -> str:
    """Return what an exception says, as a text that every file can hold, however odd its class is."""
    try:
        said = str(error)
    except Exception as problem:  # noqa: BLE001 - classes of other people may do anything
        said = f"(its text cannot be made: {type(problem).__name__})"
    return _clean(said)[:_MOST_TEXT]


def one_line(text: str, most: int = 300) -> str:
    """Shorten a text to one line of at most so many characters."""
    line = " ".join(text.split())
    return line if len(line) <= most else f"{line[: most - 1]}…"


# Frames ---------------------------------------------------------------------------------------------------------------

_Found = tuple[str, str, str, str, int]
"""Kind, plug-in, function, file and line."""


def _find_frame(trace: list[tuple[FrameType, int]]) -> _Found | None:
    """Find the code of others that trundle called, and the innermost place in it."""
    caller, first = "", None
    for index, (frame, _) in enumerate(trace):
        if _is_of_trundle(frame):
            caller = _package(frame)
        elif _is_of_others(frame) and caller != "cli":  # the command line itself calls no plug-in
            first = index
            break
    if first is None:
        return None
    outer = trace[first][0]
    package = _module(outer).partition(".")[0]
    mine = [
        (frame, line)
        for frame, line in trace[first:]
        if _is_of_others(frame) and (_module(frame).partition(".")[0] == package or not _is_installed(frame))
    ]
    frame, line = mine[-1]
    kind, plugin = _name(outer, caller)
    return kind, plugin, _qualname(frame), frame.f_code.co_filename, line


def _find_class(frames: list[FrameType], error: BaseException, parts: Iterable[object]) -> _Found:
    """Find a class of others whose inherited method raised, or one of compiled code, which leaves no frame."""
    if isinstance(error, InputError):
        return "", "", "", "", 0
    owners = [type(owner) for frame in reversed(frames) if (owner := _self_of(frame)) is not None]
    compiled = [type(part) for part in parts if _is_compiled(type(part))]
    for made in (*owners, *compiled):
        if is_plugin_class(made):
            return _kind_of(made), made.__name__, made.__name__, *place_of(made)
    return "", "", "", "", 0


def _is_of_others(frame: FrameType) -> bool:
    if _is_of_trundle(frame) or _module(frame).partition(".")[0] in LIBRARIES:
        return False
    file = frame.f_code.co_filename
    return not (file.startswith("<frozen ") or _is_of_python(file))


def _is_of_trundle(frame: FrameType) -> bool:
    return _module(frame).partition(".")[0] == "trundle" or frame.f_code.co_filename.startswith(_HERE)


def _is_of_python(file: str) -> bool:
    return file.startswith(_PYTHON) and not any(part in file for part in _INSTALLED)


def _is_installed(frame: FrameType) -> bool:
    return any(part in frame.f_code.co_filename for part in _INSTALLED)


def _module(frame: FrameType) -> str:
    return str(frame.f_globals.get("__name__", ""))


def _package(frame: FrameType) -> str:
    """Return the name of the package of trundle that a frame is in."""
    return _module(frame).partition(".")[2].partition(".")[0]


def _qualname(frame: FrameType) -> str:
    return frame.f_code.co_qualname.rpartition("<locals>.")[2]


def _self_of(frame: FrameType) -> object | None:
    """Return the object whose method a frame runs; None for functions."""
    code = frame.f_code
    return frame.f_locals.get("self") if code.co_argcount and code.co_varnames[0] == "self" else None


def _name(frame: FrameType, caller: str) -> tuple[str, str]:
    """Return kind and name of the plug-in whose code a frame runs, called by the package `caller` of trundle."""
    owner = _self_of(frame)
    if owner is not None:
        return _kind_of(type(owner), caller), type(owner).__name__
    name = _qualname(frame)
    return _CALLERS.get(caller, "plug-in"), _module(frame) if name == "<module>" else name


def _kind_of(made: type, caller: str = "") -> str:
    return next((kind for name, kind in _KINDS if hasattr(made, name)), _CALLERS.get(caller, "plug-in"))


def _is_compiled(made: type) -> bool:
    file = getattr(sys.modules.get(made.__module__), "__file__", None) or ""
    return bool(file) and not file.endswith(".py")


# Texts ----------------------------------------------------------------------------------------------------------------


def _format(error: BaseException) -> str:
    try:
        text = "".join(traceback.format_exception(error))
    except Exception:  # noqa: BLE001 - classes of other people may do anything
        text = "".join(traceback.format_tb(error.__traceback__))
    text = _clean(text)
    return text if len(text) <= _MOST_TRACEBACK else f"…{text[-_MOST_TRACEBACK:]}"


def _clean(text: str) -> str:
    return text.encode("utf-8", errors="backslashreplace").decode()


def _short(value: object) -> str:
    try:
        return one_line(_clean(repr(value)), 80)
    except Exception:  # noqa: BLE001 - classes of other people may do anything
        return f"a {type(value).__name__}"
