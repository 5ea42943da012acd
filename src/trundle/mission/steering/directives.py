"""Directives: what can be asked of a run in progress, such as a pause, another goal or a command by hand."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from trundle.errors import InputError
from trundle.geometry import Pose2D, Pose3D, wrap_angle
from trundle.geometry.solids import Box, Solid
from trundle.mission.steering.goal_directives import (
    Cancel,
    ClearObstacles,
    FollowPath,
    RunBehavior,
    SetGoal,
    SetGoals,
    SetPose,
)
from trundle.values import as_number, as_sequence, check_count, check_flag, check_number, check_seed

SLOWEST, FASTEST = 0.1, 50.0
"""Speeds of a run relative to real time; infinity, as fast as it can, is allowed too."""

_FASTEST_COMMAND = 1e6  # [m/s] or [rad/s]; the robot's limits come far below
_SMALLEST_M, _LARGEST_M = 0.01, 20.0
_FARTHEST_M = 1e6
_LONGEST_TEXT = 1000
_MOST_PERIODS = 1_000_000


@dataclass(frozen=True, slots=True)
class Pause:
    """Pause the run, or let it go on: the simulated time stands meanwhile, and then the goal is set again.

    Raises:
        InputError: If `paused` is not a bool.
    """

    paused: bool = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "paused", check_flag("paused", self.paused))


@dataclass(frozen=True, slots=True)
class StepOnce:
    """Drive exactly one control period, or so many, and be paused after it.

    Attributes:
        periods: How many, up to a million.

    Raises:
        InputError: If it is no such number.
    """

    periods: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "periods", check_count("periods of a step", self.periods, 1, _MOST_PERIODS))


@dataclass(frozen=True, slots=True)
class Speed:
    """How fast the simulated time passes relative to real time.

    Attributes:
        factor: From 0.1 to 50, or infinity for as fast as it can.

    Raises:
        InputError: If the factor is out of range.
    """

    factor: float

    def __post_init__(self) -> None:
        factor = as_number(self.factor, "the speed of a run")
        if not (SLOWEST <= factor <= FASTEST or factor == math.inf):
            raise InputError(
                f"the speed of a run is a factor from {SLOWEST:g} to {FASTEST:g}, or infinity, got {self.factor!r}"
            )
        object.__setattr__(self, "factor", factor)


@dataclass(frozen=True, slots=True)
class Manual:
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

    def __post_init__(self) -> None:
        for name, unit in (("v", "m/s"), ("w", "rad/s")):
            speed = check_number(
                f"{name} of a manual command", getattr(self, name), -_FASTEST_COMMAND, _FASTEST_COMMAND, unit
            )
            object.__setattr__(self, name, speed)


@dataclass(frozen=True, slots=True)
class Release:
    """Give control back to the agent after commands by hand; its goal is set again."""


@dataclass(frozen=True, slots=True)
class DropBox:
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

    def __post_init__(self) -> None:
        for name in ("x", "y"):
            place = check_number(f"{name} of a box", getattr(self, name), -_FARTHEST_M, _FARTHEST_M, "m")
            object.__setattr__(self, name, place)
        object.__setattr__(self, "yaw", check_number("yaw of a box", self.yaw, -_FARTHEST_M, _FARTHEST_M, "rad"))
        size = as_sequence(self.size, "the size of a box")
        if len(size) != 3:
            raise InputError(f"the size of a box is three numbers (x, y, z) [m], got {self.size!r}")
        sides = [check_number("a side of a box", side, _SMALLEST_M, _LARGEST_M, "m") for side in size]
        object.__setattr__(self, "size", tuple(sides))

    def solid(self, name: str) -> Solid:
        """The box as a solid of a world."""
        half = self.yaw / 2.0
        turn = (math.cos(half), 0.0, 0.0, math.sin(half))
        return Solid(name, Box(self.size), Pose3D((self.x, self.y, self.size[2] / 2.0), turn), _BOX_COLOR)


_BOX_COLOR = (0.93, 0.60, 0.18, 1.0)


@dataclass(frozen=True, slots=True)
class PlaceRobot:
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

    def __post_init__(self) -> None:
        for name, unit in (("x", "m"), ("y", "m"), ("yaw", "rad")):
            number = check_number(f"{name} of a place", getattr(self, name), -_FARTHEST_M, _FARTHEST_M, unit)
            object.__setattr__(self, name, number)

    @property
    def pose(self) -> Pose2D:
        """The pose, map frame."""
        return Pose2D(self.x, self.y, wrap_angle(self.yaw))


@dataclass(frozen=True, slots=True)
class Restart:
    """End the run, and begin it again.

    Attributes:
        seed: Of the next run: a seed, "next" for the one after the present seed, or None for the same.

    Raises:
        InputError: If it is none of these.
    """

    seed: int | Literal["next"] | None = None

    def __post_init__(self) -> None:
        if self.seed is not None and self.seed != "next":
            object.__setattr__(self, "seed", check_seed(self.seed))


@dataclass(frozen=True, slots=True)
class End:
    """End the run.

    Attributes:
        why: For the message of the run, up to 1000 characters.

    Raises:
        InputError: If that is no such text.
    """

    why: str = "ended by hand"

    def __post_init__(self) -> None:
        if not isinstance(self.why, str) or not 0 < len(self.why) <= _LONGEST_TEXT:
            raise InputError(f"why a run ends is a text of 1 to {_LONGEST_TEXT} characters, got {self.why!r:.80}")


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
    | Manual
    | Release
    | DropBox
    | PlaceRobot
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
    "manual": Manual,
    "release": Release,
    "box": DropBox,
    "place": PlaceRobot,
    "restart": Restart,
    "end": End,
}
"""The directives by the names that they have in records."""


@dataclass(frozen=True, slots=True)
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
