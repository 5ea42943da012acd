"""`NavigationStatus`: what a navigator is doing, and when that changes."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum


class NavigationStatus(StrEnum):
    """What a navigator is doing."""

    IDLE = "idle"
    """It has no goal."""
    DRIVING = "driving"
    """It follows a path to the goal."""
    BLOCKED = "blocked"
    """Every command would cause a contact, or planning takes long; it replans, backs up, or waits to replan."""
    BEHAVING = "behaving"
    """It runs a behavior that it was asked for, or the task of a waypoint."""
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    FINISHED = "finished"
    """All that an agent without a goal had to do, such as a script of commands or a behavior, is done."""
    STUCK = "stuck"
    """The robot made no progress within the time allowance, though there is a path, or a behavior that it was asked for
    failed; it has given up this goal."""
    NO_PATH = "no_path"
    """No path to the goal was found, from the start or from where the robot was blocked; `Navigator.error` says why."""
    PLANNING_TIMED_OUT = "planning_timed_out"
    """Planning missed its deadline three times in a row; whether there is a path is not known."""


FINAL = frozenset(
    {
        NavigationStatus.ARRIVED,
        NavigationStatus.FINISHED,
        NavigationStatus.STUCK,
        NavigationStatus.NO_PATH,
        NavigationStatus.PLANNING_TIMED_OUT,
    }
)
"""The robot stands still until there is another goal."""

_S = NavigationStatus

ANY_STATUS_TO: Mapping[NavigationStatus, str] = {
    _S.IDLE: "`reset` or `cancel`",
    _S.DRIVING: "`set_goal`, `set_goals` or `follow`",
    _S.BEHAVING: "`run`",
}
"""What a program asks for, which changes every status to this one."""

TRANSITIONS: Mapping[tuple[NavigationStatus, NavigationStatus], str] = {
    (_S.DRIVING, _S.BLOCKED): "no progress, or a plan has to wait",
    (_S.DRIVING, _S.BEHAVING): "a waypoint with tasks is reached",
    (_S.BLOCKED, _S.BEHAVING): "a waypoint with tasks is reached",
    (_S.BEHAVING, _S.DRIVING): "the behaviors have ended, or `cancel_behavior`: on to the goal",
    (_S.BLOCKED, _S.DRIVING): "the controller commands a motion again, or the next goal is taken up",
    (_S.BEHAVING, _S.ARRIVED): "the tasks of the last goal have succeeded",
    (_S.DRIVING, _S.ARRIVED): "the robot stands at the last goal",
    (_S.BLOCKED, _S.ARRIVED): "the robot stands at the last goal",
    (_S.BEHAVING, _S.FINISHED): "the behavior has succeeded, or `cancel_behavior`, and there is no goal to drive on to",
    (_S.BEHAVING, _S.IDLE): "`cancel_behavior`, and there is no goal",
    (_S.BEHAVING, _S.STUCK): "a task has failed, or a behavior and there is no goal to drive on to",
    (
        _S.DRIVING,
        _S.STUCK,
    ): "no progress within the time allowance, after all tries of recovery, or not localized for too long; or a task "
    "has failed at once",
    (
        _S.BLOCKED,
        _S.STUCK,
    ): "no progress within the time allowance, after all tries of recovery, or not localized for too long",
    (_S.DRIVING, _S.NO_PATH): "no path, and nothing that was sensed may move away",
    (_S.BLOCKED, _S.NO_PATH): "no path, and the robot has waited or tried for long enough",
    (_S.DRIVING, _S.PLANNING_TIMED_OUT): "the third plan in a row missed its deadline",
    (_S.BLOCKED, _S.PLANNING_TIMED_OUT): "the third plan in a row missed its deadline",
}
"""The event of each other change of status; no other change happens."""
