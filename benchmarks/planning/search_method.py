"""Does `GridSearch(method="auto")` choose the faster of jumps and bucket A*?

    python -m benchmarks.planning.search_method [MAPS] [--queries 60]

Random cells, blocks of them, and mazes with and without loops, all 512 x 512 and made here by seed, and the MovingAI
maps of a folder. Each query is asked three times of each method in turn, and the least counts; queries are drawn from
all free cells that can reach each other, or evenly from a map's file. Processor time of the calling thread.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt
from benchmarks.timing import describe_machine, print_table

from trundle.maps.movingai import load_map, load_scenarios
from trundle.planning import GridSearch

Mask = npt.NDArray[np.bool_]
Query = tuple[tuple[int, int], tuple[int, int]]
SIDE = 512


def grids() -> Iterator[tuple[str, Mask]]:
    """Maps made by seed, and what they are."""
    rng = np.random.default_rng(3)
    for percent in (3, 5, 6, 8, 10, 15, 20, 25, 30, 35, 40, 45):
        yield f"random, {percent} %", rng.random((SIDE, SIDE)) < percent / 100
    for size, percent in ((2, 10), (2, 20), (2, 30), (2, 40), (4, 20), (4, 35)):
        small = rng.random((SIDE // size, SIDE // size)) < percent / 100
        yield f"blocks of {size} x {size}, {percent} %", small.repeat(size, axis=0).repeat(size, axis=1)
    for width, loops in ((1, 0.0), (2, 0.0), (4, 0.0), (1, 0.1), (2, 0.2), (4, 0.3)):
        yield f"maze, {width} wide, loops {loops:g}", make_maze(rng, width, loops)


def make_maze(rng: np.random.Generator, width: int, loops: float) -> Mask:
    """From every cell one opening to the row before or the column before, and some more by chance."""
    cells, pitch = SIDE // (width + 1), width + 1
    blocked = np.ones((cells * pitch + 1,) * 2, bool)
    up = rng.random((cells, cells)) < 0.5
    up[0], up[1:, 0] = False, True
    left = ~up | (rng.random(up.shape) < loops)
    up |= rng.random(up.shape) < loops
    up[0], left[:, 0] = False, False
    for row in range(cells):
        for col in range(cells):
            y, x = row * pitch + 1, col * pitch + 1
            blocked[y - up[row, col] : y + width, x : x + width] = False
            blocked[y : y + width, x - left[row, col] : x + width] = False
    return blocked


def draw(blocked: Mask, count: int) -> list[Query]:
    """Pairs of free cells that can reach each other, by seed."""
    rng, search, free = np.random.default_rng(5), GridSearch(blocked), np.argwhere(~blocked)
    starts, goals = free[rng.integers(len(free), size=(2, 100 * count))]
    found = np.flatnonzero(search.plan_many(starts, goals, threads=1).status == "found")[:count]
    return [((int(a), int(b)), (int(c), int(d))) for (a, b), (c, d) in zip(starts[found], goals[found], strict=True)]


def race(blocked: Mask, queries: list[Query]) -> dict[str, float]:
    """Microseconds a query by method."""
    searches = {method: GridSearch(blocked, method=method) for method in ("jps", "astar")}
    sums = dict.fromkeys(searches, 0.0)
    for start, goal in queries:
        least = dict.fromkeys(searches, float("inf"))
        for _ in range(3):
            for method, search in searches.items():
                begin = time.thread_time_ns()
                search.shortest_path(start, goal)
                least[method] = min(least[method], 1e-3 * (time.thread_time_ns() - begin))
        for method in sums:
            sums[method] += least[method] / len(queries)
    return sums


def row(name: str, blocked: Mask, queries: list[Query]) -> tuple[str, ...]:
    times, search = race(blocked, queries), GridSearch(blocked)
    over = times[search.method] / min(times.values())
    figures = f"{times['jps']:.1f}", f"{times['astar']:.1f}", f"{times['jps'] / times['astar']:.2f}"
    return name, str(len(queries)), *figures, f"{search.clutter:.4f}", search.method, f"{over:.2f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path, nargs="?", help="folder of MovingAI maps and their .scen files")
    parser.add_argument("--queries", type=int, default=60)
    options = parser.parse_args()
    print(f"{describe_machine()}\n")
    rows = [row(name, blocked, draw(blocked, options.queries)) for name, blocked in grids()]
    for path in sorted(options.maps.glob("*.map")) if options.maps else ():
        scenarios = load_scenarios(path.with_name(f"{path.name}.scen"))
        queries = [(q.start, q.goal) for q in scenarios[:: max(1, len(scenarios) // options.queries)]]
        rows.append(row(path.stem, load_map(path).data != 0, queries))
    header = ("map", "queries", "`jps`, µs", "`astar`, µs", "`jps` / `astar`", "clutter", "chosen", "chosen / better")
    print_table(header, rows)


if __name__ == "__main__":
    main()
