"""Checks of what every planner takes: a costmap, a start and a goal."""

from __future__ import annotations

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.values import check_kind


def check_question(costmap: object, start: object, goal: object) -> tuple[Pose2D, Pose2D]:
    """The start and the goal of a plan as poses: `Pose2D`, (x, y) or (x, y, yaw) [m, m, rad], map frame.

    Raises:
        InputError: If they are not poses, or `costmap` is not a `Costmap`.
    """
    check_kind(costmap, Costmap, "a planner's costmap", "Costmap.from_grid(grid, robot) makes one")
    return _as_pose(start, "start"), _as_pose(goal, "goal")


def _as_pose(pose: object, what: str) -> Pose2D:
    if isinstance(pose, Pose2D):
        return pose
    try:
        return Pose2D.of(pose)  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise InputError(f"the {what} must be a pose: Pose2D, (x, y) or (x, y, yaw); got {pose!r}: {error}") from error
