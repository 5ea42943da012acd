"""When a goal is reached, and when a robot makes no progress; with Nav2's defaults."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.values import check_number


@dataclass(frozen=True, slots=True)
class GoalChecker:
    """The goal is reached when the robot stands in its tolerance (Nav2's StoppedGoalChecker).

    Attributes:
        xy_tolerance: Distance in position [m].
        yaw_tolerance: Difference in yaw [rad].
        stopped_linear: Speed below which it stands [m/s].
        stopped_angular: Turning speed below which it stands [rad/s].

    Raises:
        InputError: If one is no number of 0 or more.
    """

    xy_tolerance: float = 0.25
    yaw_tolerance: float = 0.25
    stopped_linear: float = 0.02
    stopped_angular: float = 0.02

    def __post_init__(self) -> None:
        for field in fields(self):
            check_number(field.name, getattr(self, field.name), 0.0, math.inf)

    def is_reached(self, pose: Pose2D, twist: Twist2D, goal: Pose2D, *, any_yaw: bool) -> bool:
        """Return whether a robot at `pose`, moving with `twist`, has arrived; `any_yaw` where the goal has no yaw."""
        return (
            self.is_within(pose, goal, any_yaw=any_yaw)
            and abs(twist.v) <= self.stopped_linear
            and abs(twist.w) <= self.stopped_angular
        )

    def is_within(self, pose: Pose2D, goal: Pose2D, *, any_yaw: bool) -> bool:
        """Return whether a pose is in the tolerance."""
        if math.hypot(goal.x - pose.x, goal.y - pose.y) > self.xy_tolerance:
            return False
        return any_yaw or abs(wrap_angle(goal.yaw - pose.yaw)) <= self.yaw_tolerance


class ProgressChecker:
    """A robot makes progress if it moves or turns by a minimum within the time allowance (Nav2's PoseProgressChecker).

    Args:
        required_movement_radius: [m].
        required_movement_angle: [rad]; turning in place counts as progress.
        movement_time_allowance: [s].

    Raises:
        InputError: If one is no number of 0 or more.
    """

    def __init__(
        self,
        required_movement_radius: float = 0.5,
        required_movement_angle: float = 0.5,
        movement_time_allowance: float = 10.0,
    ) -> None:
        self.required_movement_radius = check_number(
            "required_movement_radius", required_movement_radius, 0.0, math.inf
        )
        self.required_movement_angle = check_number("required_movement_angle", required_movement_angle, 0.0, math.inf)
        self.movement_time_allowance = check_number("movement_time_allowance", movement_time_allowance, 0.0, math.inf)
        self._pose: Pose2D | None = None
        self._time = 0.0

    def reset(self) -> None:
        """Forget where the robot was."""
        self._pose = None

    def is_moving_on(self, pose: Pose2D, time: float) -> bool:
        """Return whether the robot, at `pose` at `time` [s], has made progress within the allowance."""
        return self.standing_s(pose, time) <= self.movement_time_allowance

    def standing_s(self, pose: Pose2D, time: float) -> float:
        """Return for how long [s] a robot that is at `pose` at `time` [s] has made no progress."""
        last = self._pose
        if (
            last is None
            or math.hypot(pose.x - last.x, pose.y - last.y) >= self.required_movement_radius
            or abs(wrap_angle(pose.yaw - last.yaw)) >= self.required_movement_angle
        ):
            self._pose, self._time = pose, time
        return time - self._time
