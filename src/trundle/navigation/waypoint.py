"""`Waypoint`, a goal with tasks, and `Route`, the goals of a drive in order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Self, cast

from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.navigation.behaviors import Behavior
from trundle.navigation.behaviors.behavior import check_behavior_kind


class Waypoint(Goal):
    """A goal where the robot stops, and runs tasks before it drives on: `Waypoint(5, 3, tasks=[Wait(2), Spin(1.57)])`.

    A waypoint is a `Goal`: equal to the tuple (x, y, yaw), or (x, y) for any yaw.

    Attributes:
        tasks: Behaviors, run in this order when the goal is reached.
    """

    tasks: tuple[Behavior, ...]

    def __new__(cls, x: float, y: float, yaw: float | None = None, *, tasks: Iterable[Behavior] = ()) -> Self:
        """Check the numbers and the tasks.

        Args:
            x: [m], map frame.
            y: [m], map frame.
            yaw: [rad]; None for any.
            tasks: Behaviors, run in this order when the goal is reached.

        Raises:
            InputError: If a number is NaN or infinite, or a task is no behavior.
        """
        made = super().__new__(cls, x, y, yaw)
        made.tasks = tuple(tasks)
        for task in made.tasks:
            check_behavior_kind(task)
        return made

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, tasks={list(self.tasks)})".replace("Goal(", "Waypoint(", 1)


def tasks_of(goal: Goal) -> tuple[Behavior, ...]:
    """Return the tasks of a waypoint; another goal has none."""
    return goal.tasks if isinstance(goal, Waypoint) else ()


class Route:
    """Goals in order, and how far the robot has come.

    Args:
        goals: The goals.
        through: Whether the robot drives through them without stopping, but for waypoints with tasks and the last.

    Attributes:
        goals: The same.
        index: Of the goal that it drives to.

    Raises:
        InputError: If there is no goal, or one is no pose.
    """

    def __init__(self, goals: Sequence[Pose2D | Sequence[float]], *, through: bool = False) -> None:
        if isinstance(goals, str | Pose2D) or not isinstance(cast("object", goals), Iterable):
            raise InputError(f"goals are a list of poses, [(5.0, 3.5), (8.0, 1.0, 1.57)]; got {goals!r}")
        self.goals = tuple(Goal.of(goal) for goal in goals)
        if not self.goals:
            raise InputError("give at least one goal")
        self._through = through
        self.index = 0

    def is_stop(self, index: int) -> bool:
        """Whether the robot stops at this goal."""
        return not self._through or index == len(self.goals) - 1 or bool(tasks_of(self.goals[index]))

    @property
    def ahead(self) -> tuple[Goal, ...]:
        """The goals from the one that it drives to up to the next stop."""
        end = next(index for index in range(self.index, len(self.goals)) if self.is_stop(index))
        return self.goals[self.index : end + 1]

    def advance(self) -> bool:
        """Drive to the next goal from now on; False if this was the last one."""
        if self.index == len(self.goals) - 1:
            return False
        self.index += 1
        return True

    def describe(self, index: int) -> str:
        """A goal in words, such as "goal 2 of 4 (5.00, 3.50)"."""
        goal = self.goals[index]
        return f"goal {index + 1} of {len(self.goals)} ({goal.x:.2f}, {goal.y:.2f})"
