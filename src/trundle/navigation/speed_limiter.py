"""`SpeedLimiter`: how fast the robot may drive now, so that it keeps the limits of a speed mask here and ahead.

`limits_along` and `fastest_s` say the same of a whole path before anything moves.
"""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps.masks import SpeedMask
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Robot

BRAKING_SHARE = 0.5
"""Share of the robot's deceleration that is used to slow down to a limit ahead."""

BESIDE_M = 0.1
"""A limit this far beside the path [m] counts too: controllers cut corners."""

_STEP_M = 0.025
_FARTHEST_M = 1000.0
_DRIVING_MPS = 0.05


class SpeedLimiter:
    """The limit at the robot's base_link, and ahead as far as it needs to brake.

    Ahead is along the path, 0.1 m to both sides of it, and along the arc that the robot drives now.

    Args:
        mask: The limits.
        robot: Its top speed, of which the limits are a share, and its deceleration count.
    """

    def __init__(self, mask: SpeedMask, robot: Robot) -> None:
        self._mask = mask
        self._top_speed = robot.limits.linear_speed
        self._braking = BRAKING_SHARE * robot.limits.linear_acceleration
        self._check: PathCheck | None = None
        self._limits: FloatArray = np.zeros(0)

    def set_path(self, check: PathCheck) -> None:
        """Look ahead along this path from now on."""
        self._check, self._limits = check, limits_along(check.poses, self._mask, self._top_speed)

    def limit(self, pose: Pose2D, twist: Twist2D, index: int, dt: float, *, backwards: bool = False) -> float:
        """Speed [m/s] that may be driven for `dt` [s]; infinite where nothing limits it.

        Args:
            pose: Where the robot is, map frame.
            twist: How it moves, base_link.
            index: Position on the path: the index of the `PathCheck`'s pose.
            dt: Control period [s].
            backwards: Whether the next command drives backwards.
        """
        braking_m = self._top_speed * (dt + self._top_speed / (2.0 * self._braking))
        reach = min(braking_m, _FARTHEST_M) + BESIDE_M + _STEP_M
        s = np.arange(0.0, reach + _STEP_M, _STEP_M)
        x, y = _arc(pose, twist, -s if backwards or twist.v < -_DRIVING_MPS else s)
        limits, distances = self._mask.limit_at(x, y, self._top_speed), s - _STEP_M
        if self._check is not None:
            along = self._check.along
            ahead = slice(index, int(along.searchsorted(float(along[index]) + reach)) + 1)
            places = self._check.poses[ahead, :2]
            # No path to a place is shorter than the straight line.
            straight = np.hypot(places[:, 0] - pose.x, places[:, 1] - pose.y)
            limits = np.concatenate([limits, self._limits[ahead]])
            distances = np.concatenate([distances, straight - BESIDE_M - _STEP_M])
        some = np.isfinite(limits)
        return float(self._allow(limits[some], distances[some], dt).min()) if some.any() else math.inf

    def _allow(self, limits: FloatArray, distances: FloatArray, dt: float) -> FloatArray:
        """Speeds v with v² = limit² + 2 · braking · (distance − v · dt), and the limit where v is below it."""
        step = self._braking * dt
        room = np.maximum(distances - limits * dt, 0.0)
        return np.sqrt((limits + step) ** 2 + 2.0 * self._braking * room) - step


def slow_down(command: Twist2D, limit: float) -> Twist2D:
    """The same arc within a speed limit [m/s]."""
    if abs(command.v) <= limit:
        return command
    share = limit / abs(command.v)
    return Twist2D(share * command.v, share * command.w)


def limits_along(poses: FloatArray, mask: SpeedMask, top_speed: float) -> FloatArray:
    """Limits [m/s] at poses (x, y, yaw) [m, m, rad], and 0.1 m to both sides of each: the least of the three.

    Args:
        poses: Map frame, shape (N, 3).
        mask: The limits.
        top_speed: The robot's [m/s].

    Returns:
        Shape (N,); infinite where nothing limits the speed.
    """
    x, y, yaw = poses[:, 0], poses[:, 1], poses[:, 2]
    beside = np.array([[-BESIDE_M], [0.0], [BESIDE_M]])
    limits: FloatArray = mask.limit_at(x - beside * np.sin(yaw), y + beside * np.cos(yaw), top_speed).min(axis=0)
    return limits


def fastest_s(path: Path, robot: Robot, mask: SpeedMask | None) -> float:
    """Driving time [s] of a path at the robot's top speed, or at the mask's limits; turns in place not counted."""
    top = robot.limits.linear_speed
    if mask is None:
        return path.length / top
    check = PathCheck(path)
    speeds = np.minimum(limits_along(check.poses, mask, top), top)
    return float((np.diff(check.along) / np.minimum(speeds[1:], speeds[:-1])).sum())


def _arc(pose: Pose2D, twist: Twist2D, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points x, y [m] after driving s [m] as the robot moves now; straight on where it stands or turns in place."""
    curvature = twist.w / twist.v if abs(twist.v) > _DRIVING_MPS else 0.0
    if abs(curvature) < 1e-6:
        return pose.x + s * math.cos(pose.yaw), pose.y + s * math.sin(pose.yaw)
    yaw = pose.yaw + curvature * s
    return (
        pose.x + (np.sin(yaw) - math.sin(pose.yaw)) / curvature,
        pose.y - (np.cos(yaw) - math.cos(pose.yaw)) / curvature,
    )
