"""Fifty missions on a map and fifty in generated warehouses: does the robot arrive, and does it touch anything?

    python benchmarks/missions.py --map carter_warehouse_navigation.yaml [--backend mujoco] [--robot nova_carter]

Seeds 0 to 49; start and goal at least 5 m apart, with room for a full turn at both. The warehouses have aisles of 1.1
to 1.8 m by seed. Every mission counts: none is drawn again, and those that fail are listed.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np

import trundle
from trundle.mission import Episode, sample_mission

MISSIONS = 50


@dataclass(frozen=True)
class Setting:
    """One family of missions: a name and, by seed, a world with its map."""

    name: str
    make: object


def on_map(path: str):
    grid = trundle.OccupancyGrid.load(path)
    world = trundle.World.from_map(grid)
    return lambda seed: (world, grid, "")


def in_warehouse(robot: trundle.Robot):
    def make(seed: int):
        aisle = float(np.random.default_rng(seed).uniform(1.1, 1.8))
        world = trundle.World.generate("warehouse", seed=seed, aisle_width=aisle)
        return world, trundle.OccupancyGrid.from_world(world, z_range=robot.z_range), f"aisles of {aisle:.2f} m"

    return make


def drive(make, seed: int, robot: trundle.Robot, backend: str) -> tuple[Episode, str]:
    world, grid, note = make(seed)
    navigator = trundle.Navigator(grid, robot, planning_deadline_s=None)
    start, goal = sample_mission(navigator.costmap, seed)
    with trundle.simulate(world, robot, backend=backend) as sim:
        episode = trundle.run(sim, navigator, start, goal, seed=seed)
    where = " -> ".join(f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})" for pose in (start, goal))
    return episode, f"seed {seed}, {where}{', ' + note if note else ''}"


def report(name: str, make, robot: trundle.Robot, backend: str, missions: int) -> bool:
    began, episodes, failures = time.perf_counter(), [], []
    for seed in range(missions):
        episode, where = drive(make, seed, robot, backend)
        episodes.append(episode)
        if episode.outcome is not trundle.Outcome.ARRIVED or episode.metrics.contacts:
            failures.append(f"- {where}: {episode.outcome}: {episode.message}")
    counts = Counter(str(episode.outcome) for episode in episodes)
    metrics = [episode.metrics for episode in episodes]
    clearances = sorted(metric.min_clearance_m for metric in metrics)

    def median(values) -> float:
        return statistics.median(list(values))

    print(f"\n## {name}\n")
    print("| figure | value |\n| --- | --- |")
    print(f"| outcomes | {', '.join(f'{count} {outcome}' for outcome, count in counts.items())} |")
    print(f"| contacts | {sum(len(metric.contacts) for metric in metrics)} |")
    print(f"| smallest clearance: least, median | {clearances[0]:.3f} m, {median(clearances):.3f} m |")
    print(
        f"| time: median, longest | {median(m.time_s for m in metrics):.1f} s, {max(m.time_s for m in metrics):.1f} s |"
    )
    print(
        f"| driven: median, longest | {median(m.distance_m for m in metrics):.1f} m, "
        f"{max(m.distance_m for m in metrics):.1f} m |"
    )
    print(f"| SPL: mean | {statistics.mean(m.spl for m in metrics):.3f} |")
    print(
        f"| planning: median, longest | {median(m.planning_ms for m in metrics):.1f} ms, "
        f"{max(m.planning_ms for m in metrics):.1f} ms |"
    )
    print(f"| real-time factor: median | {median(m.real_time_factor for m in metrics):.0f} |")
    print(f"| wall time of all | {time.perf_counter() - began:.1f} s |")
    print("\nFailures: " + ("none" if not failures else "\n" + "\n".join(failures)))
    return not failures


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map", help="path of a ROS map YAML; left out, only the warehouses are driven")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--missions", type=int, default=MISSIONS)
    options = parser.parse_args()
    robot = trundle.Robot.load(options.robot)
    print(
        f"# {options.missions} missions each: {robot.name}, backend {options.backend}, trundle {trundle.__version__}, "
        f"{platform.machine()}, Python {platform.python_version()}"
    )
    done = True
    if options.map:
        done &= report(
            f"On the map {options.map.rsplit('/')[-1]}", on_map(options.map), robot, options.backend, options.missions
        )
    done &= report(
        "In warehouses with aisles of 1.1 to 1.8 m", in_warehouse(robot), robot, options.backend, options.missions
    )
    sys.exit(0 if done else 1)


if __name__ == "__main__":
    main()
