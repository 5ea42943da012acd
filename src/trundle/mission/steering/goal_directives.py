"""Directives about where a robot drives and what it believes: goals, paths, behaviors, its costmap and its pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Any, Literal, Self, TypeAlias, cast, get_args

import numpy as np
from pydantic import ValidationInfo, field_validator, model_validator
from pydantic.dataclasses import dataclass

from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.localization.localizer import check_covariance
from trundle.mission.steering.checks import CONFIG, CheckedDirective, flag, number_of
from trundle.navigation.behaviors import Behavior, create_behavior
from trundle.navigation.goal_queue import tasks_of
from trundle.path import Path
from trundle.values import as_sequence

MOST_GOALS = 1000
"""Goals that one directive may set."""
MOST_POSES = 100_000
"""Poses of a path that is given to a run: 5 km at a pose every 5 cm."""
MOST_REGION_M = 1000.0

Region: TypeAlias = Literal["all", "around", "except"]
"""What of a costmap is cleared: all of it, a square around the robot, or all but such a square."""


def read_target(goal: Goal | Pose2D | Sequence[float]) -> Goal:
    """Return a goal of a directive, which has no tasks.

    Raises:
        InputError: If it is no goal, or a waypoint with tasks.
    """
    value = goal if isinstance(goal, Pose2D) else as_sequence(goal, "a goal")
    target = Goal.of(goal if isinstance(goal, Goal) else value)
    if tasks_of(target):
        raise InputError("a goal that is set while driving has no tasks: give (x, y) or (x, y, yaw)")
    return target


@dataclass(frozen=True, slots=True, config=CONFIG)
class SetGoal(CheckedDirective):
    """Drive to this goal instead of those that are left, or after them.

    Attributes:
        goal: (x, y) for any yaw, (x, y, yaw), or a pose; map frame.
        append: Whether it comes after the goals that are left, instead of replacing them.

    Raises:
        InputError: If it is no goal, or a waypoint with tasks.
    """

    goal: Goal | Pose2D | Sequence[float]
    append: bool = False

    @field_validator("goal", mode="plain")
    @classmethod
    def _check_goal(cls, goal: Any) -> Goal:
        return read_target(goal)

    _check_append = field_validator("append", mode="plain")(flag)

    @property
    def target(self) -> Goal:
        """The goal."""
        return Goal.of(self.goal)


@dataclass(frozen=True, slots=True, config=CONFIG)
class SetGoals(CheckedDirective):
    """Drive to these goals, in order, instead of those that are left.

    Attributes:
        goals: The goals, as of `SetGoal`; 1 to 1000.
        through: Whether the robot drives through them without stopping, but for the last.

    Raises:
        InputError: If there is none or more than that, or one is no goal or has tasks.
    """

    goals: Sequence[Goal | Pose2D | Sequence[float]]
    through: bool = True

    @field_validator("goals", mode="plain")
    @classmethod
    def _check_goals(cls, given: Any) -> tuple[Goal, ...]:
        goals = cast("Sequence[Any]", as_sequence(given, "the goals"))
        if not 0 < len(goals) <= MOST_GOALS:
            raise InputError(f"give 1 to {MOST_GOALS} goals, got {len(goals)}")
        return tuple(read_target(goal) for goal in goals)

    _check_through = field_validator("through", mode="plain")(flag)

    @property
    def targets(self) -> tuple[Goal, ...]:
        """The goals."""
        return tuple(Goal.of(goal) for goal in self.goals)


@dataclass(frozen=True, slots=True, config=CONFIG)
class FollowPath(CheckedDirective):
    """Follow this path to its end, instead of driving to the goals that are left; the robot plans no other one.

    Attributes:
        poses: (x, y, yaw) of each pose, map frame; 1 to 100,000. The path begins within 1.5 m of the robot.
        backward: Whether each leg between two poses is driven in reverse. If empty, all are driven forward.

    Raises:
        InputError: If there is no pose or more than that, or one is not finite.
    """

    poses: Sequence[Sequence[float]]
    backward: Sequence[bool] = ()

    @field_validator("poses", mode="plain")
    @classmethod
    def _check_poses(cls, given: Any) -> tuple[tuple[float, ...], ...]:
        poses = as_sequence(given, "the poses of a path")
        if not 0 < len(poses) <= MOST_POSES:
            raise InputError(f"a path that is followed has 1 to {MOST_POSES} poses, got {len(poses)}")
        return tuple(map(tuple, _make_path(poses, ()).poses.tolist()))

    @field_validator("backward", mode="plain")
    @classmethod
    def _check_backward(cls, given: Any, info: ValidationInfo) -> tuple[bool, ...]:
        backward = as_sequence(given, "backward of a path")
        if "poses" not in info.data:  # they were refused, which is the first problem
            return ()
        path = _make_path(info.data["poses"], backward)
        return tuple(path.backward.tolist()) if path.backward.any() else ()

    @property
    def path(self) -> Path:
        """The path."""
        return _make_path(self.poses, self.backward)


def _make_path(poses: Sequence[Any], backward: Sequence[Any]) -> Path:
    return Path(cast("Any", poses), planner="given", backward=np.array(backward, dtype=np.bool_))


@dataclass(frozen=True, slots=True, config=CONFIG)
class RunBehavior(CheckedDirective):
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

    @field_validator("behavior", mode="plain")
    @classmethod
    def _check_behavior(cls, behavior: Any) -> str:
        if not isinstance(behavior, str):
            raise InputError(f"a behavior that is asked for is given by its name, got {behavior!r}")
        return behavior

    @field_validator("options", mode="plain")
    @classmethod
    def _check_options(cls, options: Any) -> dict[str, Any]:
        if not isinstance(options, Mapping):
            raise InputError(f"the options of a behavior are a mapping, got {options!r}")
        return dict(cast("Mapping[str, Any]", options))

    @model_validator(mode="after")
    def _check_made(self) -> Self:
        self.make()
        return self

    def make(self) -> Behavior:
        """Make the behavior."""
        return create_behavior(self.behavior, **dict(self.options))


@dataclass(frozen=True, slots=True, config=CONFIG)
class Cancel(CheckedDirective):
    """Stop what the robot does: it stands, and waits for the next goal.

    Attributes:
        what: "all" gives up the goals that are left and what runs; "behavior" ends only the behavior that was asked
            for, after which the robot drives on to its goal.

    Raises:
        InputError: If it is neither.
    """

    what: Literal["all", "behavior"] = "all"

    @field_validator("what", mode="plain")
    @classmethod
    def _check_what(cls, what: Any) -> str:
        if what not in ("all", "behavior"):
            raise InputError(f"what is cancelled is 'all' or 'behavior', got {what!r}")
        return what


@dataclass(frozen=True, slots=True, config=CONFIG)
class ClearObstacles(CheckedDirective):
    """Forget what the scans put into the costmap; the map stays.

    Attributes:
        region: "all", "around" for a square around the robot, or "except" for all but that square.
        size: Edge of the square [m], which is aligned with the odom frame.
        at: The middle of the square: (x, y, yaw), or a pose; map frame. If None, it is the robot.

    Raises:
        InputError: If it is none of these, or the size is not positive where it is needed.
    """

    region: Region = "all"
    size: float = 0.0
    at: Pose2D | Sequence[float] | None = None

    @field_validator("region", mode="plain")
    @classmethod
    def _check_region(cls, region: Any) -> str:
        if region not in get_args(Region):
            raise InputError(f"the region to clear is 'all', 'around' or 'except', got {region!r}")
        return region

    _check_size = field_validator("size", mode="plain")(number_of("the region to clear", 0.0, MOST_REGION_M, "m"))

    @field_validator("at", mode="plain")
    @classmethod
    def _check_at(cls, at: Any) -> tuple[float, float, float] | None:
        return None if at is None else Pose2D.of(at).as_tuple()

    @model_validator(mode="after")
    def _check_has_size(self) -> Self:
        if self.region != "all" and self.size == 0.0:
            raise InputError(f"clearing {self.region!r} needs the size of the square around the robot [m]")
        return self


@dataclass(frozen=True, slots=True, config=CONFIG)
class SetPose(CheckedDirective):
    """Tell the localizer where the robot is. Without a localizer it is refused: the robot knows its true pose.

    Attributes:
        pose: (x, y, yaw), or a pose; map frame.
        covariance: Covariance of (x, y, yaw) [m², rad²], three rows of three numbers; None where the pose is exact.

    Raises:
        InputError: If it is no pose, or the covariance is not symmetric or has a negative variance.
    """

    pose: Pose2D | Sequence[float]
    covariance: Sequence[Sequence[float]] | None = None

    @field_validator("pose", mode="plain")
    @classmethod
    def _check_pose(cls, pose: Any) -> tuple[float, float, float]:
        return Pose2D.of(pose).as_tuple()

    @field_validator("covariance", mode="plain")
    @classmethod
    def _check_covariance(cls, covariance: Any) -> tuple[tuple[float, ...], ...] | None:
        if covariance is None:
            return None
        rows = check_covariance(covariance, "the pose").tolist()
        return tuple(tuple(row) for row in rows)

    @property
    def target(self) -> Pose2D:
        """The pose."""
        return Pose2D.of(self.pose)


@dataclass(frozen=True, slots=True, config=CONFIG)
class ReinitializeGlobal(CheckedDirective):
    """Tell the localizer that the robot may be anywhere on the map, as Nav2's service of a like name does.

    It is refused without a localizer, and where that cannot find a pose by itself.
    """
