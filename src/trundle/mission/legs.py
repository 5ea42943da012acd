"""The goals of a run, and the plans to each of them from the one before."""

from __future__ import annotations

import contextlib
import numbers
from collections.abc import Sequence
from typing import cast

import numpy as np

from trundle.errors import BlockedPoseError, OutsideMapError, PlanningError, ScenarioError
from trundle.geometry import Goal, Pose2D
from trundle.navigation import Navigator
from trundle.path import Path


def read_goals(goal: Pose2D | Sequence[float] | Sequence[Pose2D | Sequence[float]] | None) -> tuple[Goal, ...]:
    """Take one goal, or a list of them.

    Raises:
        InputError: If these are no poses, or there is none.
    """
    if isinstance(goal, Pose2D):
        return (Goal.of(goal),)
    if not isinstance(goal, Sequence | np.ndarray) or isinstance(goal, str):
        raise ScenarioError(f"a goal is a pose, (x, y) or (x, y, yaw), or a list of these; got {goal!r}")
    if len(goal) == 0:
        raise ScenarioError("a run needs at least one goal")
    if all(isinstance(part, numbers.Real) for part in goal):
        return (Goal.of(cast("Sequence[float]", goal)),)
    return tuple(Goal.of(cast("Pose2D | Sequence[float]", part)) for part in goal)


def plan_legs(
    navigator: Navigator, start: Pose2D, goals: Sequence[Goal], *, through: bool | None = None
) -> tuple[list[Path], PlanningError | None]:
    """Plan to every goal from the one before, so that a blocked goal is reported before anything moves.

    Args:
        navigator: What plans.
        start: From where.
        goals: To where, in order.
        through: Whether the navigator gets all goals at once, and drives through them (True) or stops at each (False);
            None means that it gets the first one.

    Returns:
        The plans, as far as there are any, and why there is no path to the first goal, if so; not where planning only
        took too long, as the navigator tries again. The first goal, or all, and the plan stay in the navigator.
    """
    plans: list[Path] = []
    unreachable: PlanningError | None = None
    here = start
    for index, goal in enumerate(goals):
        navigator.set_goal(goal)
        try:
            path = navigator.plan(here)
        except PlanningError as error:
            if _is_bad_input(error, goal, first=index == 0):
                raise
            if index == 0 and not navigator.waits_to_plan:
                unreachable = error
            here = goal.pose
        else:
            plans.append(path)
            here = path.goal
    if len(goals) > 1 or through is not None:
        navigator.set_goals(goals[:1] if through is None else goals, through=bool(through))
        if unreachable is None:
            with contextlib.suppress(PlanningError):  # the navigator tries again
                navigator.plan(start)
    return plans, unreachable


def _is_bad_input(error: PlanningError, goal: Goal, *, first: bool) -> bool:
    """Whether the start or a goal is at fault. How the robot will stand at an earlier goal is not known yet."""
    if not isinstance(error, BlockedPoseError | OutsideMapError):
        return False
    return first or error.pose is None or error.pose[:2] == goal[:2]
