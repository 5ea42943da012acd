"""`Events`: what happened in a run, in words."""

from __future__ import annotations

from typing import Any

from trundle.mission.episode import Episode
from trundle.mission.observers import RunInfo, SteeringReport, Step
from trundle.navigation.behaviors import BehaviorRun
from trundle.page.rows import goal_of
from trundle.path import Path

KINDS = ("start", "plan", "replan", "blocked", "recovery", "monitor", "contact", "goal", "steer", "end")
"""Kinds of events."""

_QUIET_S = 1.0
"""The collision monitor's actions may change at every step: it is reported again only after this time."""


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
        self._steered: SteeringReport | None = None

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
            of = f" of {self._goals}" if self._goals > 1 else ""
            self.note(time, "goal", f"goal {step.goal}{of} reached")
            self._goal, self._planned = step.goal, False
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

    def end(self, episode: Episode) -> None:
        """Add the end of a run."""
        outcome = episode.outcome.value.replace("_", " ")
        self.note(float(episode.trajectory.time[-1]), "end", f"{outcome}: {episode.message}")

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
