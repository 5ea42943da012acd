"""`PluginChoice`: a planner, controller, smoother, agent, localizer or simulator of a suite, or a Python object."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from pathlib import Path
from typing import Annotated, Any, TypeAlias, cast

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from trundle.control.controller import CONTROLLERS
from trundle.errors import InputError, UnknownNameError
from trundle.extras import missing_extra
from trundle.files.choice import Choice, takes_plugin
from trundle.navigation.agents import AGENTS
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.registry import Registry, is_model_file, is_plugin_file
from trundle.sim.simulator import SIMULATORS


class PluginChoice(Choice):
    """A planner, a controller, a smoother, an agent, a localizer or a simulator: `astar`, or `{name: astar, label: a}`.

    Attributes:
        name: Its name, or `module:name` of a class, a function or an object that no installed package has registered.
        label: What it is called in tables; by default its name, with its options where the name is there twice.
    """

    label: str | None = None

    def plain(self) -> Choice:
        """The same without its label, for a scenario."""
        if self.given is None:
            return Choice(name=self.name, options=self.options)
        return Choice.of_object(self.given, options=self.options)


def identity_of(choice: Choice) -> dict[str, Any]:
    """Return what decides how a choice acts, as plain values; of a Python object, a hash of its code and state."""
    options = {name: choice.options[name] for name in sorted(choice.options)}
    if not choice.is_python:
        if is_model_file(choice.name):  # the same policy, wherever its file lies
            return {"name": choice.short_name, "options": options, "code": _file_digest(choice.name)}
        code = {"code": _file_digest(choice.name.rpartition(":")[0])} if is_plugin_file(choice.name) else {}
        return {"name": choice.name, "options": options, **code}
    code = None if choice.given is None else _code_digest(choice.given)
    return {"name": choice.name, "code": code, **({"options": options} if options else {})}


def _file_digest(name: str) -> str:
    """Hash of a file, so that what a changed one did is not taken for what it does."""
    try:
        return hashlib.sha256(Path(name).read_bytes()).hexdigest()
    except OSError:
        return ""


def _code_digest(given: object) -> str:
    """Hash of a Python object's source and state, as far as Python can tell them."""
    kind = given if isinstance(given, type) or inspect.isroutine(given) else type(given)
    try:
        source = inspect.getsource(cast("Any", kind))
    except (OSError, TypeError):
        code = getattr(given, "__code__", None)
        source = "" if code is None else repr((code.co_code, code.co_names))
    if kind is given:
        closure = tuple(cell.cell_contents for cell in getattr(given, "__closure__", None) or ())
        state = _pickled((closure, getattr(given, "__defaults__", None)))
    else:
        state = _pickled(given)
    return hashlib.sha256(f"{kind.__module__}:{kind.__qualname__}\n{source}".encode() + state).hexdigest()


def _pickled(given: object) -> bytes:
    """Pickle an object's state, by cloudpickle where that is needed, as for what was defined in a notebook."""
    try:
        return pickle.dumps(given)
    except Exception as error:  # noqa: BLE001 - what cannot be pickled raises anything
        try:
            import cloudpickle  # pyright: ignore[reportMissingTypeStubs]
        except ImportError:
            raise missing_extra("sending it to worker processes", "cloudpickle", "evaluate") from error
        try:
            return cast("bytes", cloudpickle.dumps(given))  # pyright: ignore[reportUnknownMemberType]
        except Exception as reason:
            raise InputError(f"{given!r} cannot be sent to worker processes: {reason}") from reason


def _known(registry: Registry[Any]) -> AfterValidator:
    """Validate that a name is known; Python objects are looked at when a suite is checked."""

    def check(choice: PluginChoice | None) -> PluginChoice | None:
        try:
            # A file of Python is not imported before the suite is checked: it may be named by a file.
            if choice is not None and not choice.is_python and not is_plugin_file(choice.name):
                registry.check(choice.name)
        except (UnknownNameError, InputError) as error:
            raise PydanticCustomError("unknown_name", "{what}", {"what": str(error)}) from None
        return choice

    return AfterValidator(check)


_TAKES = takes_plugin(PluginChoice, optional=False)

Planner: TypeAlias = Annotated[PluginChoice, _TAKES, _known(PLANNERS)]
Controller: TypeAlias = Annotated[PluginChoice, _TAKES, _known(CONTROLLERS)]
Smoother: TypeAlias = Annotated[PluginChoice | None, takes_plugin(PluginChoice), _known(SMOOTHERS)]
Agent: TypeAlias = Annotated[PluginChoice, _TAKES, _known(AGENTS)]
Localizer: TypeAlias = Annotated[PluginChoice | None, takes_plugin(PluginChoice)]
Backend: TypeAlias = Annotated[
    PluginChoice, takes_plugin(PluginChoice, objects=False, optional=False), _known(SIMULATORS)
]
