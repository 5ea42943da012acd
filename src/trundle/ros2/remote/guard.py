"""`Guard`: why the robot must stand now. Nothing here is trundle's own, so nothing is taken for granted.

`OutlineCheck` compares the outline in the robot's file with the wheels of the robot that is there.
"""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from trundle.control import CollisionMonitor, Intent
from trundle.control.collision_monitor import MonitorReport
from trundle.control.latency import Latency
from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.ros2.remote.frames import FrameTree

STAND = Twist2D()

HOLD_S = 1.0
"""After a jump the robot stands so long [s of real time]: the localizer sees new scans before it drives on."""

Reasons = dict[str, str]
"""Why the robot must stand: the kind of each reason, and its text."""


@dataclass(frozen=True, slots=True)
class _Hold:
    text: str
    until: float


class Guard:
    """Collects the reasons for which the robot must stand, and counts them.

    Rules are functions that give the reasons of now; events, such as a jump, hold the robot for some time.

    Args:
        warn: Counts a reason, and reports the first of each kind.

    Attributes:
        reasons: What holds the robot now.
        counts: How often each kind began to hold it.
    """

    def __init__(self, warn: Callable[[str, str], None]) -> None:
        self._warn = warn
        self._rules: list[Callable[[float], Reasons]] = []
        self._holds: dict[str, _Hold] = {}
        self._lock = threading.Lock()
        self.reasons: Reasons = {"not begun": "nothing was looked at yet"}
        self.counts: Counter[str] = Counter()

    def add_rule(self, rule: Callable[[float], Reasons]) -> None:
        """Ask this rule, with the real time [s], in every control period."""
        self._rules.append(rule)

    def hold(self, kind: str, text: str, now: float, *, for_s: float = HOLD_S) -> None:
        """Let the robot stand from now on for some real time [s]; any thread may call it."""
        with self._lock:
            self._holds[kind] = _Hold(text, now + for_s)

    def look(self, now: float) -> Reasons:
        """Return the reasons at a real time [s]; those that are new are counted, and reported."""
        ruled: Reasons = {}
        for rule in self._rules:
            ruled |= rule(now)
        with self._lock:
            self._holds = {kind: hold for kind, hold in self._holds.items() if hold.until > now}
            found = {
                kind: hold.text for kind, hold in self._holds.items()
            } | ruled  # first: what rules find may come of them
        before, self.reasons = self.reasons, found
        for kind in found.keys() - before.keys():
            self.counts[kind] += 1
            self._warn(f"stands: {kind}", f"the robot stands: {found[kind]}")
        return found


class GuardedMonitor:
    """The monitor of a robot that is somewhere else: first the guard, then the collision monitor.

    Args:
        guard: Says why the robot must stand.
        monitor: The collision monitor; None where the robot has no lidars, or it is off.
        real: Real time [s].
    """

    def __init__(self, guard: Guard, monitor: CollisionMonitor | None, real: Callable[[], float]) -> None:
        self._guard, self._monitor, self._real = guard, monitor, real

    def reset(self) -> None:
        """Forget all scans."""
        if self._monitor is not None:
            self._monitor.reset()

    def set_latency(self, latency: Latency) -> None:
        """Take into account how late commands arrive."""
        if self._monitor is not None:
            self._monitor.set_latency(latency)

    def set_intent(self, intent: Intent | None) -> None:
        """Set what the agent means to command next."""
        if self._monitor is not None:
            self._monitor.set_intent(intent)

    def check(
        self, command: Twist2D, twist: Twist2D, scans: Sequence[Scan], time: float, odometry: Pose2D
    ) -> MonitorReport:
        """Return what to send instead of a command: nothing moves while the guard has a reason."""
        monitor = self._monitor
        report = MonitorReport(command) if monitor is None else monitor.check(command, twist, scans, time, odometry)
        reasons = self._guard.look(self._real())
        if not reasons:
            return report
        return MonitorReport(STAND, "stop" if command != STAND else "none", next(iter(reasons.values())))


OUTSIDE_M = 0.05
"""Middles of wheels that are farther than this outside of the outline [m] are those of a larger robot."""

_WHEEL = "wheel"


class OutlineCheck:
    """Lets a robot stand whose wheels, by tf, are outside of the outline that its file gives.

    Nothing else that robots usually send says how large they are: one that publishes no frames of its wheels is taken
    as its file has it.

    Args:
        frames: The transforms.
        base: Frame of the robot's base.
        robot: The robot, by its file.
    """

    def __init__(self, frames: FrameTree, base: str, robot: Robot) -> None:
        self._frames, self._base, self._robot = frames, base, robot
        self._seen = 0
        self._reasons: Reasons = {}

    def look(self) -> None:
        """Look at the frames if there are new ones; in the thread that has them."""
        if len(self._frames) == self._seen:
            return
        self._seen = len(self._frames)
        wheels = {name: at.pose for name, at in self._frames.below(self._base).items() if _WHEEL in name.lower()}
        out = {name: _outside(pose, self._robot) for name, pose in wheels.items()}
        name = max(out, key=lambda one: out[one], default="")
        if not name or out[name] <= OUTSIDE_M:
            self._reasons = {}
            return
        x, y, _ = wheels[name].as_tuple()
        self._reasons = {
            "outline": f"by tf {name} is at ({x:.2f}, {y:.2f}), outside of the outline of {self._robot.name}: give the "
            "file of the robot that is there with --robot"
        }

    def rule(self, now: float) -> Reasons:
        """Return what was found; a rule of the guard."""
        return self._reasons


def _outside(pose: Pose2D, robot: Robot) -> float:
    """Return how far a point is outside of the outline, which is convex and counter-clockwise [m]."""
    corners = np.asarray(robot.outline, dtype=np.float64)
    sides = np.roll(corners, -1, axis=0) - corners
    outward = np.column_stack([sides[:, 1], -sides[:, 0]]) / np.linalg.norm(sides, axis=1)[:, None]
    return float(((np.array((pose.x, pose.y)) - corners) * outward).sum(axis=1).max())
