"""Missions with biased odometry: could the robot stand where its estimate takes the goal to be?

python -m benchmarks.sensing.drift runs/odometry

The robot drives by its odometry on a true map. Where the estimate is off by a metre, the goal is a metre away from its
true place, and may lie inside a rack. Episodes that did not end where the estimate says are driven once more, which
gives the same drive, to see where that place is: no robot fits where, within the tolerance, it touches something there.
Only missions are counted for which `least_cost` finds a path to the true goal.
"""

from __future__ import annotations

import argparse
import math
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context

from benchmarks.sensing.report import has_path, true_costmap
from benchmarks.timing import print_table

from trundle.evaluation import Evaluation
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import wilson
from trundle.geometry import Pose2D
from trundle.mission import Scenario
from trundle.navigation.route_planner import nearest_free_pose

TRULY_M = 0.5


@dataclass(frozen=True)
class Judged:
    """An episode: whether it ended where its estimate says, truly near the goal, and whether a robot fits there."""

    world: str
    odometry: str
    outcome: str
    there: bool
    truly: bool
    has_path: bool
    fits: bool


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="folder of a finished evaluation")
    parser.add_argument("--longest", type=float, default=20.0, help="leave out missions with longer paths [m]")
    parser.add_argument("--workers", type=int, default=None, help="processes; left out: one for each CPU")
    options = parser.parse_args()
    finished = [row for row in Evaluation(options.folder).rows() if row.time_s is not None]
    rows = [row for row in finished if (row.path_length_m or 0.0) <= options.longest]
    with ProcessPoolExecutor(options.workers, mp_context=get_context("spawn")) as pool:
        judged = list(pool.map(partial(judge, options.folder), rows))
    groups: dict[tuple[str, str], list[Judged]] = {}
    for episode in judged:
        groups.setdefault((episode.world, episode.odometry), []).append(episode)
    header = (
        "world",
        "odometry",
        "missions",
        "no path",
        "there",
        "95 %",
        "truly",
        "goal free",
        "there of these",
        "others",
    )
    print_table(header, [tuple(map(str, (*names, *figures(group)))) for names, group in groups.items()])


def judge(folder: str, row: Row) -> Judged:
    """Judge one episode; drive it once more if it did not end where the estimate says."""
    evaluation = Evaluation(folder)
    there = row.outcome in ("arrived", "arrived_by_estimate")
    truly = math.dist((row.end_x or 0.0, row.end_y or 0.0), (row.goal_x or 0.0, row.goal_y or 0.0)) <= TRULY_M
    scenario = evaluation.scenario_of(row.id)
    path = there or has_path(scenario)
    fits = there or (path and fits_at_drifted_goal(scenario))
    errors = scenario.odometry
    odometry = "none" if errors is None else f"{errors.scale:.1%}, {math.degrees(errors.heading):g}°/m"
    return Judged(row.world, odometry, row.outcome, there, truly, path, fits)


def fits_at_drifted_goal(scenario: Scenario) -> bool:
    """Whether the robot fits where its estimate takes the goal to be at the end, within the tolerance."""
    with scenario.build() as mission:
        episode = mission.run()
        goal = mission.goals[-1]
        costmap = true_costmap(mission)
    truth, estimate = (
        Pose2D(*poses[-1].tolist()) for poses in (episode.trajectory.poses, episode.trajectory.estimates)
    )
    drifted = truth @ estimate.inverse() @ goal.pose
    free = nearest_free_pose(costmap, drifted, scenario.goal_tolerance, any_yaw=goal.yaw_free)
    return free is not None


def figures(group: list[Judged]) -> tuple[object, ...]:
    """Counts and shares of the episodes of one world and odometry."""
    counted = [episode for episode in group if episode.has_path]
    there = sum(episode.there for episode in counted)
    free = [episode for episode in counted if episode.fits]
    low, high = wilson(there, len(counted)) if counted else (0.0, 1.0)
    others = Counter(episode.outcome for episode in counted if not episode.there)
    return (
        len(counted),
        len(group) - len(counted),
        share(there, len(counted)),
        f"{100.0 * low:.0f} to {100.0 * high:.0f}",
        share(sum(episode.truly for episode in counted), len(counted)),
        share(len(free), len(counted)),
        share(sum(episode.there for episode in free), len(free)),
        ", ".join(f"{number} {name}" for name, number in others.items()) or "none",
    )


def share(part: int, whole: int) -> str:
    """A count, of how many, and in percent."""
    return f"{part} of {whole}" + (f" ({100.0 * part / whole:.0f} %)" if whole else "")


if __name__ == "__main__":
    main()
