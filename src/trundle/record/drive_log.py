"""The record of `trundle drive`: every control period, the state at the end of each command, and a summary."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypedDict

from trundle.files.writing import write_text
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.sim import RobotState

COLUMNS = (
    "time_s",
    "x",
    "y",
    "yaw",
    "command_v",
    "command_w",
    "v",
    "w",
    "wheel_left",
    "wheel_right",
    "odom_x",
    "odom_y",
    "odom_yaw",
    "contacts",
)


class Leg(TypedDict):
    """State at the end of one command: pose [m, m, rad], twist, wheel speeds [rad/s], and its contacts."""

    v: float
    w: float
    seconds: float
    x: float
    y: float
    yaw: float
    twist: dict[str, float]
    wheel_speeds: dict[str, float]
    contacts: list[str]


class DriveLog:
    """Rows of a drive, and its legs: one for each command."""

    def __init__(self) -> None:
        self._rows: list[str] = []
        self._legs: list[tuple[float, float, float, set[str]]] = []
        self._ends: list[RobotState] = []
        self._states: list[RobotState] = []

    def __len__(self) -> int:
        return len(self._rows)

    def begin(self, v: float, w: float, seconds: float) -> None:
        """Start a leg that is commanded v [m/s], w [rad/s] for some seconds."""
        self._legs.append((v, w, seconds, set()))

    def add(self, state: RobotState, command: Twist2D = Twist2D()) -> None:
        """Add the state at the end of one control period."""
        touched = sorted({contact.other for contact in state.contacts})
        numbers = (
            state.time,
            *state.pose.as_tuple(),
            command.v,
            command.w,
            state.twist.v,
            state.twist.w,
            *state.wheel_speeds,
            *state.odometry.as_tuple(),
        )
        self._rows.append(",".join([*(f"{number:.6f}" for number in numbers), " ".join(touched)]))
        self._states.append(state)
        if self._legs:
            self._legs[-1][3].update(touched)
            del self._ends[len(self._legs) - 1 :]
            self._ends.append(state)

    def legs(self) -> list[Leg]:
        """Return all driven legs, in order."""
        return [
            Leg(
                v=v,
                w=w,
                seconds=seconds,
                x=end.pose.x,
                y=end.pose.y,
                yaw=end.pose.yaw,
                twist={"v": end.twist.v, "w": end.twist.w},
                wheel_speeds={"left": end.wheel_speeds.left, "right": end.wheel_speeds.right},
                contacts=sorted(touched),
            )
            for (v, w, seconds, touched), end in zip(self._legs, self._ends, strict=False)
        ]

    def summary(self) -> DriveSummary:
        """Return time, distance, turns and contacts of the whole drive, which must have at least one state."""
        return DriveSummary.from_states(self._states)

    def save(self, path: Path) -> None:
        """Write all rows as CSV."""
        write_text(path, "\n".join([",".join(COLUMNS), *self._rows, ""]), durable=True)


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
