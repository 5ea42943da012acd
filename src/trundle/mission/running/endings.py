"""How a run ends: its outcome, and the outcome in words; `RunEnd`, how one has ended."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TypeAlias

from trundle.errors import PlanningError, SimulationError
from trundle.fault import Fault, find_fault, keep_fault, text_of
from trundle.geometry import Goal, Pose2D
from trundle.mission.episode import Outcome
from trundle.navigation import Agent, AgentReport, NavigationStatus
from trundle.sim import Contact, RobotState

Ending: TypeAlias = tuple[Outcome, str]
"""The outcome and its message."""

TIPPED_RAD = math.radians(70.0)
"""No robot on wheels comes back from this tilt."""


class RunEnd:
    """How a run has ended. An exception that comes later, while its episode is made, takes precedence.

    Args:
        parts: Objects of the run that may be plug-ins.

    Attributes:
        outcome: The outcome; None while the run is running.
        message: The outcome in words; empty while the run is running.
        error: What ended it: a KeyboardInterrupt, a SimulationError, or what a plug-in raised; None otherwise.
        fault: Which plug-in raised what; None where none did.
        complete: Whether the search that found no path was complete.
    """

    def __init__(self, parts: Sequence[object]) -> None:
        self.parts = tuple(parts)
        self.outcome: Outcome | None = None
        self.message = ""
        self.error: BaseException | None = None
        self.fault: Fault | None = None
        self.complete = False

    def put(self, outcome: Outcome, message: str, error: BaseException | None, contacts: Iterable[str]) -> None:
        """Set the end of a run in which these were touched: it is a collision then, unless it is an error."""
        touched = ", ".join(contacts)
        if touched and outcome not in (Outcome.COLLIDED, Outcome.ERROR):
            outcome, message = Outcome.COLLIDED, f"touched {touched} while driving; {message}"
        self.outcome, self.message, self.error = outcome, message, error

    def explain(self, error: BaseException) -> Ending:
        """Return the end that an exception means: no path, a failed simulator, Ctrl-C, or the fault of a plug-in."""
        if isinstance(error, KeyboardInterrupt):
            return Outcome.ABORTED, "stopped by Ctrl-C"
        if isinstance(error, SimulationError):
            return Outcome.ABORTED, f"the simulator failed: {text_of(error)}"
        if isinstance(error, PlanningError):
            self.complete = error.complete
            return Outcome.NO_PATH, text_of(error)
        return Outcome.ERROR, self._blame(error)

    def fail(self, error: BaseException) -> None:
        """End the run, which has ended, by what a plug-in raised since, unless another exception has."""
        if self.fault is None:
            self.put(Outcome.ERROR, self._blame(error), error, ())

    def _blame(self, error: BaseException) -> str:
        self.fault = find_fault(error, self.parts)
        keep_fault(error, self.fault)
        return str(self.fault)


def at_goal(state: RobotState, estimate: Pose2D | None) -> Ending:
    """Arrived; only by this estimate, if it is given."""
    if estimate is None:
        return Outcome.ARRIVED, f"arrived after {state.time:.1f} s"
    off = state.pose.distance_to(estimate)
    return (
        Outcome.ARRIVED_BY_ESTIMATE,
        f"arrived by its estimate after {state.time:.1f} s, which is {off:.2f} m from where the robot is",
    )


def elsewhere(agent: Agent, state: RobotState) -> Ending:
    """Return the end of a run whose agent says that it has arrived, where there is no goal."""
    name = "navigator" if agent.plans else "agent"
    return Outcome.STUCK, f"the {name} says that it arrived, but it is at {_words(state.pose)}"


def timed_out(goals: Sequence[Goal], time_limit_s: float) -> Ending:
    """Return the end of a run at its time limit."""
    what = "goal not reached" if goals else "not finished"
    return Outcome.TIMED_OUT, f"{what} within {time_limit_s:.1f} s"


def tipped_over(state: RobotState) -> Ending:
    """Something has knocked the robot over by more than `TIPPED_RAD`, and its wheels no longer move it."""
    tilt = f"{math.degrees(state.tilt):.0f}°"
    return Outcome.STUCK, f"tipped over by {tilt} at {_words(state.pose)} after {state.time:.1f} s"


def given_up(report: AgentReport, state: RobotState) -> Ending | None:
    """Return what the status of an agent that does not drive on means; None where it goes on later."""
    status, said = report.status, report.message
    if status is NavigationStatus.DRIVING:
        return None
    where, reason = _words(state.pose), report.error or said
    if status is NavigationStatus.NO_PATH:
        return Outcome.NO_PATH, str(reason or "no path to the goal was found")
    if status is NavigationStatus.PLANNING_TIMED_OUT:
        return Outcome.PLANNING_TIMED_OUT, f"planning timed out at {where}: {reason}"
    if status is NavigationStatus.STUCK:
        because = f": {said}" if said else ""
        return Outcome.STUCK, f"stuck at {where} after {state.time:.1f} s{because}"
    if status in (NavigationStatus.FINISHED, NavigationStatus.ARRIVED):
        because = f": {said}" if said else ""
        return Outcome.FINISHED, f"finished after {state.time:.1f} s{because}"
    return None


def describe_contact(contact: Contact, time: float) -> str:
    """Return in one line what touches what, where and when [s]."""
    where = f"the {contact.part} touches {contact.other} at ({contact.x:.2f}, {contact.y:.2f})"
    if time == 0.0:
        return (
            f"in contact at the start: {where}; start farther from it, or, if it is what the robot stands on, give the "
            "height of its top with --floor-z (floor_z in Python and in a scenario)"
        )
    return f"{where} after {time:.1f} s"


def _words(pose: Pose2D) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})"
