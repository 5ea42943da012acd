"""Whether a command leaves the robot a way to stop before it touches something."""

from __future__ import annotations

import math

import numpy as np

from trundle.costmap import NO_INFORMATION, Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D, integrate_twist
from trundle.robots import Limits

_SUBSTEP_S = 0.05


def stopping_poses(
    pose: Pose2D, twist: Twist2D, command: Twist2D, limits: Limits, dt: float
) -> list[tuple[float, float, float]]:
    """Poses (x, y, yaw) on the way of driving `command` for `dt` [s] from `twist`, then braking to a stand.

    Speeds change evenly, as fast as the limits allow, in steps of 0.05 s; each step is an arc at their mean.
    """
    x, y, yaw = pose.x, pose.y, pose.yaw
    linear, angular = limits.linear_acceleration, limits.angular_acceleration
    target = limits.clamp(command)
    v, w, goal_v, goal_w = twist.v, twist.w, target.v, target.w
    poses: list[tuple[float, float, float]] = []
    driven = 0.0
    while True:
        step = _SUBSTEP_S if driven >= dt else min(_SUBSTEP_S, dt - driven)
        change_v = min(linear * step, max(-linear * step, goal_v - v))
        change_w = min(angular * step, max(-angular * step, goal_w - w))
        x, y, yaw = integrate_twist(x, y, yaw, v + 0.5 * change_v, w + 0.5 * change_w, step)
        v, w = v + change_v, w + change_w
        poses.append((x, y, yaw))
        driven += step
        if driven >= dt - 1e-12:
            if abs(v) < 1e-9 and abs(w) < 1e-9:
                return poses
            goal_v = goal_w = 0.0


def can_stop(
    costmap: Costmap,
    limits: Limits,
    pose: Pose2D,
    twist: Twist2D,
    command: Twist2D,
    dt: float,
    *,
    outline: FloatArray | None = None,
) -> bool:
    """Whether a robot can drive `command` for `dt` [s] and then brake without touching something on the way.

    `outline` [m], shape (N, 2), stands for the costmap's footprint where it is given, e.g. a padded one.
    """
    poses = stopping_poses(pose, twist, command, limits, dt)
    return not costmap.footprint_collides(np.array(poses), outline=outline).any()


def cost_under(costmap: Costmap, x: float, y: float) -> int:
    """Cost of the cell that holds one point (x, y) [m], map frame; 255 outside the map. Quicker than `cost_at`."""
    origin, resolution = costmap.origin, costmap.resolution
    dx, dy = x - origin.x, y - origin.y
    cos, sin = math.cos(origin.yaw), math.sin(origin.yaw)
    row = math.floor((cos * dy - sin * dx) / resolution)
    col = math.floor((cos * dx + sin * dy) / resolution)
    rows, cols = costmap.shape
    return costmap.data.item(row, col) if 0 <= row < rows and 0 <= col < cols else NO_INFORMATION
