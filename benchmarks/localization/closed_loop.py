"""What an evaluation of a suite of closed loops comes to, of the missions that have a path in the true world.

    trundle evaluate benchmarks/localization/suites/closed_loop.yaml -o runs/closed_loop
    python -m benchmarks.localization.closed_loop runs/closed_loop

A mission that did not arrive counts where the planner `auto` finds a path for the robot's footprint in the world with
its boxes, which close the way in many offices, mazes and corridors. One is `closed on its map` where there is none on
the robot's map with these boxes: a ghost stands in the way.
"""

from __future__ import annotations

import argparse
import itertools
import math
import warnings
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from benchmarks.timing import print_table

from trundle.costmap import Costmap
from trundle.errors import TrundleError
from trundle.evaluation import Evaluation, Row
from trundle.geometry import Pose2D
from trundle.maps import OCCUPIED, OccupancyGrid
from trundle.planning import create_planner
from trundle.robots import Robot

_NEAR_M = 0.25


@dataclass(frozen=True)
class Judged:
    """A mission, and whether a path leads to its goal in the true world, and on its own map with the boxes."""

    row: Row
    path: bool
    open_on_map: bool


def judge(evaluation: Evaluation, row: Row) -> Judged:
    """Look for paths where a mission did not arrive."""
    setting = evaluation.scenario_of(row.id).model_copy(update={"localizer": None, "start_error": None}).prepare()
    robot, goal = setting.robot, setting.goals[0]
    world = replace(setting.world, seeds=((setting.start.x, setting.start.y),))
    try:
        grid = OccupancyGrid.from_world(world, resolution=setting.grid.resolution, z_range=robot.z_range)
    except TrundleError:  # a box stands around the start
        return Judged(row, False, False)
    if not _is_open(grid, robot, setting.start, goal):
        return Judged(row, False, False)
    return Judged(row, True, _is_open(_with_obstacles(setting.grid, grid), robot, setting.start, goal))


def _with_obstacles(own: OccupancyGrid, true: OccupancyGrid) -> OccupancyGrid:
    """Return a map on which all that is in the world is occupied, too."""
    rows, cols = np.indices(own.data.shape)
    centres = own.origin.transform_points(own.resolution * (np.stack((cols.ravel(), rows.ravel()), axis=1) + 0.5))
    at = np.floor(true.origin.inverse().transform_points(centres) / true.resolution).astype(int)
    inside = np.all((at >= 0) & (at < true.data.shape[::-1]), axis=1)
    col, row = at[inside].T
    occupied = np.zeros(len(at), bool)
    occupied[inside] = true.data[row, col] == OCCUPIED
    return replace(own, data=np.where(occupied.reshape(own.data.shape), OCCUPIED, own.data).astype(own.data.dtype))


def _is_open(grid: OccupancyGrid, robot: Robot, start: Pose2D, goal: Pose2D) -> bool:
    try:
        create_planner("auto").plan(Costmap.from_grid(grid, robot), start, goal)
    except TrundleError:
        return False
    return True


def _judge(folder: str, row: Row) -> Judged:
    if row.outcome == "arrived":
        return Judged(row, True, True)
    return judge(_opened(folder), row)


@cache
def _opened(folder: str) -> Evaluation:
    """Open an evaluation once for each process."""
    warnings.simplefilter("ignore")
    return Evaluation(folder)


def summarize(judged: Sequence[Judged]) -> tuple[str, ...]:
    """One line of the table."""
    with_path = [each for each in judged if each.path]
    arrived = [each.row for each in with_path if each.row.outcome == "arrived"]
    truly = sum(math.dist((row.end_x, row.end_y), (row.goal_x, row.goal_y)) <= _NEAR_M for row in arrived)
    errors = 1e3 * np.array([row.position_error_m for row in arrived])
    others = Counter(
        each.row.outcome if each.open_on_map else "closed on its map"
        for each in with_path
        if each.row.outcome != "arrived"
    )
    return (
        str(len(judged)),
        str(len(with_path)),
        f"{truly} ({100 * truly / max(len(with_path), 1):.1f} %)",
        ", ".join(f"{count} {name}" for name, count in others.most_common()) or "–",
        str(sum(bool(each.row.contacts) for each in judged)),
        f"{np.median(errors):.0f}, {np.percentile(errors, 95):.0f}, {errors.max():.0f}" if len(errors) else "–",
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="of evaluations")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--each", action="store_true", help="print each mission with a path that did not arrive")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    lines = []
    for folder in options.folders:
        with Evaluation(folder) as evaluation:
            rows = list(evaluation.rows())
            with ProcessPoolExecutor(options.jobs) as pool:
                judged = list(pool.map(_judge, itertools.repeat(folder), rows))
            lines.append((evaluation.suite.name, *summarize(judged)))
        for each in judged:
            if options.each and each.path and each.row.outcome != "arrived":
                closed = "" if each.open_on_map else "(closed on its map) "
                print(each.row.world, each.row.seed, each.row.outcome, closed + each.row.message, flush=True)
    header = ("suite", "missions", "with a path", "truly arrived", "others with a path", "contacts")
    print_table((*header, "estimate at the end: median, p95, largest [mm]"), lines)


if __name__ == "__main__":
    main()
