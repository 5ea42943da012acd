"""`BehaviorRunner`: runs one behavior at a time, checks its commands, and records how it went."""

from __future__ import annotations

from collections import deque

from trundle.errors import BehaviorFailedError
from trundle.geometry import Twist2D
from trundle.navigation.behaviors import Behavior, BehaviorResult, BehaviorRun
from trundle.navigation.command_check import CommandCheck
from trundle.navigation.replanner import Replanner
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import NOTHING, Decision, DriveState, Snapshot
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
