"""What a behavior is and how it is named, and those that stand: `Wait`, `ClearCostmap`, `Replan` and `ReplanWith`."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Protocol, TypeAlias, cast, runtime_checkable

from pydantic import BeforeValidator, model_validator

from trundle.errors import BehaviorFailedError, InputError
from trundle.files.choice import Choice, split_choice
from trundle.geometry import Twist2D
from trundle.navigation.state import Snapshot as BehaviorContext
from trundle.planning import Planner, create_planner
from trundle.planning.planner import PlannerLike
from trundle.registry import Contract, Registry, is_plugin_file
from trundle.values import check_number

BEHAVIORS: Registry[Behavior] = Registry(
    "behavior",
    "trundle.behaviors",
    {
        "back_up": "trundle.navigation.behaviors.motions:BackUp",
        "clear_costmap": "trundle.navigation.behaviors.behavior:ClearCostmap",
        "drive_clear": "trundle.navigation.behaviors.motions:DriveClear",
        "drive_on_heading": "trundle.navigation.behaviors.motions:DriveOnHeading",
        "replan": "trundle.navigation.behaviors.behavior:Replan",
        "replan_with": "trundle.navigation.behaviors.behavior:ReplanWith",
        "spin": "trundle.navigation.behaviors.motions:Spin",
        "wait": "trundle.navigation.behaviors.behavior:Wait",
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
        """Return whether it can help where the robot makes no progress now; recovery leaves it out otherwise."""
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
    """Return names that `create_behavior` takes, sorted."""
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
    """Return the name of a class in snake case, as behaviors and services of ROS are called: `BackUp` is back_up."""
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
    """Return the options of a behavior of which only the first value is given."""
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


_STAND = Twist2D()
_SCANS_WITHIN_S = 2.0


class ClearCostmap(Behavior):
    """Forget what the scans saw, and stand until new ones have come in. The map stays.

    What no lidar sees from here is free again afterwards, even where something stands that was seen before.
    """

    def __init__(self) -> None:
        self._began: float | None = None

    def __repr__(self) -> str:
        return "ClearCostmap()"

    def start(self, context: BehaviorContext) -> None:
        """Begin now."""
        self._began = None

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return zero; None when new scans have come in, or nothing was sensed.

        Raises:
            BehaviorFailedError: If none come in within 2 s: the robot would drive blindly.
        """
        if self._began is None:
            self._began = context.time
            if not context.sees:
                return None
            context.clear_costmap()
        elif context.sees:
            return None
        if context.time - self._began > _SCANS_WITHIN_S:
            raise BehaviorFailedError(f"no scans came in within {_SCANS_WITHIN_S:g} s after the costmap was cleared")
        return _STAND


class Replan(Behavior):
    """Plan from here to the goal by the navigator's planner, and follow that path."""

    def __repr__(self) -> str:
        return f"{type(self).__name__}()"

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Plan; done at once.

        Raises:
            BehaviorFailedError: If there is no goal, or no path to it.
        """
        context.replan(self._planner())

    def _planner(self) -> Planner | None:
        return None


class ReplanWith(Replan):
    """Plan from here to the goal by another planner, and follow that path. Later plans are the navigator's again.

    Args:
        planner: The planner: its name, a class, a function or an object.
        options: Its options.

    Raises:
        UnknownNameError: If there is no such planner.
        InputError: If it does not take an option.
    """

    def __init__(self, planner: PlannerLike, **options: Any) -> None:
        if isinstance(planner, str) and is_plugin_file(planner):  # a step of recovery is named by files of others, too
            raise InputError(f"planner {planner!r} of replan_with is a file: give its class, or write module:name")
        self.planner = create_planner(planner, **options)
        self._label = split_choice(planner)[0]

    def __repr__(self) -> str:
        return f"ReplanWith({self._label!r})"

    def _planner(self) -> Planner | None:
        return self.planner


class Wait(Behavior):
    """Stand for a while.

    Args:
        seconds: Time to wait [s].

    Raises:
        InputError: If that is negative, or not finite.
    """

    def __init__(self, seconds: float = 5.0) -> None:
        self.seconds = check_number("seconds", seconds, 0.0, math.inf)
        if math.isinf(self.seconds):
            raise InputError("wait needs a finite number of seconds")
        self._until = 0.0

    def __repr__(self) -> str:
        return f"Wait({self.seconds:g})"

    @property
    def time_allowance(self) -> float:
        """That time, and 5 s [s]."""
        return self.seconds + 5.0

    def start(self, context: BehaviorContext) -> None:
        """Begin now."""
        self._until = context.time + self.seconds

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return zero; None when the time is over."""
        return None if context.time >= self._until - 1e-9 else _STAND
