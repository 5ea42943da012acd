"""`Gate`: passes every command of a run through its collision monitor."""

from __future__ import annotations

from trundle.control import CollisionMonitor
from trundle.control.latency import Latency
from trundle.geometry import Twist2D
from trundle.mission.observers import MonitorReport
from trundle.mission.running.monitoring import Monitor
from trundle.mission.running.scan_mail import report_latency
from trundle.navigation import Agent
from trundle.observation import Observation
from trundle.robots import Robot


class Gate:
    """Passes commands through a collision monitor, if there is one.

    Args:
        monitor: The monitor; True for a `CollisionMonitor` from the start, None for one from the first scan on, and
            False for none.
        robot: The robot.
        latency: How late scans and commands arrive, for the monitor.
    """

    def __init__(self, monitor: Monitor | bool | None, robot: Robot, latency: Latency) -> None:
        self._monitor = None if isinstance(monitor, bool) else monitor
        self._waits_for_scans = monitor is None
        self._robot, self._latency = robot, latency
        if monitor is True:
            self._monitor = CollisionMonitor(robot)
        report_latency(self._monitor, latency)

    def reset(self) -> None:
        """Begin a run."""
        if self._monitor is not None:
            self._monitor.reset()

    def check(self, command: Twist2D, seen: Observation, agent: Agent, *, by_hand: bool) -> MonitorReport | None:
        """What the monitor makes of a command, which the agent is told; None without a monitor.

        Args:
            command: The command.
            seen: What the robot observes.
            agent: Whose command it is; what it means to command next counts.
            by_hand: Whether the command is not the agent's, but given by hand.
        """
        if self._waits_for_scans and seen.scans:
            self._monitor, self._waits_for_scans = CollisionMonitor(self._robot), False
            report_latency(self._monitor, self._latency)
        if self._monitor is None:
            return None
        if callable(set_intent := getattr(self._monitor, "set_intent", None)):
            set_intent(None if by_hand else getattr(agent, "intent", None))
        report = self._monitor.check(command, seen.twist, seen.scans, seen.time, seen.odometry)
        if report.command != command and callable(report_sent := getattr(agent, "set_sent_command", None)):
            report_sent(report.command)
        return report
