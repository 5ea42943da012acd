"""`PathDriver`: one control period of a drive along a path: plans, follows, recovers."""

from __future__ import annotations

from typing import cast

from trundle.errors import NoValidControlError
from trundle.fault import check_result
from trundle.geometry import Twist2D
from trundle.navigation.behavior_runner import BehaviorRunner
from trundle.navigation.command_check import CommandCheck
from trundle.navigation.drive import Drive, Now, count_reason
from trundle.navigation.followed_path import FollowedPath
from trundle.navigation.recovery import Recovery
from trundle.navigation.replanner import Replanner
from trundle.navigation.speed_limiter import slow_down
from trundle.navigation.status import NavigationStatus

_STAND = Twist2D()


class PathDriver:
    """Drives towards the next goals of a drive.

    Args:
        drive: The drive, whose status it keeps.
        replanner: Plans, and checks the path.
        runner: Runs behaviors.
        recovery: Helps where the controller makes no progress.
        check: Checks the controller's commands.
        dt: Control period [s].
    """

    def __init__(
        self,
        drive: Drive,
        replanner: Replanner,
        runner: BehaviorRunner,
        recovery: Recovery,
        check: CommandCheck,
        dt: float,
    ) -> None:
        self._drive, self._replanner, self._runner, self._recovery = drive, replanner, runner, recovery
        self._check, self._dt = check, dt

    def step(self, now: Now, *, held: bool) -> Twist2D:
        """The command for the next control period.

        Args:
            now: Where the robot is when the command takes effect.
            held: Whether something stopped the last command on its way to the robot.
        """
        drive, replanner = self._drive, self._replanner
        replanner.follow(now)
        if replanner.is_given and replanner.followed is None:  # the pose has jumped away from it
            drive.status = NavigationStatus.STUCK
            return _STAND
        if (replanner.followed is None or replanner.tries.pending) and not replanner.plan_first(now):
            count_reason(drive, replanner.standing_reason)
            return _STAND
        recovering = self._runner.is_recovering
        if held and not replanner.obstacle.gives_up:  # what stops the robot may move away
            drive.progress_checker.reset()
        if not recovering and not drive.progress_checker.is_moving_on(now.pose, now.time):
            drive.status = NavigationStatus.STUCK
            return _STAND
        followed = cast("FollowedPath", replanner.followed)
        followed.advance(now.pose)
        if not recovering:
            replanner.reconsider(followed, now)
        if replanner.tries.pending:
            return _STAND
        if recovering:
            return self._recovery.continue_step(now)
        return self._follow(followed, now)

    def _follow(self, followed: FollowedPath, now: Now) -> Twist2D:
        drive, controller = self._drive, self._drive.controller
        self._check.limit_speed(now, followed)
        if callable(set_through := getattr(controller, "set_through", None)):
            set_through(followed.marks, drive.settings.through_tolerance)
        blocked = ""
        try:
            command = controller.compute_velocity(now.pose, now.twist, now.costmap, self._dt)
            check_result(command, Twist2D, controller, "compute_velocity")
        except NoValidControlError:
            command, blocked = _STAND, self._why_waiting("no valid control")
        if command != _STAND and (command := slow_down(command, self._replanner.fastest)) == _STAND:
            blocked = self._why_waiting("blocked by a mover")
        reason = getattr(controller, "reason", "") or blocked
        count_reason(drive, reason)
        return self._recovery.watch(self._check.cut(command, now), now, reason)

    def _why_waiting(self, reason: str) -> str:
        """The reason, or that the goal is occupied."""
        replanner = self._replanner
        occupied = replanner.obstacle.is_blocked and replanner.standing_reason == "goal occupied"
        return "goal occupied" if occupied else reason
