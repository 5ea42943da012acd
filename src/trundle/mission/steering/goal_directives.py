"""Directives about where a robot drives and what it believes: goals, paths, behaviors, its costmap and its pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias, cast, get_args

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.navigation.behaviors import Behavior, create_behavior
from trundle.navigation.waypoint import tasks_of
from trundle.path import Path
from trundle.values import as_sequence, check_flag, check_number

MOST_GOALS = 1000
"""Goals that one directive may set."""
MOST_POSES = 100_000
"""Poses of a path that is given to a run: 5 km at a pose every 5 cm."""
MOST_REGION_M = 1000.0

Region: TypeAlias = Literal["all", "around", "except"]
"""What of a costmap is cleared: all of it, a square around the robot, or all but such a square."""


def read_target(goal: Goal | Pose2D | Sequence[float]) -> Goal:
    """A goal of a directive, which has no tasks.

    Raises:
        InputError: If it is no goal, or a waypoint with tasks.
    """
    value = goal if isinstance(goal, Pose2D) else as_sequence(goal, "a goal")
    target = Goal.of(goal if isinstance(goal, Goal) else value)
    if tasks_of(target):
        raise InputError("a goal that is set while driving has no tasks: give (x, y) or (x, y, yaw)")
    return target


@dataclass(frozen=True, slots=True)
class SetGoal:
    """Drive to this goal instead of those that are left, or after them.

    Attributes:
        goal: (x, y) for any yaw, (x, y, yaw), or a pose; map frame.
        append: Whether it comes after the goals that are left, instead of replacing them.

    Raises:
        InputError: If it is no goal, or a waypoint with tasks.
    """

    goal: Goal | Pose2D | Sequence[float]
    append: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "goal", read_target(self.goal))
        object.__setattr__(self, "append", check_flag("append", self.append))

    @property
    def target(self) -> Goal:
        """The goal."""
        return Goal.of(self.goal)


@dataclass(frozen=True, slots=True)
class SetGoals:
    """Drive to these goals, in order, instead of those that are left.

    Attributes:
        goals: The goals, as of `SetGoal`; 1 to 1000.
        through: Whether the robot drives through them without stopping, but for the last.

    Raises:
        InputError: If there is none or more than that, or one is no goal or has tasks.
    """

    goals: Sequence[Goal | Pose2D | Sequence[float]]
    through: bool = True

    def __post_init__(self) -> None:
        goals = cast("Sequence[Any]", as_sequence(self.goals, "the goals"))
        if not 0 < len(goals) <= MOST_GOALS:
            raise InputError(f"give 1 to {MOST_GOALS} goals, got {len(goals)}")
        object.__setattr__(self, "goals", tuple(read_target(goal) for goal in goals))
        object.__setattr__(self, "through", check_flag("through", self.through))

    @property
    def targets(self) -> tuple[Goal, ...]:
        """The goals."""
        return tuple(Goal.of(goal) for goal in self.goals)


@dataclass(frozen=True, slots=True)
class FollowPath:
    """Follow this path to its end, instead of driving to the goals that are left; the robot plans no other one.

    Attributes:
        poses: (x, y, yaw) of each pose, map frame; 1 to 100,000. The path begins within 1.5 m of the robot.
        backward: Whether each leg between two poses is driven in reverse; none means that all are driven forward.

    Raises:
        InputError: If there is no pose or more than that, or one is not finite.
    """

    poses: Sequence[Sequence[float]]
    backward: Sequence[bool] = ()

    def __post_init__(self) -> None:
        poses = as_sequence(self.poses, "the poses of a path")
        if not 0 < len(poses) <= MOST_POSES:
            raise InputError(f"a path that is followed has 1 to {MOST_POSES} poses, got {len(poses)}")
        path = _make_path(poses, as_sequence(self.backward, "backward of a path"))
        object.__setattr__(self, "poses", tuple(map(tuple, path.poses.tolist())))
        object.__setattr__(self, "backward", tuple(path.backward.tolist()) if path.backward.any() else ())

    @property
    def path(self) -> Path:
        """The path."""
        return _make_path(self.poses, self.backward)


def _make_path(poses: Sequence[Any], backward: Sequence[Any]) -> Path:
    return Path(cast("Any", poses), planner="given", backward=np.array(backward, dtype=np.bool_))


@dataclass(frozen=True, slots=True)
class RunBehavior:
    """Run a behavior now, and drive on to the goal afterwards, if there is one: `RunBehavior("spin", {"angle": 1.57})`.

    Attributes:
        behavior: Its name; see `trundle.navigation.behaviors`.
        options: Its options, by name.

    Raises:
        UnknownNameError: If there is no such behavior.
        InputError: If it does not take an option or a value.
    """

    behavior: str
    options: Mapping[str, Any] = field(default_factory=dict[str, Any])

    def __post_init__(self) -> None:
        if not isinstance(self.behavior, str):
            raise InputError(f"a behavior that is asked for is given by its name, got {self.behavior!r}")
        if not isinstance(cast("object", self.options), Mapping):
            raise InputError(f"the options of a behavior are a mapping, got {self.options!r}")
        object.__setattr__(self, "options", dict(self.options))
        self.make()

    def make(self) -> Behavior:
        """Make the behavior."""
        return create_behavior(self.behavior, **dict(self.options))


@dataclass(frozen=True, slots=True)
class Cancel:
    """Stop what the robot does: it stands, and waits for the next goal.

    Attributes:
        what: "all" gives up the goals that are left and what runs; "behavior" ends only the behavior that was asked
            for, after which the robot drives on to its goal.

    Raises:
        InputError: If it is neither.
    """

    what: Literal["all", "behavior"] = "all"

    def __post_init__(self) -> None:
        if self.what not in ("all", "behavior"):
            raise InputError(f"what is cancelled is 'all' or 'behavior', got {self.what!r}")


@dataclass(frozen=True, slots=True)
class ClearObstacles:
    """Forget what the scans put into the costmap; the map stays.

    Attributes:
        region: "all", "around" for a square around the robot, or "except" for all but that square.
        size: Edge of the square [m], which is aligned with the odom frame.

    Raises:
        InputError: If it is none of these, or the size is not positive where it is needed.
    """

    region: Region = "all"
    size: float = 0.0

    def __post_init__(self) -> None:
        if self.region not in get_args(Region):
            raise InputError(f"the region to clear is 'all', 'around' or 'except', got {self.region!r}")
        size = check_number("size of the region to clear", self.size, 0.0, MOST_REGION_M, "m")
        if self.region != "all" and size == 0.0:
            raise InputError(f"clearing {self.region!r} needs the size of the square around the robot [m]")
        object.__setattr__(self, "size", size)


@dataclass(frozen=True, slots=True)
class SetPose:
    """Tell the localizer where the robot is. Without a localizer it is refused: the robot knows its true pose.

    Attributes:
        pose: (x, y, yaw), or a pose; map frame.

    Raises:
        InputError: If it is no pose.
    """

    pose: Pose2D | Sequence[float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", Pose2D.of(self.pose).as_tuple())

    @property
    def target(self) -> Pose2D:
        """The pose."""
        return Pose2D.of(self.pose)
