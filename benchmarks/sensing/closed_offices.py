"""Missions in offices with boxes that are on no map: how many arrive, and how long the slowest take.

trundle evaluate benchmarks/sensing/closed_offices.yaml -o runs/closed_offices --workers 16
python -m benchmarks.sensing.closed_offices runs/closed_offices

With the folders of two versions it counts the missions that only one of them solves. Wall time is that of a worker: use
one worker for every two cores to see what a mission takes on an idle machine.
"""

from __future__ import annotations

import argparse
from collections import Counter

import numpy as np
from benchmarks.timing import print_table

from trundle.evaluation import Evaluation
from trundle.evaluation.row import Row

_SLOW_S = 120.0


def main() -> None:
    """Print a line for each folder, its slowest missions, and what differs between two."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", help="folders of evaluations")
    parser.add_argument("--slowest", type=int, default=5, help="how many of the slowest missions to list")
    options = parser.parse_args()
    rows = {folder: {row.seed: row for row in Evaluation(folder).rows()} for folder in options.folders}
    header = (
        "evaluation",
        "missions",
        "arrived",
        f"over {_SLOW_S:g} s",
        "wall max s",
        "95 %",
        "CPU max s",
        "sum h",
        "",
    )
    print_table(header, [tuple(map(str, describe(folder, list(by.values())))) for folder, by in rows.items()])
    for folder, by_seed in rows.items():
        for row in sorted(by_seed.values(), key=lambda row: -(row.wall_s or 0.0))[: options.slowest]:
            planning_s = 1e-3 * (row.planning_ms or 0.0)
            print(
                f"{folder} seed {row.seed}: {row.wall_s or 0.0:.0f} s ({planning_s:.0f} s of planning, "
                f"{row.cpu_s or 0.0:.0f} s of CPU), {row.replans} replans: {row.message or row.outcome}"
            )
    if len(rows) == 2:
        first, second = rows.values()
        for name, one, other in (("first", first, second), ("second", second, first)):
            only = [seed for seed in sorted(one.keys() & other.keys()) if arrived(one[seed]) > arrived(other[seed])]
            print(f"arrived in the {name} alone: {len(only)} {only}")


def arrived(row: Row) -> bool:
    """Whether the robot got there."""
    return row.outcome == "arrived"


def describe(folder: str, rows: list[Row]) -> tuple[object, ...]:
    """Figures of the missions of one evaluation."""
    wall = np.array([row.wall_s or 0.0 for row in rows])
    cpu = np.array([row.cpu_s or 0.0 for row in rows])
    others = Counter(row.outcome for row in rows if not arrived(row))
    return (
        folder,
        len(rows),
        f"{sum(map(arrived, rows))} ({100.0 * np.mean([arrived(row) for row in rows]):.1f} %)",
        int((wall > _SLOW_S).sum()),
        f"{wall.max():.0f}",
        f"{np.percentile(wall, 95.0):.0f}",
        f"{cpu.max():.0f}",
        f"{cpu.sum() / 3600.0:.2f}",
        ", ".join(f"{count} {name}" for name, count in others.items()),
    )


if __name__ == "__main__":
    main()
