"""The protocol of behaviors, what they get, and behaviors by name: `create_behavior`, `BehaviorChoice`."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Protocol, TypeAlias, cast, runtime_checkable

from pydantic import BeforeValidator, model_validator

from trundle.errors import InputError
from trundle.files.choice import Choice
from trundle.geometry import Twist2D
from trundle.navigation.state import Snapshot as BehaviorContext
from trundle.registry import Contract, Registry

BEHAVIORS: Registry[Behavior] = Registry(
    "behavior",
    "trundle.behaviors",
    {
        "back_up": "trundle.navigation.behaviors.motions:BackUp",
        "clear_costmap": "trundle.navigation.behaviors.standing:ClearCostmap",
        "drive_clear": "trundle.navigation.behaviors.motions:DriveClear",
        "drive_on_heading": "trundle.navigation.behaviors.motions:DriveOnHeading",
        "replan": "trundle.navigation.behaviors.standing:Replan",
        "replan_with": "trundle.navigation.behaviors.standing:ReplanWith",
        "spin": "trundle.navigation.behaviors.motions:Spin",
        "wait": "trundle.navigation.behaviors.standing:Wait",
    },
    contract=Contract({"update": "context"}, files=False),
)

ASKED_FOR = "asked for"
"""Why a behavior ran that a program asked for."""

BehaviorResult: TypeAlias = Literal["succeeded", "failed", "interrupted", "running"]
"""How a behavior ended, or that it has not."""


@runtime_checkable
class Behavior(Protocol):
    """One thing that a robot does: a step of recovery, the task of a waypoint, or what a program asks for.

    A navigator checks every command as it checks those of a controller: it is cut to the robot's limits, to those of a
    speed mask and to what was seen to be free, and sent only if the robot can stop before it touches anything.
    Otherwise the behavior fails.

    A class of another package derives from this one and has `update`; `name` is then the name of its class.
    """

    @property
    def name(self) -> str:
        """Its name in messages and records, such as "back_up"."""
        return snake_case(type(self).__name__)

    @property
    def time_allowance(self) -> float:
        """Time [s] after which it has failed; 10 s by default, as in Nav2."""
        return 10.0

    def helps(self, context: BehaviorContext) -> bool:
        """Whether it can help where the robot makes no progress now; recovery leaves it out otherwise."""
        return True

    def start(self, context: BehaviorContext) -> None:
        """Begin here, also where it ran before. The default does nothing."""

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return the command for the next control period; None when it is done.

        Raises:
            BehaviorFailedError: If it cannot go on.
        """
        ...


@dataclass(frozen=True, slots=True)
class BehaviorRun:
    """One behavior that a robot ran.

    Attributes:
        behavior: Its name.
        reason: Why it ran, such as "no valid control", "asked for" or "task of goal 2".
        result: "succeeded", "failed", "interrupted" or "running".
        message: Why it failed or was interrupted; empty otherwise.
        begin_s: When it began [s].
        end_s: When it ended [s].
        recovery: Whether it was a step of recovery.
    """

    behavior: str
    reason: str
    result: BehaviorResult
    message: str
    begin_s: float
    end_s: float
    recovery: bool

    def __str__(self) -> str:
        why = f": {self.message}" if self.message else ""
        return f"{self.begin_s:.1f} s: {self.behavior} ({self.reason}) {self.result}{why}"


def describe_behaviors(runs: Sequence[BehaviorRun]) -> str:
    """Name what ran, each with how often: `replan 2, back_up 1 (1 failed)`; empty if nothing ran."""
    counts: dict[str, list[int]] = {}
    for ran in runs:
        count = counts.setdefault(ran.behavior, [0, 0])
        count[0] += 1
        count[1] += ran.result == "failed"
    return ", ".join(
        f"{name} {number}" + (f" ({failed} failed)" if failed else "") for name, (number, failed) in counts.items()
    )


def behavior_names() -> list[str]:
    """Names that `create_behavior` takes, sorted."""
    return BEHAVIORS.names()


def create_behavior(behavior: str | Behavior, **options: Any) -> Behavior:
    """Make a behavior from its name and options, or take one as it is: `create_behavior("back_up", distance=0.5)`.

    Raises:
        UnknownNameError: If there is no such behavior.
        InputError: If it does not take an option or a value.
    """
    return cast("Behavior", BEHAVIORS.resolve(behavior, {}, options))


def check_behavior_kind(behavior: object) -> None:
    """Refuse what is no behavior.

    Raises:
        InputError: If it is none.
    """
    if isinstance(behavior, type) or not isinstance(behavior, Behavior):
        raise InputError(f"a behavior is an object such as BackUp(0.3) or Spin(1.57), got {behavior!r}")


def snake_case(name: str) -> str:
    """The name of a class in snake case, as behaviors and services of ROS are called: `BackUp` is back_up."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")


_FORM = "write back_up, back_up=0.5 or {back_up: {distance: 0.5}}"


class BehaviorChoice(Choice):
    """A behavior: `back_up`, `back_up=0.5`, `{back_up: 0.5}` or `{back_up: {distance: 0.5}}`.

    Attributes:
        name: Its name.
        options: Its options, passed by keyword.
    """

    @model_validator(mode="before")
    @classmethod
    def _read(cls, given: object) -> object:
        if isinstance(given, str):
            name, equals, value = (part.strip() for part in given.partition("="))
            return {"name": name, "options": _first_option(name, _number(value)) if equals else {}}
        if isinstance(given, Mapping) and len(cast("Mapping[str, Any]", given)) == 1 and "name" not in given:
            ((name, value),) = cast("Mapping[str, Any]", given).items()
            if value is None or isinstance(value, Mapping):
                return {"name": name, "options": cast("object", value or {})}
            return {"name": name, "options": _first_option(name, value)}
        return cast("object", given)

    def make(self) -> Behavior:
        """Make the behavior.

        Raises:
            UnknownNameError: If there is no such behavior.
            InputError: If it does not take an option or a value.
        """
        return create_behavior(self.name, **dict[str, Any](self.options))


def shorten_behavior(choice: Mapping[str, Any]) -> object:
    """Write a behavior without options as its name alone, and one with options as `{name: {…}}`."""
    return {choice["name"]: choice["options"]} if choice["options"] else choice["name"]


def _first_option(name: str, value: object) -> dict[str, object]:
    """The options of a behavior of which only the first value is given."""
    maker = cast("Callable[..., object]", BEHAVIORS.load(name))
    for parameter in inspect.signature(maker).parameters.values():
        if parameter.kind is parameter.POSITIONAL_OR_KEYWORD:
            return {parameter.name: value}
    raise InputError(f"behavior {name!r} takes no value")


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _split(given: object) -> object:
    """Take one step alone, and split text at commas, also where it is one of a list."""
    if isinstance(given, str | Mapping | Choice):
        given = (cast("object", given),)
    if isinstance(given, list | tuple):
        items = cast("list[object]", given)
        split = [_parts(item) if isinstance(item, str) else (item,) for item in items]
        return tuple(part for parts in split for part in parts)
    raise InputError(f"a list of behaviors is needed, got {given!r}; {_FORM}")


def _parts(text: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in text.split(",") if part.strip())


BehaviorChoices: TypeAlias = Annotated[
    tuple[BehaviorChoice, ...],
    BeforeValidator(_split, json_schema_input_type=str | list[str | dict[str, Any]]),
]
"""Behaviors in order; text is split at commas."""
