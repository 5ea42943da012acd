"""Checks of what every planner takes: a costmap, a start and a goal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.values import check_kind

_Read = TypeVar("_Read")


def check_question(costmap: object, start: object, goal: object) -> tuple[Pose2D, Goal]:
    """The start and the goal of a plan; see `read_ends`.

    Raises:
        InputError: If they are none, or `costmap` is not a `Costmap`.
    """
    check_kind(costmap, Costmap, "a planner's costmap", "Costmap.from_grid(grid, robot) makes one")
    return read_ends(start, goal)


def read_ends(start: object, goal: object) -> tuple[Pose2D, Goal]:
    """The start and the goal of a plan, each as it is, or of (x, y) or (x, y, yaw) [m, m, rad], map frame.

    A goal (x, y) is one with any yaw. A goal may also be a pose, whose yaw is wanted then.

    Raises:
        InputError: If they are none of these.
    """
    return (
        _read(Pose2D.of, start, "the start must be a pose: Pose2D, (x, y) or (x, y, yaw)"),
        _read(Goal.of, goal, "the goal must be a pose: Goal, Pose2D, (x, y) for any yaw, or (x, y, yaw)"),
    )


def _read(of: Callable[[Any], _Read], value: object, requirement: str) -> _Read:
    try:
        return of(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"{requirement}; got {value!r}: {error}") from error
