"""Directives: what can be asked of a run in progress, such as a pause, another goal or a command by hand."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, fields
from dataclasses import dataclass as plain_dataclass
from typing import Any, Literal, TypeAlias

from pydantic import field_validator
from pydantic.dataclasses import dataclass

from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D, Pose3D, wrap_angle
from trundle.geometry.solids import Box, Solid
from trundle.mission.steering.checks import CONFIG, CheckedDirective, flag, number_of
from trundle.mission.steering.goal_directives import (
    Cancel,
    ClearObstacles,
    FollowPath,
    ReinitializeGlobal,
    RunBehavior,
    SetGoal,
    SetGoals,
    SetPose,
)
from trundle.values import as_number, as_sequence, check_count, check_number, check_seed

SLOWEST, FASTEST = 0.1, 50.0
"""Speeds of a run relative to real time; infinity, as fast as it can, is allowed too."""

_FASTEST_COMMAND = 1e6  # [m/s] or [rad/s]; the robot's limits come far below
_SMALLEST_M, _LARGEST_M = 0.01, 20.0
_FARTHEST_M = 1e6
_LONGEST_TEXT = 1000
_MOST_PERIODS = 1_000_000


@dataclass(frozen=True, slots=True, config=CONFIG)
class Pause(CheckedDirective):
    """Pause the run, or let it go on: the simulated time stands meanwhile, and then the goal is set again.

    Raises:
        InputError: If `paused` is not a bool.
    """

    paused: bool = True

    _check_paused = field_validator("paused", mode="plain")(flag)


@dataclass(frozen=True, slots=True, config=CONFIG)
class StepOnce(CheckedDirective):
    """Drive exactly one control period, or so many, and be paused after it.

    Attributes:
        periods: How many, up to a million.

    Raises:
        InputError: If it is no such number.
    """

    periods: int = 1

    @field_validator("periods", mode="plain")
    @classmethod
    def _check_periods(cls, periods: Any) -> int:
        return check_count("periods of a step", periods, 1, _MOST_PERIODS)


@dataclass(frozen=True, slots=True, config=CONFIG)
class Speed(CheckedDirective):
    """How fast the simulated time passes relative to real time.

    Attributes:
        factor: From 0.1 to 50, or infinity for as fast as it can.

    Raises:
        InputError: If the factor is out of range.
    """

    factor: float

    @field_validator("factor", mode="plain")
    @classmethod
    def _check_factor(cls, given: Any) -> float:
        factor = math.nan if isinstance(given, bool) else as_number(given, "the speed of a run")
        if not (SLOWEST <= factor <= FASTEST or factor == math.inf):
            raise InputError(
                f"the speed of a run is a factor from {SLOWEST:g} to {FASTEST:g}, or infinity, got {given!r}"
            )
        return factor


@dataclass(frozen=True, slots=True, config=CONFIG)
class Manual(CheckedDirective):
    """Drive this command by hand, as far as the stop check lets it pass.

    It holds for `DEAD_MAN_S` of real time: repeat it while a key is down. After that the robot stands, until there is
    another command, a `Release`, or a goal.

    Attributes:
        v: Forward [m/s].
        w: To the left [rad/s].

    Raises:
        InputError: If a speed is not a finite number.
    """

    v: float = 0.0
    w: float = 0.0

    _check_v = field_validator("v", mode="plain")(
        number_of("a manual command", -_FASTEST_COMMAND, _FASTEST_COMMAND, "m/s")
    )
    _check_w = field_validator("w", mode="plain")(
        number_of("a manual command", -_FASTEST_COMMAND, _FASTEST_COMMAND, "rad/s")
    )


@dataclass(frozen=True, slots=True, config=CONFIG)
class Release(CheckedDirective):
    """Give control back to the agent after commands by hand; its goal is set again."""


@dataclass(frozen=True, slots=True, config=CONFIG)
class DropBox(CheckedDirective):
    """Put a box on the floor of the running world. It is not on the robot's map.

    Attributes:
        x, y: Its centre [m], map frame.
        yaw: Its turn [rad].
        size: Its full extent (x, y, z) [m], 0.01 to 20 each.

    Raises:
        InputError: If a number is out of range.
    """

    x: float
    y: float
    yaw: float = 0.0
    size: tuple[float, float, float] = (0.5, 0.5, 0.5)

    _check_place = field_validator("x", "y", mode="plain")(number_of("a box", -_FARTHEST_M, _FARTHEST_M, "m"))
    _check_yaw = field_validator("yaw", mode="plain")(number_of("a box", -_FARTHEST_M, _FARTHEST_M, "rad"))

    @field_validator("size", mode="plain")
    @classmethod
    def _check_size(cls, given: Any) -> tuple[float, ...]:
        size = as_sequence(given, "the size of a box")
        if len(size) != 3:
            raise InputError(f"the size of a box is three numbers (x, y, z) [m], got {given!r}")
        return tuple(check_number("a side of a box", side, _SMALLEST_M, _LARGEST_M, "m") for side in size)

    def solid(self, name: str) -> Solid:
        """Return the box as a solid of a world."""
        half = self.yaw / 2.0
        turn = (math.cos(half), 0.0, 0.0, math.sin(half))
        return Solid(name, Box(self.size), Pose3D((self.x, self.y, self.size[2] / 2.0), turn), _BOX_COLOR)


_BOX_COLOR = (0.93, 0.60, 0.18, 1.0)


@dataclass(frozen=True, slots=True, config=CONFIG)
class PlaceRobot(CheckedDirective):
    """Put the robot somewhere else, at rest, where it touches nothing that stands in the world.

    Its wheels and its odometry do not notice, nor does a localizer; an agent that gets the true pose plans again from
    there. What the run's metrics say of distances then includes the jump.

    Attributes:
        x, y: Where [m], map frame.
        yaw: Which way it faces [rad].

    Raises:
        InputError: If a number is out of range.
    """

    x: float
    y: float
    yaw: float = 0.0

    _check_place = field_validator("x", "y", mode="plain")(number_of("a place", -_FARTHEST_M, _FARTHEST_M, "m"))
    _check_yaw = field_validator("yaw", mode="plain")(number_of("a place", -_FARTHEST_M, _FARTHEST_M, "rad"))

    @property
    def pose(self) -> Pose2D:
        """The pose, map frame."""
        return Pose2D(self.x, self.y, wrap_angle(self.yaw))


@dataclass(frozen=True, slots=True, config=CONFIG)
class WaitAtGoal(CheckedDirective):
    """Keep the run going after its goals: arriving, giving up and the default time limit no longer end it.

    In a run that takes directives the simulated time stands still from then on, until there is another goal or a
    command by hand. A `Restart`, an `End`, a contact or a time limit that was given ends the run.
    """


@dataclass(frozen=True, slots=True, config=CONFIG)
class Restart(CheckedDirective):
    """End the run, and begin it again.

    Attributes:
        seed: Seed of the next run: a number, "next" for the one after the present seed, or None for the same.

    Raises:
        InputError: If it is none of these.
    """

    seed: int | Literal["next"] | None = None

    @field_validator("seed", mode="plain")
    @classmethod
    def _check_seed(cls, seed: Any) -> int | Literal["next"] | None:
        return seed if seed is None or seed == "next" else check_seed(seed)


@dataclass(frozen=True, slots=True, config=CONFIG)
class End(CheckedDirective):
    """End the run.

    Attributes:
        why: For the message of the run, up to 1000 characters.

    Raises:
        InputError: If that is no such text.
    """

    why: str = "ended by hand"

    @field_validator("why", mode="plain")
    @classmethod
    def _check_why(cls, why: Any) -> str:
        if not isinstance(why, str) or not 0 < len(why) <= _LONGEST_TEXT:
            raise InputError(f"why a run ends is a text of 1 to {_LONGEST_TEXT} characters, got {why!r:.80}")
        return why


Directive: TypeAlias = (
    Pause
    | StepOnce
    | Speed
    | SetGoal
    | SetGoals
    | FollowPath
    | RunBehavior
    | Cancel
    | ClearObstacles
    | SetPose
    | ReinitializeGlobal
    | Manual
    | Release
    | DropBox
    | PlaceRobot
    | WaitAtGoal
    | Restart
    | End
)
"""What can be asked of a run in progress."""

DIRECTIVES: dict[str, type[Directive]] = {
    "pause": Pause,
    "step": StepOnce,
    "speed": Speed,
    "goal": SetGoal,
    "goals": SetGoals,
    "path": FollowPath,
    "behavior": RunBehavior,
    "cancel": Cancel,
    "clear": ClearObstacles,
    "pose": SetPose,
    "reinitialize": ReinitializeGlobal,
    "manual": Manual,
    "release": Release,
    "box": DropBox,
    "place": PlaceRobot,
    "wait": WaitAtGoal,
    "restart": Restart,
    "end": End,
}
"""The directives by the names that they have in records and in the messages of a page."""

_NAMES: dict[type[Directive], str] = {kind: name for name, kind in DIRECTIVES.items()}
_MAX = "max"
"""Infinity as the factor of a `Speed` in JSON, which has no infinity."""


def directive_name(directive: Directive) -> str:
    """Return the name that a directive has in `DIRECTIVES`."""
    return _NAMES[type(directive)]


def read_directive(name: object, values: Mapping[str, Any]) -> Directive:
    """Make a directive of its name and its fields, as records and the messages of a page have them.

    Raises:
        UnknownNameError: If there is no such directive, or it has no such field.
        InputError: If a field is missing or has a wrong value.
    """
    if not isinstance(name, str) or name not in DIRECTIVES:
        raise UnknownNameError("directive", str(name), list(DIRECTIVES))
    kind = DIRECTIVES[name]
    known = {field.name: field for field in fields(kind)}
    for key in values:
        if key not in known:
            raise UnknownNameError(f"field of a {name!r} directive", key, list(known))
    if any(field.default is field.default_factory is MISSING and key not in values for key, field in known.items()):
        raise InputError(f"the directive {name!r} needs {', '.join(known)}")
    given = dict(values)
    if given.get("factor") == _MAX:
        given["factor"] = math.inf
    return kind(**given)


def directive_fields(directive: Directive) -> dict[str, object]:
    """Return the fields of a directive as JSON can hold them; `read_directive` makes it of them again."""
    values = {field.name: getattr(directive, field.name) for field in fields(directive)}
    return {name: _MAX if value == math.inf else value for name, value in values.items()}


@plain_dataclass(frozen=True, slots=True)
class GivenDirective:
    """A directive that was given to a run: when, and what became of it.

    Attributes:
        index: Number of control periods that had been driven.
        time: Simulated time [s].
        directive: The directive.
        by: Who gave it; "dead-man" where a manual command was not repeated.
        refused: Why it was not applied; empty where it was.
    """

    index: int
    time: float
    directive: Directive
    by: str = ""
    refused: str = ""
