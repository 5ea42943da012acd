"""`trundle plan --compare`: every planner on one query, as a table and a picture."""

from __future__ import annotations

import statistics
import time
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, TypedDict

from trundle.cli.shared import output
from trundle.errors import BlockedPoseError, OutsideMapError, PlanningError
from trundle.geometry import Pose2D, wrap_angle

if TYPE_CHECKING:
    from trundle.costmap import Costmap
    from trundle.mission import Goal
    from trundle.navigation import Navigator
    from trundle.path import Path
    from trundle.planning import Planner, Smoother

_ROUNDS = 5


class Row(TypedDict):
    """How one planner did.

    `clearance_m` is the smallest distance from the footprint at the path's poses to something, 0 where it touches.
    """

    planner: str
    length_m: float | None
    turning_rad: float | None
    clearance_m: float | None
    planning_ms: float
    message: str


def compare(
    navigator: Navigator, begin: Pose2D, end: Goal, names: list[str], *, target: FilePath | None, json: bool
) -> int:
    """Plan from `begin` to `end` by every planner, print a table and draw all paths, with the zones of the masks.

    Where the navigator smooths, so are these paths. Without a target nothing is drawn.

    Returns:
        The exit code: 0 where at least one planner found a way, 2 where all say that the start or the goal is at fault.
    """
    from trundle.planning import create_planner
    from trundle.record.overlay import draw_paths
    from trundle.record.run_folder import save_png

    rows: list[Row] = []
    paths: dict[str, Path] = {}
    errors: list[PlanningError] = []
    for name in names:
        row, found = _try(create_planner(name), navigator.smoother, name, navigator.costmap, begin, Pose2D.of(end))
        rows.append(row)
        if isinstance(found, PlanningError):
            errors.append(found)
        else:
            paths[name] = found
    if paths and target is not None:
        picture = draw_paths(navigator.costmap, navigator.robot, paths, speed_mask=navigator.speed_mask)
        save_png(picture, target)
    _print(rows, target if paths else None, json=json)
    if paths:
        return 0
    return 2 if all(isinstance(error, OutsideMapError | BlockedPoseError) for error in errors) else 1


def _try(
    planner: Planner, smoother: Smoother | None, name: str, costmap: Costmap, begin: Pose2D, end: Pose2D
) -> tuple[Row, Path | PlanningError]:
    """Plan several times: the first makes what a planner keeps of a map, and the median of the others counts."""
    row = Row(planner=name, length_m=None, turning_rad=None, clearance_m=None, planning_ms=0.0, message="")
    times: list[float] = []
    outcome: Path | PlanningError
    while True:
        began = time.perf_counter()
        try:
            outcome = planner.plan(costmap, begin, end)
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


def _print(rows: list[Row], target: FilePath | None, *, json: bool) -> None:
    if json:
        output.print_json({"planners": rows, "overlay": target})
        return
    output.print_table(
        ("planner", "length m", "turning rad", "clearance m", "ms", ""),
        [
            (
                row["planner"],
                row["length_m"],
                row["turning_rad"],
                row["clearance_m"],
                row["planning_ms"],
                "touches something" if row["clearance_m"] == 0.0 else row["message"],
            )
            for row in rows
        ],
    )
    if target is not None:
        print(f"overlay  {target}")
