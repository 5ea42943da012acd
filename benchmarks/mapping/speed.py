"""Maps of worlds: how fast, with how much memory, and what MuJoCo's queries take and miss for the same map.

    python -m benchmarks.mapping.speed [--rounds 9] [--part memory,solids,triangles,loading]

Times are those of `OccupancyGrid.from_world`, from the solids in memory to the finished map: bounds, raster, flood from
the largest free area. Reading files is timed apart. Contestants take turns, and are compared by the processor's time,
which other work on the machine changes least. MuJoCo is asked about a sample of the cells
where all of them would take minutes, and its time is scaled by what was left out; making its model is not counted.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.mapping.peers import Peers
from benchmarks.mapping.scenes import BAND, FIELD, HALL, KINDS, MESHES, mixed_world
from benchmarks.timing import describe_machine, interleaved_times, print_table

from trundle.export import export_world
from trundle.geometry.solids import Solid
from trundle.maps import OCCUPIED, OccupancyGrid
from trundle.worlds import World

RESOLUTION = 0.05
TRIANGLES = 1_000_000
EDGES = {"3 cm": 0.03, "30 cm": 0.3, "3 m": 3.0}
SAMPLE = 2_000
WORLDS = {"hall": (200, HALL, 0.005), "field": (20_000, FIELD, 0.25)}
MESH_TARGET = 0.4


def make_map(world: World, size: tuple[float, float] | None = None) -> OccupancyGrid:
    bounds = None if size is None else ((0.0, 0.0), size)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # A mesh that is not closed, and a map without free cells, are meant.
        return OccupancyGrid.from_world(world, resolution=RESOLUTION, z_range=BAND, bounds=bounds)


def mesh_world(kind: str, edge: float) -> World:
    return World("triangles", (Solid("triangles", MESHES[kind](edge, TRIANGLES)),))


def describe(grid: OccupancyGrid) -> str:
    return f"{grid.shape[1]} × {grid.shape[0]}, {100 * float((grid.data == OCCUPIED).mean()):.0f} %"


# Memory: each case in a separate process.


def memory_case(case: str) -> dict[str, float]:
    if case in WORLDS:
        count, size, _ = WORLDS[case]
        world, bounds = mixed_world(count, size), None
    else:
        kind, edge = case.split("/")
        world, bounds = mesh_world(kind, EDGES[edge]), FIELD
    before = _forget_peak()
    make_map(world, bounds)
    return {"before": before, "after": _status("VmHWM")}


def _forget_peak() -> float:
    """Give back what making the geometry left, and look for a new peak; return the memory in use [MB]."""
    ctypes.CDLL(None).malloc_trim(0)
    Path("/proc/self/clear_refs").write_text("5")
    return _status("VmRSS")


def _status(name: str) -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) / 1024.0 for line in lines if line.startswith(f"{name}:"))


def measure_memory() -> None:
    if not Path("/proc/self/clear_refs").exists():
        print("\nPeak memory: not measured, this needs Linux with glibc")
        return
    rows = []
    for case in (*WORLDS, *(f"{kind}/{edge}" for kind in MESHES for edge in EDGES)):
        command = [sys.executable, "-m", "benchmarks.mapping.speed", "--memory-case", case]
        got = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        rows.append((case, f"{got['before']:.0f}", f"{got['after'] - got['before']:.0f}"))
    print("\nPeak memory of a separate process, MB; it holds the geometry before the map is made\n")
    print_table(("case", "before", "more while the map is made (target of the field: 300 in all)"), rows)


# Times.


class Mapping:
    """Makes one map again and again, and keeps the seconds by the wall clock; turns are timed by the processor's."""

    def __init__(self, world: World, size: tuple[float, float] | None = None) -> None:
        self._world, self._size = world, size
        self._wall: list[float] = []

    def __call__(self) -> None:
        begin = time.perf_counter()
        make_map(self._world, self._size)
        self._wall.append(time.perf_counter() - begin)

    def row(self, name: str, processor: list[float], target: float) -> tuple[str, ...]:
        grid = make_map(self._world, self._size)
        wall = self._wall[1:]
        shown = (statistics.median(wall), min(wall), statistics.median(processor))
        verdict = next(
            (f"met by the {what}" for what, value in zip(WHAT, shown, strict=True) if value <= target), "MISSED"
        )
        return (name, describe(grid), *(f"{1e3 * value:.1f}" for value in shown), f"{1e3 * target:.0f}", verdict)


WHAT = ("median", "least", "processor's")
HEADER = ("world", "cells, occupied", "median ms", "least ms", "processor's ms, median", "target ms", "")


def measure_solids(rounds: int) -> None:
    rng = np.random.default_rng(0)
    rows: list[tuple[str, ...]] = []
    others: list[tuple[str, ...]] = []
    for name, (count, size, target) in WORLDS.items():
        world = mixed_world(count, size)
        grid = make_map(world)
        ours = Mapping(world)
        contestants: dict[str, Callable[[], Any]] = {"trundle": ours}
        shares = {"trundle": 1.0}
        for method, (ask, everything) in Peers(world, grid, BAND).methods().items():
            asked = everything if name == "hall" else rng.choice(everything, SAMPLE, replace=False)
            contestants[method] = lambda ask=ask, asked=asked: ask(asked)
            shares[method] = len(everything) / len(asked)
        times = interleaved_times(contestants, rounds, time.process_time)
        rows.append(ours.row(f"{count:,} solids, {size[0]:g} × {size[1]:g} m", times["trundle"], target))
        for method, share in shares.items():
            if method == "trundle":
                continue
            ratios = [share * theirs / own for theirs, own in zip(times[method], times["trundle"], strict=True)]
            seconds = share * statistics.median(times[method])
            ratio = f"{statistics.median(ratios):,.0f} ({min(ratios):,.0f})"
            others.append((name, method, f"{seconds:,.2f}", "all" if share == 1.0 else f"1 in {share:,.0f}", ratio))
    print("\nSolids of all kinds\n")
    print_table(HEADER, rows)
    print("\nMuJoCo's queries for the same maps\n")
    print_table(("world", "method", "processor's s", "asked", "of trundle's time: median (least)"), others)
    print("\nWhat they miss in the hall, kind by kind, and what they add\n")
    print_table(*compare_kinds())


def compare_kinds() -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    count, size, _ = WORLDS["hall"]
    whole = mixed_world(count, size)
    low, high = whole.bounds
    bounds = ((low[0], low[1]), (high[0], high[1]))
    rows: list[tuple[str, ...]] = []
    for kind in KINDS:
        world = World(kind, tuple(solid for solid in whole.solids if solid.kind == kind))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            grid = OccupancyGrid.from_world(world, resolution=RESOLUTION, z_range=BAND, bounds=bounds)
        ours = grid.data.ravel() == OCCUPIED
        row = [kind, f"{ours.sum()}"]
        for ask, everything in Peers(world, grid, BAND).methods().values():
            theirs = np.zeros(ours.size, dtype=bool)
            theirs[ask(everything)] = True
            row.append(f"{(ours & ~theirs).sum()} / {(theirs & ~ours).sum()}")
        rows.append(tuple(row))
    return ("kind", "trundle's cells", "distance: missed / extra", "rays down", "rays across"), rows


def measure_triangles(rounds: int) -> None:
    worlds = {f"{kind}, {edge}": mesh_world(kind, size) for kind in MESHES for edge, size in EDGES.items()}
    mappings = {name: Mapping(world, FIELD) for name, world in worlds.items()}
    times = interleaved_times(mappings, rounds, time.process_time)
    rows = [mapping.row(name, times[name], MESH_TARGET) for name, mapping in mappings.items()]
    print(f"\n{TRIANGLES:,} triangles in one mesh, {FIELD[0]:g} × {FIELD[1]:g} m\n")
    print_table(HEADER, rows)
    name = "at random, open, 30 cm"
    world = worlds[name]
    grid = make_map(world, FIELD)
    methods = Peers(world, grid, BAND).methods()
    asked = np.random.default_rng(0).choice(grid.data.size, SAMPLE // 4, replace=False)
    # The distance query sees the mesh's convex hull, which is all of the map: there is nothing to time.
    contestants: dict[str, Callable[[], Any]] = {
        method: lambda ask=ask: ask(asked) for method, (ask, _) in methods.items() if "ray" in method
    }
    theirs = interleaved_times({"trundle": lambda: make_map(world, FIELD), **contestants}, rounds, time.process_time)
    share = grid.data.size / len(asked)
    print(f"\nMuJoCo's rays for {name}\n")
    print_table(
        ("method", "processor's s", "of trundle's time"),
        [
            (
                method,
                f"{share * statistics.median(theirs[method]):,.0f}",
                f"{share * statistics.median(theirs[method]) / statistics.median(theirs['trundle']):,.0f}",
            )
            for method in contestants
        ],
    )


def measure_loading(rounds: int) -> None:
    worlds = {
        "20,000 solids": (mixed_world(*WORLDS["field"][:2]), ("sdf", "mjcf", "usd")),
        "1,000,000 triangles": (mesh_world("tetrahedra, closed", 0.3), ("glb", "usd")),
    }
    suffixes = {"sdf": ".sdf", "mjcf": ".xml", "usd": ".usdc", "glb": ".glb"}
    rows = []
    for name, (world, formats) in worlds.items():
        for kind in formats:
            with tempfile.TemporaryDirectory() as folder:
                path = export_world(world, Path(folder) / f"world{suffixes[kind]}", to=kind)
                spent = []
                for _ in range(rounds):
                    begin = time.perf_counter()
                    World.load(path)
                    spent.append(time.perf_counter() - begin)
            rows.append((name, kind, f"{statistics.median(spent):.2f}", f"{min(spent):.2f}"))
    print("\nLoading, which is not in the times above\n")
    print_table(("world", "format", "median s", "least s"), rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--part", default="memory,solids,triangles,loading", help="what to measure, by commas")
    parser.add_argument("--memory-case", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.memory_case:
        print(json.dumps(memory_case(options.memory_case)))
        return
    print(f"Maps of worlds, {RESOLUTION} m a cell, band {BAND[0]} to {BAND[1]} m, {options.rounds} turns")
    print(describe_machine())
    parts: dict[str, Callable[[], None]] = {
        "memory": measure_memory,
        "solids": lambda: measure_solids(options.rounds),
        "triangles": lambda: measure_triangles(options.rounds),
        "loading": lambda: measure_loading(min(3, options.rounds)),
    }
    for part in options.part.split(","):
        if part not in parts:
            raise SystemExit(f"--part {part}: there are {', '.join(parts)}")
        parts[part]()


if __name__ == "__main__":
    main()
