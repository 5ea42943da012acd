"""Options that are generated from the fields of settings classes, and the errors that name them."""

from __future__ import annotations

import types
import typing
from collections.abc import Sequence
from dataclasses import make_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast, overload

from cyclopts import Group, Parameter, default_name_transform
from pydantic import BaseModel, ValidationError

from trundle.cli.shared.options import Integer, parse_pairs
from trundle.costmap import CostmapSettings
from trundle.errors import InputError, respell
from trundle.files.choice import Choice
from trundle.files.field_docs import describe_fields
from trundle.files.yaml_problems import describe_problems
from trundle.mission import RunSettings

EXAMPLES = {
    "planner": "goal_tolerance=0.5",
    "controller": "desired_linear_vel=0.4",
    "smoother": "minimum_turning_radius=0.5",
    "localizer": "particles=500",
    "agent": "speed=0.3",
    "layers": "rolling_window=true",
    "latency": "scan_age_s=0.1",
    "odometry": "heading=1deg",
    "lidar_errors": "dropouts=0.01",
    "map_errors": "missing=0.25",
    "start_error": "distance=0.5",
    "monitor": "time_before_collision=1.5",
}
"""A pair for each option that takes KEY=VALUE, or whose plug-in does, for messages and help."""

PAIRS = "KEY=VALUE"
"""How options that take pairs show what they take."""

OptionField: typing.TypeAlias = tuple[str, Any, Any]
"""Name, type and default of a field of a class of options, for `dataclasses.make_dataclass`."""


class GivenOptions:
    """Base of a class of options: it has an attribute for each, with the default where the option was not given."""

    if TYPE_CHECKING:

        def __init__(self, **given: object) -> None: ...
        def __getattr__(self, name: str) -> Any: ...


def options_class(options: Sequence[OptionField]) -> type[GivenOptions]:
    """Make a dataclass of options, for a class with methods to inherit."""
    return cast("type[GivenOptions]", make_dataclass("Given", options, bases=(GivenOptions,), frozen=True))


def option_name(field: str) -> str:
    """Return the name of a field's option. It omits the unit: `--planning-deadline` for `planning_deadline_s`."""
    return f"--{default_name_transform(field.removesuffix('_s'))}"


def option_for(
    model: type[BaseModel], field: str, *, help: str = "", name: str = "", path: bool = False
) -> OptionField:
    """Make the option of a field: what is written on a command line follows from the field's type.

    A number, a text or one of several texts is written as it is. A flag that is only true or false becomes an option
    that, when given, turns the default over; one that may also be something else has an option for both. A plug-in is
    written as its name, a pose as X,Y[,YAW], a list of them repeats the option, and a model takes KEY=VALUE.

    Args:
        model: The settings class.
        field: Its field.
        help: Text in --help; by default that of the class's docstring.
        name: Name of the option, where it is not the field's.
        path: Whether a text is the path of a file.
    """
    name = name or option_name(field)
    settings: dict[str, Any] = {"name": name, "help": help or describe_fields(model)[field]}
    annotation = model.model_fields[field].annotation
    is_union = typing.get_origin(annotation) in (types.UnionType, typing.Union)
    kind: Any = typing.get_args(annotation)[0] if is_union else annotation
    if typing.get_origin(kind) is Annotated:
        kind = typing.get_args(kind)[0]
    default = None
    if kind is bool and not is_union:
        settings["negative"], default = "", False
    elif kind is bool:
        settings["negative"] = f"--no-{name.removeprefix('--')}"
        kind = bool | None
    elif typing.get_origin(kind) is tuple:
        several = typing.get_args(kind)[0] is not float
        settings |= {"allow_leading_hyphen": True, "negative": "", "metavar": "X,Y[,YAW]"}
        kind = list[str] if several else str
    elif isinstance(kind, type) and issubclass(kind, BaseModel) and not issubclass(kind, Choice):
        return pairs_option(field, settings["help"])
    elif isinstance(kind, type):
        kind = {int: Integer, float: float}.get(kind, Path if path else str)
    return field, Annotated[kind if kind is bool else kind | None, Parameter(**settings)], default


def pairs_option(field: str, help: str, *, name: str = "") -> OptionField:
    """Make an option that takes KEY=VALUE and may be repeated."""
    settings = Parameter(
        name=name or option_name(field), allow_leading_hyphen=True, negative="", metavar=PAIRS, help=help
    )
    return field, Annotated[list[str] | None, settings], None


def _group(title: str, help: str) -> Parameter:
    group = Group(title, help=help, sort_key=0)
    return Parameter(
        name="*",
        group=group,
        name_transform=lambda field: option_name(field)[2:],
        negative="",
        show_default=_show_default,
    )


def _show_default(default: object) -> object:
    """Return a field's default as it is written on a command line."""
    if isinstance(default, tuple) and all(isinstance(item, Choice) for item in default):
        return ",".join(item.name for item in default)
    return default


CostmapOptions = Annotated[
    CostmapSettings | None,
    _group("Costmap", "How the costmap is computed from the map."),
]
RunOptions = Annotated[
    RunSettings | None,
    _group("Navigation", "When the goal is reached, when the robot is stuck, and when it replans."),
]


def given(settings: BaseModel | None) -> dict[str, object]:
    """Return the fields whose options were given."""
    return {} if settings is None else {name: getattr(settings, name) for name in settings.model_fields_set}


@overload
def choose(kind: str, name: str | None, pairs: list[str] | None, default: Choice) -> Choice: ...
@overload
def choose(kind: str, name: str | None, pairs: list[str] | None, default: Choice | None) -> Choice | None: ...
def choose(kind: str, name: str | None, pairs: list[str] | None, default: Choice | None) -> Choice | None:
    """Combine `--planner NAME` and `--planner-option KEY=VALUE`; `default` if neither is given.

    Options without a name are added to the default's. Another name starts without options.

    Raises:
        InputError: If a pair cannot be parsed, or there is no default for its option.
    """
    options = parse_pairs(f"--{kind}-option", pairs, EXAMPLES[kind])
    name = None if name is None else spelt(kind, name)
    if name is None and not options:
        return default
    if default is not None and name in (None, default.name):
        return Choice(name=default.name, options={**default.options, **options})
    if name is None:
        raise InputError(f"--{kind}-option needs a {kind}: give its name with --{kind}")
    return Choice(name=name, options=dict(options))


def spelt(kind: str, name: str) -> str:
    """Return the name of a planner or a controller that is only spelt otherwise, `A*` for `astar`; else it as it is."""
    from trundle.control import controller_names
    from trundle.planning import planner_names

    names = {"planner": planner_names, "controller": controller_names}.get(kind)
    return name if names is None or ":" in name else respell(name, names()) or name


def explain(error: ValidationError) -> InputError:
    """Return the error that names the option whose value the settings reject."""
    problems = error.errors(include_url=False)
    field = _field_of(problems[0]["loc"])
    model = RunSettings if field in RunSettings.model_fields else CostmapSettings
    found = {_field_of(problem["loc"]): problem["input"] for problem in problems if problem["loc"]}
    texts = [(problem["loc"], describe_problems([problem], model, found)[0]) for problem in problems]
    return InputError("\n".join(_of_option(loc, text) for loc, text in texts))


def _of_option(location: tuple[int | str, ...], text: str) -> str:
    """Rewrite a line about a field to name its option."""
    if not location:
        return text
    field = _field_of(location)
    place, _, rest = text.partition(": ")
    return f"{option_name(field)} {rest if place.partition('.')[0] == field else text}"


def _field_of(location: tuple[int | str, ...]) -> str:
    """Return the field of a problem's place; that of a list's item is the list's."""
    names = [part for part in location if isinstance(part, str)]
    return names[-1] if names else ""
