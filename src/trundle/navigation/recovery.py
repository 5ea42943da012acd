"""`Recovery`: what a navigator does where the controller makes no progress."""

from __future__ import annotations

import math
from collections.abc import Sequence

from trundle.geometry import Twist2D
from trundle.navigation.behavior_runner import BehaviorRunner
from trundle.navigation.behaviors import BackUp, Behavior, Replan, ReplanWith
from trundle.navigation.drive import Drive, Now, count_reason
from trundle.navigation.progress import PathProgress, Retries
from trundle.navigation.replanner import Replanner
from trundle.navigation.sensing import SensedMap
from trundle.navigation.status import NavigationStatus

_STAND = Twist2D(0.0, 0.0)
_LEAST_BACK_M = 0.1
_NO_PROGRESS = "no progress along the path"


class Recovery:
    """Runs the steps of recovery, one after the other, where the controller makes no progress.

    Each time the robot is blocked, the next step runs; where a step fails, the one after it runs at once. The robot
    then replans, unless the step itself did, and drives on. After progress the order begins again. In front of
    something that was sensed, which may move away, the navigator replans by itself: there only the other steps run.

    Args:
        drive: The drive, whose status it keeps.
        sensed: The costmap with what its scans saw.
        replanner: Plans again.
        runner: Runs the steps.
        steps: The steps, in order; without any, a blocked robot gives up.
        retries: How often a robot that makes no progress tries again.
        progress: Whether what it drives brings it further along its path.
    """

    def __init__(
        self,
        drive: Drive,
        sensed: SensedMap,
        replanner: Replanner,
        runner: BehaviorRunner,
        steps: Sequence[Behavior],
        retries: Retries,
        progress: PathProgress,
    ) -> None:
        self._drive, self._sensed, self._replanner, self._runner = drive, sensed, replanner, runner
        self.steps = tuple(steps)
        self._retries, self._progress = retries, progress
        self._others = tuple(step for step in self.steps if isinstance(step, ReplanWith) or not _replans(step))
        self.reset()

    def reset(self) -> None:
        """Start over."""
        self._retries.reset()
        self._progress.reset()
        self._next = self._next_other = 0
        self._untried: list[Behavior] = []
        self._reason = ""

    # Blocked --------------------------------------------------------------------------------------------------------

    def watch(self, command: Twist2D, now: Now, reason: str) -> Twist2D:
        """Pass the controller's command on; if it makes no progress before the goal, begin to recover.

        Args:
            command: The command.
            now: Where the robot is.
            reason: Why the controller makes no progress, if it says so.
        """
        followed, drive = self._replanner.followed, self._drive
        left_m = 0.0 if followed is None else followed.left_m
        strays = followed is not None and self._progress.is_lost(followed, now.pose, now.twist)
        if not self._retries.is_blocked(command, now.twist, left_m) and not strays:
            if command != _STAND:
                drive.status = NavigationStatus.DRIVING
            return command
        if strays:
            reason = _NO_PROGRESS
            count_reason(drive, reason)
        if self._replanner.is_given and not strays:
            return self._wait_on_given()
        if self._replanner.obstacle.is_blocked and not strays:
            return self._wait_for_obstacle(now)
        tries = self.steps and not self._replanner.is_given
        if not tries or (not self._retries.try_again(left_m) and (strays or not self._is_patient())):
            self._give_up()
            return _STAND
        drive.status = NavigationStatus.BLOCKED
        drive.progress_checker.reset()
        if self._retries.count <= 1:
            self._next = 0
        turn = [self.steps[(self._next + k) % len(self.steps)] for k in range(len(self.steps))]
        self._untried = [step for step in turn if self._runner.helps(step, now)] or turn
        self._next += turn.index(self._untried[0])
        self._reason = reason or "no progress"
        return self._run_next(now)

    def _is_patient(self) -> bool:
        """Whether to start over with the tries of recovery: what holds the robot may be sensed, and may move away."""
        if not self._sensed.is_active or self._replanner.obstacle.gives_up:
            return False
        self._retries.reset()
        return True

    def _wait_for_obstacle(self, now: Now) -> Twist2D:
        """Stand in front of what was sensed on the path, run a step now and then, and give up after a while."""
        obstacle, drive = self._replanner.obstacle, self._drive
        if self._replanner.gives_up(now):
            if self._replanner.searches_less and self._replanner.replan(now):
                obstacle.clear()
                return _STAND
            self._give_up()
            return _STAND
        drive.status = NavigationStatus.BLOCKED
        drive.progress_checker.reset()
        others = self._steps_at_obstacle(now)
        if others and drive.error is not None and obstacle.backs_up(now.time):
            self._untried = [others[self._next_other % len(others)]]
            self._next_other += 1
            self._reason = drive.message
            return self._run_next(now)
        return _STAND

    def _steps_at_obstacle(self, now: Now) -> list[Behavior]:
        """The steps that help there; before what moves the robot backs up as far as gives that room, and no farther."""
        steps = [step for step in self._others if self._runner.helps(step, now)]
        room_m = self._replanner.obstacle.room_m
        if room_m == math.inf:
            return steps
        if room_m > -_LEAST_BACK_M:
            return [step for step in steps if not isinstance(step, BackUp)]
        return [BackUp(max(-room_m, step.distance), step.speed) if isinstance(step, BackUp) else step for step in steps]

    def _wait_on_given(self) -> Twist2D:
        """Stand on a path that is followed as it is, while what was sensed there may move away; or give up."""
        obstacle, drive = self._replanner.obstacle, self._drive
        if not obstacle.is_blocked or obstacle.gives_up:
            self._give_up()
            return _STAND
        drive.status = NavigationStatus.BLOCKED
        drive.progress_checker.reset()
        return _STAND

    def _give_up(self) -> None:
        self._drive.status = NavigationStatus.STUCK if self._drive.error is None else NavigationStatus.NO_PATH

    # Steps ----------------------------------------------------------------------------------------------------------

    def continue_step(self, now: Now) -> Twist2D:
        """The command of the step that is running; when it ends, replan or run the next one."""
        command = self._runner.step(now)
        return self._after_step(now) if command is None else command

    def _run_next(self, now: Now) -> Twist2D:
        """Run the next of the steps that were not tried yet."""
        self._step = self._untried.pop(0)
        self._next += 1
        command = self._runner.start(self._step, self._reason, now, recovery=True)
        return self._after_step(now) if command is None else command

    def _after_step(self, now: Now) -> Twist2D:
        drive = self._drive
        drive.progress_checker.reset()
        if self._runner.runs[-1].result == "failed" and self._untried:
            return self._run_next(now)
        if not _replans(self._step):
            self._replanner.replan(now)
        return _STAND


def _replans(step: Behavior) -> bool:
    return isinstance(step, Replan)
