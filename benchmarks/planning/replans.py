"""Large maps where the footprint collides again and again: are all queries planned, and with how many replans?

    python -m benchmarks.planning.replans [--size 4096] [--queries 20] [--planners astar any_angle least_cost]

Two maps of cells of 5 cm, made by seed: rooms of 10 m with a door of 1 m in each wall, and free space with sparse
clutter, boxes of 0.1 to 0.6 m and one on 8 m². Nova Carter drives between places where it can turn in place, drawn by
seed all over the map. The time is the process's; each path is checked with the footprint.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
import numpy.typing as npt
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import PathCheck, create_planner
from trundle.robots import Robot

RESOLUTION = 0.05
ROOM = 200
DOOR = 20
WALL = 2


def rooms(size: int, seed: int) -> npt.NDArray[np.int8]:
    """Rooms of 10 m, their walls of 0.1 m with a door of 1 m between each two."""
    rng = np.random.default_rng(seed)
    cells = np.zeros((size, size), np.int8)
    for wall in range(ROOM, size - DOOR, ROOM):
        cells[wall : wall + WALL], cells[:, wall : wall + WALL] = 100, 100
    for wall in range(ROOM, size - DOOR, ROOM):
        for room in range(0, size - ROOM // 2, ROOM):
            for turned in (cells, cells.T):
                door = room + int(rng.integers(WALL + 4, ROOM - DOOR - 4)) if room + ROOM <= size else room + WALL + 4
                turned[wall : wall + WALL, door : door + DOOR] = 0
    return cells


def clutter(size: int, seed: int) -> npt.NDArray[np.int8]:
    """Boxes of 0.1 to 0.6 m, one on 8 m²."""
    rng = np.random.default_rng(seed)
    cells = np.zeros((size, size), np.int8)
    for _ in range(int((size * RESOLUTION) ** 2 / 8.0)):
        height, width = rng.integers(2, 13, 2)
        row, col = rng.integers(0, size, 2)
        cells[row : row + height, col : col + width] = 100
    return cells


def draw(costmap: Costmap, count: int) -> list[tuple[Pose2D, Pose2D]]:
    """Pairs of poses at least half the map's edge apart, the robot able to turn at both."""
    rng, edge, pairs = np.random.default_rng(3), costmap.shape[0] * RESOLUTION, []
    while len(pairs) < count:
        ends = np.column_stack([rng.uniform(0.0, edge, (2, 2)), rng.uniform(-np.pi, np.pi, 2)])
        all_round = costmap.footprint_sweeps(ends, np.add(ends, (0.0, 0.0, 2.0 * np.pi)))
        if np.isinf(all_round).all() and np.hypot(*(ends[1] - ends[0])[:2]) > 0.5 * edge:
            pairs.append((Pose2D(*ends[0].tolist()), Pose2D(*ends[1].tolist())))
    return pairs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=4096, help="edge of the maps [cells]")
    parser.add_argument("--queries", type=int, default=20)
    parser.add_argument("--planners", nargs="+", default=["astar", "any_angle", "least_cost"])
    arguments = parser.parse_args()
    robot, rows = Robot.load("nova_carter"), []
    for name, make in (("rooms", rooms), ("clutter", clutter)):
        costmap = Costmap.from_grid(OccupancyGrid(make(arguments.size, 1), RESOLUTION), robot)
        missions = draw(costmap, arguments.queries)
        for planner_name in arguments.planners:
            planner = create_planner(planner_name)
            times, replans, lengths, failures = [], [], [], []
            for start, goal in missions:
                begin = time.process_time()
                try:
                    path = planner.plan(costmap, start, goal)
                except PlanningError as error:
                    failures.append(str(error))
                else:
                    replans.append(path.replans)
                    lengths.append(path.length)
                    if PathCheck(path).first_hit(costmap) is not None:
                        raise SystemExit(f"{planner_name}: the path from {start} to {goal} is not free")
                times.append(time.process_time() - begin)
            rows.append(
                [name, planner_name, f"{len(replans)}/{len(missions)}",
                 *(f"{value:.0f}" for value in (statistics.median(replans or [0]), max(replans, default=0))),
                 *(f"{value:.2f}" for value in (statistics.median(times), max(times), sum(lengths)))]
            )  # fmt: skip
            for failure in failures:
                print(f"{name}, {planner_name}: {failure}")
    print(describe_machine())
    header = ["map", "planner", "planned", "replans: median", "most", "s: median", "most", "m in all"]
    print_table(header, rows)


if __name__ == "__main__":
    main()
