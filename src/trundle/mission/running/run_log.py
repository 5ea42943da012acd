"""`RunLog`: the rows, paths and contacts of a run in progress; `AgentTotals`: what its agent counts."""

from __future__ import annotations

import math
from collections import Counter, deque
from collections.abc import Sequence

import numpy as np

from trundle.geometry import Pose2D, Twist2D
from trundle.mission.observers import MonitorReport
from trundle.mission.trajectory import Trajectory
from trundle.navigation import AgentReport
from trundle.observation import LOCALIZATION_STATES, Estimate
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim import Contact, RobotState
from trundle.sim.lidar import unseen_names
from trundle.worlds import World

_STANDING_V = 0.05
_STANDING_W = 0.05
"""A robot whose speeds [m/s, rad/s] are below these stands."""
_PUSH_S = 0.5
"""A robot that something has run into is touched again for so long [s], and for as long as it does not move as told."""
_SETTLE_S = 3.0
"""So long after that [s] it may slide or tip back while it stands, and touch something."""
_SAME_PLACE_M = 0.05
"""A robot that was pushed against something, and is still within this of there, goes on touching it."""


_STAND = Twist2D()
_PATH = Trajectory.columns().index("path")


class RunLog:
    """The rows, the paths and the contacts of a run in progress.

    Args:
        every_contact: Count moving obstacles that run into the standing robot as collisions, too.
        most_rows: How many rows are kept, the last ones, with their paths; none keeps all.

    Attributes:
        paths: Every path that was followed, in order.
        hit: A contact of the last row that counts as a collision, or none.
        contacts: Names of what the robot touched, in order of first touch.
        standing_contacts: Names of moving obstacles that ran into the robot while it stood, and of what they pushed it
            against while its commands were to stand.
        monitor_stops: How often the collision monitor stopped the robot; None if it never reported.
        forgotten_m: How far the robot was driven in the rows that are not kept [m].
        lost_s: Time [s] of the control periods after which the localizer did not say that it is localized.
    """

    def __init__(self, *, every_contact: bool = False, most_rows: int | None = None) -> None:
        self._every_contact = every_contact
        self.paths: list[Path] = []
        self.hit: Contact | None = None
        self.contacts: dict[str, None] = {}
        self.standing_contacts: dict[str, None] = {}
        self.monitor_stops: int | None = None
        self.lost_s = 0.0
        self.forgotten_m = 0.0
        self._rows: deque[tuple[float, ...]] = deque()
        self._most_rows = most_rows
        self._count = 0
        self._forgotten_paths = 0
        self._touching: frozenset[str] = frozenset()
        self._spared: frozenset[str] = frozenset()
        self._pushed_at = -math.inf
        self._is_pushed = False
        self._spared_at: dict[str, tuple[float, Pose2D]] = {}
        self._twist = _STAND
        self._lidars: set[str] = set()
        self._stopped = False
        self._time = 0.0
        self._given: Trajectory | None = None

    @classmethod
    def of(cls, trajectory: Trajectory, paths: Sequence[Path]) -> RunLog:
        """Return the log of a run without contacts that was driven as a whole."""
        log = cls()
        log._given, log._count, log.paths = trajectory, len(trajectory), list(paths)
        return log

    def __len__(self) -> int:
        """Return how many rows were added."""
        return self._count

    def add(self, state: RobotState, sent: Twist2D, estimate: Estimate, goal: int, path: Path | None) -> None:
        """Add the state at the end of a control period, with what was sent to the robot during it."""
        if path is not None and (not self.paths or path is not self.paths[-1]):
            self.paths.append(path)
        self._count += 1
        if estimate.state != "localized":
            self.lost_s += state.time - self._time
        self._time = state.time
        if self._most_rows is not None and self._count % self._most_rows == 0:
            self._forget_paths()
        pose = state.pose.as_tuple()
        self._rows.append(
            (
                state.time,
                *pose,
                state.twist.v,
                state.twist.w,
                sent.v,
                sent.w,
                *state.odometry.as_tuple(),
                goal,
                self._forgotten_paths + len(self.paths) - 1 if path is not None else -1,
                *(pose if estimate.pose is state.pose else estimate.pose.as_tuple()),
                LOCALIZATION_STATES.index(estimate.state),
            )
        )
        if self._most_rows is not None and len(self._rows) > self._most_rows:
            (_, x, y, *_), (_, next_x, next_y, *_) = self._rows.popleft(), self._rows[0]
            self.forgotten_m += math.hypot(next_x - x, next_y - y)
        if state.contacts or self._touching:
            self._note_contacts(state, sent)
        if not state.contacts and _stands(Twist2D(state.twist.v - sent.v, state.twist.w - sent.w)):
            self._is_pushed = False
        if state.scans:
            self._lidars.update(scan.lidar for scan in state.scans)
        self._twist = state.twist

    def add_report(self, report: MonitorReport) -> None:
        """Count what a collision monitor did."""
        stops = report.action == "stop"
        self.monitor_stops = (self.monitor_stops or 0) + (stops and not self._stopped)
        self._stopped = stops

    def trajectory(self) -> Trajectory:
        """Return the rows."""
        if self._given is not None:
            return self._given
        columns = dict(zip(Trajectory.columns(), map(np.array, zip(*self._rows, strict=True)), strict=True))
        columns["path"] = np.where(columns["path"] < 0, -1, columns["path"] - self._forgotten_paths)
        return Trajectory(**columns)

    def _forget_paths(self) -> None:
        """Forget the paths that no row follows any more, but for the last one."""
        followed = [int(row[_PATH]) for row in self._rows if row[_PATH] >= 0]
        last = self._forgotten_paths + len(self.paths) - 1
        first = min(followed, default=last)
        if first > self._forgotten_paths:
            del self.paths[: first - self._forgotten_paths]
            self._forgotten_paths = first

    def unseen_contacts(self, world: World | None, robot: Robot) -> tuple[str, ...]:
        """Return names of what was touched and is not crossed by the plane of any lidar that sent a scan."""
        touched = [*self.contacts, *(name for name in self.standing_contacts if name not in self.contacts)]
        lidars = self._lidars.intersection(robot.lidars)
        if not touched or not lidars or world is None:
            return ()
        unseen = unseen_names(world, robot, lidars)
        return tuple(name for name in touched if name in unseen)

    def _note_contacts(self, state: RobotState, sent: Twist2D) -> None:
        names = frozenset(contact.other for contact in state.contacts)
        # How it moved when the touch began: a collision itself stops the robot, or a mover pushes it.
        stood = _stands(self._twist)
        spared = {name for name in names & self._touching if name in self._spared}
        new = names - self._touching
        movers = {mover.name for mover in state.movers}
        spared |= {name for name in new if stood and name in movers}
        # A touch that broke off for a moment is the same touch.
        spared |= {name for name in new if self._touches_again(name, state, stood=stood)}
        # What pushes the robot may press it against something in the same period.
        since_s = state.time - self._pushed_at
        is_pushed = self._is_pushed or since_s <= _PUSH_S or (stood and sent == _STAND and since_s <= _SETTLE_S)
        if (stood or _stands(sent)) and (spared & movers or is_pushed):
            spared |= new
        self._spared = frozenset() if self._every_contact else frozenset(spared)
        if self._spared:
            self._pushed_at, self._is_pushed = state.time, True
            self._spared_at.update(dict.fromkeys(self._spared, (state.time, state.pose)))
        self._touching = names
        self.hit = None
        for contact in state.contacts:
            if contact.other in self._spared:
                self.standing_contacts.setdefault(contact.other)
            else:
                self.contacts.setdefault(contact.other)
                self.hit = self.hit or contact

    def _touches_again(self, name: str, state: RobotState, *, stood: bool) -> bool:
        """Return whether the robot touches what it was pushed against, and has hardly moved since."""
        if name not in self._spared_at:
            return False
        time, pose = self._spared_at[name]
        moved = math.hypot(state.pose.x - pose.x, state.pose.y - pose.y)
        return state.time - time <= _PUSH_S or (stood and moved <= _SAME_PLACE_M)


def _stands(twist: Twist2D) -> bool:
    return abs(twist.v) < _STANDING_V and abs(twist.w) < _STANDING_W


class AgentTotals:
    """What an agent counts for each goal, summed over a run.

    Attributes:
        planning_s: Wall time spent on planning [s].
        replans: Plans beyond the first ones.
        standing_reasons: In how many control periods its controller made no progress, by reason.
    """

    def __init__(self) -> None:
        self.planning_s = 0.0
        self.replans = 0
        self.standing_reasons: Counter[str] = Counter()

    def add(self, report: AgentReport) -> None:
        """Add what an agent reports at the end of a goal: the next `set_goal` clears its counts."""
        self.planning_s += report.planning_time_s
        self.replans += report.replans
        self.standing_reasons.update(report.standing_reasons)
