"""`Monitor`: what checks every command of a run before it is sent."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from trundle.geometry import Pose2D, Twist2D
from trundle.mission.observers import MonitorReport
from trundle.observation import Scan


class Monitor(Protocol):
    """Checks every command before it is sent; `trundle.control.CollisionMonitor` is one."""

    def reset(self) -> None:
        """Forget all scans, at the start of a run."""
        ...

    def check(
        self, command: Twist2D, twist: Twist2D, scans: Sequence[Scan], time: float, odometry: Pose2D
    ) -> MonitorReport:
        """Say what to send instead of a command."""
        ...
