"""A controller: turn to the next point, drive to it, and at the end turn to the goal's yaw."""

from __future__ import annotations

import math

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.path import Path
from trundle.robots import Robot

REACHED_M = 0.08
AIMED_RAD = 0.15
STANDS_RAD = 0.02


class TurnThenDrive:
    """Slow and simple."""

    def __init__(self, robot: Robot, *, share: float = 0.8) -> None:
        self._limits = robot.limits
        self._share = share
        self._points: list[tuple[float, float]] = []
        self._yaw: float | None = None

    def set_path(self, path: Path) -> None:
        self._points = [(x, y) for x, y, _ in path.poses.tolist()]
        self._yaw = path.goal.yaw

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        while self._points and math.dist(self._points[0], (pose.x, pose.y)) < REACHED_M:
            self._points.pop(0)
        if self._yaw is None:
            return Twist2D(0.0, 0.0)
        if not self._points:
            error = wrap_angle(self._yaw - pose.yaw)
            return Twist2D(0.0, self._turn(error) if abs(error) > STANDS_RAD else 0.0)
        x, y = self._points[0]
        error = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        fastest = min(self._share * self._limits.linear_speed, 2.0 * math.dist((x, y), (pose.x, pose.y)))
        v = fastest if abs(error) < AIMED_RAD else 0.0
        command = Twist2D(v, self._turn(error))
        ahead = [command.integrate(pose, seconds).as_tuple() for seconds in (0.1, 0.2, 0.3)]
        return Twist2D(0.0, 0.0) if costmap.footprint_collides(np.array(ahead)).any() else command

    def _turn(self, error: float) -> float:
        limit = self._share * self._limits.angular_speed
        return max(-limit, min(limit, 3.0 * error))
