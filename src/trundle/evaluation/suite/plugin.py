"""`PluginChoice`: a planner, controller, smoother or simulator of a suite, by name or as a Python object."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Generic, Self, TypeVar, cast

from pydantic import AfterValidator, BeforeValidator, PrivateAttr
from pydantic_core import PydanticCustomError

from trundle.control.controller import CONTROLLERS
from trundle.costmap import Costmap
from trundle.errors import InputError, MissingExtraError, UnknownNameError
from trundle.files.choice import Choice
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning.planner import PLANNERS
from trundle.planning.smoother import SMOOTHERS
from trundle.registry import Registry
from trundle.sim.simulator import SIMULATORS

PYTHON = "python:"
"""What the name of a Python object begins with: a file cannot hold the object itself."""

_Made = TypeVar("_Made")


class PluginChoice(Choice):
    """A planner, a controller, a smoother or a simulator: `astar`, or `{name: astar, options: {…}, label: fast}`.

    Attributes:
        name: Its name, or `module:Class` of one that no installed package has registered.
        label: What it is called in tables; none means its name, with its options where the name is there twice.
    """

    label: str | None = None
    _object: Any = PrivateAttr(default=None)

    @classmethod
    def of_object(cls, given: object, label: str | None = None) -> Self:
        """Choose a Python object: a planner, the class of one, or a function (costmap, start, goal) → path."""
        name = label or _name_of(given)
        choice = cls(name=PYTHON + name, label=name)
        choice._object = given
        return choice

    @property
    def given(self) -> object:
        """The Python object; None where it is chosen by name."""
        return self._object

    @property
    def is_python(self) -> bool:
        """Whether it is, or was before it was saved, a Python object."""
        return self.name.startswith(PYTHON)

    def planner(self) -> Any:
        """What to plan with instead of the name; None where the name says it all.

        Raises:
            InputError: If the suite was read from a file, which cannot hold the object.
        """
        if not self.is_python:
            return None
        if self._object is None:
            raise InputError(
                f"planner {self.label or self.name!r} was a Python object, which a file cannot hold: give the suite "
                "with the object again, in Python"
            )
        if isinstance(self._object, type):
            return cast("Any", self._object)()
        return self._object if callable(getattr(self._object, "plan", None)) else FunctionPlanner(self._object)

    def identity(self) -> dict[str, Any]:
        """What decides how it acts, as plain values."""
        options = {name: self.options[name] for name in sorted(self.options)}
        if not self.is_python:
            return {"name": self.name, "options": options}
        return {"name": self.name, "code": None if self._object is None else _code_digest(self._object)}


@dataclass(frozen=True, slots=True)
class FunctionPlanner:
    """A function (costmap, start, goal) → `Path` or poses, as a planner.

    Attributes:
        function: The function.
    """

    function: Any

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> Path:
        """Plan from `start` to `goal`; poses become a path."""
        answer = self.function(costmap, start, goal)
        return answer if isinstance(answer, Path) else Path(answer, planner=_name_of(self.function))


class Role(Generic[_Made]):
    """What a choice is for: its registry and the method that such an object has.

    Args:
        kind: In messages ("planner").
        registry: The known names.
        method: What a class by `module:Class` must have.
        takes_objects: Whether Python objects are taken.
    """

    def __init__(self, kind: str, registry: Registry[Any], method: str, *, takes_objects: bool = False) -> None:
        self._kind = kind
        self._registry = registry
        self._method = method
        self._takes_objects = takes_objects

    def read(self, given: object) -> object:
        """Take a name alone, a `Choice`, or a Python object as a `PluginChoice`."""
        if isinstance(given, PluginChoice) or given is None or isinstance(given, Mapping):
            return cast("object", given)
        if isinstance(given, str):
            return {"name": given}
        if isinstance(given, Choice):
            return given.model_dump()
        if self._takes_objects and (callable(given) or callable(getattr(given, self._method, None))):
            if isinstance(given, type) and not callable(getattr(given, self._method, None)):
                raise PydanticCustomError(
                    "plugin", "{what}", {"what": f"class {given.__name__} has no {self._method}(…), as a planner has"}
                )
            return PluginChoice.of_object(given)
        return given

    def check(self, choice: PluginChoice | None) -> PluginChoice | None:
        """Refuse a name that is not known."""
        if choice is None or (choice.is_python and self._takes_objects):
            return choice
        try:
            if ":" in choice.name:
                self._registry.load_class(choice.name, self._method)
            else:
                self._registry.check(choice.name)
        except (UnknownNameError, InputError) as error:
            raise PydanticCustomError("unknown_name", "{what}", {"what": str(error)}) from None
        return choice


_PLANNER = Role[Any]("planner", PLANNERS, "plan", takes_objects=True)
_CONTROLLER = Role[Any]("controller", CONTROLLERS, "compute_velocity")
_SMOOTHER = Role[Any]("smoother", SMOOTHERS, "smooth")
_BACKEND = Role[Any]("backend", SIMULATORS, "step")


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
    """Its state; by cloudpickle where that is installed and needed, as for what was defined in a notebook."""
    try:
        return pickle.dumps(given)
    except Exception as error:  # noqa: BLE001 - what cannot be pickled raises anything
        try:
            import cloudpickle  # pyright: ignore[reportMissingTypeStubs]
        except ImportError:
            install = 'pip install "trundle[evaluate]"'
            raise MissingExtraError("sending a planner to worker processes", "cloudpickle", install) from error
        try:
            return cast("bytes", cloudpickle.dumps(given))  # pyright: ignore[reportUnknownMemberType]
        except Exception as reason:
            raise InputError(f"{given!r} cannot be sent to worker processes: {reason}") from reason


def _name_of(given: object) -> str:
    name = getattr(given, "__name__", None) or type(given).__name__
    return str(name)


_NAMED = str | PluginChoice

Planner = Annotated[
    PluginChoice,
    BeforeValidator(_PLANNER.read, json_schema_input_type=_NAMED),
    AfterValidator(_PLANNER.check),
]
Controller = Annotated[
    PluginChoice,
    BeforeValidator(_CONTROLLER.read, json_schema_input_type=_NAMED),
    AfterValidator(_CONTROLLER.check),
]
Smoother = Annotated[
    PluginChoice | None,
    BeforeValidator(_SMOOTHER.read, json_schema_input_type=_NAMED | None),
    AfterValidator(_SMOOTHER.check),
]
Backend = Annotated[
    PluginChoice,
    BeforeValidator(_BACKEND.read, json_schema_input_type=_NAMED),
    AfterValidator(_BACKEND.check),
]
