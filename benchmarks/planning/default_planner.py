"""What the default planner `auto` costs over `least_cost` on ordinary queries: the ratio of median CPU times.

    python -m benchmarks.planning.default_planner map.yaml [--queries 100]

On a ROS map and in three generated worlds, between ends where the robot can turn round. The two planners take turns,
and each query counts with the best of five times. The exit code is 1 where a ratio is over 1.03.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time

import trundle
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.mission import sample_mission
from trundle.planning import Planner, create_planner

WORLDS = ("office", "warehouse", "lot")
ROUNDS, MOST = 5, 1.03


def costmaps(file: str) -> dict[str, Costmap]:
    robot = trundle.Robot.load("nova_carter")
    grids = {"map": trundle.OccupancyGrid.load(file)}
    for name in WORLDS:
        world = trundle.World.generate(name, seed=3)
        grids[name] = trundle.OccupancyGrid.from_world(world, z_range=robot.z_range)
    return {name: Costmap.from_grid(grid, robot.outline) for name, grid in grids.items()}


def seconds(planner: Planner, costmap: Costmap, start: Pose2D, goal: Pose2D) -> float:
    began = time.process_time()
    planner.plan(costmap, start, goal)
    return time.process_time() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="path of a ROS map YAML")
    parser.add_argument("--queries", type=int, default=100)
    options = parser.parse_args()
    planners = [create_planner(name) for name in ("least_cost", "auto")]
    worst = 0.0
    print(
        "| map | least_cost: median | auto: median | ratio | other planners' paths |\n| --- | --- | --- | --- | --- |"
    )
    for name, costmap in costmaps(options.map).items():
        best: list[list[float]] = [[], []]
        others = 0
        for seed in range(options.queries):
            ends = sample_mission(costmap, seed)
            others += planners[1].plan(costmap, *ends).planner != "least_cost"
            times = [[seconds(planner, costmap, *ends) for planner in planners] for _ in range(ROUNDS)]
            for mine, theirs in zip(best, zip(*times, strict=True), strict=True):
                mine.append(min(theirs))
        plain, auto = (1000.0 * statistics.median(each) for each in best)
        worst = max(worst, auto / plain)
        print(f"| {name} | {plain:.3f} ms | {auto:.3f} ms | {auto / plain:.3f} | {others} of {options.queries} |")
    sys.exit(0 if worst <= MOST else 1)


if __name__ == "__main__":
    main()
