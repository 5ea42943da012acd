"""Summary of a drive."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

from trundle.geometry import Pose2D, wrap_angle
from trundle.sim import RobotState


@dataclass(frozen=True, slots=True)
class DriveSummary:
    """Totals of a drive.

    Attributes:
        seconds: Simulated time [s].
        distance: Length of the path [m].
        top_speed: Largest speed, forward or back [m/s].
        turned_left: Sum of all turns to the left [rad].
        turned_right: Sum of all turns to the right [rad].
        contacts: Number of contacts that began, counted once while they last.
        touched: Names of the touched solids, sorted.
        pose: The last pose, map frame.
    """

    seconds: float
    distance: float
    top_speed: float
    turned_left: float
    turned_right: float
    contacts: int
    touched: tuple[str, ...]
    pose: Pose2D

    @classmethod
    def from_states(cls, states: Sequence[RobotState]) -> Self:
        """Summarise the states of a drive, in order, at least one."""
        distance = left = right = 0.0
        contacts = 0
        for before, after in itertools.pairwise(states):
            distance += math.hypot(after.pose.x - before.pose.x, after.pose.y - before.pose.y)
            turn = wrap_angle(after.pose.yaw - before.pose.yaw)
            left += max(turn, 0.0)
            right += max(-turn, 0.0)
            contacts += len(_names(after) - _names(before))
        return cls(
            seconds=states[-1].time - states[0].time,
            distance=distance,
            top_speed=max(abs(state.twist.v) for state in states),
            turned_left=left,
            turned_right=right,
            contacts=contacts + len(_names(states[0])),
            touched=tuple(sorted(set[str]().union(*map(_names, states)))),
            pose=states[-1].pose,
        )


def _names(state: RobotState) -> set[str]:
    return {contact.other for contact in state.contacts}
