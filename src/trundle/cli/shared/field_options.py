"""Command-line options generated from the fields of the settings classes."""

from __future__ import annotations

from typing import Annotated, overload

from cyclopts import Group, Parameter, default_name_transform
from pydantic import BaseModel, ValidationError

from trundle.cli.shared.options import EXAMPLES, parse_pairs
from trundle.costmap import CostmapSettings
from trundle.errors import InputError
from trundle.files.choice import Choice
from trundle.files.yaml_problems import describe_problems
from trundle.mission import RunSettings


def _option(field: str) -> str:
    """Option names omit the unit, which is in the help: `--planning-deadline` for `planning_deadline_s`."""
    return default_name_transform(field.removesuffix("_s"))


def _parameter(title: str, help: str) -> Parameter:
    return Parameter(name="*", group=Group(title, help=help, sort_key=0), name_transform=_option, negative="")


CostmapOptions = Annotated[
    CostmapSettings | None,
    _parameter("Costmap", "How the costmap is computed from the map."),
]
RunOptions = Annotated[
    RunSettings | None,
    _parameter("Navigation", "When the goal is reached, when the robot is stuck, and when it replans."),
]


def given(settings: BaseModel | None) -> dict[str, object]:
    """The fields whose options were given."""
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
    if name is None and not options:
        return default
    if default is not None and name in (None, default.name):
        return Choice(name=default.name, options={**default.options, **options})
    if name is None:
        raise InputError(f"--{kind}-option needs a {kind}: give its name with --{kind}")
    return Choice(name=name, options=dict(options))


def explain(error: ValidationError) -> InputError:
    """The error that names the option whose value the settings reject."""
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
    return f"--{_option(field)} {rest if place.partition('.')[0] == field else text}"


def _field_of(location: tuple[int | str, ...]) -> str:
    """The field of a problem's place; that of a list's item is the list's."""
    names = [part for part in location if isinstance(part, str)]
    return names[-1] if names else ""
