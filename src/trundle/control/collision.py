"""Whether a command leaves the robot room to stop before it touches something."""

from __future__ import annotations

import math

from trundle import _core
from trundle.costmap import NO_INFORMATION, Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D, shrink_outline
from trundle.robots import Limits

FOOTPRINT_PADDING_M = 0.01
"""Clearance [m] that the footprint keeps while driving, where there is room."""

_FAR_M = 1e12
_NEAREST_M = 0.1  # larger clearances count the same
_AS_CLEAR_M = 1e-6
_DEPTHS_M = (0.04, 0.08, 0.12, 0.16)

_TURN_STEP_RAD = math.radians(2.0)
"""Largest turn between two tested poses."""


def stopping_poses(
    pose: Pose2D, twist: Twist2D, command: Twist2D, limits: Limits, dt: float, *, turn_step: float = math.inf
) -> FloatArray:
    """Poses of driving `command` for `dt` [s], starting with `twist`, and then braking to a stop.

    Speeds change evenly, as fast as the limits allow, in steps of 0.05 s; each step is an arc at their mean. A step
    that turns by more than `turn_step` [rad] is given in parts of at most that.

    A robot that takes longer than 50 s gets longer steps, and one that turns more than once in a step larger parts, so
    that there are 2,000 steps of 180 parts at most. What moves faster than 1e6 m/s or rad/s counts as that.

    Returns:
        (x, y, yaw), the first where the robot is, shape (N, 3).
    """
    back = limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed
    return _core.stopping_poses(
        *(pose.x, pose.y, pose.yaw, twist.v, twist.w, command.v, command.w, limits.linear_speed, back),
        *(limits.angular_speed, limits.linear_acceleration, limits.angular_acceleration, dt, turn_step),
    )


def can_stop(
    costmap: Costmap,
    limits: Limits,
    pose: Pose2D,
    twist: Twist2D,
    command: Twist2D,
    dt: float,
    *,
    padded: FloatArray,
) -> bool:
    """Whether a robot can drive `command` for `dt` [s] and then brake with its padded outline free throughout.

    Poses at most 0.05 s and 2° apart are tested by `may_pass`.

    Args:
        costmap: Where it drives.
        limits: Of the robot.
        pose: Where it is, map frame.
        twist: How it moves, base_link.
        command: The command to test.
        dt: For how long [s].
        padded: The footprint's outline [m], base_link, widened by the clearance to keep, shape (N, 2).
    """
    poses = stopping_poses(pose, twist, command, limits, dt, turn_step=_TURN_STEP_RAD)
    return may_pass(costmap, poses, padded=padded)


def may_pass(costmap: Costmap, poses: FloatArray, *, padded: FloatArray) -> bool:
    """Whether a robot may drive from pose to pose, with its padded outline free throughout.

    All that the outline sweeps between the poses is tested. Where the padded outline touches something at the first
    pose already, the robot may drive if the footprint itself touches nothing and never comes nearer to anything than it
    is: otherwise it could not leave that place. Where the footprint itself touches something, as something has pushed
    the robot against it, this holds for a smaller one that does not.

    Args:
        costmap: Where it drives.
        poses: (x, y, yaw) [m, m, rad], map frame, close together; the first is where the robot is. Shape (N, 3).
        padded: The footprint's outline [m], base_link, widened by the clearance to keep, shape (N, 2).
    """
    # `Costmap.footprint_sweeps` without its checks of the arguments: this is part of every control period.
    origin, ends = costmap.origin, (poses[:-1], poses[1:])
    shares = _core.footprint_sweep(costmap.data, costmap.resolution, origin.x, origin.y, origin.yaw, padded, *ends)
    blocked = shares < math.inf
    if not blocked.any():
        return True
    if not costmap.footprint_collides(poses[0], outline=padded)[0]:
        return False
    clearances = costmap.clearance(poses, cap=_NEAREST_M)
    if not blocked[1:].any() and not costmap.footprint_collides(poses[1], outline=padded)[0]:
        touches = costmap.footprint_sweeps(poses[0], poses[1])[0] < math.inf
        return not touches or clearances[0] == 0.0  # a robot may drive off what it touches
    if clearances[0] > 0.0:
        return _comes_no_nearer(costmap, poses, clearances, costmap.footprint)
    for depth in _DEPTHS_M:
        smaller = shrink_outline(costmap.footprint, depth)
        if smaller is None:
            break
        clearances = costmap.clearance(poses, cap=_NEAREST_M, outline=smaller)
        if clearances[0] > 0.0:
            return _comes_no_nearer(costmap, poses, clearances, smaller)
    return False


def _comes_no_nearer(costmap: Costmap, poses: FloatArray, clearances: FloatArray, outline: FloatArray) -> bool:
    """Whether an outline touches nothing on its way, and comes no nearer to anything than it is at the first pose."""
    if clearances.min() == 0.0 or clearances[1:].min() < clearances[0] - _AS_CLEAR_M:
        return False
    return not (costmap.footprint_sweeps(poses[:-1], poses[1:], outline=outline) < math.inf).any()


def cost_under(costmap: Costmap, x: float, y: float) -> int:
    """Cost of the cell that holds one point (x, y) [m], map frame; 255 outside the map. Quicker than `cost_at`."""
    origin, resolution = costmap.origin, costmap.resolution
    dx, dy = x - origin.x, y - origin.y
    if not (abs(dx) < _FAR_M and abs(dy) < _FAR_M):
        return NO_INFORMATION
    cos, sin = math.cos(origin.yaw), math.sin(origin.yaw)
    row = math.floor((cos * dy - sin * dx) / resolution)
    col = math.floor((cos * dx + sin * dy) / resolution)
    rows, cols = costmap.data.shape
    return costmap.data.item(row, col) if 0 <= row < rows and 0 <= col < cols else NO_INFORMATION
