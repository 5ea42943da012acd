"""`NavigationStatus`: what a navigator is doing."""

from __future__ import annotations

from enum import StrEnum


class NavigationStatus(StrEnum):
    """What a navigator is doing."""

    IDLE = "idle"
    """It has no goal."""
    DRIVING = "driving"
    """It is on the way."""
    BLOCKED = "blocked"
    """Every way on would touch something, or planning takes long; it plans again, backs up, or waits to plan again."""
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    STUCK = "stuck"
    """The robot has not got on for too long, though there is a way; it has given up this goal."""
    NO_PATH = "no_path"
    """No path to the goal was found, from the start or from where the robot was blocked; `Navigator.error` says why."""
    PLANNING_TIMED_OUT = "planning_timed_out"
    """Planning was not done by its deadline, three times in a row; whether there is a path is not known."""


FINAL = frozenset(
    {
        NavigationStatus.ARRIVED,
        NavigationStatus.STUCK,
        NavigationStatus.NO_PATH,
        NavigationStatus.PLANNING_TIMED_OUT,
    }
)
"""The robot stands, until there is another goal."""
