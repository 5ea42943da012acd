"""`WaypointFields`: a goal with tasks in a scenario; and goals made of what a scenario holds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, TypeAlias, cast

from pydantic import Discriminator, Tag

from trundle.files.yaml_config import Angle, Config, NotNegative, PoseNumbers
from trundle.geometry import Goal
from trundle.navigation.behaviors import Behavior, Spin, Wait
from trundle.navigation.behaviors.behavior import BehaviorChoices, shorten_behavior
from trundle.navigation.goal_queue import Waypoint


class WaypointFields(Config):
    """A goal with tasks: `{pose: [5, 3], wait: 2.0}`. The robot stops there, turns, waits, and runs the other tasks.

    Attributes:
        pose: (x, y), to be reached with any yaw, or (x, y, yaw) [m, m, rad], map frame.
        turn: Angle to turn by in place [rad], counter-clockwise.
        wait: How long to stand [s].
        tasks: More behaviors, in order: `[{spin: {heading: 0}}, drive_on_heading=0.5]`, as in `recovery`.
    """

    pose: PoseNumbers
    turn: Angle | None = None
    wait: NotNegative | None = None
    tasks: BehaviorChoices = ()

    def make(self) -> Waypoint:
        """Make the waypoint.

        Raises:
            UnknownNameError: If there is no such task.
            InputError: If a task does not take an option or a value.
        """
        tasks: list[Behavior] = []
        if self.turn is not None:
            tasks.append(Spin(self.turn))
        if self.wait is not None:
            tasks.append(Wait(self.wait))
        tasks += [choice.make() for choice in self.tasks]
        x, y, *yaw = self.pose
        return Waypoint(x, y, yaw[0] if yaw else None, tasks=tasks)


def _kind(given: object) -> str:
    return "waypoint" if isinstance(given, Mapping | WaypointFields) else "pose"


GoalFields: TypeAlias = Annotated[
    Annotated[PoseNumbers, Tag("pose")] | Annotated[WaypointFields, Tag("waypoint")], Discriminator(_kind)
]
"""A goal as numbers, or with tasks."""


def make_goal(given: tuple[float, ...] | WaypointFields) -> Goal:
    """Make a goal of what a scenario holds.

    Raises:
        InputError: If a task cannot be made.
    """
    return given.make() if isinstance(given, WaypointFields) else Goal.of(given)


def exact_goals(goals: Sequence[Goal], given: Sequence[tuple[float, ...] | WaypointFields] | None) -> dict[str, object]:
    """Return the fields `goal` and `goals` of a scenario with known goals; those with tasks stay as they were given."""
    if given is not None and any(isinstance(one, WaypointFields) for one in given):
        return {"goal": None, "goals": tuple(given)}
    return {"goal": goals[0], "goals": None} if len(goals) == 1 else {"goal": None, "goals": tuple(goals)}


def position_of(given: tuple[float, ...] | WaypointFields) -> tuple[float, float]:
    """Return the goal's x and y [m]."""
    x, y = (given.pose if isinstance(given, WaypointFields) else given)[:2]
    return x, y


def shorten_goal(plain: object) -> object:
    """Return a dumped goal as a YAML has it: tasks by name, and no empty list of them."""
    if not isinstance(plain, dict):
        return plain
    values = cast("dict[str, object]", plain)
    tasks = [shorten_behavior(task) for task in cast("list[dict[str, object]]", values.get("tasks") or [])]
    return {**{name: value for name, value in values.items() if name != "tasks"}, **({"tasks": tasks} if tasks else {})}
