"""`LookaheadFollower`: drives towards a point ahead on the path and checks nothing, by name `lookahead`."""

from __future__ import annotations

import math

from trundle.control.controller import Controller
from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.path import Path
from trundle.robots import Robot


class LookaheadFollower(Controller):
    """Drives towards the first path point beyond the lookahead, turning in proportion to its bearing.

    It stops at the last point. This is the follower of many tutorials, for comparison: it checks no footprint and turns
    to no final yaw.

    Args:
        robot: What is driven; its limits hold.
        lookahead_dist: Distance to the point that it drives towards [m].
        linear_speed: [m/s].
        angular_gain: Turning speed per bearing [1/s].
        rotate_min_angle: Above this bearing the robot only turns [rad].
        goal_tolerance: The last point is reached within this distance [m].

    Raises:
        InputError: If a number is not positive.
    """

    def __init__(
        self,
        robot: Robot,
        *,
        lookahead_dist: float = 0.7,
        linear_speed: float = 0.8,
        angular_gain: float = 1.5,
        rotate_min_angle: float = 0.8,
        goal_tolerance: float = 0.1,
    ) -> None:
        numbers = (lookahead_dist, linear_speed, angular_gain, rotate_min_angle, goal_tolerance)
        if not all(math.isfinite(number) and number > 0.0 for number in numbers):
            raise InputError(f"controller 'lookahead' takes positive numbers only, got {numbers}")
        self._robot = robot
        self._lookahead, self._speed, self._gain = lookahead_dist, linear_speed, angular_gain
        self._rotate_min_angle, self._goal_tolerance = rotate_min_angle, goal_tolerance
        self.reset()

    def reset(self, *, seed: int = 0) -> None:
        """Forget the path; nothing here is random."""
        self._points: list[tuple[float, float]] = []
        self._next = 0

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        self._points = [(x, y) for x, y, _ in path.poses.tolist()]
        self._next = 0

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period; see `Controller`."""
        if not self._points:
            return Twist2D()
        goal_x, goal_y = self._points[-1]
        if math.hypot(goal_x - pose.x, goal_y - pose.y) <= self._goal_tolerance:
            return Twist2D()
        while self._next < len(self._points) - 1:
            x, y = self._points[self._next]
            if math.hypot(x - pose.x, y - pose.y) >= self._lookahead:
                break
            self._next += 1
        x, y = self._points[self._next]
        bearing = wrap_angle(math.atan2(y - pose.y, x - pose.x) - pose.yaw)
        speed = 0.0 if abs(bearing) > self._rotate_min_angle else self._speed * math.cos(bearing)
        near = math.hypot(goal_x - pose.x, goal_y - pose.y)
        return self._robot.limits.clamp(Twist2D(min(speed, max(near, 0.1)), self._gain * bearing))
