"""The cost from every cell to one goal: all cells of a map, exact, beside scikit-image and SciPy.

    python -m benchmarks.planning.cost_field MAPS [--times 2] [--rounds 9] [--map NAME ...] [--no-peers]

MAPS is a folder of MovingAI maps; each cell becomes `--times` squared cells. Four kinds of uint8 costs: 1 everywhere;
`inflated`, Nav2's costs of the map at 0.05 m a cell weighed as NavFn does (50 + 0.8 c), taken as uint16 and as
float32 too; `noise`, 1 to 200 by chance in every cell; and `wide`, from 1 to 254 with every power of 2 as likely as the
next, where the cheapest paths wind the most. The goal is the free cell in the middle of all.

Beside two threads on one field stand two fields at once, of one thread each, that share nothing: what they take less
than one after the other is what the processors have to give, and bounds what two threads on one field can gain.

The processor's time stands beside the wall's: on a busy machine the former says more. The result is compared with
SciPy's Dijkstra on the same graph. scikit-image solves an easier problem: it cuts corners.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.timing import describe_machine, interleaved_times, load_peer, print_table

from trundle.costmap import INSCRIBED, Costmap
from trundle.maps import OccupancyGrid
from trundle.maps.movingai import load_map
from trundle.planning import cost_field

WALL = 255
FOOTPRINT = 0.10 * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])


def make_costs(blocked: np.ndarray) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    costmap = Costmap.from_grid(OccupancyGrid(np.where(blocked, 100, 0).astype(np.int8), 0.05), FOOTPRINT, 1.0)
    inflated = np.where(costmap.data >= INSCRIBED, WALL, 50.0 + 0.8 * costmap.data)
    return {
        "1": np.where(blocked, WALL, 1).astype(np.uint8),
        "inflated": inflated.astype(np.uint8),
        "noise": np.where(blocked, WALL, rng.integers(1, 201, blocked.shape)).astype(np.uint8),
        "wide": np.where(blocked, WALL, 2.0 ** rng.uniform(0.0, 7.99, blocked.shape)).astype(np.uint8),
    }


def make_graph(costs: np.ndarray) -> Any:
    """The same problem as a sparse matrix, for SciPy."""
    sparse = load_peer("scipy.sparse", "SciPy")
    rows, cols = costs.shape
    free = costs != WALL
    index = np.arange(rows * cols, dtype=np.int32).reshape(rows, cols)
    starts, ends, weights = [], [], []
    for dr, dc in ((0, 1), (1, 0), (1, 1), (1, -1)):
        a = (slice(0, rows - dr), slice(max(0, -dc), cols - max(0, dc)))
        b = (slice(dr, rows), slice(max(0, dc), cols + min(0, dc)))
        open_ = free[a] & free[b]
        if dr and dc:
            open_ &= free[a[0], b[1]] & free[b[0], a[1]]
        starts.append(index[a][open_])
        ends.append(index[b][open_])
        weights.append(np.hypot(dr, dc) * (costs[a][open_].astype(float) + costs[b][open_]) / 2.0)
    joined = (np.concatenate(weights), (np.concatenate(starts), np.concatenate(ends)))
    return sparse.csr_matrix(joined, shape=(rows * cols, rows * cols))


def by_scipy(costs: np.ndarray, goal: tuple[int, int]) -> Callable[[], np.ndarray]:
    graph = make_graph(costs)
    csgraph = load_peer("scipy.sparse.csgraph", "SciPy")
    source = goal[0] * costs.shape[1] + goal[1]
    return lambda: csgraph.dijkstra(graph, directed=False, indices=source).reshape(costs.shape)


def by_skimage(costs: np.ndarray, goal: tuple[int, int]) -> Callable[[], Any]:
    library = load_peer("skimage.graph", "scikit-image")
    weights = np.where(costs == WALL, -1.0, costs)
    return lambda: library.MCP_Geometric(weights).find_costs([goal])


def once(run: Callable[[], Any], clock: Callable[[], float]) -> tuple[float, Any]:
    begin = clock()
    result = run()
    return clock() - begin, result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path)
    parser.add_argument("--map", nargs="+", default=["Berlin_0_1024"])
    parser.add_argument("--times", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--no-peers", action="store_true")
    options = parser.parse_args()
    print(describe_machine())
    for name in options.map:
        blocked = load_map(options.maps / f"{name}.map").data != 0
        blocked = np.kron(blocked, np.ones((options.times, options.times), dtype=bool))
        print(f"\n{name} times {options.times}: {blocked.shape[0]} x {blocked.shape[1]} cells")
        measure_map(blocked, options.rounds, not options.no_peers)


def measure_map(blocked: np.ndarray, rounds: int, peers: bool) -> None:
    table: list[tuple[str, ...]] = []
    kinds = make_costs(blocked)
    for name, costs in kinds.items():
        cells = np.argwhere(costs != WALL)
        goal = tuple(cells[len(cells) // 2].tolist())
        reached = measure_costs(name, costs, goal, rounds, table)
        if peers:
            measure_peers(name, costs, goal, reached, table)
    for dtype, wall in ((np.uint16, 65535), (np.float32, np.inf)):
        costs = kinds["inflated"].astype(dtype)
        costs[kinds["inflated"] == WALL] = wall
        cells = np.argwhere(costs != wall)
        measure_costs(f"inflated, {dtype.__name__}", costs, tuple(cells[len(cells) // 2].tolist()), rounds, table)
    print()
    print_table(("costs", "who", "median ms", "least ms", "processor's ms", "M cells/s by the least"), table)


def measure_costs(
    name: str, costs: np.ndarray, goal: tuple[int, int], rounds: int, table: list[tuple[str, ...]]
) -> int:
    """The times of our own field; how many cells it reaches."""
    other = costs.copy()
    with ThreadPoolExecutor(2) as pool:

        def both() -> None:
            list(pool.map(lambda array: cost_field(array, goal, threads=1), (costs, other)))

        runs = {f"{n} thread{'s' * (n > 1)}": partial(cost_field, costs, goal, threads=n) for n in (1, 2)}
        reached = int(np.isfinite(runs["1 thread"]()).sum())
        wall = interleaved_times({**runs, "both": both}, rounds)
    busy = interleaved_times(runs, rounds, time.process_time)
    gain = statistics.median(a / b for a, b in zip(wall["1 thread"], wall["2 threads"], strict=True))
    bound = statistics.median(2.0 * a / b for a, b in zip(wall["1 thread"], wall["both"], strict=True))
    for run in runs:
        seconds, least = statistics.median(wall[run]), min(wall[run])
        table.append((name, f"trundle, {run}", *rates(reached, seconds, least, statistics.median(busy[run]))))
    print(f"{name}: {reached} cells reached; two threads {gain:.2f} x one; two fields at once {bound:.2f} x (medians)")
    return reached


def measure_peers(
    name: str, costs: np.ndarray, goal: tuple[int, int], reached: int, table: list[tuple[str, ...]]
) -> None:
    seconds, expected = once(by_scipy(costs, goal), time.process_time)
    field, reachable = cost_field(costs, goal, threads=1), np.isfinite(expected) & (expected > 0)
    off = np.abs(field[reachable] / expected[reachable] - 1.0).max()
    same = bool((np.isfinite(expected) == np.isfinite(field)).all())
    print(f"    against SciPy: the same cells {same}, costs to {off:.1e} of theirs")
    table.append((name, "SciPy Dijkstra, once", *rates(reached, seconds, seconds, seconds)))
    seconds, _ = once(by_skimage(costs, goal), time.process_time)
    table.append((name, "scikit-image MCP_Geometric, once", *rates(reached, seconds, seconds, seconds)))


def rates(cells: int, seconds: float, least: float, busy: float) -> tuple[str, ...]:
    return f"{1e3 * seconds:.1f}", f"{1e3 * least:.1f}", f"{1e3 * busy:.1f}", f"{1e-6 * cells / least:.1f}"


if __name__ == "__main__":
    main()
