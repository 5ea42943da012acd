"""`BehaviorRunner`: runs one behavior at a time, checks its commands, and records how it went."""

from __future__ import annotations

from collections import deque

from trundle.errors import BehaviorFailedError
from trundle.geometry import Twist2D
from trundle.navigation.behaviors import Behavior, BehaviorContext, BehaviorResult, BehaviorRun
from trundle.navigation.command_check import CommandCheck
from trundle.navigation.drive import Drive, Now
from trundle.navigation.replanner import Replanner
from trundle.navigation.sensing import SensedMap
from trundle.planning import Planner
from trundle.robots import Robot
from trundle.values import check_kind

_STAND = Twist2D()
_MOST_RUNS = 10_000
_HELD_S = 2.0
"""A behavior that was asked for fails where the collision monitor stops the robot for so long."""


class BehaviorRunner:
    """Runs one behavior at a time. Every command is checked like one of a controller.

    Args:
        drive: The drive that it is part of.
        robot: The robot.
        sensed: The costmap with what its scans saw.
        replanner: Plans again, where a behavior asks for it.
        check: Checks its commands.
        dt: Control period [s].
    """

    def __init__(
        self,
        drive: Drive,
        robot: Robot,
        sensed: SensedMap,
        replanner: Replanner,
        check: CommandCheck,
        dt: float,
    ) -> None:
        self._drive, self._robot, self._sensed, self._replanner = drive, robot, sensed, replanner
        self._check, self._dt = check, dt
        self.reset()

    def reset(self) -> None:
        """Forget everything, also what ran."""
        self._runs: deque[BehaviorRun] = deque(maxlen=_MOST_RUNS)
        self._behavior: Behavior | None = None
        self._reason, self._recovery, self._begin_s, self._now_s = "", False, 0.0, 0.0
        self._held_since: float | None = None

    @property
    def is_running(self) -> bool:
        """Whether a behavior is running."""
        return self._behavior is not None

    @property
    def is_recovering(self) -> bool:
        """Whether that is a step of recovery."""
        return self._behavior is not None and self._recovery

    @property
    def runs(self) -> tuple[BehaviorRun, ...]:
        """What ran, in order, with what is running."""
        return (*self._runs, self._describe("running", "")) if self._behavior is not None else tuple(self._runs)

    def helps(self, behavior: Behavior, now: Now) -> bool:
        """Whether a behavior can help a robot here that makes no progress."""
        return behavior.helps(self._context(now))

    def start(self, behavior: Behavior, reason: str, now: Now, *, recovery: bool) -> Twist2D | None:
        """Start a behavior, and return its first command; None if it has ended already."""
        self._behavior, self._reason, self._recovery = behavior, reason, recovery
        self._begin_s = self._now_s = now.time
        self._held_since = None
        try:
            behavior.start(self._context(now))
        except BehaviorFailedError as error:
            self._end("failed", str(error))
            return None
        return self.step(now)

    def step(self, now: Now) -> Twist2D | None:
        """The command for the next control period; None if the behavior ends now."""
        behavior = self._behavior
        if behavior is None:
            return None
        self._now_s = now.time
        if now.time - self._begin_s > behavior.time_allowance:
            return self._end("failed", f"it took longer than {behavior.time_allowance:.1f} s")
        if self._held_since is not None and not self._recovery and now.time - self._held_since > _HELD_S:
            where = f"({now.pose.x:.2f}, {now.pose.y:.2f})"
            return self._end("failed", f"stopped at {where} by the collision monitor: it would touch something")
        try:
            wish = behavior.update(self._context(now))
        except BehaviorFailedError as error:
            return self._end("failed", str(error))
        if wish is None:
            return self._end("succeeded", "")
        check_kind(wish, Twist2D, f"the command of behavior {behavior.name!r}", "return Twist2D(v, w), or None")
        command = self._check.slow_down(self._robot.limits.clamp(wish), now, self._replanner.followed)
        if not self._check.can_stop(command, now):
            return self._end("failed", f"blocked at ({now.pose.x:.2f}, {now.pose.y:.2f}): it would touch something")
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

    def _end(self, result: BehaviorResult, message: str) -> None:
        self._runs.append(self._describe(result, message))
        self._behavior = None

    def _describe(self, result: BehaviorResult, message: str) -> BehaviorRun:
        name = "" if self._behavior is None else self._behavior.name
        return BehaviorRun(name, self._reason, result, message, self._begin_s, self._now_s, self._recovery)

    def _context(self, now: Now) -> BehaviorContext:
        def replan(planner: Planner | None) -> None:
            if self._drive.target is None:
                raise BehaviorFailedError("there is no goal to plan to")
            if not self._replanner.replan(now, planner):
                raise BehaviorFailedError(str(self._drive.error))

        return BehaviorContext(
            time=now.time,
            pose=now.pose,
            twist=now.twist,
            costmap=now.costmap,
            dt=self._dt,
            robot=self._robot,
            sees=self._sensed.is_active,
            clear_costmap=self._clear_costmap,
            replan=replan,
        )

    def _clear_costmap(self) -> None:
        self._sensed.reset()
