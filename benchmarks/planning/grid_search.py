"""Shortest paths on binary grids: correct on every query of a `.scen` file, and the speed beside pyastar2d and tcod.

    python -m benchmarks.planning.grid_search MAPS [--queries 60] [--city Berlin_0_1024] [--only peers,...]

MAPS is a folder of MovingAI maps, each `NAME.map` with its `NAME.map.scen`. The contestants take turns, query by query.
Times are the calling thread's on the processor: all but `plan_many` run in one thread, and where other work shares the
machine, the clock on the wall would count its turns against the long calls only.

Before each cold call 96 MB are written to, three times the last-level cache of most machines. 'Cold' then makes the
same call on a map of 16 x 16 cells, so that the library and the interpreter are near, and the map and what the search
keeps are not; 'all cold' does not. Warm means the same call once more.

pyastar2d solves an easier problem: diagonals cost it 1, and it cuts corners. tcod is given the rules of the `.scen`
files by a graph with conditions (one for each diagonal), and both get their maps in their own form beforehand.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.timing import describe_machine, load_peer, print_table

from trundle.maps.movingai import MovingAIQuery, load_map, load_scenarios
from trundle.planning import GridSearch

METHODS = ("auto", "jps", "astar")
_FLUSH = np.zeros(12_000_000)


def flush_caches() -> None:
    np.add(_FLUSH, 1.0, out=_FLUSH)


def microseconds(run: Callable[[], Any], *, first: Callable[[], Any] | None = None) -> float:
    """How long a call takes, after another one."""
    if first is not None:
        first()
    begin = time.thread_time_ns()
    run()
    return 1e-3 * (time.thread_time_ns() - begin)


def read(folder: Path, name: str) -> tuple[np.ndarray, list[MovingAIQuery]]:
    """The blocked cells, and the queries."""
    return load_map(folder / f"{name}.map").data != 0, load_scenarios(folder / f"{name}.map.scen")


def make_pyastar2d(blocked: np.ndarray) -> Callable[[MovingAIQuery], Any]:
    library = load_peer("pyastar2d", "pyastar2d")
    weights = np.where(blocked, np.inf, 1.0).astype(np.float32)
    return lambda query: library.astar_path(weights, query.start, query.goal, allow_diagonal=True)


def make_tcod(blocked: np.ndarray) -> Callable[[MovingAIQuery], Any]:
    library = load_peer("tcod.path", "tcod")
    free = np.pad(~blocked, 1)
    cost = (~blocked).astype(np.int8)
    graph = library.CustomGraph(blocked.shape)
    for row, col in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        graph.add_edge((row, col), 5741, cost=cost)
    for row, col in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        beside = free[1 + row : free.shape[0] - 1 + row, 1:-1] & free[1:-1, 1 + col : free.shape[1] - 1 + col]
        graph.add_edge((row, col), 8119, cost=cost, condition=np.ascontiguousarray(beside.astype(np.int8)))
    graph.set_heuristic(cardinal=5741, diagonal=8119)

    def plan(query: MovingAIQuery) -> Any:
        finder = library.Pathfinder(graph)
        finder.add_root(query.start)
        return finder.path_to(query.goal)

    return plan


def check_lengths(folder: Path, names: list[str]) -> None:
    print("## Every query of every map, all methods, both directions\n")
    rows = []
    for name in names:
        blocked, queries = read(folder, name)
        wrong, largest = 0, 0.0
        for method in METHODS:
            search = GridSearch(blocked, method=method)
            for query in queries:
                forth = search.shortest_path(query.start, query.goal)
                back = search.shortest_path(query.goal, query.start)
                none = query.optimal_length == 0 and query.start != query.goal
                error = abs(forth.length - query.optimal_length) if not none else 0.0
                right = forth.status == ("unreachable" if none else "found") and back.length == forth.length
                # Files give two decimals, six digits, or 32 bits.
                decimals = len(repr(query.optimal_length).partition(".")[2])
                wrong += not (right and error <= 0.501 * 10.0**-decimals + 1e-7 * query.optimal_length)
                largest = max(largest, error)
        rows.append((name, str(len(queries)), f"{largest:.1e}", str(wrong)))
    print_table(("map", "queries", "largest difference", "lengths that differ by more than the file's rounding"), rows)


def race_methods(folder: Path, names: list[str]) -> None:
    print("\n## What is chosen, and against bucket A*: all queries, warm, microseconds a query\n")
    rows = []
    for name in names:
        blocked, queries = read(folder, name)
        begin = time.perf_counter()
        search = GridSearch(blocked)
        build = time.perf_counter() - begin
        searches = {"auto": search, "astar": GridSearch(blocked, method="astar")}
        times: dict[str, list[float]] = {method: [] for method in searches}
        for query in queries:
            for method, one in searches.items():
                turns = [microseconds(lambda s=one, q=query: s.shortest_path(q.start, q.goal)) for _ in range(3)]
                times[method].append(min(turns))
        ratios = [auto / astar for auto, astar in zip(times["auto"], times["astar"], strict=True)]
        medians = {method: statistics.median(values) for method, values in times.items()}
        rows.append(
            (
                name,
                f"{search.clutter:.4f}",
                search.method,
                f"{1e3 * build:.2f}",
                f"{medians['auto']:.1f}",
                f"{medians['astar']:.1f}",
                f"{statistics.median(ratios):.3f}",
                f"{sum(times['auto']) / sum(times['astar']):.3f}",
            )
        )
    header = ("map", "clutter", "chosen", "built in ms", "chosen", "astar")
    print_table((*header, "chosen / astar: median", "of all the time"), rows)


def make_ours(blocked: np.ndarray) -> Callable[[MovingAIQuery], Any]:
    search = GridSearch(blocked)
    return lambda query: search.shortest_path(query.start, query.goal)


def race_peers(folder: Path, names: list[str], count: int) -> None:
    print(f"\n## Beside peers, {count} queries a map drawn by seed, medians in microseconds\n")
    tiny = MovingAIQuery(0, "", 16, 16, (1, 2), (14, 12), 14.0)
    makers = {"ours": make_ours, "pyastar2d": make_pyastar2d, "tcod": make_tcod}
    near = {name: make(np.zeros((16, 16), bool)) for name, make in makers.items()}
    rows = []
    for name in names:
        blocked, queries = read(folder, name)
        drawn = [queries[i] for i in np.random.default_rng(0).permutation(len(queries))[:count]]
        contestants = {contestant: make(blocked) for contestant, make in makers.items()}
        times: dict[str, list[float]] = {}

        def note(
            what: str, call: Callable[[], Any], first: Callable[[], Any], times: dict[str, list[float]] = times
        ) -> None:
            times.setdefault(what, []).append(microseconds(call, first=first))

        for query in drawn:
            for contestant, run in contestants.items():

                def flush(again: Callable[[MovingAIQuery], Any] = near[contestant]) -> None:
                    flush_caches()
                    again(tiny)

                note(contestant, lambda r=run, q=query: r(q), flush)
                note(f"{contestant} all cold", lambda r=run, q=query: r(q), flush_caches)
            ours = contestants["ours"]
            note("cells", lambda r=ours, q=query: r(q).cells, lambda: (flush_caches(), near["ours"](tiny).cells))
            note("warm", lambda r=ours, q=query: r(q), lambda r=ours, q=query: r(q))
        row = [name, *(f"{statistics.median(times[what]):.0f}" for what in ("warm", *makers, "cells", "ours all cold"))]
        for peer in ("pyastar2d", "tcod"):
            for what in ("", " all cold"):
                over = statistics.median(times[peer + what]) / statistics.median(times["ours" + what])
                row.append(f"{over:.0f}")
        rows.append(tuple(row))
    header = ("map", "warm", "cold", "pyastar2d", "tcod", "cold with .cells", "all cold")
    print_table((*header, "pyastar2d / cold", "all cold", "tcod / cold", "all cold"), rows)


def race_large(folder: Path, city: str) -> None:
    print(f"\n## {city} tiled 4 x 4\n")
    tile, queries = read(folder, city)
    blocked = np.tile(tile, (4, 4))
    begin = time.perf_counter()
    search = GridSearch(blocked)
    build = time.perf_counter() - begin
    empty = search.nbytes
    free = np.argwhere(~blocked)
    starts, goals = free[np.random.default_rng(0).integers(len(free), size=(2, 2000))]
    lengths = search.plan_many(starts, goals).length
    lengths[~np.isfinite(lengths)] = 0.0
    longest = int(lengths.argmax())
    turns = [microseconds(lambda: search.shortest_path(starts[longest], goals[longest])) for _ in range(300)]
    each = [microseconds(lambda i=i: search.shortest_path(starts[i], goals[i])) for i in range(2000)]
    offset = blocked.shape[0] // 4
    hardest = max(queries, key=lambda query: query.optimal_length)
    start, goal = np.array(hardest.start) + tile.shape, np.array(hardest.goal) + tile.shape
    within = [microseconds(lambda: search.shortest_path(start, goal)) for _ in range(300)]
    shape = f"{blocked.shape[0]} x {blocked.shape[1]}"
    rows = [
        (f"built, {shape}", f"{1e3 * build:.1f} ms"),
        ("memory over the map", f"{1e-6 * empty:.2f} MB, after the searches {1e-6 * search.nbytes:.2f} MB"),
        (f"longest of 2000 drawn by seed ({lengths[longest]:.0f} cells)", describe(turns)),
        (f"longest of the file, in one tile ({search.shortest_path(start, goal).length:.0f} cells)", describe(within)),
        ("all 2000", f"{describe(each)}, nine tenths {np.percentile(each, 90):.0f} us"),
    ]
    span = offset, offset + 20
    updates = [microseconds(lambda t=turn: search.update(span, span, t % 2 == 0)) for turn in range(41)]
    rows.append(("update of 20 x 20 cells", describe(updates)))
    print_table(("what", "figure"), rows)


def describe(times: list[float]) -> str:
    return f"median {statistics.median(times):.1f} us, best {min(times):.1f} us"


def race_calls(folder: Path, city: str) -> None:
    print("\n## Other figures\n")
    blocked, queries = read(folder, city)
    search = GridSearch(blocked)
    starts, goals = (np.array([getattr(query, end) for query in queries]) for end in ("start", "goal"))
    wall: dict[int, list[float]] = {1: [], 2: []}
    processor: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(40):
        for threads in wall:
            begin, spent = time.perf_counter(), time.process_time()
            search.plan_many(starts, goals, threads=threads)
            processor[threads].append(time.process_time() - spent)
            wall[threads].append(time.perf_counter() - begin)
    walled = blocked.copy()
    walled[:, walled.shape[1] // 2] = True
    closed = GridSearch(walled)
    free = np.argwhere(~walled)
    left, right = free[free[:, 1] < walled.shape[1] // 2][0], free[free[:, 1] > walled.shape[1] // 2][-1]
    if closed.shortest_path(left, right).status != "unreachable":
        raise SystemExit("the wall has a hole")
    unreachable = [microseconds(lambda: closed.shortest_path(left, right)) for _ in range(2000)]
    row, col = free[len(free) // 2].tolist()
    rows = [
        *(
            (
                f"plan_many, {len(queries)} queries, {threads} thread{'s' * (threads > 1)}",
                f"median {1e3 * statistics.median(wall[threads]):.1f} ms, best {1e3 * min(wall[threads]):.1f} ms; "
                f"on processors {1e3 * statistics.median(processor[threads]):.1f} ms",
            )
            for threads in wall
        ),
        ("one thread over two: best", f"{min(wall[1]) / min(wall[2]):.2f}"),
        ("one thread over two: medians", f"{statistics.median(wall[1]) / statistics.median(wall[2]):.2f}"),
        ("unreachable goal", describe(unreachable)),
        (
            "update of one cell",
            describe([microseconds(lambda i=i: search.update(row, col, i % 2 == 0)) for i in range(101)]),
        ),
        ("import of the kernels", f"{import_time():.2f} ms, best of 9"),
    ]
    print_table(("what", "figure"), rows)


def import_time() -> float:
    code = (
        "import numpy, time, trundle; begin = time.perf_counter(); import trundle._core; "
        "print(1e3 * (time.perf_counter() - begin))"
    )
    runs = [subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True) for _ in range(9)]
    return min(float(run.stdout) for run in runs)


def race_huge(side: int) -> None:
    print(f"\n## {side} x {side}: boxes of 2 to 600 cells, and a serpentine\n")
    rng = np.random.default_rng(0)
    blocked = np.zeros((side, side), bool)
    for _ in range(side * side // 200_000):
        row, col = rng.integers(0, side, 2)
        height, width = rng.integers(2, 600, 2)
        blocked[row : row + height, col : col + width] = True
    rows = []
    for what in ("boxes", "serpentine"):
        if what == "serpentine":
            blocked[:] = False
            blocked[1::4, :-1] = blocked[3::4, 1:] = True
        begin = time.perf_counter()
        search = GridSearch(blocked)
        build = time.perf_counter() - begin
        start, goal = (0, int((~blocked[0]).argmax())), (side - 1, side - 1 - int((~blocked[-1, ::-1]).argmax()))
        path = search.shortest_path(start, goal)
        took = [1e-3 * microseconds(lambda s=start, g=goal, f=search: f.shortest_path(s, g)) for _ in range(5)]
        memory = f"{1e-6 * search.nbytes:.0f} MB"
        rows.append(
            (what, f"{build:.2f} s", memory, search.method, f"{path.length:.0f}", f"{statistics.median(took):.1f} ms")
        )
    print_table(("map", "built", "memory", "method", "length, cells", "from the first row to the last"), rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", type=Path, help="folder of MovingAI maps and their .scen files")
    parser.add_argument("--queries", type=int, default=60, help="for each map beside peers")
    parser.add_argument("--city", default="Berlin_0_1024", help="the map that is tiled and planned in batches")
    parser.add_argument("--huge", type=int, default=20_000, help="side of the largest map [cells]")
    parser.add_argument("--only", default="lengths,methods,peers,large,calls,huge")
    options = parser.parse_args()
    names = sorted(path.stem for path in options.maps.glob("*.map") if (options.maps / f"{path.name}.scen").exists())
    if not names:
        raise SystemExit(f"there is no NAME.map with a NAME.map.scen in {options.maps}")
    print(describe_machine() + "\n")
    parts: dict[str, Callable[[], None]] = {
        "lengths": lambda: check_lengths(options.maps, names),
        "methods": lambda: race_methods(options.maps, names),
        "peers": lambda: race_peers(options.maps, names, options.queries),
        "large": lambda: race_large(options.maps, options.city),
        "calls": lambda: race_calls(options.maps, options.city),
        "huge": lambda: race_huge(options.huge),
    }
    for part in options.only.split(","):
        parts[part]()


if __name__ == "__main__":
    main()
