"""`Monitor`: what checks every command of a run before it is sent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from trundle.control import Intent
from trundle.control.latency import Latency
from trundle.geometry import Pose2D, Twist2D
from trundle.mission.observers import MonitorReport
from trundle.observation import Scan


class SomeMonitor(Protocol):
    """The least that an object needs to be used as a monitor."""

    def reset(self) -> None:
        """Forget all scans, at the start of a run."""
        ...

    def check(
        self, command: Twist2D, twist: Twist2D, scans: Sequence[Scan], time: float, odometry: Pose2D
    ) -> MonitorReport:
        """Say what to send instead of a command."""
        ...


@runtime_checkable
class Monitor(SomeMonitor, Protocol):
    """Checks every command before it is sent; `trundle.control.CollisionMonitor` is one.

    `reset` and `check` are all that a monitor must have; one of another package gets the other methods from here.
    """

    def set_latency(self, latency: Latency) -> None:
        """Take into account from now on how late scans and commands arrive. By default it does not."""

    def set_intent(self, intent: Intent | None) -> None:
        """Take what the agent means to command next, or None, before each check. By default it does not count."""


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
