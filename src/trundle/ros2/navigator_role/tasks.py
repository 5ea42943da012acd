"""`Tasks`: what the network asked the robot to do, one drive and one behavior at a time, and their results."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

from trundle.errors import TrundleError
from trundle.geometry import Goal
from trundle.mission import Cancel, SetGoal, SetGoals, Step, TaskEnd
from trundle.mission.steering.directives import Directive
from trundle.ros2.actions import ActionGoal
from trundle.ros2.role import BridgeContext


class Report(Protocol):
    """What an action sends about a goal: its feedback, and the code and message of a failure."""

    def begin(self, time: float) -> None:
        """Take note that the robot has taken the goal up, at this time of the run [s]."""
        ...

    def feedback(self, step: Step) -> dict[str, Any] | None:
        """Return the fields of the feedback after a control period, or None to send nothing."""
        ...

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """Return the fields of the result of a goal that the run refused."""
        ...

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """Return the fields of the result of a goal that has ended, however it did."""
        ...


class Task:
    """A goal of an action that the robot works at; watches its directive.

    What the run says comes in the thread that drives; results are sent in the listening thread, after whatever the
    client has asked for.

    Args:
        goal: The goal.
        report: What is sent about it.
        later: Calls something in the listening thread.

    Attributes:
        goal: The goal.
        report: What is sent about it.
        later: Calls something in the listening thread.
        runs: Whether the run has taken it up.
        failed: Called where it has failed, or None.
        given: What gave it to the run, and who; None where it cannot be given again.
        is_carried: Whether it is given to the next run where this one ends.
    """

    def __init__(self, goal: ActionGoal, report: Report, later: Callable[[Callable[[], None]], None]) -> None:
        self.goal, self.report, self.later = goal, report, later
        self._lock = threading.Lock()
        self.runs = False
        self.failed: Callable[[], None] | None = None
        self.given: tuple[Directive, str] | None = None
        self.is_carried = False
        self._left: tuple[Goal, ...] = ()

    def again(self) -> tuple[Directive, str] | None:
        """Return what gives the goal to the next run, from where it has come to, and who; None where nothing does."""
        match self.given:
            case (SetGoals() as goals, by):
                return (replace(goals, goals=self._left or goals.goals), by)
            case (SetGoal(), _):
                return self.given
            case _:
                return None

    def begin(self, time: float) -> None:
        """Begin to report: the run has taken the goal up; see `TaskWatcher`."""
        self.report.begin(time)
        self.runs = True

    def refuse(self, error: TrundleError) -> None:
        """Send the result of a goal that the run has refused."""
        fields = self.report.refused(error)
        self.later(lambda: self._fail(fields))

    def end(self, end: TaskEnd) -> None:
        """Send the result of a goal that the run has ended, unless the next run goes on with it."""
        self.runs = False
        if self.is_carried and end.result == "stopped":
            return
        fields = self.report.ended(end)
        match end.result:
            case "succeeded":
                self.later(lambda: self.finish(self.goal.succeed, fields))
            case "cancelled":
                self.later(lambda: self.finish(self.cancelled, fields))
            case "failed":
                self.later(lambda: self._fail(fields))
            case _:
                self.later(lambda: self.finish(self.goal.abort, fields))

    def preempt(self, end: TaskEnd) -> None:
        """End the goal as aborted because another one has come, as Nav2 does."""
        self.finish(self.goal.abort, self.report.ended(end))

    def follow(self, step: Step) -> None:
        """Send feedback for a control period."""
        if not self.runs or self.goal.is_over:
            return
        if step.steering is not None:
            self._left = step.steering.goals[step.goal :]
        fields = self.report.feedback(step)
        if fields is not None:
            with self._lock:
                self.goal.publish_feedback(**fields)

    def _fail(self, fields: dict[str, Any]) -> None:
        if self.failed is not None:
            self.failed()
        self.finish(self.goal.abort, fields)

    def cancelled(self, **fields: Any) -> None:
        """End the goal as cancelled, if its client has asked for that; else as aborted."""
        end = self.goal.canceled if self.goal.cancel_requested else self.goal.abort
        end(**fields)

    def finish(self, end: Callable[..., None], fields: dict[str, Any]) -> None:
        """End the goal in this way, with these fields of its result."""
        with self._lock:
            end(**fields)


class Slot:
    """One thing that the robot does at a time: a drive, or a behavior.

    Args:
        context: The bridge.
        later: Calls something in the listening thread.
        cancel: The directive that ends it.
    """

    def __init__(self, context: BridgeContext, later: Callable[[Callable[[], None]], None], cancel: Cancel) -> None:
        self._steering, self._clock = context.driver.steering, context.clock
        self._later, self._cancel = later, cancel
        self._status = lambda: context.mission.navigator.status
        self._current: Task | None = None
        self._lock = threading.Lock()
        """Held while a run is given what the one before has left: what has ended before is not given after."""

    def start(self, goal: ActionGoal, report: Report, directive: Directive, by: str) -> None:
        """Do what a goal asks for from now on; what runs is aborted."""
        task = Task(goal, report, self._later)
        task.failed = lambda: self._give_up(task)
        task.given = directive, by
        self.adopt(task)
        self._steering.put(directive, by=by, watcher=task)

    def adopt(self, task: Task) -> None:
        """Replace the running task, which is aborted, by one that gives its directives itself."""
        self.preempt("another goal has come")
        self._current = task

    def preempt(self, why: str) -> bool:
        """End what runs as aborted, and return whether something ran."""
        with self._lock:
            task, self._current = self._current, None
        if task is None or task.goal.is_over:
            return False
        task.preempt(TaskEnd("replaced", why, self._clock.now - self._clock.offset, self._status()))
        return True

    def carry(self, why: str) -> None:
        """Carry the running tasks over into the next run, and abort those that cannot go on there."""
        task = self._current
        if task is None or task.goal.is_over or task.again() is None:
            self.preempt(why)
        else:
            task.is_carried = True

    def resume(self) -> None:
        """Resume in the new run what the last one has left."""
        with self._lock:
            task = self._current
            if task is None or not task.is_carried or task.goal.is_over:
                return
            task.is_carried = False
            again = task.again()
            if again is not None and not task.goal.cancel_requested:
                self._steering.put(again[0], by=again[1], watcher=task)
            else:
                self._later(lambda: task.finish(task.cancelled, {}))

    def cancel(self, goal: ActionGoal, by: str) -> bool:
        """End a goal as its client asks, and return whether it runs."""
        if self._current is None or self._current.goal is not goal:
            return False
        self._steering.put(self._cancel, by=by)
        return True

    def follow(self, step: Step) -> None:
        """Send feedback for a control period."""
        task = self._current
        if task is not None:
            task.follow(step)

    def _give_up(self, task: Task) -> None:
        """Stop the robot after a task that failed, so that it does not go on with it or with what it had before."""
        if self._current is task:
            self._steering.put(self._cancel, by="failed")


class Tasks:
    """The drive and the behavior that the network asked for.

    Args:
        context: The bridge.

    Attributes:
        drive: A drive to a goal, through several, or along a path.
        behavior: A behavior.
        refuses: Why goals are refused now; empty where no source has a reason.
        ends: End other goals as aborted, for a reason.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._wire = context.wire
        self._due: deque[Callable[[], None]] = deque()
        self.drive = Slot(context, self.later, Cancel())
        self.behavior = Slot(context, self.later, Cancel("behavior"))
        self.refuses = ""
        self._reasons: dict[str, str] = {}
        self._lock = threading.Lock()
        self.ends: list[Callable[[str], None]] = []
        context.wire.every_round(self.flush)

    def refuse(self, source: str, why: str) -> None:
        """Refuse goals for a reason, or no longer for that of this source (""); any thread may call it."""
        with self._lock:
            self._reasons[source] = why
            self.refuses = next((one for one in self._reasons.values() if one), "")

    def follow(self, step: Step) -> None:
        """Send feedback for a control period; in the thread that drives."""
        self.drive.follow(step)
        self.behavior.follow(step)

    def flush(self) -> None:
        """Send the results that are due; in the listening thread, or where all goals end."""
        while True:
            try:
                call = self._due.popleft()
            except IndexError:
                return
            call()

    def end(self, why: str) -> None:
        """End all goals as aborted: the other side is lost, or navigation is shut down. What is due goes first."""
        self.flush()
        self.drive.preempt(why)
        self.behavior.preempt(why)
        for end in self.ends:
            end(why)

    def carry(self, why: str) -> None:
        """Carry drives to goals over into the next run; abort paths and behaviors for a reason."""
        self.flush()
        self.drive.carry(why)
        self.behavior.preempt(why)

    def later(self, call: Callable[[], None]) -> None:
        """Call this in the listening thread, after what clients have asked for; from any thread."""
        self._due.append(call)
        self._wire.wake()
