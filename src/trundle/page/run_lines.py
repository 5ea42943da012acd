"""`RunLines`: the log of a run for the page: rows of `COLUMNS`, paths and events, which are only added to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.mission.episode import Episode
from trundle.mission.metrics import CLEARANCE_CAP
from trundle.mission.observers import RunInfo, SteeringReport, Step
from trundle.mission.own_map import Correction, describe_correction
from trundle.navigation import NavigationStatus
from trundle.navigation.behaviors import BehaviorRun
from trundle.observation import LocalizationState, describe_state
from trundle.page.encoding import finite, pack_array, rounded
from trundle.path import Path
from trundle.sim.clearance import map_world

COLUMNS = (
    "t",
    "x",
    "y",
    "yaw",
    "v",
    "w",
    "cmd_v",
    "cmd_w",
    "sent_v",
    "sent_w",
    "clearance",
    "cross_track",
    "goal",
    "status",
    "tick_ms",
    "plan_ms",
    "left",
    "right",
    "ex",
    "ey",
    "eyaw",
    "state",
)
"""What a row holds: time [s], true pose, measured, commanded and sent twist, clearance and distance to the path [m],
index of the goal, status, wall times [ms], angles of the drive wheels [rad], and of a localizer its estimated pose and
its state."""

_RESOLUTION_M = 0.05  # edge of the cells of the true map, on which clearances are measured
KINDS = ("start", "plan", "replan", "blocked", "recovery", "monitor", "contact", "goal", "locate", "steer", "end")
"""Kinds of events."""

_QUIET_S = 1.0
"""The collision monitor's actions may change at every step: it is reported again only after this time."""


def info_of(info: RunInfo) -> dict[str, Any]:
    """Return what the page shows of a run's start."""
    return {
        "name": info.name,
        "robot": info.robot.name,
        "planner": info.planner,
        "controller": info.controller,
        "seed": info.seed,
        "start": rounded(info.start.as_tuple()),
        "goals": [goal_of(goal) for goal in info.goals],
        "dt": info.dt,
        "time_limit_s": finite(info.time_limit_s),
        "localizer": info.localizer,
    }


def goal_of(goal: Sequence[float]) -> list[float | None]:
    """Return a goal as [x, y, yaw], with None for any yaw."""
    yaw = goal[2] if len(goal) > 2 else None
    return [round(float(goal[0]), 4), round(float(goal[1]), 4), finite(yaw)]


def row_of(step: Step, *, clearance: float | None = None, cross_track: float | None = None) -> list[Any]:
    """Return a step as a row of `COLUMNS`.

    Args:
        step: The step.
        clearance: Distance [m] from the footprint to the nearest solid; None if it is not known.
        cross_track: Distance [m] from base_link to the path that is followed; None without a path.
    """
    state, sent = step.state, step.sent
    pose, twist = state.pose, state.twist if state.odometry_twist is None else state.odometry_twist
    believed: tuple[Any, ...] = (None, None, None, None)
    if step.estimate is not None and step.estimate.pose is not pose:
        believed = (*rounded(step.estimate.pose.as_tuple()), step.estimate.state)
    return [
        *rounded((state.time, pose.x, pose.y, pose.yaw, twist.v, twist.w)),
        *rounded((step.command.v, step.command.w, sent.v, sent.w)),
        finite(clearance),
        finite(cross_track),
        step.goal,
        step.status.value,
        round(1e3 * step.tick_s, 3),
        round(1e3 * step.planning_s, 3),
        *rounded(state.wheel_positions, 3),
        *believed,
    ]


class RunLines:
    """Collects the log of a run, step by step, to be sent as it grows.

    Args:
        info: The start of the run.

    Attributes:
        info: What `info_of` says of it.
        rows: One of `COLUMNS` for each step.
        paths: {"t", "points"} for each path that was followed from then on; the points are an array (N, 2) [m].
        events: {"t", "kind", "text"}.
    """

    def __init__(self, info: RunInfo) -> None:
        self.info = info_of(info)
        self.rows: list[list[Any]] = []
        self.paths: list[dict[str, Any]] = []
        self._events = Events()
        self._events.start(info)
        self._room = _Room(info)
        self._path: Path | None = None
        self._line: _Line | None = None

    @property
    def events(self) -> list[dict[str, Any]]:
        """The events so far."""
        return self._events.found

    def note(self, time: float, kind: str, text: str) -> None:
        """Add an event from outside, such as who took over the driving."""
        self._events.note(time, kind, text)

    def add(self, step: Step) -> None:
        """Add a step."""
        state = step.state
        if step.path is not self._path:
            self._path, self._line = step.path, None if step.path is None else _Line(step.path)
            if step.path is not None:
                self.paths.append(path_of(step.path, state.time))
        clearance = 0.0 if state.contacts else self._room.around(state.pose)
        off = None if self._line is None else self._line.distance(state.pose.x, state.pose.y)
        self.rows.append(row_of(step, clearance=clearance, cross_track=off))
        self._events.add(step)

    def end(self, episode: Episode) -> None:
        """Add the end."""
        self._events.end(episode)


def path_of(path: Path, time: float) -> dict[str, Any]:
    """Return a path that is followed from a time [s] on."""
    return {"t": round(time, 4), "points": pack_array(path.poses[:, :2], "f4")}


class _Room:
    """Distance from the footprint to solids, to within a cell, on the world's true map or else the first costmap."""

    def __init__(self, info: RunInfo) -> None:
        self._map: Costmap | None = info.costmap
        if info.world is not None:
            points = np.array([(end.x, end.y) for end in (info.start, *info.goals)])
            resolution = _RESOLUTION_M if info.costmap is None else info.costmap.resolution
            margin = CLEARANCE_CAP + info.robot.circumscribed_radius
            self._map = map_world(info.world, info.robot, points, resolution=resolution, margin=margin)

    def around(self, pose: Pose2D) -> float | None:
        """Return the clearance [m] at a pose, at most 2 m, or None if nothing is known."""
        if self._map is None:
            return None
        return float(self._map.clearance(np.array([pose.as_tuple()]), CLEARANCE_CAP)[0])


class _Line:
    """A path as a polyline of complex numbers, for distances from it."""

    def __init__(self, path: Path) -> None:
        corners = path.poses[:, 0] + 1j * path.poses[:, 1]
        self._starts = corners[:-1] if len(corners) > 1 else corners
        self._along = np.diff(corners) if len(corners) > 1 else np.zeros(1, dtype=np.complex128)
        squared = np.abs(self._along) ** 2
        self._share = np.conj(self._along) / np.where(squared > 0.0, squared, 1.0)

    def distance(self, x: float, y: float) -> float:
        """Return the distance [m] from a point."""
        offsets = complex(x, y) - self._starts
        shares = (offsets * self._share).real.clip(0.0, 1.0)
        return float(np.abs(offsets - shares * self._along).min())


class Events:
    """Turns the steps of a run into events: {"t", "kind", "text"}.

    Attributes:
        found: The events so far, in order; only added to.
    """

    def __init__(self) -> None:
        self.found: list[dict[str, Any]] = []
        self._path: Path | None = None
        self._goal = 0
        self._goals = 0
        self._message = ""
        self._touching: frozenset[str] = frozenset()
        self._action = "none"
        self._action_at = -_QUIET_S
        self._behaviors = 0
        self._running = False
        self._planned = False
        self._stands_at_goal = False
        self._steered: SteeringReport | None = None
        self._localized: LocalizationState = "localized"
        self._corrections: tuple[Correction, ...] = ()

    def note(self, time: float, kind: str, text: str) -> None:
        """Add an event of `KINDS`."""
        self.found.append({"t": round(time, 4), "kind": kind, "text": text})

    def start(self, info: RunInfo) -> None:
        """Add the start of a run."""
        goals = ", ".join(_place(goal.x, goal.y) for goal in info.goals)
        self._goals = len(info.goals)
        self.note(
            0.0, "start", f"{info.robot.name} at {_place(info.start.x, info.start.y)}" + f", goal {goals}" * bool(goals)
        )

    def add(self, step: Step) -> None:
        """Add what is new at a step."""
        time = step.state.time
        if step.goal != self._goal:
            if not self._stands_at_goal:
                self.note(time, "goal", f"goal {step.goal}{self._of_all} reached")
            self._goal, self._planned = step.goal, False
        self._add_arrival(step.status is NavigationStatus.ARRIVED, time)
        if step.path is not None and step.path is not self._path:
            what = "another path" if self._planned else "path"
            self.note(time, "replan" if self._planned else "plan", f"{what} of {step.path.length:.2f} m")
            self._path, self._planned = step.path, True
        self._add_behaviors(step.behaviors, time)
        self._add_message(step.message, time)
        self._add_contacts(step, time)
        if step.monitor is not None:
            self._add_action(step.monitor.action, time)
        if step.steering is not None:
            self._add_steering(step.steering, time)
        if step.estimate is not None and step.estimate.state != self._localized:
            self._localized = step.estimate.state
            self.note(time, "locate", describe_state(step.estimate))
        if step.map_track is not None:
            self._add_corrections(step.map_track.corrections, time)

    def end(self, episode: Episode) -> None:
        """Add the end of a run."""
        outcome = episode.outcome.value.replace("_", " ")
        self.note(float(episode.trajectory.time[-1]), "end", f"{outcome}: {episode.message}")

    @property
    def _of_all(self) -> str:
        return f" of {self._goals}" if self._goals > 1 else ""

    def _add_arrival(self, arrived: bool, time: float) -> None:
        """Add that the robot has arrived in a run that goes on, which says so in no other way."""
        if arrived and not self._stands_at_goal:
            self.note(time, "goal", f"goal {self._goal + 1}{self._of_all} reached")
        self._stands_at_goal = arrived

    def _add_steering(self, steering: SteeringReport, time: float) -> None:
        """Add new goals, with all that there are now, and when driving by hand begins, ends or is held back."""
        if self._steered is not None and steering.goals != self._steered.goals:
            goals = ", ".join(_place(goal.x, goal.y) for goal in steering.goals[self._goal :])
            self.note(time, "goal", f"goal set: {goals}" if goals else "no goal")
            self.found[-1]["goals"] = [goal_of(goal) for goal in steering.goals]
            self._goals = len(steering.goals)
        before = self._steered
        if (steering.manual is None) != (before is None or before.manual is None):
            self.note(
                time, "steer", "driven by hand" if steering.manual is not None else "driven by the navigator again"
            )
        if steering.held_back and (before is None or steering.held_back != before.held_back):
            self.note(time, "steer", f"held back: {steering.held_back}")
        self._steered = steering

    def _add_behaviors(self, behaviors: tuple[BehaviorRun, ...], time: float) -> None:
        if (
            self._running
            and len(behaviors) >= self._behaviors
            and (ran := behaviors[self._behaviors - 1]).result != "running"
        ):
            self._running = False
            self.note(time, "recovery", f"{ran.behavior} {ran.result}" + f": {ran.message}" * bool(ran.message))
        for ran in behaviors[self._behaviors :]:
            self.note(time, "recovery", f"{ran.behavior}: {ran.reason}")
            self._running = ran.result == "running"
        self._behaviors = len(behaviors)

    def _add_corrections(self, corrections: tuple[Correction, ...], time: float) -> None:
        """Add those of the largest corrections that are new."""
        if corrections is not self._corrections:
            for one in corrections:
                if one not in self._corrections:
                    self.note(time, "locate", f"the estimate was corrected by {describe_correction(one)}")
            self._corrections = corrections

    def _add_message(self, message: str, time: float) -> None:
        said = message.partition(" at (")[0]
        if said and said != self._message:
            self.note(time, "blocked", message)
        self._message = said

    def _add_contacts(self, step: Step, time: float) -> None:
        contacts = step.state.contacts
        if not contacts and not self._touching:
            return
        for contact in contacts:
            if contact.other not in self._touching:
                self._touching |= {contact.other}
                self.note(time, "contact", f"{contact.part} touches {contact.other} at {_place(contact.x, contact.y)}")
        self._touching = frozenset(contact.other for contact in contacts)

    def _add_action(self, action: str, time: float) -> None:
        changed = action != self._action
        self._action = action
        if changed and action != "none" and time - self._action_at >= _QUIET_S:
            self._action_at = time
            done = "stops the robot" if action == "stop" else "slows the robot"
            self.note(time, "monitor", f"the collision monitor {done}")


def _place(x: float, y: float) -> str:
    return f"({x:.2f}, {y:.2f})"
