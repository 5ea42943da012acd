"""`Recovery`: what a navigator does where the controller makes no progress."""

from __future__ import annotations

from trundle.control.collision import can_stop
from trundle.geometry import FloatArray, Twist2D
from trundle.navigation.drive import Drive, Now
from trundle.navigation.replanner import Replanner
from trundle.navigation.retries import Retries
from trundle.navigation.sensed_map import SensedMap
from trundle.navigation.status import NavigationStatus
from trundle.robots import Robot

_STAND = Twist2D(0.0, 0.0)


class Recovery:
    """Replans or backs up where the controller makes no progress, waits where something was sensed, and gives up.

    Args:
        drive: The drive, whose status it keeps.
        robot: The robot.
        sensed: The costmap with what its scans saw.
        replanner: Plans again.
        padded: The footprint's outline [m], base_link, widened by the clearance to keep.
        dt: Control period [s].
    """

    def __init__(
        self, drive: Drive, robot: Robot, sensed: SensedMap, replanner: Replanner, padded: FloatArray, dt: float
    ) -> None:
        self._drive, self._robot, self._sensed, self._replanner = drive, robot, sensed, replanner
        self._padded, self._dt = padded, dt
        self._retries = Retries(dt)

    def reset(self) -> None:
        """Start over."""
        self._retries.reset()

    @property
    def is_backing_up(self) -> bool:
        """Whether the robot is backing up."""
        return self._retries.is_backing_up

    def watch(self, command: Twist2D, now: Now) -> Twist2D:
        """Pass the controller's command on; if it makes no progress before the goal, replan or back up."""
        followed, drive = self._replanner.followed, self._drive
        left_m = 0.0 if followed is None else followed.left_m
        if not self._retries.is_blocked(command, now.twist, left_m):
            if command != _STAND:
                drive.status = NavigationStatus.DRIVING
            return command
        if self._replanner.obstacle.is_blocked:
            return self._wait_for_obstacle(now)
        if not self._retries.try_again(left_m) and not self._is_patient():
            self._give_up()
            return _STAND
        drive.status = NavigationStatus.BLOCKED
        drive.progress_checker.reset()
        if self._retries.backs_up_first or not self._replanner.replan(now):
            self._retries.start_backing_up()
        return _STAND

    def _is_patient(self) -> bool:
        """Whether to start over with the tries of recovery: what holds the robot may be sensed, and may move away."""
        if not self._sensed.is_active or self._replanner.obstacle.gives_up:
            return False
        self._retries.reset()
        return True

    def _wait_for_obstacle(self, now: Now) -> Twist2D:
        """Stand in front of what was sensed on the path, back up now and then, and give up after a while."""
        obstacle, drive = self._replanner.obstacle, self._drive
        if obstacle.gives_up:
            if self._replanner.searches_less and self._replanner.replan(now):
                obstacle.clear()
                return _STAND
            self._give_up()
            return _STAND
        drive.status = NavigationStatus.BLOCKED
        drive.progress_checker.reset()
        if drive.error is not None and obstacle.backs_up(now.time):
            self._retries.start_backing_up()
        return _STAND

    def _give_up(self) -> None:
        self._drive.status = NavigationStatus.STUCK if self._drive.error is None else NavigationStatus.NO_PATH

    def back_up(self, now: Now) -> Twist2D:
        """Drive straight back while that is clear, then replan."""
        command = self._retries.back_up()
        limits = self._robot.limits
        clear = can_stop(now.costmap, limits, now.pose, now.twist, command, self._dt, padded=self._padded)
        if clear and self._retries.is_backing_up:
            return command
        self._retries.stop_backing_up()
        self._replanner.replan(now)
        return _STAND
