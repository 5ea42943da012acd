"""Many missions planned on one map: do all of them plan, does the footprint touch anything, how long does it take?

    python -m benchmarks.planning.plan_missions MAP.yaml [--robot nova_carter] [--missions 200]

Start and goal are drawn by seed, at least 5 m apart, with room for a full turn at both. Every path is then checked with
the oriented footprint every 5 mm and 0.5°, five and four times as finely as the planner does.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import FloatArray
from trundle.maps.grid import OccupancyGrid
from trundle.mission import sample_mission
from trundle.path import Path
from trundle.planning import create_planner
from trundle.robots import Robot

STEP_M = 0.005
STEP_RAD = np.radians(0.5)


def dense_poses(path: Path) -> FloatArray:
    """Poses along a path, at most STEP_M and STEP_RAD apart."""
    pieces = []
    for a, b in zip(path.poses[:-1], path.poses[1:], strict=True):
        change = b - a
        change[2] = np.remainder(change[2] + np.pi, 2.0 * np.pi) - np.pi
        count = 1 + int(max(np.hypot(change[0], change[1]) / STEP_M, abs(change[2]) / STEP_RAD))
        pieces.append(a + np.linspace(0.0, 1.0, count + 1)[:, np.newaxis] * change)
    return np.concatenate(pieces)


def plan_all(name: str, costmap: Costmap, missions: int) -> tuple[str, ...]:
    planner = create_planner(name)
    times, replans, clearances, lengths = [], [], [], []
    failures: list[str] = []
    for seed in range(missions):
        start, goal = sample_mission(costmap, seed)
        begin = time.perf_counter()
        try:
            path = planner.plan(costmap, start, goal)
        except PlanningError as error:
            failures.append(f"{name}, seed {seed}: {error}")
            continue
        times.append(1e3 * (time.perf_counter() - begin))
        replans.append(path.replans)
        lengths.append(path.length)
        clearances.append(float(costmap.clearance(dense_poses(path)).min()))
    for failure in failures:
        print(failure)
    return (
        name,
        f"{len(times)} of {missions}",
        str(sum(clearance == 0.0 for clearance in clearances)),
        f"{statistics.mean(replans):.2f}",
        f"{statistics.median(times):.1f}",
        f"{np.percentile(times, 95):.1f}",
        f"{min(clearances):.3f}",
        f"{statistics.median(clearances):.2f}",
        f"{sum(lengths):.0f}",
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="ROS map YAML")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--missions", type=int, default=200)
    options = parser.parse_args()
    costmap = Costmap.from_grid(OccupancyGrid.load(options.map), Robot.load(options.robot))
    print(f"{options.missions} missions of {options.robot} on {costmap.shape[1]} x {costmap.shape[0]} cells")
    print(describe_machine() + "\n")
    header = ("planner", "planned", "touching", "replans", "ms", "p95", "clearance m", "median", "length m")
    print_table(
        header, [plan_all(name, costmap, options.missions) for name in ("least_cost", "astar", "manhattan_astar")]
    )


if __name__ == "__main__":
    main()
