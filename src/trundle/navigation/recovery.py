"""`BehaviorRunner` runs one behavior at a time; `Recovery` picks them where the controller makes no progress."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence

from trundle.errors import BehaviorFailedError
from trundle.geometry import Twist2D
from trundle.navigation.behaviors import BackUp, Behavior, BehaviorResult, BehaviorRun, Replan, ReplanWith
from trundle.navigation.command_check import CommandCheck
from trundle.navigation.progress import PathProgress, Retries
from trundle.navigation.replanner import Replanner
from trundle.navigation.retreat import Retreat
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import NOTHING, Decision, DriveState, NavigationStatus, Snapshot
from trundle.planning import Planner
from trundle.values import check_kind

_MOST_RUNS = 10_000  # that are kept: a drive may go on for days
_HELD_S = 2.0
"""A behavior that was asked for fails where the collision monitor stops the robot for so long."""


class BehaviorRunner:
    """Runs one behavior at a time. Every command is checked like one of a controller.

    Its decisions have the behavior's command, none where the behavior has ended, and what a plan decided that the
    behavior asked for.

    Args:
        sensed: The costmap with what its scans saw.
        replanner: Plans again, where a behavior asks for it.
        check: Checks its commands.
    """

    def __init__(self, sensed: SensedMap, replanner: Replanner, check: CommandCheck) -> None:
        self._sensed, self._replanner, self._check = sensed, replanner, check
        self.reset()

    def reset(self) -> None:
        """Forget everything, also what ran."""
        self._runs: deque[BehaviorRun] = deque(maxlen=_MOST_RUNS)
        self._behavior: Behavior | None = None
        self._reason, self._recovery, self._begin_s, self._now_s = "", False, 0.0, 0.0
        self._held_since: float | None = None
        self._now: Snapshot | None = None
        self._state, self._planned = DriveState(), NOTHING

    @property
    def is_recovering(self) -> bool:
        """Whether that is a step of recovery."""
        return self._behavior is not None and self._recovery

    @property
    def runs(self) -> tuple[BehaviorRun, ...]:
        """What ran, in order, with what is running."""
        return (*self._runs, self._describe("running", "")) if self._behavior is not None else tuple(self._runs)

    def helps(self, behavior: Behavior, now: Snapshot) -> bool:
        """Whether a behavior can help a robot here that makes no progress."""
        return behavior.helps(self._context(now))

    def start(self, behavior: Behavior, reason: str, now: Snapshot, state: DriveState, *, recovery: bool) -> Decision:
        """Start a behavior; the decision has its first command, and none if it has ended already."""
        self._behavior, self._reason, self._recovery = behavior, reason, recovery
        self._begin_s = self._now_s = now.time
        self._held_since = None
        self._now, self._state, self._planned = now, state, NOTHING
        try:
            behavior.start(self._context(now))
        except BehaviorFailedError as error:
            self._end("failed", str(error))
            return self._planned
        command = self._step(behavior, now)  # which may plan
        return self._planned.then(Decision(command))

    def step(self, now: Snapshot, state: DriveState) -> Decision:
        """Go on with the behavior; the decision has its next command, and none if it ends now."""
        if self._behavior is None:
            return NOTHING
        self._now, self._state, self._planned = now, state, NOTHING
        command = self._step(self._behavior, now)  # which may plan
        return self._planned.then(Decision(command))

    def _step(self, behavior: Behavior, now: Snapshot) -> Twist2D | None:
        self._now_s = now.time
        if now.time - self._begin_s > behavior.time_allowance:
            return self._end("failed", f"it took longer than {behavior.time_allowance:.1f} s")
        where = f"({now.pose.x:.2f}, {now.pose.y:.2f})"
        if self._held_since is not None and not self._recovery and now.time - self._held_since > _HELD_S:
            return self._end("failed", f"stopped at {where} by the collision monitor: it would touch something")
        try:
            wish = behavior.update(self._context(now))
        except BehaviorFailedError as error:
            return self._end("failed", str(error))
        if wish is None:
            return self._end("succeeded", "")
        check_kind(wish, Twist2D, f"the command of behavior {behavior.name!r}", "return Twist2D(v, w), or None")
        command = self._check.slow_down(now.robot.limits.clamp(wish), now, self._replanner.followed)
        if not self._check.can_stop(command, now):
            return self._end("failed", f"blocked at {where}: it would touch something")
        return command

    def hold(self, held: bool, time: float) -> None:
        """Take whether the last command was stopped on its way to the robot, at this time [s]."""
        if not held:
            self._held_since = None
        elif self._held_since is None:
            self._held_since = time

    def interrupt(self, why: str) -> None:
        """End the behavior that is running, if there is one."""
        if self._behavior is not None:
            self._end("interrupted", why)

    def replan(self, planner: Planner | None) -> None:
        """Plan for the behavior that runs now, by another planner if one is given; see `Snapshot.replan`.

        Raises:
            BehaviorFailedError: If there is no goal, or no path to it.
        """
        state = self._state.after(self._planned)
        if self._now is None or state.target is None:
            raise BehaviorFailedError("there is no goal to plan to")
        made = self._replanner.replan(self._now, state, planner)
        self._planned = self._planned.then(made)
        if self._replanner.finds_none(made):
            raise BehaviorFailedError(str(made.error))

    def _context(self, now: Snapshot) -> Snapshot:
        """Return what the behavior gets: another one may have cleared the costmap in this control period."""
        return now if now.sees == self._sensed.is_active else now._replace(sees=self._sensed.is_active)

    def _end(self, result: BehaviorResult, message: str) -> None:
        self._runs.append(self._describe(result, message))
        self._behavior = None

    def _describe(self, result: BehaviorResult, message: str) -> BehaviorRun:
        name = "" if self._behavior is None else self._behavior.name
        return BehaviorRun(name, self._reason, result, message, self._begin_s, self._now_s, self._recovery)


_STAND = Twist2D(0.0, 0.0)
_WAIT = Decision(_STAND, status=NavigationStatus.BLOCKED, restarts_progress=True)
_LEAST_BACK_M = 0.1
_NO_PROGRESS = "no progress along the path"


class Recovery:
    """Runs the steps of recovery, one after the other, where the controller makes no progress.

    Each time the robot is blocked, the next step runs; where a step fails, the one after it runs at once. The robot
    then replans, unless the step itself did, and drives on. After progress the order begins again. In front of
    something that was sensed, which may move away, the navigator replans by itself: there only the other steps run.

    Args:
        sensed: The costmap with what its scans saw.
        replanner: Plans again.
        runner: Runs the steps.
        steps: The steps, in order; without any, a blocked robot gives up.
        retries: How often a robot that makes no progress tries again.
        progress: Whether what it drives brings it further along its path.
        retreat: Makes room for those who wait for the robot, where backing up is a step.
    """

    def __init__(
        self,
        sensed: SensedMap,
        replanner: Replanner,
        runner: BehaviorRunner,
        steps: Sequence[Behavior],
        retries: Retries,
        progress: PathProgress,
        retreat: Retreat,
    ) -> None:
        self._sensed, self._replanner, self._runner = sensed, replanner, runner
        self.steps = tuple(steps)
        self._retries, self._progress, self._retreat = retries, progress, retreat
        self._may_make_room = any(isinstance(step, BackUp) for step in self.steps)
        self._others = tuple(step for step in self.steps if isinstance(step, ReplanWith) or not _replans(step))
        self.reset()

    def reset(self) -> None:
        """Start over."""
        self._retries.reset()
        self._progress.reset()
        self._retreat.reset()
        self._next = self._next_other = 0
        self._untried: list[Behavior] = []
        self._reason = ""

    @property
    def makes_room(self) -> bool:
        """Whether the robot drives to where others can pass, or waits there."""
        return self._retreat.is_active

    def make_room(self, now: Snapshot, state: DriveState) -> Decision:
        """Let others pass who wait for the robot; without a command where the controller is to drive."""
        if self._runner.is_recovering or not self._may_make_room:
            return NOTHING
        return self._retreat.decide(now, state)

    # Blocked --------------------------------------------------------------------------------------------------------

    def watch(self, command: Twist2D, now: Snapshot, state: DriveState, reason: str) -> Decision:
        """Pass the controller's command on; if it makes no progress before the goal, begin to recover.

        Args:
            command: The command.
            now: Where the robot is.
            state: What the drive has come to.
            reason: Why the controller makes no progress, if it says so.
        """
        if self._retreat.is_active:
            return Decision(command, status=NavigationStatus.DRIVING if command != _STAND else None)
        followed = self._replanner.followed
        left_m = 0.0 if followed is None else followed.left_m
        strays = followed is not None and self._progress.is_lost(followed, now.pose, now.twist)
        if not self._retries.is_blocked(command, now.twist, left_m) and not strays:
            return Decision(command, status=NavigationStatus.DRIVING if command != _STAND else None)
        if strays:
            said = Decision(reasons=(_NO_PROGRESS,))
            return said.then(self._try_again(now, state.after(said), left_m, _NO_PROGRESS, strays=True))
        if self._replanner.is_given:
            return self._wait_on_given(state)
        if self._replanner.obstacle.is_blocked:
            return self._wait_for_obstacle(now, state)
        return self._try_again(now, state, left_m, reason, strays=False)

    def _try_again(self, now: Snapshot, state: DriveState, left_m: float, reason: str, *, strays: bool) -> Decision:
        """Run the next step that helps here, or give up where all were tried too often."""
        tries = self.steps and not self._replanner.is_given
        if not tries or (not self._retries.try_again(left_m) and (strays or not self._is_patient())):
            return _give_up(state)
        if self._retries.count <= 1:
            self._next = 0
        turn = [self.steps[(self._next + k) % len(self.steps)] for k in range(len(self.steps))]
        self._untried = [step for step in turn if self._runner.helps(step, now)] or turn
        self._next += turn.index(self._untried[0])
        self._reason = reason or "no progress"
        return _WAIT.then(self._run_next(now, state))

    def _is_patient(self) -> bool:
        """Whether to start over with the tries of recovery: what holds the robot may be sensed, and may move away."""
        if not self._sensed.is_active or self._replanner.obstacle.gives_up:
            return False
        self._retries.reset()
        return True

    def _wait_for_obstacle(self, now: Snapshot, state: DriveState) -> Decision:
        """Stand in front of what was sensed on the path, run a step now and then, and give up after a while."""
        obstacle = self._replanner.obstacle
        if self._replanner.gives_up(now, state):
            last = self._replanner.replan(now, state) if self._replanner.quick is not None else NOTHING
            if self._replanner.quick is not None and not self._replanner.finds_none(last):
                obstacle.clear()
                return last.then(Decision(_STAND))
            return last.then(_give_up(state.after(last)))
        others = self._steps_at_obstacle(now)
        if others and state.error is not None and obstacle.backs_up(now.time):
            self._untried = [others[self._next_other % len(others)]]
            self._next_other += 1
            self._reason = state.message
            return _WAIT.then(self._run_next(now, state))
        return _WAIT

    def _steps_at_obstacle(self, now: Snapshot) -> list[Behavior]:
        """The steps that help there; before what moves the robot backs up as far as gives that room, and no farther."""
        steps = [step for step in self._others if self._runner.helps(step, now)]
        room_m = self._replanner.obstacle.room_m
        if room_m == math.inf:
            return steps
        if room_m > -_LEAST_BACK_M:
            return [step for step in steps if not isinstance(step, BackUp)]
        return [BackUp(max(-room_m, step.distance), step.speed) if isinstance(step, BackUp) else step for step in steps]

    def _wait_on_given(self, state: DriveState) -> Decision:
        """Stand on a path that is followed as it is, while what was sensed there may move away; or give up."""
        obstacle = self._replanner.obstacle
        return _WAIT if obstacle.is_blocked and not obstacle.gives_up else _give_up(state)

    # Steps ----------------------------------------------------------------------------------------------------------

    def continue_step(self, now: Snapshot, state: DriveState) -> Decision:
        """Go on with the step that is running; when it ends, replan or run the next one."""
        ran = self._runner.step(now, state)
        return ran if ran.command is not None else ran.then(self._after_step(now, state.after(ran)))

    def _run_next(self, now: Snapshot, state: DriveState) -> Decision:
        """Run the next of the steps that were not tried yet."""
        self._step = self._untried.pop(0)
        self._next += 1
        ran = self._runner.start(self._step, self._reason, now, state, recovery=True)
        return ran if ran.command is not None else ran.then(self._after_step(now, state.after(ran)))

    def _after_step(self, now: Snapshot, state: DriveState) -> Decision:
        ended = Decision(_STAND, restarts_progress=True)
        if self._runner.runs[-1].result == "failed" and self._untried:
            return ended.then(self._run_next(now, state))
        return ended if _replans(self._step) else ended.then(self._replanner.replan(now, state))


def _give_up(state: DriveState) -> Decision:
    """End the drive: it has no path, or makes no progress although there is one."""
    return Decision(_STAND, status=NavigationStatus.STUCK if state.error is None else NavigationStatus.NO_PATH)


def _replans(step: Behavior) -> bool:
    return isinstance(step, Replan)
