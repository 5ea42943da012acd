"""Single cells planted where a motion just passes: is one touched that the check calls free?

    python -m benchmarks.planning.turns [--cells 100000] [--seed 0]

Each cell of 5 cm is planted near what the robot's farthest corners sweep over: on a quarter turn in place, planned by
`least_cost`; on a straight line, planned by it; on a quarter turn of `hybrid_astar` that begins 0.1 mm beside another
cell, so that it has no padding left. What is accepted is sampled every 0.1° and 1 mm. "Samples alone" is the check of
poses every 2° and 0.025 m without padding. A pair is lost where a planner finds no path though a motion is free at
every sample.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from benchmarks.timing import describe_machine, print_table

from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import FloatArray, Pose2D, wrap_angles
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import PathCheck, Planner, create_planner
from trundle.planning.motions import sample_between
from trundle.robots import Robot

EDGE = 120
RESOLUTION = 0.05
MIDDLE = 0.5 * EDGE * RESOLUTION
TOUCH_M = 1e-6
"""Contact that counts: more than rounding."""


@dataclass(slots=True)
class Count:
    """One family: what was planted and accepted, and how many cells were touched nevertheless."""

    planted: int = 0
    accepted: int = 0
    touched: int = 0
    by_samples: int = 0
    touched_by_samples: int = 0
    lost: int = 0


def plant(rng: np.random.Generator, outline: FloatArray, pose: Pose2D, corner: FloatArray, apart_m: float) -> Costmap:
    """A costmap with one cell of which the middle or so is at `corner`, moved by up to `apart_m`."""
    x, y = pose.transform_points(corner.reshape(1, 2))[0] + rng.uniform(-apart_m, apart_m, 2)
    data = np.zeros((EDGE, EDGE), np.int8)
    data[int(y / RESOLUTION), int(x / RESOLUTION)] = 100
    return Costmap.from_grid(OccupancyGrid(data, RESOLUTION), outline)


def turn_in_place(rng: np.random.Generator, outline: FloatArray) -> tuple[Costmap, Pose2D, Pose2D]:
    start = Pose2D(*(MIDDLE + rng.uniform(0.0, RESOLUTION, 2)), rng.uniform(-math.pi, math.pi))
    goal = Pose2D(start.x, start.y, start.yaw + math.copysign(math.pi / 2, rng.uniform(-1, 1)))
    corner = outline[int(np.argmax(np.hypot(*outline.T)))]
    midway = Pose2D(start.x, start.y, start.yaw + rng.uniform(0.0, 1.0) * (goal.yaw - start.yaw))
    return plant(rng, outline, midway, corner * rng.uniform(1.0, 1.12), 0.005), start, goal


def straight_line(rng: np.random.Generator, outline: FloatArray) -> tuple[Costmap, Pose2D, Pose2D]:
    start = Pose2D(*(MIDDLE + rng.uniform(0.0, RESOLUTION, 2)), rng.uniform(-math.pi, math.pi))
    goal = start @ Pose2D(0.5, 0.0, 0.0)
    corner = outline[int(np.argmax(outline @ (1.0, 1.0)))] + (rng.uniform(0.0, 0.5), rng.uniform(0.0, 0.05))
    return plant(rng, outline, start, corner, 0.0), start, goal


def turn_beside_something(rng: np.random.Generator, outline: FloatArray) -> tuple[Costmap, Pose2D, Pose2D]:
    """A quarter turn away from a cell at 0.1 mm from the left side, where hybrid A* has no padding left."""
    left, tail = float(outline[:, 1].max()), float(outline[:, 0].min())
    start = Pose2D(MIDDLE + rng.uniform(0.0, RESOLUTION), MIDDLE - left - 1e-4, 0.0)
    corner = outline[int(np.argmax(np.hypot(*outline.T)))]
    midway = Pose2D(start.x, start.y, rng.uniform(0.0, math.pi / 2))
    costmap = plant(rng, outline, midway, corner * rng.uniform(1.0, 1.12), 0.005)
    row, col = int(MIDDLE / RESOLUTION), int((start.x + 0.9 * tail) / RESOLUTION)
    costmap = costmap.update(slice(row, row + 1), slice(col, col + 1), 100)
    return costmap, start, Pose2D(start.x, start.y, math.pi / 2)


def samples(path: Path, step_m: float, step_rad: float) -> FloatArray:
    first, last = path.poses[:-1], path.poses[1:].copy()
    last[:, 2] = first[:, 2] + wrap_angles(last[:, 2] - first[:, 2])
    return sample_between(first, last, step_m, step_rad)[0]


def touches(costmap: Costmap, path: Path) -> bool:
    """Whether the footprint touches the cell at one of the poses every 1 mm and 0.1°."""
    poses = samples(path, 1e-3, math.radians(0.1))
    shrunk = costmap.footprint * (1.0 - TOUCH_M / costmap.inscribed_radius)
    return bool(costmap.footprint_collides(poses, outline=shrunk).any())


def direct(start: Pose2D, goal: Pose2D) -> Path:
    return Path(np.array([start.as_tuple(), goal.as_tuple()]))


def measure(
    family: Callable[[np.random.Generator, FloatArray], tuple[Costmap, Pose2D, Pose2D]],
    planner: Planner,
    outline: FloatArray,
    cells: int,
    seed: int,
) -> Count:
    rng, count = np.random.default_rng(seed), Count()
    while count.planted < cells:
        costmap, start, goal = family(rng, outline)
        ends = costmap.clearance([start.as_tuple(), goal.as_tuple()], cap=1.0)
        if ends.min() == 0.0:
            continue
        count.planted += 1
        plain = direct(start, goal)
        looked_at = samples(plain, 0.025, math.radians(2.0))
        if not costmap.footprint_collides(looked_at).any():
            count.by_samples += 1
            count.touched_by_samples += touches(costmap, plain)
        try:
            path = planner.plan(costmap, start, goal)
        except PlanningError:
            count.lost += not touches(costmap, plain)
            continue
        if PathCheck(path).first_hit(costmap) is None:
            count.accepted += 1
            count.touched += touches(costmap, path)
    return count


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=100_000, help="of quarter turns; a tenth of it of the others")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    tolerances = {"start_tolerance": 0.0, "goal_tolerance": 0.0}
    least_cost = create_planner("least_cost", **tolerances)
    hybrid = create_planner("hybrid_astar", in_place=True, **tolerances)
    rows: list[list[str]] = []
    for name, family, planner, share in (
        ("quarter turn", turn_in_place, least_cost, 1.0),
        ("straight line", straight_line, least_cost, 0.1),
        ("quarter turn beside something", turn_beside_something, hybrid, 0.1),
    ):
        for robot in ("nova_carter", "turtlebot3_burger"):
            cells = max(1, int(0.5 * share * arguments.cells))
            count = measure(family, planner, Robot.load(robot).outline, cells, arguments.seed)
            numbers = (
                count.planted,
                count.by_samples,
                count.touched_by_samples,
                count.accepted,
                count.touched,
                count.lost,
            )
            rows.append([name, robot, *(str(number) for number in numbers)])
    print(describe_machine())
    header = [
        "motion",
        "robot",
        "cells",
        "free by samples alone",
        "of these touched",
        "planned",
        "of these touched",
        "lost",
    ]
    print_table(header, rows)


if __name__ == "__main__":
    main()
