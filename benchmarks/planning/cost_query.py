"""One query on a grid with costs, against pyastar2d on the same grid.

    python -m benchmarks.planning.cost_query [--size 1000] [--queries 20] [--rounds 5]

Both search with 8 neighbours over the weights 50 + 0.8 · cost (pyastar2d gets them divided by 50, as it wants 1 or
more, and infinity where a cell is blocked). It is not the same problem: a diagonal step costs pyastar2d as much as a
straight one, and it cuts corners; so it has less to do. Every query starts cold: nothing is kept between queries.
"""

from __future__ import annotations

import argparse
import statistics

import numpy as np
from benchmarks.planning.inflation import RESOLUTION, make_map
from benchmarks.timing import describe_machine, interleaved_medians, load_peer, print_table

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.planning.grid_planners.footprint_planner import cell_weights
from trundle.planning.grid_planners.least_cost import COST_WEIGHT, NEUTRAL_COST, LeastCostPlanner

FOOTPRINT = np.array([(0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)])


def pick_queries(costmap: Costmap, weights: np.ndarray, count: int) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Cells where the robot can turn round, at least half a map apart and connected by a path."""
    rng = np.random.default_rng(1)
    size = costmap.shape[0]
    open_cells = np.argwhere(costmap.data < 180)
    queries: list[tuple[tuple[int, int], tuple[int, int]]] = []
    while len(queries) < count:
        start, goal = (tuple(int(i) for i in cell) for cell in rng.choice(open_cells, 2))
        if np.hypot(start[0] - goal[0], start[1] - goal[1]) < size / 2:
            continue
        if len(_core.grid_search(costmap.data, weights, start, goal)[0]) > 0:
            queries.append((start, goal))
    return queries


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=1000, help="edge of the map [cells]")
    parser.add_argument("--queries", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    pyastar2d = load_peer("pyastar2d", "pyastar2d")

    costmap = Costmap.from_grid(OccupancyGrid(make_map(options.size), RESOLUTION), FOOTPRINT)
    weights = cell_weights(NEUTRAL_COST, COST_WEIGHT)
    whole = np.floor(weights).astype(np.uint16)
    theirs = np.floor(weights)[costmap.data].astype(np.float32) / np.float32(NEUTRAL_COST)
    theirs[theirs == 0] = np.inf
    planner = LeastCostPlanner()

    medians: dict[str, list[float]] = {}
    ratios: dict[str, list[float]] = {}
    for start, goal in pick_queries(costmap, whole, options.queries):
        start_pose, goal_pose = (Pose2D(*(float(v) for v in costmap.cell_to_world(*cell))) for cell in (start, goal))
        times = interleaved_medians(
            {
                "trundle, the search": lambda s=start, g=goal: _core.grid_search(costmap.data, whole, s, g),
                "trundle, least_cost with shortcut and checks": lambda s=start_pose, g=goal_pose: planner.plan(
                    costmap, s, g
                ),
                "pyastar2d": lambda s=start, g=goal: pyastar2d.astar_path(theirs, s, g, allow_diagonal=True),
            },
            options.rounds,
        )
        for name, value in times.items():
            medians.setdefault(name, []).append(value)
            ratios.setdefault(name, []).append(times["pyastar2d"] / value)
    print(f"Query with costs, {options.size} x {options.size}, {options.queries} queries, medians")
    print(describe_machine() + "\n")
    print_table(
        ("what", "ms", "pyastar2d's time over it: median (smallest)"),
        [
            (
                name,
                f"{1e3 * statistics.median(values):.2f}",
                f"{statistics.median(ratios[name]):.1f} ({min(ratios[name]):.1f})",
            )
            for name, values in medians.items()
        ],
    )


if __name__ == "__main__":
    main()
