"""Many queries on two threads: how many times as fast as on one, and what the machine itself gives.

    python -m benchmarks.planning.plan_many MAP.yaml CITY.map [--rounds 9] [--queries 120]

`GridSearch.plan_many` and `any_angle_paths` ask the queries of CITY.map.scen, the planners seeded missions of Nova
Carter on MAP.yaml. In each round all queries are asked on one thread, then on two, and then by two processes at once
that have half of them each, on one thread: what two processors give to work that shares nothing. Times are by the
clock, so nothing else may run: on a machine with more processors, `taskset -c 2,3` leaves it two.
"""

from __future__ import annotations

import argparse
import multiprocessing
import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import Costmap
from trundle.maps.grid import OccupancyGrid
from trundle.maps.movingai import load_map, load_scenarios
from trundle.mission import sample_mission
from trundle.planning import GridSearch, create_planner, plan_many
from trundle.robots import Robot

SEARCHES = ("GridSearch.plan_many", "GridSearch.any_angle_paths")
PLANNERS = ("least_cost", "hybrid_astar", "any_angle", "astar")


def prepare(what: str, options: argparse.Namespace) -> tuple[Callable[[slice, int], object], int]:
    """What asks some of the queries on so many threads, and how many queries there are."""
    if what in SEARCHES:
        search, queries = GridSearch(load_map(options.city).data != 0), load_scenarios(f"{options.city}.scen")
        starts, goals = np.array([query.start for query in queries]), np.array([query.goal for query in queries])
        ask = search.plan_many if what == SEARCHES[0] else search.any_angle_paths
        return lambda part, threads: ask(starts[part], goals[part], threads=threads), len(queries)
    costmap = Costmap.from_grid(OccupancyGrid.load(options.map), Robot.load("nova_carter"))
    planner = create_planner(what)
    pairs = [sample_mission(costmap, seed) for seed in range(options.queries)]
    return lambda part, threads: plan_many(
        planner, costmap, [start for start, _ in pairs[part]], [goal for _, goal in pairs[part]], threads=threads
    ), len(pairs)


def work(what: str, options: argparse.Namespace, half: int, end: Connection) -> None:
    """A process that plans every second query on request."""
    ask, count = prepare(what, options)
    ask(slice(half, count, 2), 1)
    end.send(True)
    while end.recv():
        ask(slice(half, count, 2), 1)
        end.send(True)


def race(what: str, options: argparse.Namespace) -> tuple[str, ...]:
    ask, count = prepare(what, options)
    every = slice(0, count)
    ask(every, 1)
    ask(every, 2)
    ends: list[Connection] = []
    for half in (0, 1):
        here, there = multiprocessing.Pipe()
        multiprocessing.Process(target=work, args=(what, options, half, there), daemon=True).start()
        ends.append(here)
    for end in ends:
        end.recv()

    def apart() -> None:
        for end in ends:
            end.send(True)
        for end in ends:
            end.recv()

    times = np.array([[clock(lambda: ask(every, 1)), clock(lambda: ask(every, 2)), clock(apart)]
                      for _ in range(options.rounds)])  # fmt: skip
    for end in ends:
        end.send(False)
    one, two, processes = times.min(axis=0)
    ratios = np.median(times[:, :1] / times[:, 1:], axis=0)
    return (what, str(count), f"{one:.1f}", f"{two:.1f}", f"{one / two:.2f} ({ratios[0]:.2f})",
            f"{one / processes:.2f} ({ratios[1]:.2f})")  # fmt: skip


def clock(run: Callable[[], object]) -> float:
    """Milliseconds."""
    begin = time.perf_counter()
    run()
    return 1e3 * (time.perf_counter() - begin)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", type=Path, help="ROS map YAML")
    parser.add_argument("city", type=Path, help="MovingAI map with its .scen file")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--queries", type=int, default=120, help="missions on the ROS map")
    options = parser.parse_args()
    print(describe_machine() + "\n\nBest of the rounds, and in brackets the median of their ratios.\n")
    rows = [race(what, options) for what in (*SEARCHES, *PLANNERS)]
    print_table(("what", "queries", "one thread, ms", "two, ms", "two threads / one", "two processes / one"), rows)


if __name__ == "__main__":
    main()
