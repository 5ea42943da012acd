"""Missions in MuJoCo, by seed: does the robot arrive, and does it touch anything?

    python benchmarks/missions.py --map carter_warehouse_navigation.yaml [--jobs 16] [--backend mujoco]

Roomy ends: fifty missions on a map and fifty in generated warehouses with aisles of 1.1 to 1.8 m; start and goal at
least 5 m apart, with room for a full turn at both.

Tight ends: a hundred missions on the map and in each of three worlds, between random poses whose footprint is free by
0.03 to 0.25 m, in one area that the robot's inscribed circle can get about in. There each pair is also planned by
`least_cost` and `hybrid_astar` alone, to see that the default planner misses no path that one of them finds.

Every mission counts: none is drawn again, and those that fail are listed.
"""

from __future__ import annotations

import argparse
import functools
import math
import multiprocessing
import platform
import statistics
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field

import numpy as np

import trundle
from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import PlanningError
from trundle.geometry import Pose2D
from trundle.mission import Metrics, sample_mission
from trundle.planning import create_planner

ROOMY, TIGHT = 50, 100
TIGHT_CLEARANCE = (0.03, 0.25)
TIGHT_WORLDS = ("office", "warehouse", "lot")
TIGHT_SEED = 3
ALONE = {
    "least_cost": ("least_cost", {}),
    "hybrid_astar": ("hybrid_astar", {}),
    "hybrid_astar, in_place": ("hybrid_astar", {"in_place": True}),
}
LEAST_DISTANCE = 0.5


@dataclass(frozen=True)
class Job:
    """One mission: where, which, and with what."""

    place: str  # "roomy map", "roomy warehouse", "tight map" or "tight <world>"
    seed: int
    robot: str
    backend: str
    map: str | None


@dataclass(frozen=True)
class Result:
    """What became of it; `planned` says who found a path, `by` whose path the default planner took."""

    where: str
    outcome: str
    message: str
    metrics: Metrics
    planned: frozenset[str] = field(default_factory=frozenset)
    by: str = ""

    @property
    def is_fine(self) -> bool:
        return self.outcome == trundle.Outcome.ARRIVED and not self.metrics.contacts


@functools.cache
def place_of(
    name: str, seed: int, aisle_width: float | None, robot: str, map_file: str | None
) -> tuple[trundle.World, trundle.OccupancyGrid]:
    if name == "map":
        grid = trundle.OccupancyGrid.load(map_file)
        return trundle.World.from_map(grid), grid
    options = {} if aisle_width is None else {"aisle_width": aisle_width}
    world = trundle.World.generate(name, seed=seed, **options)
    return world, trundle.OccupancyGrid.from_world(world, z_range=trundle.Robot.load(robot).z_range)


def sample_tight_ends(costmap: Costmap, seed: int) -> tuple[Pose2D, Pose2D]:
    """Two random poses in one area, each free by 0.03 to 0.25 m."""
    rng = np.random.default_rng(seed)
    areas, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), diagonal=False)
    poses = _tight_poses(costmap, areas, rng)
    start, area = next(poses)
    return start, next(pose for pose, its in poses if its == area and pose.distance_to(start) >= LEAST_DISTANCE)


def _tight_poses(costmap: Costmap, areas: np.ndarray, rng: np.random.Generator) -> Iterator[tuple[Pose2D, int]]:
    cells, half = np.flatnonzero(areas > 0), 0.5 * costmap.resolution
    while True:
        rows, cols = np.unravel_index(rng.choice(cells, 256), areas.shape)
        x, y = (centre + rng.uniform(-half, half, 256) for centre in costmap.cell_to_world(rows, cols))
        poses = np.round(np.column_stack([x, y, rng.uniform(-math.pi, math.pi, 256)]), 4)
        clearance = costmap.clearance(poses, cap=0.5)
        for k in np.flatnonzero((clearance >= TIGHT_CLEARANCE[0]) & (clearance <= TIGHT_CLEARANCE[1])):
            yield Pose2D(*poses[k].tolist()), int(areas[rows[k], cols[k]])


def drive(job: Job) -> Result:
    kind, _, place = job.place.partition(" ")
    seed, aisle = TIGHT_SEED, None
    if job.place == "roomy warehouse":
        seed, aisle = job.seed, float(np.random.default_rng(job.seed).uniform(1.1, 1.8))
    world, grid = place_of(place, seed, aisle, job.robot, job.map)
    navigator = trundle.Navigator(grid, job.robot, settings=trundle.NavigatorSettings(planning_deadline_s=None))
    planned: set[str] = set()
    by = ""
    if kind == "tight":
        start, goal = sample_tight_ends(navigator.costmap, job.seed)
        for name, (planner, options) in {**ALONE, "auto": ("auto", {})}.items():
            try:
                path = create_planner(planner, **options).plan(navigator.costmap, start, goal)
            except PlanningError:
                continue
            planned.add(name)
            by = path.planner if name == "auto" else by
    else:
        start, goal = sample_mission(navigator.costmap, job.seed)
    with trundle.simulate(world, job.robot, backend=job.backend) as sim:
        episode = trundle.run(sim, navigator, start, goal, seed=job.seed)
    where = " -> ".join(f"({pose.x:.4f}, {pose.y:.4f}, {pose.yaw:.4f})" for pose in (start, goal))
    return Result(
        f"seed {job.seed}, {where}", str(episode.outcome), episode.message, episode.metrics, frozenset(planned), by
    )


def figures(results: list[Result]) -> dict[str, str]:
    metrics = [result.metrics for result in results]

    def median(values) -> float:
        return statistics.median(list(values))

    return {
        "outcomes": ", ".join(f"{count} {name}" for name, count in Counter(each.outcome for each in results).items()),
        "contacts": f"{sum(len(m.contacts) for m in metrics)}",
        "smallest clearance: least, median": f"{min(m.min_clearance_m for m in metrics):.3f} m, "
        f"{median(m.min_clearance_m for m in metrics):.3f} m",
        "time: median, longest": f"{median(m.time_s for m in metrics):.1f} s, {max(m.time_s for m in metrics):.1f} s",
        "driven: median, longest": f"{median(m.distance_m for m in metrics):.1f} m, "
        f"{max(m.distance_m for m in metrics):.1f} m",
        "SPL: mean": f"{statistics.mean(m.spl for m in metrics):.3f}",
        "planning: median, longest": f"{median(m.planning_ms for m in metrics):.1f} ms, "
        f"{max(m.planning_ms for m in metrics):.1f} ms",
        "real-time factor: median": f"{median(m.real_time_factor for m in metrics):.0f}",
    }


def plan_figures(results: list[Result]) -> dict[str, str]:
    by = Counter(result.by for result in results if "auto" in result.planned)
    missed = [result for result in results if result.planned and "auto" not in result.planned]
    found = {name: sum(name in result.planned for result in results) for name in (*ALONE, "auto")}
    return {
        "planned by each alone": ", ".join(f"{name} {count}" for name, count in found.items() if name != "auto"),
        "planned by default": f"{found['auto']} ({', '.join(f'{count} by {name}' for name, count in by.items())})",
        "missed of what one of them finds": f"{len(missed)}",
    }


def report(title: str, results: list[Result]) -> None:
    is_tight = any(result.planned for result in results)
    rows = (plan_figures(results) if is_tight else {}) | figures(results)
    print(f"\n## {title}\n\n| figure | value |\n| --- | --- |")
    print("\n".join(f"| {name} | {value} |" for name, value in rows.items()))
    failures = [f"- {each.where}: {each.outcome}: {each.message}" for each in results if not each.is_fine]
    print("\nFailures: " + ("none" if not failures else "\n" + "\n".join(failures)), flush=True)


def report_tight(results: list[Result]) -> bool:
    """The figure of all tight ends together: whether 99 % of what was planned arrived, and nothing was missed."""
    planned = [result for result in results if "auto" in result.planned]
    fine = sum(result.is_fine for result in planned)
    missed = sum(bool(result.planned) and "auto" not in result.planned for result in results)
    print(
        f"\n## Tight ends together\n\n{fine} of {len(planned)} planned missions arrived without contact "
        f"({fine / max(1, len(planned)):.1%}); {missed} pairs are missed."
    )
    return fine >= 0.99 * len(planned) and not missed


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map", help="path of a ROS map YAML; left out, only generated worlds are driven in")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--missions", type=int, default=ROOMY, help="of each family with roomy ends")
    parser.add_argument("--tight", type=int, default=TIGHT, help="missions of each world with tight ends")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    options = parser.parse_args()
    print(
        f"# Missions: {options.robot}, backend {options.backend}, trundle {trundle.__version__}, "
        f"{platform.machine()}, Python {platform.python_version()}, {options.jobs} processes"
    )
    on_map = ("map",) if options.map else ()
    families = {f"roomy {name}": options.missions for name in (*on_map, "warehouse")}
    families |= {f"tight {name}": options.tight for name in (*on_map, *TIGHT_WORLDS)}
    titles = {
        "roomy map": f"On the map {str(options.map).rsplit('/')[-1]}",
        "roomy warehouse": "In warehouses with aisles of 1.1 to 1.8 m",
        "tight map": f"Tight ends on the map {str(options.map).rsplit('/')[-1]}",
        **{f"tight {name}": f"Tight ends in `{name}`, seed {TIGHT_SEED}" for name in TIGHT_WORLDS},
    }
    began, done, tight = time.perf_counter(), True, []
    with ProcessPoolExecutor(options.jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        for family, count in families.items():
            jobs = [Job(family, seed, options.robot, options.backend, options.map) for seed in range(count)]
            results = list(pool.map(drive, jobs))
            if not results:
                continue
            report(titles[family], results)
            if family.startswith("tight"):
                tight += results
            else:
                done &= all(result.is_fine for result in results)
    if tight:
        done &= report_tight(tight)
    print(f"\nWall time of all: {time.perf_counter() - began:.1f} s")
    sys.exit(0 if done else 1)


if __name__ == "__main__":
    main()
