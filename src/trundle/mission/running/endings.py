"""How a run ends: its outcome, and the outcome in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

from trundle.geometry import Goal, Pose2D
from trundle.mission.episode import Outcome
from trundle.navigation import Agent, NavigationStatus, Navigator
from trundle.sim import Contact, RobotState

Ending: TypeAlias = tuple[Outcome, str]
"""The outcome and its message."""

_TIPPED_RAD = math.radians(70.0)
"""No robot on wheels comes back from this tilt."""


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
    """The agent says that it has arrived where there is no goal."""
    name = "navigator" if isinstance(agent, Navigator) else "agent"
    return Outcome.STUCK, f"the {name} says that it arrived, but it is at {_words(state.pose)}"


def timed_out(goals: Sequence[Goal], time_limit_s: float) -> Ending:
    """The time limit is over."""
    what = "goal not reached" if goals else "not finished"
    return Outcome.TIMED_OUT, f"{what} within {time_limit_s:.1f} s"


def tipped_over(state: RobotState) -> Ending | None:
    """Something has knocked the robot over, and its wheels no longer move it; None where it stands."""
    if state.tilt < _TIPPED_RAD:
        return None
    tilt = f"{math.degrees(state.tilt):.0f}°"
    return Outcome.STUCK, f"tipped over by {tilt} at {_words(state.pose)} after {state.time:.1f} s"


def given_up(agent: Agent, state: RobotState) -> Ending | None:
    """What the status of an agent that does not drive on means; None where it goes on later."""
    status, where = agent.status, _words(state.pose)
    said = getattr(agent, "message", None)
    reason = getattr(agent, "error", None) or said
    if status is NavigationStatus.NO_PATH:
        return Outcome.NO_PATH, str(reason or "no path to the goal was found")
    if status is NavigationStatus.PLANNING_TIMED_OUT:
        return Outcome.PLANNING_TIMED_OUT, f"planning timed out at {where}: {reason}"
    if status is NavigationStatus.STUCK:
        because = f": {said}" if said else ""
        return Outcome.STUCK, f"stuck at {where} after {state.time:.1f} s{because}"
    if status in (NavigationStatus.FINISHED, NavigationStatus.ARRIVED):
        return Outcome.FINISHED, f"finished after {state.time:.1f} s"
    return None


def describe_contact(contact: Contact, time: float) -> str:
    """What touches what, where and when [s]."""
    where = f"the {contact.part} touches {contact.other} at ({contact.x:.2f}, {contact.y:.2f})"
    if time == 0.0:
        return (
            f"in contact at the start: {where}; start farther from it, or, if it is what the robot stands on, give the "
            "height of its top with --floor-z (floor_z in Python and in a scenario)"
        )
    return f"{where} after {time:.1f} s"


def _words(pose: Pose2D) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})"
