"""What a navigator is given from outside, checked where it comes in: settings, the map, a goal, how the robot moves."""

from __future__ import annotations

import numbers
import os
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, cast

from trundle.costmap import Costmap, UnknownPolicy
from trundle.errors import InputError, RobotWarning
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.robots import Robot
from trundle.values import as_sequence, check_kind, is_finite_number

LEAST_FREQUENCY, MOST_FREQUENCY = 0.1, 1000.0
"""Of control [Hz]."""

_CREDIBLE = 4.0  # times its limits: so fast may a robot be that is pushed, or runs down a ramp


def check_settings(control_frequency: object, replan_interval_s: object, replan_margin: object) -> None:
    """Raise `InputError` unless these are settings that can be used."""
    if not (is_finite_number(control_frequency) and LEAST_FREQUENCY <= control_frequency <= MOST_FREQUENCY):
        raise InputError(
            f"control_frequency must be a number of hertz from {LEAST_FREQUENCY:g} to {MOST_FREQUENCY:g}, got "
            f"{control_frequency!r}"
        )
    if replan_interval_s is not None and not (is_finite_number(replan_interval_s) and replan_interval_s > 0.0):
        raise InputError(f"replan_interval_s must be a positive number of seconds, got {replan_interval_s!r}")
    if not (is_finite_number(replan_margin) and 0.0 <= replan_margin < 1.0):
        raise InputError(f"replan_margin must be a share from 0 to below 1, got {replan_margin!r}")


def load_costmap(
    grid: OccupancyGrid | Costmap | str | os.PathLike[str],
    robot: Robot,
    *,
    keepout: KeepoutMask | str | os.PathLike[str] | None,
    inflation_radius: float | None,
    cost_scaling_factor: float | None,
    unknown: UnknownPolicy | None,
    unknown_cost: int | None,
) -> tuple[OccupancyGrid | None, Costmap]:
    """Make the map (none where a costmap is given) and the costmap; none of an option means the costmap's default.

    Raises:
        MapError: If a map or a mask cannot be read.
        InputError: If an option is out of range, or is settled in the costmap that is given.
    """
    if isinstance(grid, Costmap):
        if keepout is not None:
            raise InputError("a keep-out mask belongs into the costmap: Costmap.from_grid(…, keepout=mask)")
        if unknown is not None or unknown_cost is not None:
            raise InputError("what unknown cells are is settled in the costmap: Costmap.from_grid(…, unknown=…)")
        return None, grid
    if unknown_cost is not None and unknown != "costly":
        raise InputError('unknown_cost is what unknown cells cost where unknown="costly": give both, or none')
    advice = "OccupancyGrid.from_world(world) makes one of a world"
    check_kind(grid, (OccupancyGrid, Costmap, str, os.PathLike), "a navigator's map", advice)
    cells = grid if isinstance(grid, OccupancyGrid) else OccupancyGrid.load(grid)
    zones = keepout if keepout is None or isinstance(keepout, KeepoutMask) else KeepoutMask.load(keepout)
    wanted = {
        "inflation_radius": inflation_radius,
        "cost_scaling_factor": cost_scaling_factor,
        "unknown": unknown,
        "unknown_cost": unknown_cost,
    }
    given: dict[str, Any] = {name: value for name, value in wanted.items() if value is not None}
    return cells, Costmap.from_grid(cells, robot.outline, **given, keepout=zones)


def read_options(options: object, what: str) -> dict[str, Any]:
    """Take options by name; none are none.

    Raises:
        InputError: If they are no mapping of names.
    """
    if options is None:
        return {}
    if isinstance(options, Mapping):
        given = dict(cast("Mapping[Any, Any]", options))
        if all(isinstance(name, str) for name in given):
            return given
    raise InputError(f"{what} are options by name, {{'name': value}}; got {options!r}")


def read_pose(pose: Pose2D | Sequence[float]) -> Pose2D:
    """Take where a robot is. A yaw of its odometry may have added up to more than a whole turn.

    Raises:
        InputError: If it is no pose.
    """
    if isinstance(pose, Pose2D):
        return pose
    numbers = as_sequence(pose)
    if len(numbers) == 3 and is_finite_number(numbers[2]):
        numbers = (numbers[0], numbers[1], wrap_angle(numbers[2]))
    return Pose2D.of(numbers)


def read_goal(
    goal: Pose2D | Sequence[float] | float, y: float | None = None, yaw: float | None = None
) -> tuple[Pose2D, bool]:
    """Take a goal as `Navigator.set_goal` does: the pose, and whether any yaw will do.

    Raises:
        InputError: If these are not two or three finite numbers.
    """
    if isinstance(goal, numbers.Real):
        if y is None:
            raise InputError("set_goal needs x and y, and may take a yaw")
        x = cast("float", goal)
        given: Sequence[float] = (x, y) if yaw is None else (x, y, yaw)
    elif y is not None or yaw is not None:
        raise InputError(f"set_goal takes x, y and a yaw as numbers, or one pose, got {(goal, y, yaw)!r}")
    else:
        given = goal.as_tuple() if isinstance(goal, Pose2D) else as_sequence(goal)
    return Pose2D.of(given), len(given) == 2


def credible_twist(twist: object, robot: Robot) -> Twist2D:
    """How the robot moves, cut to what it can at all, with a `RobotWarning` that names the caller's caller.

    Raises:
        InputError: If it is no twist.
    """
    if not isinstance(twist, Twist2D):
        raise InputError(f"how the robot moves is a Twist2D, got {twist!r}")
    limits = robot.limits
    v_most = _CREDIBLE * max(limits.linear_speed, limits.reverse_speed or 0.0)
    w_most = _CREDIBLE * limits.angular_speed
    if abs(twist.v) <= v_most and abs(twist.w) <= w_most:
        return twist
    warnings.warn(
        f"{robot.name} cannot move by {twist.v:g} m/s and {twist.w:g} rad/s; these are cut to {v_most:g} m/s "
        f"and {w_most:g} rad/s: check the units of the twist and where it comes from",
        RobotWarning,
        stacklevel=3,
    )
    return Twist2D(min(v_most, max(-v_most, twist.v)), min(w_most, max(-w_most, twist.w)))
