"""Hybrid A* with the true footprint: how long does a plan take [ms], and how good is it?

    python -m benchmarks.planning.hybrid_astar MAP.yaml [--robot nova_carter] [--pairs 1000] [--only offices]

Pairs of poses at least 2 m apart are drawn by seed, anywhere that the footprint fits at any yaw. Those that a kind of
motion does not join within 300,000 expansions are left out; how many they are, and how long it took to say so, stands
below the table. Kinds of motion, each as it is searched and smoothed afterwards, take turns on each pair, so that a
busy moment of the machine hits all; beside the time on the clock stands the processor time of the process. The second
map is made here, 2000 x 2000 cells: 100 x 100 m in rooms of 10 m with doors of 1.5 m and things standing about;
it takes a fifth of the pairs. So do three generated offices of 1.2 to 2 million cells with their furniture; most of
what is hard to reach is there.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass, field

import numpy as np
from benchmarks.planning.plan_missions import dense_poses
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import PlanningError, PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.robots import Robot
from trundle.worlds import World

FAR_M = 2.0
OFFICES = ((1, (60.0, 50.0)), (2, (75.0, 65.0)), (3, (90.0, 55.0)))
"""Seed and size [m] of each."""
DIRECT = 1.2
"""Paths shorter than this many times the straight line are counted apart."""


@dataclass
class Contestant:
    """A planner and what it did on each pair."""

    name: str
    planner: HybridAStarPlanner
    clock_ms: list[float] = field(default_factory=list)
    processor_ms: list[float] = field(default_factory=list)
    paths: list[Path] = field(default_factory=list)
    refused_ms: list[float] = field(default_factory=list)
    """Processor time of those without a path."""
    exhausted: int = 0
    """How many of these ended at the most expansions."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        clock, processor = time.perf_counter(), time.process_time()
        try:
            path = self.planner.plan(costmap, start, goal)
        except PlanningError as error:
            self.refused_ms.append(1e3 * (time.process_time() - processor))
            self.exhausted += isinstance(error, PlanningStoppedError)
            return
        self.processor_ms.append(1e3 * (time.process_time() - processor))
        self.clock_ms.append(1e3 * (time.perf_counter() - clock))
        self.paths.append(path)


def draw_pairs(costmap: Costmap, count: int) -> list[tuple[Pose2D, Pose2D]]:
    """Pairs of poses where the footprint fits, drawn with seed 0."""
    generator = np.random.default_rng(0)
    rows, cols = np.nonzero(costmap.data < INSCRIBED)

    def draw() -> Pose2D:
        while True:
            k = int(generator.integers(len(rows)))
            x, y = costmap.cell_to_world(rows[k] + generator.uniform(-0.5, 0.5), cols[k] + generator.uniform(-0.5, 0.5))
            pose = Pose2D(float(x), float(y), generator.uniform(-math.pi, math.pi))
            if not costmap.footprint_collides([pose.as_tuple()])[0]:
                return pose

    pairs: list[tuple[Pose2D, Pose2D]] = []
    while len(pairs) < count:
        start, goal = draw(), draw()
        if start.distance_to(goal) >= FAR_M:
            pairs.append((start, goal))
    return pairs


def rooms(robot: Robot) -> Costmap:
    """2000 x 2000 cells of 0.05 m: rooms of 10 m, a door of 1.5 m in every wall, and six things in every room."""
    generator = np.random.default_rng(7)
    data = np.zeros((2000, 2000), np.int8)
    for k in range(0, 2000, 200):
        data[k : k + 3, :] = data[:, k : k + 3] = 100
    data[-3:, :] = data[:, -3:] = 100
    for row in range(0, 2000, 200):
        for col in range(0, 2000, 200):
            for _ in range(6):
                r, c = (int(value) for value in generator.integers(40, 150, 2))
                height, width = (int(value) for value in generator.integers(4, 30, 2))
                data[row + r : row + min(r + height, 165), col + c : col + min(c + width, 165)] = 100
            along, across = (int(value) for value in generator.integers(20, 150, 2))
            if row > 0:
                data[row : row + 3, col + along : col + along + 30] = 0
            if col > 0:
                data[row + across : row + across + 30, col : col + 3] = 0
    return Costmap.from_grid(OccupancyGrid(data, 0.05), robot)


def office(robot: Robot, seed: int, size: tuple[float, float]) -> Costmap:
    """A furnished office in cells of 0.05 m."""
    return Costmap.from_grid(
        OccupancyGrid.from_world(World.generate("office", seed=seed, size=size), resolution=0.05), robot
    )


def contestants(radius: float) -> list[Contestant]:
    kinds: dict[str, dict[str, object]] = {
        "Reeds-Shepp": {},
        "Reeds-Shepp, `in_place`": {"in_place": True},
        "Dubins": {"motion_model": "dubins"},
        "Dubins, `in_place`": {"motion_model": "dubins", "in_place": True},
    }
    return [
        Contestant(
            f"{name}, {'smoothed' if smooth else 'searched'}",
            HybridAStarPlanner(minimum_turning_radius=radius, max_expansions=300_000, smooth=smooth, **options),
        )
        for name, options in kinds.items()
        for smooth in (False, True)
    ]


def first_queries(costmap: Costmap, pair: tuple[Pose2D, Pose2D], radius: float) -> str:
    """Milliseconds of the first and the second plan of new planners, least of 7."""
    first, second = [], []
    for _ in range(7):
        planner = HybridAStarPlanner(minimum_turning_radius=radius)
        for times in (first, second):
            begin = time.perf_counter()
            planner.plan(costmap, *pair)
            times.append(1e3 * (time.perf_counter() - begin))
    return f"first plan of a new planner {min(first):.2f} ms, the same again {min(second):.2f} ms"


def play(costmap: Costmap, pairs: list[tuple[Pose2D, Pose2D]], radius: float) -> None:
    teams = contestants(radius)
    for start, goal in pairs:
        for team in teams:
            team.plan(costmap, start, goal)
    header = ("motions", "planned", "direct: median", "of these", "processor", "all: median", "p95", "p99", "largest",
              "processor", "p99", "length / straight", "changes", "touching", "MB kept")  # fmt: skip
    print_table(header, [row(team, costmap) for team in teams])
    print()
    for team in teams:
        if team.refused_ms:
            print(
                f"no path: {team.name}: {len(team.refused_ms)}, {team.exhausted} of them at the most expansions; "
                f"processor ms: median {np.median(team.refused_ms):.1f}, largest {max(team.refused_ms):.0f}"
            )
    hardest = int(np.argmax(teams[0].processor_ms))
    path = teams[0].paths[hardest]
    print(f"hardest for {teams[0].name}: {path.start} to {path.goal}; {first_queries(costmap, pairs[0], radius)}")


def row(team: Contestant, costmap: Costmap) -> tuple[str, ...]:
    clock, processor = np.array(team.clock_ms), np.array(team.processor_ms)
    ratio = np.array([path.length / path.start.distance_to(path.goal) for path in team.paths])
    direct = ratio < DIRECT
    changes = [np.count_nonzero(np.diff(path.backward)) for path in team.paths]
    touching = sum(bool(costmap.footprint_collides(dense_poses(path)).any()) for path in team.paths)
    return (
        team.name,
        str(len(clock)),
        f"{np.median(clock[direct]):.2f}",
        str(direct.sum()),
        f"{np.median(processor[direct]):.2f}",
        f"{np.median(clock):.2f}",
        f"{np.percentile(clock, 95):.1f}",
        f"{np.percentile(clock, 99):.1f}",
        f"{clock.max():.0f}",
        f"{np.median(processor):.2f}",
        f"{np.percentile(processor, 99):.1f}",
        f"{np.mean(ratio):.3f}",
        f"{np.mean(changes):.2f}",
        str(touching),
        f"{team.planner.nbytes / 1e6:.0f}",
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="ROS map YAML")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--pairs", type=int, default=1000)
    parser.add_argument("--radius", type=float, default=0.4)
    parser.add_argument("--only", choices=("maps", "offices"))
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    print(describe_machine())
    maps: list[tuple[Costmap, int]] = []
    if options.only != "offices":
        maps.append((Costmap.from_grid(OccupancyGrid.load(options.map), robot), options.pairs))
        maps.append((rooms(robot), options.pairs // 5))
    if options.only != "maps":
        maps += [(office(robot, seed, size), options.pairs // 5) for seed, size in OFFICES]
    for costmap, count in maps:
        rows, cols = costmap.shape
        print(f"\n{options.robot}, {cols} x {rows} cells, {count} pairs, minimum radius {options.radius:g} m\n")
        play(costmap, draw_pairs(costmap, count), options.radius)


if __name__ == "__main__":
    main()
