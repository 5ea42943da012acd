"""What those who give a run a goal, a path or a behavior get back: `TaskWatcher`, `TaskEnd` and `RunningTasks`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol, TypeAlias

from trundle.errors import TrundleError
from trundle.fault import Fault
from trundle.navigation.behaviors.behavior import ASKED_FOR
from trundle.navigation.status import FINAL, NavigationStatus

if TYPE_CHECKING:
    from trundle.mission.running.course import Course
    from trundle.navigation import Navigator

TaskResult: TypeAlias = Literal["succeeded", "failed", "cancelled", "replaced", "stopped"]
"""How a task ended: "replaced" by another one, "stopped" as the run ended."""


@dataclass(frozen=True, slots=True)
class TaskEnd:
    """How a goal, a path or a behavior that a run was given ended.

    Attributes:
        result: How it ended.
        message: Why; empty where it succeeded.
        time: When [s], simulated time.
        status: What the agent was doing then.
        error: The planning error behind it, or None.
        fault: The exception that ended the run, and with it this, as "failed"; None where there was none.
    """

    result: TaskResult
    message: str
    time: float
    status: NavigationStatus
    error: TrundleError | None = None
    fault: Fault | None = None


class TaskWatcher(Protocol):
    """Gets what becomes of a task that was given to a run, from the thread that drives it."""

    def begin(self, time: float) -> None:
        """The run has taken it up at this simulated time [s]."""
        ...

    def refuse(self, error: TrundleError) -> None:
        """The run has not taken it up; the goals that it had stay."""
        ...

    def end(self, end: TaskEnd) -> None:
        """It has ended; nothing follows."""
        ...


class RunningTasks:
    """The tasks of a run that somebody watches: its goals, and the behavior that was asked for.

    Args:
        course: The goals of the run.
    """

    def __init__(self, course: Course) -> None:
        self._course = course
        self._goal: TaskWatcher | None = None
        self._behavior: TaskWatcher | None = None

    def begin_goal(self, watcher: TaskWatcher | None, time: float) -> None:
        """The run has another goal; what was running is replaced."""
        self._end_both("replaced", "there is another goal", time)
        self._goal = watcher
        if watcher is not None:
            watcher.begin(time)

    def begin_behavior(self, watcher: TaskWatcher | None, time: float) -> None:
        """The run was asked for a behavior; another one that ran is replaced."""
        self._end_behavior("replaced", "another behavior was asked for", time)
        self._behavior = watcher
        if watcher is not None:
            watcher.begin(time)

    def cancel(self, time: float, *, behavior_alone: bool) -> None:
        """What runs was cancelled."""
        self._end_behavior("cancelled", "cancelled", time)
        if not behavior_alone:
            self._end_goal("cancelled", "cancelled", time)

    def stop(self, why: str, time: float, fault: Fault | None) -> None:
        """The run has ended, by an exception where there is a fault."""
        self._end_both("stopped" if fault is None else "failed", why, time, fault)

    def check(self, time: float) -> None:
        """End what has ended in the last control period."""
        agent = self._course.navigator
        if agent is None:
            return
        if self._behavior is not None:
            self._check_behavior(agent, time)
        if self._goal is None:
            return
        if self._course.is_done and agent.status is NavigationStatus.ARRIVED:
            self._end_goal("succeeded", "", time)
        elif agent.status in FINAL and agent.status is not NavigationStatus.ARRIVED:
            error = agent.error
            self._end_goal("failed", agent.message or str(error or agent.status.value), time, error)

    def _check_behavior(self, agent: Navigator, time: float) -> None:
        if agent.status is NavigationStatus.BEHAVING:
            return
        ran = next((run for run in reversed(agent.behavior_runs) if run.reason == ASKED_FOR), None)
        if ran is not None and ran.result != "running":
            self._end_behavior("succeeded" if ran.result == "succeeded" else "failed", ran.message, time)

    def _end_both(self, result: TaskResult, message: str, time: float, fault: Fault | None = None) -> None:
        self._end_behavior(result, message, time, fault)
        self._end_goal(result, message, time, fault=fault)

    def _end_goal(
        self,
        result: TaskResult,
        message: str,
        time: float,
        error: TrundleError | None = None,
        fault: Fault | None = None,
    ) -> None:
        watcher, self._goal = self._goal, None
        if watcher is not None:
            watcher.end(TaskEnd(result, message, time, self._course.status, error, fault))

    def _end_behavior(self, result: TaskResult, message: str, time: float, fault: Fault | None = None) -> None:
        watcher, self._behavior = self._behavior, None
        if watcher is not None:
            watcher.end(TaskEnd(result, message, time, self._course.status, fault=fault))
