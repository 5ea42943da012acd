"""Faults planted in the maps of generated worlds: does the check name each, and nothing on the maps as they are?

    python benchmarks/mapping/map_check.py [--faults 30] [--resolutions 0.05,0.1,0.03]

Half of the faults are obstacles erased from a map, half are obstacles drawn into it: pieces of at least 0.1 m² that
reach beyond two cells from what stands there, at random places of four worlds, each in a separate map. A fault is
named if the check has one finding about obstacles, of its kind, and with its place inside it. The second table is of
the maps of all six generators as they are made.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from support.planted_faults import plant
from trundle.maps import OccupancyGrid
from trundle.maps.check import check_grid
from trundle.worlds import World

KINDS = ("missing_obstacle", "phantom_obstacle")
PLANTED = ("warehouse", "office", "cylinders", "lot")
UNTOUCHED = (*PLANTED, "maze", "corridors")


def count_named(faults: int, resolution: float) -> bool:
    """Plant faults, and print how many are named."""
    print(
        f"\n## {faults} faults in maps of {resolution:g} m a cell\n\n| world | faults | named | area | time a check |"
    )
    print("| --- | --- | --- | --- | --- |")
    missed = 0
    for index, name in enumerate(PLANTED):
        world = World.generate(name, seed=index)
        grid = OccupancyGrid.from_world(world, resolution=resolution)
        random = np.random.default_rng(index)
        areas, seconds, named = [], 0.0, 0
        for number in range(index, faults, len(PLANTED)):
            fault = plant(grid, KINDS[number // len(PLANTED) % 2], random)
            began = time.process_time()
            findings = check_grid(fault.grid, world=world).findings
            seconds += time.process_time() - began
            areas.append(fault.area)
            if fault.is_named(findings):
                named += 1
            else:
                found = "; ".join(f"{finding.kind}: {finding.message}" for finding in findings) or "nothing found"
                print(f"- missed in {name}: {fault.kind} of {fault.area:.2f} m²: {found}", file=sys.stderr)
        missed += len(areas) - named
        span = f"{min(areas):.2f} to {max(areas):.2f} m²"
        print(f"| {name} | {len(areas)} | {named} | {span} | {seconds / len(areas):.2f} s |")
    print(f"\n{faults - missed} of {faults} named")
    return missed == 0


def count_untouched(resolutions: list[float]) -> bool:
    """Check maps as they are made, and print what is said of their obstacles."""
    print("\n## Maps as they are made\n\n| world | " + " | ".join(f"{edge:g} m" for edge in resolutions) + " |")
    print("| --- " * (len(resolutions) + 1) + "|")
    clean = True
    for name in UNTOUCHED:
        world = World.generate(name, seed=3)
        counts: list[int] = []
        for resolution in resolutions:
            report = check_grid(OccupancyGrid.from_world(world, resolution=resolution), world=world)
            counts.append(len(report.findings))
        clean = clean and not any(counts)
        print(f"| {name} | " + " | ".join(map(str, counts)) + " |")
    return clean


def main() -> int:
    """Print both tables; 1 where a fault was missed or a map as it is was found fault with."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faults", type=int, default=30)
    parser.add_argument("--resolutions", default="0.05,0.1,0.03")
    given = parser.parse_args()
    resolutions = [float(text) for text in given.resolutions.split(",")]
    done = [count_named(given.faults, resolution) for resolution in resolutions]
    return 0 if all([*done, count_untouched(resolutions)]) else 1


if __name__ == "__main__":
    sys.exit(main())
