"""Shortest paths in any direction: how fast, beside those over cells, and how much shorter.

    python -m benchmarks.planning.any_angle MAPS [--queries 0] [--only exact,cells]

MAPS is a folder of MovingAI maps, each `NAME.map` with its `NAME.map.scen`. Of each map all queries are asked, or so
many drawn by seed. The contestants take turns, query by query; a time is the smaller of two of the same call from
Python, on a `GridSearch` that is there, so that the second is warm. Milliseconds are of the processor time of the
thread, which work beside it disturbs less; the time by the clock stands beside it.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.timing import describe_machine, print_table

from trundle.maps.movingai import MovingAIQuery, load_map, load_scenarios
from trundle.planning import GridSearch, any_angle_path

CONTESTANTS = ("exact", "cells")


def read(folder: Path, name: str) -> tuple[np.ndarray, list[MovingAIQuery]]:
    """The blocked cells, and the queries."""
    return load_map(folder / f"{name}.map").data != 0, load_scenarios(folder / f"{name}.map.scen")


def timed(run: Callable[[], Any]) -> tuple[float, float, Any]:
    """Milliseconds of the processor and of the clock, and what came of it."""
    begin, clock = time.thread_time_ns(), time.perf_counter_ns()
    result = run()
    return 1e-6 * (time.thread_time_ns() - begin), 1e-6 * (time.perf_counter_ns() - clock), result


def ask(search: GridSearch, contestant: str, query: MovingAIQuery) -> Any:
    if contestant == "cells":
        return search.shortest_path(query.start, query.goal)
    return search.any_angle_path(query.start, query.goal)


def race(folder: Path, name: str, count: int, contestants: list[str]) -> list[tuple[str, ...]]:
    blocked, queries = read(folder, name)
    if 0 < count < len(queries):
        queries = [queries[i] for i in np.random.default_rng(0).permutation(len(queries))[:count]]
    search = GridSearch(blocked, method="jps")
    processor: dict[str, list[float]] = {contestant: [] for contestant in contestants}
    clock: dict[str, list[float]] = {contestant: [] for contestant in contestants}
    lengths: dict[str, list[float]] = {contestant: [] for contestant in contestants}
    for query in queries:
        for contestant in contestants:
            turns = [timed(lambda c=contestant, q=query: ask(search, c, q)) for _ in range(2)]
            processor[contestant].append(min(turn[0] for turn in turns))
            clock[contestant].append(min(turn[1] for turn in turns))
            lengths[contestant].append(turns[0][2].length)
    found = np.isfinite(lengths["exact"])
    found_lengths = {contestant: np.array(lengths[contestant])[found] for contestant in contestants}
    apart = [float(np.hypot(*np.subtract(q.start, q.goal))) for q in queries]
    least = np.min(list(found_lengths.values()), axis=0)
    if (found_lengths["exact"] > (1.0 + 1e-12) * least).any() or (
        found_lengths["exact"] < (1.0 - 1e-12) * np.array(apart)[found]
    ).any():
        raise SystemExit(f"{name}: a path is longer than another one, or shorter than the straight line")
    rows = []
    for contestant in contestants:
        longer = found_lengths[contestant].sum() / found_lengths["exact"].sum() - 1.0
        some = processor[contestant]
        rows.append(
            (
                name if contestant == "exact" else "",
                str(len(queries)),
                contestant,
                f"{np.median(some):.3f} ({np.percentile(some, 95):.2f})",
                f"{max(some):.2f}",
                f"{np.median(clock[contestant]):.3f} ({np.percentile(clock[contestant], 95):.2f})",
                f"{100.0 * longer:.3f} %",
            )
        )
    return rows


def race_calls(folder: Path, names: list[str]) -> None:
    print("\n## One query from an array, packed and labelled for it, and an unreachable goal: medians, milliseconds\n")
    rows = []
    for name in names:
        blocked, queries = read(folder, name)
        query = queries[len(queries) // 2]
        packed = np.median([timed(lambda b=blocked: GridSearch(b, method="jps"))[0] for _ in range(15)])
        whole = [timed(lambda b=blocked, q=query: any_angle_path(b, q.start, q.goal))[0] for _ in range(15)]
        walled = blocked.copy()
        walled[:, walled.shape[1] // 2] = True
        search, free = GridSearch(walled), np.argwhere(~walled)
        ends = free[free[:, 1].argsort()][[0, -1]].tolist()
        if search.any_angle_path(*ends).status != "unreachable":
            raise SystemExit("the wall has a hole")
        closed = np.median([timed(lambda s=search, e=ends: s.any_angle_path(*e))[0] for _ in range(500)])
        rows.append((name, f"{packed:.3f}", f"{np.median(whole):.3f}", f"{closed:.4f}"))
    print_table(("map", "GridSearch(blocked)", "any_angle_path(blocked, …)", "unreachable"), rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path, help="folder of MovingAI maps and their .scen files")
    parser.add_argument("--queries", type=int, default=0, help="of each map, drawn by seed; 0 for all")
    parser.add_argument("--only", default=",".join(CONTESTANTS), help="contestants, exact among them")
    options = parser.parse_args()
    names = sorted(path.stem for path in options.maps.glob("*.map") if (options.maps / f"{path.name}.scen").exists())
    if not names:
        raise SystemExit(f"there is no NAME.map with a NAME.map.scen in {options.maps}")
    print(describe_machine() + "\n\n## Milliseconds a query: median (95 % below)\n")
    rows = [row for name in names for row in race(options.maps, name, options.queries, options.only.split(","))]
    print_table(("map", "queries", "what", "processor", "worst", "by the clock", "longer than exact"), rows)
    race_calls(options.maps, names)


if __name__ == "__main__":
    main()
