"""Time and peak memory of maps of 20,000 × 20,000 cells, each part in a separate process.

    python -m benchmarks.planning.large_maps [--side 20000] [--parts jps cost_field_uint8]

The map has boxes of 2 to 600 cells' edge, one for 400,000 cells, at 0.05 m a cell. Times are the processor's, of all
threads together, and the wall's. Memory is the most that was resident (VmHWM) over what was resident before, with the
input in place.
"""

from __future__ import annotations

import argparse
import math
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from benchmarks.timing import describe_machine, print_table

from trundle._core import label_components
from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import GridPath, GridSearch, PointPath, cost_field, create_planner
from trundle.robots import Robot

RESOLUTION = 0.05
SHORT_M = 40.0
Steps = list[tuple[str, Callable[[], Any]]]
"""What is measured, one after the other, by what it is called."""


def make_map(side: int) -> npt.NDArray[np.bool_]:
    rng = np.random.default_rng(0)
    blocked = np.zeros((side, side), bool)
    for _ in range(side * side // 400_000):
        row, col = rng.integers(0, side, 2)
        height, width = rng.integers(2, 600, 2)
        blocked[row : row + height, col : col + width] = True
    return blocked


def free_cell(blocked: npt.NDArray[np.bool_], near: tuple[int, int], around: int = 40) -> tuple[int, int]:
    """The middle of the first free square whose half edge is `around` cells, going from a cell to the middle."""
    row, col = near
    side = len(blocked)
    step = 1 if row < side // 2 else -1, 1 if col < side // 2 else -1
    while blocked[max(0, row - around) : row + around, max(0, col - around) : col + around].any():
        row, col = row + 7 * step[0], col + 5 * step[1]
    return row, col


def far_ends(blocked: npt.NDArray[np.bool_]) -> tuple[tuple[int, int], tuple[int, int]]:
    last = len(blocked) - 1
    return free_cell(blocked, (100, 100)), free_cell(blocked, (last - 100, last - 100))


def search_steps(method: str) -> Callable[[int], Steps]:
    def prepare(side: int) -> Steps:
        blocked = make_map(side)
        start, goal = far_ends(blocked)
        made: list[GridSearch] = []
        patch = ~blocked[500:520, 500:520]
        return [
            (f"GridSearch, {method}: built", lambda: made.append(GridSearch(blocked, method=method))),
            ("corner to corner", lambda: made[0].shortest_path(start, goal)),
            ("again", lambda: made[0].shortest_path(start, goal)),
            ("update of 20 × 20 cells", lambda: made[0].update((500, 520), (500, 520), patch)),
        ]

    return prepare


def any_angle_steps(side: int) -> Steps:
    blocked = make_map(side)
    start, goal = far_ends(blocked)
    near = free_cell(blocked, (900, 900))
    search = GridSearch(blocked)
    return [
        ("any-angle optimum: 1100 cells", lambda: search.any_angle_path(start, near)),
        ("corner to corner", lambda: search.any_angle_path(start, goal)),
    ]


def field_steps(dtype: str, free: float, wall: float, threads: int) -> Callable[[int], Steps]:
    def prepare(side: int) -> Steps:
        blocked = make_map(side)
        goal, _ = far_ends(blocked)
        costs = np.where(blocked, np.dtype(dtype).type(wall), np.dtype(dtype).type(free))
        del blocked
        what = f"cost field, {dtype} costs of {free:g}, threads: {threads}"
        return [(what, lambda: cost_field(costs, goal, threads=threads))]

    return prepare


def make_grid(side: int) -> OccupancyGrid:
    return OccupancyGrid(np.where(make_map(side), np.int8(100), np.int8(0)), RESOLUTION)


def costmap_steps(side: int) -> Steps:
    grid, robot = make_grid(side), Robot.load("nova_carter")
    made: list[Costmap] = []
    rows, cols = slice(500, 520), slice(500, 520)
    return [
        ("Costmap.from_grid, 20 cells far", lambda: made.append(Costmap.from_grid(grid, robot, 1.0))),
        ("Costmap.update of 20 × 20 cells", lambda: made[0].update(rows, cols, 100)),
    ]


def planner_steps(name: str, **options: Any) -> Callable[[int], Steps]:
    def prepare(side: int) -> Steps:
        grid = make_grid(side)
        blocked = grid.data == 100
        begin, end = far_ends(blocked)
        near = free_cell(blocked, (begin[0] + round(SHORT_M / RESOLUTION), begin[1]))
        del blocked
        costmap = Costmap.from_grid(grid, Robot.load("nova_carter"), 1.0)
        planner = create_planner(name, **options)
        start, first, last = (
            Pose2D(*(RESOLUTION * (cell[::-1] + np.full(2, 0.5)))) for cell in map(np.array, (begin, near, end))
        )

        def plan(goal: Pose2D) -> str:
            try:
                return f"{planner.plan(costmap, start, goal).length:.0f} m"
            except PlanningError as error:
                return f"{type(error).__name__}: {error}"

        return [
            (f"{name}: {math.hypot(first.x - start.x, first.y - start.y):.0f} m", lambda: plan(first)),
            ("again", lambda: plan(first)),
            (f"{math.hypot(last.x - start.x, last.y - start.y):.0f} m", lambda: plan(last)),
        ]

    return prepare


def label_steps(side: int) -> Steps:
    free = (~make_map(side)).view(np.uint8)
    return [("label_components", lambda: label_components(free, False))]


PARTS: dict[str, Callable[[int], Steps]] = {
    "jps": search_steps("jps"),
    "astar": search_steps("astar"),
    "any_angle": any_angle_steps,
    "cost_field_uint8": field_steps("uint8", 1, 255, 1),
    "cost_field_uint8_2": field_steps("uint8", 1, 255, 2),
    "cost_field_uint16": field_steps("uint16", 65534, 65535, 2),
    "cost_field_float32": field_steps("float32", 1.0, math.inf, 2),
    "costmap": costmap_steps,
    "least_cost": planner_steps("least_cost"),
    "hybrid_astar": planner_steps("hybrid_astar", minimum_turning_radius=0.4),
    "labels": label_steps,
}


def memory_mb(what: str) -> float:
    (found,) = re.findall(rf"{what}:\s+(\d+) kB", Path("/proc/self/status").read_text())
    return float(found) / 1024.0


def measure(part: str, side: int) -> None:
    """Print a line for each step: what it is, its times, memory and answer."""
    for name, run in PARTS[part](side):
        Path("/proc/self/clear_refs").write_text("5")  # resets VmHWM
        before, wall, processor = memory_mb("VmRSS"), time.perf_counter(), time.process_time()
        try:
            answer = run()
        except (MemoryError, ValueError) as error:
            answer = f"{type(error).__name__}: {error}"
        wall, processor = time.perf_counter() - wall, time.process_time() - processor
        said = answer if isinstance(answer, str) else ""
        if isinstance(answer, GridPath | PointPath):
            said = f"{answer.status}, {answer.length:.0f} cells"
        print(f"{name}|{processor:.4g} s|{wall:.4g} s|{memory_mb('VmHWM') - before:.0f} MB|{said}", flush=True)
        del answer


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=20_000, help="of the map [cells]")
    parser.add_argument("--parts", nargs="*", choices=PARTS, default=list(PARTS))
    parser.add_argument("--here", action="store_true", help="measure one part in this process")
    options = parser.parse_args()
    if options.here:
        measure(options.parts[0], options.side)
        return
    print(describe_machine(), f"\n## Maps of {options.side} × {options.side} cells\n")
    rows = []
    for part in options.parts:
        command = [sys.executable, "-m", "benchmarks.planning.large_maps", "--here", "--parts", part]
        done = subprocess.run([*command, "--side", str(options.side)], stdout=subprocess.PIPE, text=True, check=False)
        rows += [tuple(line.split("|")) for line in done.stdout.splitlines()]
        if done.returncode:
            rows.append((part, "", "", "", f"ended with {done.returncode}"))
    print_table(("what", "processor", "wall", "memory", "answer"), rows)


if __name__ == "__main__":
    main()
