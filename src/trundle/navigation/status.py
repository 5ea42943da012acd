"""`NavigationStatus`: what a navigator is doing."""

from __future__ import annotations

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
