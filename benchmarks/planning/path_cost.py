"""What `least_cost` paths cost, and how long they take, against two planners on potentials.

    python -m benchmarks.planning.path_cost [MAP.yaml …] [MAP.map …] [--generated 2] [--size 2000] [--queries 1000]

J = ∫ w ds with w = 50 + 0.8 · cost, constant in a cell, clipped at its borders; along a border the dearer cell counts,
and 253 and more is infinite. Queries are seeded pairs of cell centres at least 20 cells apart and connected by a path.
(a) navfn: reimplemented after Nav2's NavFn (interpolated potential up to the goal, steps of half a cell down its
gradient, whole weights). (b) eikonal: first-order fast marching over the whole map, steps of a quarter cell down its
gradient. Both are in potential_peers.cpp, compiled with the C++ compiler at hand. Beside them are two full fields, with
without descent: this package's `cost_field` on one thread, and NavFn's potential over the whole map. Paths of the peers
that enter 253 and more, or end nowhere, are counted apart.

Times are processor time of one query, tracing counted: all of `least_cost` but the check of the footprint, which the
others do not have. Contestants take turns, one after the other, and each
query is timed once.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
from benchmarks.planning.inflation import make_map
from benchmarks.timing import describe_machine, print_table

import trundle
from trundle import _core
from trundle.costmap import Costmap
from trundle.planning import cost_field
from trundle.planning.grid_planners.footprint_planner import cell_weights
from trundle.planning.grid_planners.least_cost import COST_WEIGHT, NEUTRAL_COST

WEIGHTS = cell_weights(NEUTRAL_COST, COST_WEIGHT)
WHOLE = np.floor(WEIGHTS).astype(np.uint16)
STEP_CELLS = 0.25
MOST_POINTS = 400_000

Costs = npt.NDArray[np.uint8]
Cell = tuple[int, int]


def build_peers(folder: str) -> ctypes.CDLL:
    """Compile the potential planners, optimised as the kernels are."""
    source, library = Path(__file__).with_name("potential_peers.cpp"), Path(folder) / "potential_peers.so"
    subprocess.run(["c++", "-std=c++17", "-O3", "-shared", "-fPIC", "-o", str(library), str(source)], check=True)
    peers = ctypes.CDLL(str(library))
    size, array = ctypes.c_int64, ctypes.c_void_p
    peers.navfn.argtypes = peers.navfn_field.argtypes = [array, size, size, size, size, array, size]
    peers.eikonal.argtypes = [array, array, size, size, size, size, ctypes.c_double, array, size]
    peers.navfn.restype = peers.navfn_field.restype = peers.eikonal.restype = size
    return peers


class PotentialPlanner:
    """One of the peers, by name: cells in, (x, y) in grid units out."""

    def __init__(self, peers: ctypes.CDLL, name: str) -> None:
        self._peers, self._name = peers, name
        self._points = np.empty((MOST_POINTS, 2))

    def __call__(self, costs: Costs, start: Cell, goal: Cell) -> npt.NDArray[np.float64]:
        rows, cols = costs.shape
        ends = (start[0] * cols + start[1], goal[0] * cols + goal[1])
        out = (self._points.ctypes.data, MOST_POINTS)
        if self._name != "eikonal":
            count = getattr(self._peers, self._name)(costs.ctypes.data, rows, cols, *ends, *out)
        else:
            count = self._peers.eikonal(costs.ctypes.data, WEIGHTS.ctypes.data, rows, cols, *ends, STEP_CELLS, *out)
        return self._points[:count].copy()


KERNEL = _core.LeastCost(WEIGHTS)


def least_cost(costs: Costs, start: Cell, goal: Cell) -> npt.NDArray[np.float64]:
    """What `LeastCostPlanner` drives, before the check of the footprint."""
    ends = np.array([start[::-1], goal[::-1]]) + 0.5
    return KERNEL.find(costs, start, goal, ends)[1]


class FullField:
    """The exact 8-connected field over the whole map, from weights made once per map; no path is traced."""

    def __init__(self) -> None:
        self._costs: Costs | None = None
        self._weights = np.empty((0, 0), np.uint16)

    def __call__(self, costs: Costs, start: Cell, goal: Cell) -> npt.NDArray[np.float64]:
        if costs is not self._costs:
            self._costs, self._weights = costs, WHOLE[costs]
            self._weights[self._weights == 0] = np.iinfo(np.uint16).max
        cost_field(self._weights, goal, threads=1)
        return np.empty((0, 2))


def path_cost(costs: Costs, points: npt.NDArray[np.float64]) -> float:
    """J of a polyline; NaN for none."""
    if len(points) == 0:
        return math.nan
    starts, ends = np.ascontiguousarray(points[:-1]), np.ascontiguousarray(points[1:])
    return float(_core.line_costs(costs, WEIGHTS, starts, ends).sum())


def pick_queries(costs: Costs, count: int, seed: int) -> list[tuple[Cell, Cell]]:
    """Free cells at least 20 cells apart and connected by a path."""
    rng = np.random.default_rng(seed)
    free = np.argwhere(costs < 253)
    queries: list[tuple[Cell, Cell]] = []
    while len(queries) < count:
        (r0, c0), (r1, c1) = rng.choice(free, 2).tolist()
        if math.hypot(r0 - r1, c0 - c1) >= 20 and len(_core.grid_search(costs, WHOLE, (r0, c0), (r1, c1))[0]):
            queries.append(((r0, c0), (r1, c1)))
    return queries


def load_maps(options: argparse.Namespace) -> list[tuple[str, Costs]]:
    """Cost bytes by name: the maps given, generated warehouses, and boxes at random."""
    robot = trundle.Robot.load("nova_carter")
    grids = [(path.name, trundle.OccupancyGrid.load(path)) for path in options.maps]
    for seed in range(options.generated):
        world = trundle.World.generate("warehouse", seed=seed)
        grids.append((f"warehouse {seed}", trundle.OccupancyGrid.from_world(world, z_range=robot.z_range)))
    if options.size:
        grids.append(("boxes at random", trundle.OccupancyGrid(make_map(options.size), 0.05)))
    return [(name, np.ascontiguousarray(Costmap.from_grid(grid, robot.outline).data)) for name, grid in grids]


def measure(name: str, costs: Costs, contestants: dict[str, Callable], options: argparse.Namespace) -> list[tuple]:
    """The rows of one map's table."""
    queries = pick_queries(costs, options.queries, options.seed)
    for plan in contestants.values():
        plan(costs, *queries[0])  # what is made once a map is made here
    results = {who: np.full((len(queries), 2), np.nan) for who in contestants}
    for index, (start, goal) in enumerate(queries):
        for who, plan in contestants.items():
            if index >= options.eikonal and who in ("eikonal", "full field", "full navfn"):
                continue
            began = time.process_time()
            points = plan(costs, start, goal)
            took = time.process_time() - began
            results[who][index] = path_cost(costs, points), 1e3 * took
    navfn, eikonal = results["navfn"], results["eikonal"]
    rows = []
    for who, result in results.items():
        with np.errstate(invalid="ignore"):  # infinity over infinity, where both enter 253
            to_navfn, to_eikonal = result[:, 0] / navfn[:, 0], result[:, 0] / eikonal[:, 0]
        to_navfn, to_eikonal = (ratio[np.isfinite(ratio) & (ratio > 0)] for ratio in (to_navfn, to_eikonal))
        paths = [
            f"{int(np.isinf(result[:, 0]).sum())}",
            f"{int((np.isnan(result[:, 0]) & ~np.isnan(result[:, 1])).sum())}",
        ]
        if who in ("full field", "full navfn"):
            figures = ["", "", "", "", ""]
            paths = ["", ""]
        else:
            figures = [
                f"{100 * np.mean(to_navfn <= 1 + 1e-9):.1f}",
                f"{to_navfn.max():.4f}",
                f"{int((to_navfn > 1.002).sum())}",
                f"{np.median(to_eikonal):.4f}",
                f"{to_eikonal.max():.4f} ({int((to_eikonal > 1.005).sum())})",
            ]
        times = result[:, 1]
        share = np.nanmedian(times / navfn[:, 1])
        rows.append((who, *figures, *paths, f"{np.nanmedian(times):.2f}", f"{share:.2f}"))
    print(f"\n## {name}, {costs.shape[0]} x {costs.shape[1]}, {len(queries)} queries\n", flush=True)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maps", nargs="*", type=Path, help="ROS or MovingAI maps, inflated for Nova Carter at 0.05 m")
    parser.add_argument("--generated", type=int, default=2, help="how many generated warehouses")
    parser.add_argument("--size", type=int, default=2000, help="edge of the map of boxes [cells], 0 for none")
    parser.add_argument("--queries", type=int, default=1000, help="queries a map")
    parser.add_argument("--eikonal", type=int, default=1000, help="how many of them eikonal and the full field get")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    print("J and processor time of one query, whole maps\n" + describe_machine() + "\n" + " ".join(sys.argv[1:]))
    with tempfile.TemporaryDirectory() as folder:
        peers = build_peers(folder)
        contestants: dict[str, Callable] = {
            "least_cost": least_cost,
            "navfn": PotentialPlanner(peers, "navfn"),
            "eikonal": PotentialPlanner(peers, "eikonal"),
            "full field": FullField(),
            "full navfn": PotentialPlanner(peers, "navfn_field"),
        }
        for name, costs in load_maps(options):
            rows = measure(name, costs, contestants, options)
            print_table(
                (
                    "planner",
                    "% at most navfn's J",
                    "largest of navfn's",
                    "above 1.002",
                    "median of eikonal's",
                    "largest (above 1.005)",
                    "enter 253+",
                    "no path",
                    "ms, median",
                    "of navfn's time, median",
                ),
                rows,
            )


if __name__ == "__main__":
    main()
