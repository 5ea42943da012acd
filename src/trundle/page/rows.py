"""The start of a run and its steps as rows of numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from trundle.mission.observers import RunInfo, Step
from trundle.page.encoding import finite, rounded

COLUMNS = (
    "t",
    "x",
    "y",
    "yaw",
    "v",
    "w",
    "cmd_v",
    "cmd_w",
    "sent_v",
    "sent_w",
    "clearance",
    "cross_track",
    "goal",
    "status",
    "tick_ms",
    "plan_ms",
    "left",
    "right",
    "ex",
    "ey",
    "eyaw",
)
"""What a row holds: time [s], true pose, measured, commanded and sent twist, clearance and distance to the path [m],
index of the goal, status, wall times [ms], angles of the drive wheels [rad], and the estimated pose where it is not the
true one."""


def info_of(info: RunInfo) -> dict[str, Any]:
    """What the page shows of a run's start."""
    return {
        "name": info.name,
        "robot": info.robot.name,
        "planner": info.planner,
        "controller": info.controller,
        "seed": info.seed,
        "start": rounded(info.start.as_tuple()),
        "goals": [goal_of(goal) for goal in info.goals],
        "dt": info.dt,
        "time_limit_s": finite(info.time_limit_s),
    }


def goal_of(goal: Sequence[float]) -> list[float | None]:
    """A goal as [x, y, yaw], with None for any yaw."""
    yaw = goal[2] if len(goal) > 2 else None
    return [round(float(goal[0]), 4), round(float(goal[1]), 4), finite(yaw)]


def row_of(step: Step, *, clearance: float | None = None, cross_track: float | None = None) -> list[Any]:
    """A step as a row of `COLUMNS`.

    Args:
        step: The step.
        clearance: Distance [m] from the footprint to the nearest solid; none where it is not known.
        cross_track: Distance [m] from base_link to the path that is followed; none without one.
    """
    state, sent = step.state, step.sent
    pose, twist = state.pose, state.twist if state.odometry_twist is None else state.odometry_twist
    believed = (None, None, None)
    if step.estimate is not None and step.estimate.pose is not pose:
        believed = rounded(step.estimate.pose.as_tuple())
    return [
        *rounded((state.time, pose.x, pose.y, pose.yaw, twist.v, twist.w)),
        *rounded((step.command.v, step.command.w, sent.v, sent.w)),
        finite(clearance),
        finite(cross_track),
        step.goal,
        step.status.value,
        round(1e3 * step.tick_s, 3),
        round(1e3 * step.planning_s, 3),
        *rounded(state.wheel_positions, 3),
        *believed,
    ]
