"""`RobotStack`: the software of one robot in a run, from what it observes to what is sent to its wheels."""

from __future__ import annotations

import time as clock
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol, runtime_checkable

from trundle.control import CollisionMonitor, Intent
from trundle.control.latency import Latency
from trundle.errors import InputError
from trundle.fault import check_result
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.localization import Localizer
from trundle.localization.localizer import check_covariance, makes_map
from trundle.maps import OccupancyGrid
from trundle.mission.fields import StartError
from trundle.mission.observers import MonitorReport
from trundle.mission.own_map import MapKeeper, MapTrack, OwnMap
from trundle.mission.running.run_log import RunLog
from trundle.navigation import Agent, AgentReport, AssistedCommand
from trundle.observation import Estimate, Observation, Scan
from trundle.registry import name_of
from trundle.robots import Robot
from trundle.sim import RobotState


class SomeMonitor(Protocol):
    """The least that an object needs to be used as a monitor."""

    def reset(self) -> None:
        """Forget all scans, at the start of a run."""
        ...

    def check(
        self, command: Twist2D, twist: Twist2D, scans: Sequence[Scan], time: float, odometry: Pose2D
    ) -> MonitorReport:
        """Return what to send instead of a command."""
        ...


@runtime_checkable
class Monitor(SomeMonitor, Protocol):
    """Checks every command before it is sent; `trundle.control.CollisionMonitor` is one.

    `reset` and `check` are all that a monitor must have; one of another package gets the other methods from here.
    """

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late scans and commands arrive. By default it does not."""

    def set_intent(self, intent: Intent | None) -> None:
        """Set what the agent means to command next, or None, before each check. By default it is ignored."""


class MonitorAdapter(Monitor):
    """Gives a monitor of another package the methods that it does not have.

    Args:
        monitor: The monitor.
    """

    def __init__(self, monitor: SomeMonitor) -> None:
        self.reset, self.check = monitor.reset, monitor.check
        for name in ("set_latency", "set_intent"):
            if callable(own := getattr(monitor, name, None)):
                setattr(self, name, own)


_AT_ODOM_ORIGIN = Pose2D(0.0, 0.0)
"""T_map_odom of a robot that knows its true pose."""


class RobotStack:
    """What runs on one robot: a localizer, an agent, a collision monitor, and the log of what came of it.

    A session calls, in every control period, `command` or `assist`, then `check`, and after the simulator has moved the
    robot `observe`. Nothing here knows the truth, but for a robot without a localizer, whose estimate it is.

    Args:
        agent: What drives.
        robot: What its software takes the robot for.
        localizer: What estimates the pose; None means that the agent gets the true one.
        monitor: What every command passes: a monitor; True for a `CollisionMonitor` from the start, None for one from
            the first scan on, and False for none.
        latency: How late scans and commands arrive.
        log: The rows and the contacts of the run.
        start_error: How far the start that the localizer is told is from the true one; None means not at all.

    Attributes:
        agent: The agent.
        robot: The robot.
        log: The log.
        observation: What the robot observed last.
        estimate: Where it believes to be.
        report: What the agent said of itself last.
        monitored: What the monitor made of the last command; None without a monitor.
        wants_rollouts: Whether its reports are to have the best samples of its controller.
        tick_s: Wall time that the agent took for its last command [s]; 0 while the robot is driven by hand.
        planning_s: Wall time that it planned for that [s]; at first, for the plans before the run.
    """

    def __init__(
        self,
        agent: Agent,
        robot: Robot,
        *,
        localizer: Localizer | None,
        monitor: SomeMonitor | bool | None,
        latency: Latency,
        log: RunLog,
        start_error: StartError | None = None,
    ) -> None:
        self.agent, self.robot, self.log = agent, robot, log
        self.observation: Observation
        self.estimate: Estimate
        self.report: AgentReport
        self.monitored: MonitorReport | None = None
        self.wants_rollouts = True
        self.tick_s = self.planning_s = 0.0
        self._localizer, self._latency, self._seed = localizer, latency, 0
        self._keeper = None if localizer is None else MapKeeper(localizer)
        if start_error is not None and localizer is None:
            raise InputError("start_error is what a localizer is told of the start: give a localizer")
        self._start_error = StartError() if start_error is None else start_error
        self._delay = ScanDelay(latency.scan_age_s) if latency.scan_age_s > 0.0 else None
        self._monitor: Monitor | None = None
        self._monitors_scans = monitor is None
        if monitor is True:
            self._use_monitor(CollisionMonitor(robot))
        elif not isinstance(monitor, bool | None):
            self._use_monitor(monitor if isinstance(monitor, Monitor) else MonitorAdapter(monitor))

    def _use_monitor(self, monitor: Monitor) -> None:
        self._monitor, self._monitors_scans = monitor, False
        monitor.set_latency(self._latency)

    # A run ----------------------------------------------------------------------------------------------------------

    def check_goals(self, goals: Sequence[Goal]) -> None:
        """Check that the robot can know where goals lie.

        Raises:
            InputError: If its localizer makes the map, and is not told the start: then its map begins at (0, 0, 0).
        """
        if goals and self._start_error.unknown and self._localizer is not None and makes_map(self._localizer):
            raise InputError(
                f"goals need a known start with the localizer {name_of(self._localizer)!r}: it makes its map, whose "
                "frame is that of the start; leave out the goals, or start_error: unknown"
            )

    def reset(self, start: Pose2D, *, seed: int) -> None:
        """Begin a run at this start; the agent has begun it already, as it has planned."""
        self._seed = seed
        if self._monitor is not None:
            self._monitor.reset()
        if self._localizer is not None:
            told, covariance = self._start_error.draw(start, seed)
            self._localizer.reset(told, covariance=covariance, seed=seed)
        if self._keeper is not None:
            self._keeper.reset()

    def observe(self, state: RobotState) -> None:
        """Receive the part of the observation that has arrived by now, and estimate where the robot is."""
        observation = state.observation
        if self._delay is not None:
            observation = replace(observation, scans=self._delay.deliver(state.time, observation.scans))
        self.observation = observation
        if self._localizer is None:
            self.estimate = Estimate(state.time, state.pose, None, _AT_ODOM_ORIGIN)
        else:
            self.estimate = self._locate(self._localizer)
            self._take_map()

    def command(self, observation: Observation) -> object:
        """Ask the agent for its next command, and for its report; the command may be none: see `check_command`.

        Args:
            observation: What the robot observed last, or that without the scans that the agent has already.
        """
        planned_s, began = self.report.planning_time_s, clock.perf_counter()
        command = self.agent.update(observation, self.estimate)
        self.tick_s = clock.perf_counter() - began
        self.ask_report()
        self.planning_s = self.report.planning_time_s - planned_s
        return command

    def assist(self, command: Twist2D) -> AssistedCommand:
        """Ask the agent what of a command by hand may be sent."""
        self.tick_s = self.planning_s = 0.0
        assisted = self.agent.assist_teleop(command, self.observation, self.estimate)
        self.ask_report()
        return assisted

    def ask_report(self) -> None:
        """Ask the agent what it is doing, after every command and after whatever else it was told."""
        self.report = self.agent.report(rollouts=self.wants_rollouts)

    def check(self, command: Twist2D, *, by_hand: bool) -> Twist2D:
        """Pass a command through the monitor, and tell the agent what is sent where that is something else.

        Args:
            command: The command.
            by_hand: Whether it is not the agent's: then what the agent means to command next does not count.
        """
        seen = self.observation
        if self._monitors_scans and seen.scans:
            self._use_monitor(CollisionMonitor(self.robot))
        if self._monitor is None:
            return command
        self._monitor.set_intent(None if by_hand else self.report.intent)
        self.monitored = report = self._monitor.check(command, seen.twist, seen.scans, seen.time, seen.odometry)
        self.log.add_report(report)
        if report.command != command:
            self.agent.set_sent_command(report.command)
        return report.command

    # Where it is ----------------------------------------------------------------------------------------------------

    @property
    def believed(self) -> Pose2D | None:
        """Where the localizer believes the robot to be; None without one."""
        return None if self._localizer is None else self.estimate.pose

    def relocate(self, pose: Pose2D, covariance: Sequence[Sequence[float]] | None = None) -> None:
        """Tell the localizer where the robot is; it estimates the pose again, by what was observed last.

        One that makes its map keeps that.

        Args:
            pose: Where it is.
            covariance: Covariance of (x, y, yaw) [m², rad²]; None where the pose is exact.

        Raises:
            InputError: If there is no localizer.
        """
        localizer = self._need_localizer()
        known = None if covariance is None else check_covariance(covariance, "the pose")
        localizer.relocate(pose, covariance=known, seed=self._seed)
        self.estimate = self._locate(localizer)
        if self._keeper is not None:
            self._keeper.take_told(self.estimate)

    def reinitialize_global(self) -> None:
        """Tell the localizer that the robot may be anywhere; its next estimate says what it makes of that.

        Raises:
            InputError: If there is no localizer, or it cannot find a pose by itself.
        """
        self._need_localizer().reinitialize_global()

    def _need_localizer(self) -> Localizer:
        if self._localizer is None:
            raise InputError("the robot knows its true pose: there is no localizer whose pose could be set")
        return self._localizer

    def move_to(self, state: RobotState) -> None:
        """Note that the robot was put elsewhere, at rest: it has no scans yet, and its localizer is not told."""
        self.observation = replace(self.observation, twist=state.twist, scans=())
        if self._localizer is None:
            self.estimate = Estimate(state.time, state.pose, None, _AT_ODOM_ORIGIN)

    # The map that it makes -------------------------------------------------------------------------------------------

    @property
    def map(self) -> OccupancyGrid | None:
        """The map that the localizer has made, as the agent got it last; None where it makes none."""
        return None if self._keeper is None else self._keeper.grid

    @property
    def map_track(self) -> MapTrack | None:
        """Poses and loops of that map; None where the localizer does not say."""
        return None if self._keeper is None else self._keeper.track

    def finish_map(self) -> OwnMap | None:
        """Let the localizer finish the map that it has made, and return it; None where it makes none."""
        return None if self._keeper is None else self._keeper.finish()

    def _take_map(self) -> None:
        keeper = self._keeper
        if keeper is None or (corrected := keeper.follow(self.estimate)) is None or keeper.grid is None:
            return
        self.agent.set_map(keeper.grid, corrected=corrected)

    def _locate(self, localizer: Localizer) -> Estimate:
        return check_result(localizer.update(self.observation), Estimate, localizer, "update")


class ScanDelay:
    """Holds scans back until they are of a certain age.

    Args:
        age_s: That age [s].
    """

    def __init__(self, age_s: float) -> None:
        self._age_s = age_s
        self._waiting: deque[Scan] = deque()

    def deliver(self, time: float, scans: Sequence[Scan]) -> tuple[Scan, ...]:
        """Take scans that were measured, and return those that arrive by now [s]."""
        self._waiting.extend(scans)
        arrived: list[Scan] = []
        while self._waiting and self._waiting[0].time + self._age_s <= time + 1e-9:
            arrived.append(self._waiting.popleft())
        return tuple(arrived)
