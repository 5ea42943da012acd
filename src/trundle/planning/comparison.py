"""Several planners on one query: how long their paths are, how close to obstacles, and how long planning took."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypedDict

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Goal, Pose2D, wrap_angle
from trundle.path import Path
from trundle.planning.planner import Planner, create_planner
from trundle.planning.smoother import Smoother

_ROUNDS = 5  # the first fills what a planner keeps of a map, and is left out of the median


class PlannerRow(TypedDict):
    """The result of one planner.

    `clearance_m` is the smallest distance from the footprint at the path's poses to something, 0 where it touches.
    """

    planner: str
    length_m: float | None
    turning_rad: float | None
    clearance_m: float | None
    planning_ms: float
    message: str


@dataclass(frozen=True, slots=True)
class PlannerComparison:
    """The results of several planners for one query.

    Attributes:
        rows: The result of each planner, in the given order.
        paths: The paths of those that found one, by name.
        errors: The errors of the others, in the given order.
    """

    rows: list[PlannerRow]
    paths: dict[str, Path]
    errors: list[PlanningError]


def compare_planners(
    names: Iterable[str], costmap: Costmap, start: Pose2D, goal: Goal, *, smoother: Smoother | None = None
) -> PlannerComparison:
    """Plan one query by several planners, each made with its default options.

    Args:
        names: Names of the planners.
        costmap: What to stay clear of.
        start: Where the robot stands, map frame.
        goal: Where it is to stand, map frame.
        smoother: Applied to every path, and counted in its time.
    """
    rows: list[PlannerRow] = []
    paths: dict[str, Path] = {}
    errors: list[PlanningError] = []
    for name in names:
        row, outcome = _measure(name, create_planner(name), smoother, costmap, start, goal)
        rows.append(row)
        if isinstance(outcome, PlanningError):
            errors.append(outcome)
        else:
            paths[name] = outcome
    return PlannerComparison(rows, paths, errors)


def _measure(
    name: str, planner: Planner, smoother: Smoother | None, costmap: Costmap, start: Pose2D, goal: Goal
) -> tuple[PlannerRow, Path | PlanningError]:
    """Plan several times: the first makes what a planner keeps of a map, and the median of the others counts."""
    row = PlannerRow(planner=name, length_m=None, turning_rad=None, clearance_m=None, planning_ms=0.0, message="")
    times: list[float] = []
    outcome: Path | PlanningError
    while True:
        began = time.perf_counter()
        try:
            outcome = planner.plan(costmap, start, goal)
            if smoother is not None:
                outcome = smoother.smooth(outcome, costmap)
        except PlanningError as error:
            outcome = error
        times.append(1000.0 * (time.perf_counter() - began))
        if isinstance(outcome, PlanningError) or len(times) == _ROUNDS:
            break
    row["planning_ms"] = statistics.median(times[1:] or times)
    if isinstance(outcome, PlanningError):
        row["message"] = str(outcome)
    else:
        turns = (outcome.poses[1:, 2] - outcome.poses[:-1, 2]).tolist()
        row["length_m"] = outcome.length
        row["turning_rad"] = sum(abs(wrap_angle(turn)) for turn in turns)
        row["clearance_m"] = float(costmap.clearance(outcome.poses).min())
    return row, outcome
