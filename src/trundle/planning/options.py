"""What options are checked by, so that every planner and search refuses the same in the same words."""

from __future__ import annotations

import math
import numbers

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D


def check_number(name: str, value: object, least: float, most: float, unit: str = "") -> float:
    """A number from `least` to `most` as a float.

    Raises:
        InputError: If it is none, or NaN.
    """
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        number = float(value)
        if least <= number <= most:
            return number
    bounds = f"of {least:g} or more" if math.isinf(most) else f"from {least:g} to {most:g}"
    raise InputError(f"{name} must be a number {bounds}{unit and f' {unit}'}, got {value!r}")


def check_count(name: str, value: object, least: int, most: int) -> int:
    """A whole number from `least` to `most`.

    Raises:
        InputError: If it is none.
    """
    if isinstance(value, int | np.integer) and not isinstance(value, bool) and least <= value <= most:
        return int(value)
    raise InputError(f"{name} must be a whole number from {least} to {most}, got {value!r}")


def check_flag(name: str, value: object) -> bool:
    """A bool.

    Raises:
        InputError: If it is none.
    """
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} is true or false, got {value!r}")
    return bool(value)


def check_question(costmap: object, start: object, goal: object) -> tuple[Pose2D, Pose2D]:
    """The start and the goal of a plan as poses: `Pose2D`, (x, y) or (x, y, yaw) [m, m, rad], map frame.

    Raises:
        InputError: If they are none, or `costmap` is no `Costmap`.
    """
    if not isinstance(costmap, Costmap):
        raise InputError(
            f"a planner needs a Costmap, got {type(costmap).__name__}; Costmap.from_grid(grid, robot) makes one"
        )
    return _as_pose(start, "start"), _as_pose(goal, "goal")


def _as_pose(pose: object, what: str) -> Pose2D:
    if isinstance(pose, Pose2D):
        return pose
    try:
        return Pose2D.of(pose)  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise InputError(f"the {what} must be a pose: Pose2D, (x, y) or (x, y, yaw); got {pose!r}: {error}") from error
