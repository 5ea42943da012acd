"""Size and CPU time of the reports of 10,000 episodes: python benchmarks/evaluation/report.py [--rows N] [-o FOLDER]

Rows come from a few real missions in each world that trundle makes; each is repeated with other figures, and some are
cut short as failures. The target: report.html of at most 1 MB in at most 10 s.
"""

import argparse
import dataclasses
import hashlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from trundle.evaluation.report.write import write_reports
from trundle.evaluation.row import Row
from trundle.evaluation.statistics import Gate
from trundle.maps.grid import OccupancyGrid
from trundle.mission import Scenario
from trundle.worlds import world_names

PLANNERS = ("jps", "least_cost")
FAILING = (0.09, 0.02)
OUTCOMES = ("stuck", "collided", "timed_out", "stuck")


def drive(world: str, seed: int) -> tuple[Row, OccupancyGrid]:
    """A real mission as a row, and the map that it was planned on."""
    with Scenario.make(world={"name": world, "seed": 1}, seed=seed, backend="kinematic").build() as mission:
        episode = mission.run()
        grid = OccupancyGrid.from_world(mission.world, resolution=0.05, z_range=mission.robot.z_range)
    poses, metrics, goal = episode.trajectory.poses, episode.metrics, episode.goals[-1]
    picked = poses[np.linspace(0, len(poses) - 1, 64).round().astype(int), :2]
    row = Row(
        id="",
        mission="",
        index=0,
        world=world,
        robot="nova_carter",
        planner="",
        controller="regulated_pure_pursuit",
        backend="kinematic",
        seed=seed,
        outcome="arrived",
        time_s=metrics.time_s,
        distance_m=metrics.distance_m,
        spl=metrics.spl,
        min_clearance_m=metrics.min_clearance_m,
        contacts=0,
        replans=0,
        max_cross_track_error_m=metrics.max_cross_track_error_m,
        smoothness_rad_per_m=metrics.smoothness_rad_per_m,
        start_x=float(poses[0, 0]),
        start_y=float(poses[0, 1]),
        goal_x=goal.x,
        goal_y=goal.y,
        trail=tuple(picked.round(2).ravel().tolist()),
        place=hashlib.sha256(world.encode()).hexdigest()[:16],
        planning_ms=metrics.planning_ms,
        cpu_s=0.18,
        wall_s=0.2,
    )
    return row, grid


def repeat(rows: list[Row], count: int) -> Iterator[Row]:
    """`count` rows made of these, each mission with both planners."""
    rng = np.random.default_rng(0)
    for mission in range(count // len(PLANNERS)):
        model = rows[mission % len(rows)]
        hardness, friction = rng.uniform(), rng.uniform(0.4, 1.0)
        for place, planner in enumerate(PLANNERS):
            index = mission * len(PLANNERS) + place
            points = np.array(model.trail).reshape(-1, 2)
            fails = hardness < FAILING[place] * (1.6 - friction)
            if fails:
                points = points[: int(rng.integers(8, 56))]
            x, y = (float(value) for value in points[-1])
            closest = points[int(rng.integers(len(points)))]
            outcome = OUTCOMES[int(rng.integers(len(OUTCOMES)))] if fails else "arrived"
            yield dataclasses.replace(
                model,
                id=hashlib.sha256(f"{index}".encode()).hexdigest()[:16],
                mission=hashlib.sha256(f"mission {mission}".encode()).hexdigest()[:16],
                index=index,
                seed=mission,
                planner=planner,
                outcome=outcome,
                message=f"{outcome} at ({x:.2f}, {y:.2f})" if fails else "",
                spl=0.0 if fails else model.spl * rng.uniform(0.95, 1.0),
                time_s=model.time_s * rng.uniform(0.97, 1.05) + 0.3 * place,
                min_clearance_m=0.0 if outcome == "collided" else float(model.min_clearance_m * rng.uniform(0.3, 1.0)),
                contacts=int(outcome == "collided"),
                end_x=x,
                end_y=y,
                closest_x=float(closest[0]),
                closest_y=float(closest[1]),
                trail=tuple(points.ravel().tolist()),
                vary={"friction": friction, "mass": float(rng.normal(1.0, 0.1))},
                planning_ms=model.planning_ms * rng.uniform(0.7, 2.0),
            )


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--rows", type=int, default=10_000)
    parser.add_argument("--missions", type=int, default=6, help="real missions in each world")
    parser.add_argument("-o", "--out", type=Path)
    given = parser.parse_args()
    driven = [drive(world, seed) for seed in range(given.missions) for world in world_names()]
    maps = {row.place: grid for row, grid in driven}
    rows = list(repeat([row for row, _ in driven], given.rows))
    with tempfile.TemporaryDirectory() as folder:
        out = given.out or Path(folder)
        out.mkdir(parents=True, exist_ok=True)
        gates = [Gate.parse(text) for text in ("success>=0.9", "success[planner=least_cost]>=0.99", "time_s<=60")]
        began, wall = time.process_time(), time.perf_counter()
        write_reports(out, rows, require=gates, maps=maps.get)
        cpu, wall = time.process_time() - began, time.perf_counter() - wall
        sizes = {path.name: path.stat().st_size / 1e3 for path in sorted(out.iterdir())}
    print(f"{len(rows)} episodes: {cpu:.1f} s of CPU time, {wall:.1f} s")
    for name, size in sizes.items():
        print(f"  {name}: {size:.0f} kB")


if __name__ == "__main__":
    main()
