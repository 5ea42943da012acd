"""`CommandCheck`: slows commands down by the speed mask and in unseen space, and says which leave room to stop."""

from __future__ import annotations

from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop
from trundle.geometry import Twist2D
from trundle.navigation.drive import Drive, Now
from trundle.navigation.followed_path import FollowedPath
from trundle.navigation.sensing.sensed_map import SensedMap
from trundle.navigation.sensing.unseen_space import slow_down_in_unseen
from trundle.navigation.speed_limiter import SpeedLimiter, slow_down
from trundle.robots import Robot


class CommandCheck:
    """Checks the commands of a controller, of a behavior, and by hand.

    Args:
        drive: The drive that it is part of; gets the speed limit.
        robot: The robot.
        sensed: The costmap with what its scans saw.
        limiter: Of the speed mask, or None.
        dt: Control period [s].
    """

    def __init__(self, drive: Drive, robot: Robot, sensed: SensedMap, limiter: SpeedLimiter | None, dt: float) -> None:
        self._drive, self._robot, self._sensed, self._limiter, self._dt = drive, robot, sensed, limiter, dt
        self._padded = robot.planar.padded(FOOTPRINT_PADDING_M).outline

    def set_path(self, followed: FollowedPath) -> None:
        """Look ahead along this path from now on."""
        if self._limiter is not None:
            self._limiter.set_path(followed.check)

    def limit_speed(self, now: Now, followed: FollowedPath | None, *, backwards: bool = False) -> None:
        """Hand the speed that the mask allows here and ahead on the path to the controller."""
        if self._limiter is None:
            return
        index = 0 if followed is None else followed.index
        limit = self._limiter.limit(now.pose, now.twist, index, self._dt, backwards=backwards)
        self._drive.speed_limit = limit
        self._drive.controller.set_speed_limit(limit)

    def slow_down(self, command: Twist2D, now: Now, followed: FollowedPath | None) -> Twist2D:
        """The same arc within the speed limit of now, and within what was seen."""
        self.limit_speed(now, followed, backwards=command.v < 0.0)
        return self.cut(command, now)

    def cut(self, command: Twist2D, now: Now) -> Twist2D:
        """The same arc within the last speed limit, and within what was seen."""
        command = slow_down(command, self._drive.speed_limit)
        if not self._sensed.is_active:
            return command
        limits = self._robot.limits
        return slow_down_in_unseen(now.costmap, limits, now.pose, now.twist, command, self._dt, padded=self._padded)

    def can_stop(self, command: Twist2D, now: Now) -> bool:
        """Whether a command leaves the robot room to stop before it touches something."""
        limits = self._robot.limits
        return can_stop(now.costmap, limits, now.pose, now.twist, command, self._dt, padded=self._padded)
