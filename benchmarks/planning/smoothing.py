"""Smoothing: how long does it take [ms of the processor], and what does it make of planners' paths?

    python -m benchmarks.planning.smoothing MAP.yaml [--robot nova_carter] [--pairs 100] [--missions 10]

Pairs of poses are drawn by seed on the map, in a generated warehouse, and in rooms of 2000 x 2000 cells, and planned
by hybrid A* (not smoothed), `least_cost` and `astar`. Beside `ConstrainedSmoother` stands a peer: gradient descent on
the places of the poses, as Nav2's simple smoother has it (weights 0.2 and 0.3, no look at costs or footprint, but it
stops at blocked cells), written here. J is the integral of 1 + w · cost / 252, with the planner's w. Then missions of
hybrid A* and `astar` are driven in both simulators as planned and smoothed.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np
from benchmarks.planning.hybrid_astar import draw_pairs, rooms
from benchmarks.planning.plan_missions import dense_poses
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import PlanningError
from trundle.geometry import FloatArray
from trundle.maps.grid import OccupancyGrid
from trundle.mission import Outcome, Scenario
from trundle.path import Path
from trundle.planning import PathCheck, create_planner
from trundle.planning.constrained_smoother import ConstrainedSmoother
from trundle.robots import Robot
from trundle.worlds import World

PLANNERS: tuple[tuple[str, dict[str, Any], float], ...] = (
    ("hybrid_astar", {"smooth": False}, 2.0),
    ("least_cost", {}, 4.0),
    ("astar", {}, 4.0),
)
HEADER = ("paths of", "made by", "ms: median", "p99", "per m", "length m", "turning rad", "stops", "tightest bend 1/m",
          "J", "worst J / before", "least clearance m", "mean m", "kept", "touching")  # fmt: skip


def gradient(path: Path, costmap: Costmap) -> Path:
    """The peer: 1,000 steps at most, yaws along the path; the planned path where a pose would be blocked."""
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    places = path.poses[np.concatenate([[True], steps > 1e-9]), :2]
    if len(places) < 3:
        return path
    new = places.copy()
    for _ in range(1000):
        pull = 0.2 * (places[1:-1] - new[1:-1]) + 0.3 * (new[:-2] + new[2:] - 2.0 * new[1:-1])
        moved = new[1:-1] + pull
        if (costmap.cost_at(moved[:, 0], moved[:, 1]) >= INSCRIBED).any():
            break
        new[1:-1] = moved
        if (pull**2).sum() < 1e-10:
            break
    ahead = np.arctan2(*np.gradient(new, axis=0).T[::-1])
    poses = np.column_stack([new, ahead])
    return Path(np.concatenate([path.poses[:1], poses, path.poses[-1:]]))


def wrapped(angles: FloatArray) -> FloatArray:
    return np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi


def row(costmap: Costmap, names: tuple[str, str], paths: list[Path], before: list[Path], times: list[float],
        w_cost: float, kept: list[float]) -> tuple[str, ...]:  # fmt: skip
    lengths, turnings, stops, bends, prices, nearest, mean, ratios = ([] for _ in range(8))
    touching = 0
    for path, old in zip(paths, before, strict=True):
        legs = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
        turns = np.abs(wrapped(np.diff(path.poses[:, 2])))
        drives = legs > 1e-6
        lengths.append(path.length)
        turnings.append(turns.sum())
        stops.append(int((turns[~drives] > 1e-3).sum()) + int(np.count_nonzero(np.diff(path.backward[drives]))))
        bends.append((2.0 * np.sin(turns[drives] / 2.0) / legs[drives]).max(initial=0.0))
        prices.append(line_integral(costmap, path, w_cost))
        ratios.append(prices[-1] / line_integral(costmap, old, w_cost))
        clearance = costmap.clearance(path.poses)
        nearest.append(clearance.min())
        mean.append(clearance.mean())
        touching += bool(costmap.footprint_collides(dense_poses(path)).any())
    milliseconds = 1e3 * np.array(times)
    return (
        *names,
        f"{np.median(milliseconds):.2f}",
        f"{np.percentile(milliseconds, 99):.1f}",
        f"{milliseconds.sum() / np.sum([path.length for path in before]):.3f}",
        f"{np.mean(lengths):.2f}",
        f"{np.mean(turnings):.2f}",
        f"{np.mean(stops):.2f}",
        f"{np.max(bends):.2f}",
        f"{np.mean(prices):.2f}",
        f"{np.max(ratios):.4f}",
        f"{np.min(nearest):.3f}",
        f"{np.mean(mean):.3f}",
        f"{100.0 * np.mean(kept):.0f} %",
        str(touching),
    )


def line_integral(costmap: Costmap, path: Path, w_cost: float) -> float:
    check = PathCheck(path)
    costs = np.minimum(costmap.cost_at(check.poses[:, 0], check.poses[:, 1]).astype(float), 252.0)
    weights = 1.0 + w_cost * costs / 252.0
    return float((0.5 * (weights[1:] + weights[:-1]) * np.diff(check.along)).sum())


def play(costmap: Costmap, count: int) -> None:
    pairs = draw_pairs(costmap, count)
    rows = []
    for name, options, w_cost in PLANNERS:
        planner, smoother = create_planner(name, **options), ConstrainedSmoother(w_cost=w_cost)
        planned: list[Path] = []
        for start, goal in pairs:
            try:
                planned.append(planner.plan(costmap, start, goal))
            except PlanningError:
                continue
        rows.append(row(costmap, (name, "planned"), planned, planned, [0.0] * len(planned), w_cost, [1.0]))
        times, made, kept = [], [], []
        peers, peer_times = [], []
        for path in planned:
            began = time.thread_time()
            done = smoother.smooth_free(path, costmap)
            times.append(time.thread_time() - began)
            made.append(done.path)
            legs = np.hypot(*np.diff(done.path.poses[:, :2], axis=0).T)
            kept.append(float(legs[done.kept].sum() / max(legs.sum(), 1e-9)))
            began = time.thread_time()
            if not path.backward.any():  # the peer knows no direction
                peers.append((gradient(path, costmap), path))
                peer_times.append(time.thread_time() - began)
        rows.append(row(costmap, (name, "constrained"), made, planned, times, w_cost, kept))
        rows.append(
            row(costmap, (name, "gradient"), [a for a, _ in peers], [b for _, b in peers], peer_times, w_cost, [0.0])
        )
    print_table(HEADER, rows)


def drive(count: int) -> None:
    """Missions as planned and smoothed: time, turning and contacts, where both arrive."""
    rows = []
    for backend in ("kinematic", "mujoco"):
        for planner in ("hybrid_astar", "astar"):
            totals = np.zeros((2, 4))
            both = 0
            for seed in range(count):
                episodes = []
                for smooth in (False, True):
                    choice: dict[str, Any] = {"name": planner}
                    if planner == "hybrid_astar":
                        choice["options"] = {"smooth": smooth}
                    scenario = Scenario.make(
                        world={"name": "warehouse", "seed": seed},
                        backend=backend,
                        seed=seed,
                        planner=choice,
                        smoother="constrained" if smooth and planner != "hybrid_astar" else None,
                    )
                    with scenario.build() as mission:
                        episodes.append(mission.run())
                for k, episode in enumerate(episodes):
                    totals[k, 3] += episode.outcome is Outcome.COLLIDED
                if all(episode.arrived for episode in episodes):
                    both += 1
                    for k, episode in enumerate(episodes):
                        turned = np.abs(wrapped(np.diff(episode.trajectory.poses[:, 2]))).sum()
                        totals[k, :3] += (episode.metrics.time_s, episode.metrics.distance_m, turned)
            for k, name in enumerate(("planned", "smoothed")):
                mean = totals[k, :3] / max(both, 1)
                rows.append((backend, planner, name, f"{both}/{count}", *(f"{value:.2f}" for value in mean),
                             f"{totals[k, 3]:.0f}"))  # fmt: skip
    header = ("simulator", "planner", "path", "both arrived", "time s", "driven m", "turned rad", "contacts")
    print_table(header, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="ROS map YAML")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--missions", type=int, default=10)
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    print(describe_machine())
    world = World.generate("warehouse", seed=1, aisle_width=1.2)
    grids = {"the map": OccupancyGrid.load(options.map)}
    grids["warehouse"] = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    costmaps = {name: Costmap.from_grid(grid, robot) for name, grid in grids.items()}
    costmaps["rooms"] = rooms(robot)
    for name, costmap in costmaps.items():
        print(f"\n{name}, {costmap.shape[1]} x {costmap.shape[0]} cells\n")
        play(costmap, options.pairs if name != "rooms" else options.pairs // 2)
    print()
    drive(options.missions)


if __name__ == "__main__":
    main()
