"""`SuiteFields`: what a suite's YAML says, its own fields and a scenario's; `PluginChoice`: a plug-in in it."""

from __future__ import annotations

import hashlib
import inspect
import pickle
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self, TypeAlias, cast

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, create_model, model_validator
from pydantic_core import PydanticCustomError

from trundle.control.controller import CONTROLLERS
from trundle.costmap import CostmapSettings
from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.statistics import Gate
from trundle.evaluation.suite.parts import (
    Limits,
    Missions,
    MissionsField,
    Seeds,
    SuiteWorldField,
    as_items,
    read_items,
    read_lists,
)
from trundle.evaluation.suite.vary import Vary
from trundle.extras import missing_extra
from trundle.files.choice import Choice, takes_plugin
from trundle.files.field_docs import describe_fields
from trundle.files.yaml_config import Config
from trundle.mission import Scenario
from trundle.navigation import NavigatorSettings
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
        """Return the same without its label, for a scenario."""
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
    """Hash of a file, so that results of a changed file are told from those of the file before."""
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


_ROBOT_AND_SENSORS = (
    "assumed",
    "lidar",
    "lidar_errors",
    "odometry",
    "unmapped",
    "movers",
    "known_map",
    "map_errors",
    "localizer",
    "start_error",
    "layers",
    "latency",
    "collision_monitor",
    "rules",
)

CROSSED = tuple(
    name
    for name in (*CostmapSettings.model_fields, *NavigatorSettings.model_fields, "resolution", *_ROBOT_AND_SENSORS)
    if name != "planning_deadline_s"
)
"""Settings of a scenario that a suite may cross."""


def _field(name: str) -> tuple[Any, Any]:
    """Return the type and the default of a setting; the type takes one value of the scenario's field, or a list."""
    field = Scenario.model_fields[name]
    item: Any = Localizer if name == "localizer" else field.annotation  # one of a suite may have a label
    for constraint in () if name == "localizer" else field.metadata:
        item = Annotated[item, constraint]
    several = tuple[item, ...]
    read = read_lists if name == "movers" else read_items
    one_or_several = BeforeValidator(read, json_schema_input_type=item | list[item])
    return Annotated[several, one_or_several], (field.default,)


def _docstring() -> str:
    texts = describe_fields(Scenario)
    lines = "\n".join(f"    {name}: {texts[name]}" for name in CROSSED)
    return f"The settings of a scenario, each one value or a list that is crossed.\n\nAttributes:\n{lines}\n"


if TYPE_CHECKING:
    CrossedSettings = Config
else:
    CrossedSettings = create_model(
        "CrossedSettings",
        __base__=Config,
        __module__=__name__,
        __doc__=_docstring(),
        **{name: _field(name) for name in CROSSED},
    )


def _some(kind: Any) -> BeforeValidator:
    """Validate that a single value is taken as a list of one, and that a list is not empty."""
    return BeforeValidator(read_items, json_schema_input_type=kind | list[kind])


def _refuse_deadline(_: object) -> None:
    raise PydanticCustomError(
        "deadline",
        "planning has no deadline on the clock inside an evaluation, as the episodes would depend on how busy the "
        "computer is; limit the search instead ({{name: hybrid_astar, options: {{max_expansions: 50000}}}}), or the "
        "whole episode (limits: {{wall_s: 60}})",
        {},
    )


def _check_requirement(text: str) -> str:
    try:
        Gate.parse(text)
    except InputError as error:
        raise PydanticCustomError("requirement", "{what}", {"what": str(error)}) from None
    return text


class SuiteFields(CrossedSettings):
    """The fields of a suite; see `Suite`.

    Beside its own fields it has settings of a scenario; one that is given as a list is crossed. Every field that takes
    a list takes a single value as well.

    Attributes:
        name: Name of the suite.
        worlds: Where the robots drive: generated worlds, maps and worlds' files. Either these or `maps` are needed.
        maps: More worlds, by the paths of their maps. A suite that was made has them in `worlds`.
        robots: Catalogue names or paths of robots' YAML; a path in a file is relative to that file.
        planners: Planners by name, `module:name`, or `{name: …, options: {…}}`. In Python also classes, functions
            (costmap, start, goal) and objects.
        controllers: Controllers, likewise.
        smoothers: Smoothers of the planned paths, likewise; by default they are driven as they are planned.
        agents: Agents, likewise, which drive instead of planners and controllers. They are compared with planners and
            controllers where these are given too.
        backends: Simulators by name.
        missions: Where the robots are to go.
        seeds: Seeds of the missions. A suite that was made has them in `missions`.
        vary: What differs between what the robot was designed for and what it drives with.
        limits: What an episode may take.
        require: What must hold of the results: "success>=0.99".
        planning_deadline_s: Must be left out: planning has no deadline on the clock inside an evaluation.
    """

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": ["worlds"]}, {"required": ["maps"]}]})

    name: str | None = None
    worlds: Annotated[tuple[SuiteWorldField, ...], _some(SuiteWorldField)] = ()
    maps: Annotated[tuple[SuiteWorldField, ...], _some(SuiteWorldField)] = Field(default=(), exclude=True)
    robots: Annotated[tuple[str, ...], _some(str)] = ("nova_carter",)
    planners: Annotated[tuple[Planner, ...], _some(Planner)] = (PluginChoice(name="auto"),)
    controllers: Annotated[tuple[Controller, ...], _some(Controller)] = (PluginChoice(name="regulated_pure_pursuit"),)
    smoothers: Annotated[tuple[Smoother, ...], _some(Smoother)] = (None,)
    agents: Annotated[tuple[Agent, ...], _some(Agent)] = ()
    backends: Annotated[tuple[Backend, ...], _some(Backend)] = (PluginChoice(name="mujoco"),)
    missions: MissionsField = Missions(seeds=20)
    seeds: Seeds | None = Field(default=None, exclude=True)
    vary: Vary = Vary()
    limits: Limits = Limits()
    require: Annotated[
        tuple[Annotated[str, AfterValidator(_check_requirement)], ...],
        BeforeValidator(as_items, json_schema_input_type=str | list[str]),
    ] = ()
    planning_deadline_s: Annotated[None, BeforeValidator(_refuse_deadline)] = Field(default=None, exclude=True)

    @model_validator(mode="after")
    def _move_maps_and_seeds(self) -> Self:
        """Put `maps` into `worlds`, and `seeds` into `missions`: the rest of the code knows these alone."""
        changes: dict[str, Any] = {}
        if self.maps:
            changes["worlds"] = (*self.worlds, *self.maps)
        elif not self.worlds:
            raise PydanticCustomError("no_worlds", "worlds: is missing", {})
        if self.seeds is not None:
            given = {name: getattr(self.missions, name) for name in self.missions.model_fields_set}
            if "missions" in self.model_fields_set and "seeds" in given:
                raise PydanticCustomError("seeds_twice", "seeds: missions has seeds, too; leave one of them out", {})
            changes["missions"] = Missions(**{**given, "seeds": self.seeds})
        if changes:
            for name, value in {**changes, "maps": (), "seeds": None}.items():
                object.__setattr__(self, name, value)
            self.__pydantic_fields_set__ = (self.model_fields_set | changes.keys()) - {"maps", "seeds"}
        return self

    def crossed(self) -> dict[str, tuple[Any, ...]]:
        """Return settings of the scenario that it gives, each with its values."""
        return {name: getattr(self, name) for name in CROSSED if name in self.model_fields_set}
