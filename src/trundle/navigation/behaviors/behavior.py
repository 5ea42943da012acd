"""The protocol of behaviors, what they get, and the behaviors by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, Protocol, TypeAlias, cast, runtime_checkable

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.planning import Planner
from trundle.registry import Contract, Registry
from trundle.robots import Robot

BEHAVIORS: Registry[Behavior] = Registry(
    "behavior",
    "trundle.behaviors",
    {
        "back_up": "trundle.navigation.behaviors.motions:BackUp",
        "clear_costmap": "trundle.navigation.behaviors.map_steps:ClearCostmap",
        "drive_clear": "trundle.navigation.behaviors.drive_clear:DriveClear",
        "drive_on_heading": "trundle.navigation.behaviors.motions:DriveOnHeading",
        "replan": "trundle.navigation.behaviors.map_steps:Replan",
        "replan_with": "trundle.navigation.behaviors.map_steps:ReplanWith",
        "spin": "trundle.navigation.behaviors.motions:Spin",
        "wait": "trundle.navigation.behaviors.waiting:Wait",
    },
    contract=Contract({"update": "context"}, files=False),
)

ASKED_FOR = "asked for"
"""Why a behavior ran that a program asked for."""

BehaviorResult: TypeAlias = Literal["succeeded", "failed", "interrupted", "running"]
"""How a behavior ended, or that it has not."""


@dataclass(frozen=True, slots=True)
class BehaviorContext:
    """What a behavior knows in a control period.

    Attributes:
        time: Now [s], any origin.
        pose: Where the robot is, map frame.
        twist: How it moves, base_link.
        costmap: The obstacles, with what the scans saw.
        dt: Length of the control period [s].
        robot: The robot.
        sees: Whether scans have been put into the costmap.
        clear_costmap: Forgets what the scans saw.
        replan: Plans from here to the goal, by the navigator's planner (None) or another one, and follows that path.
            Raises `BehaviorFailedError` if there is no goal or no path.
    """

    time: float
    pose: Pose2D
    twist: Twist2D
    costmap: Costmap
    dt: float
    robot: Robot
    sees: bool
    clear_costmap: Callable[[], None]
    replan: Callable[[Planner | None], None]


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
    """The name of a class as the name of a behavior: `BackUp` is back_up."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
