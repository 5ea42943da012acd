"""BARN's worlds: do all load, and do their reference paths lie in the free space of the maps made of them?

Give the folder with `world_N.world` and `path_N.npy` of the BARN data set (Perille et al., 2020; in
Daffan/the-barn-challenge, jackal_helper/worlds/BARN):

    python benchmarks/barn_worlds.py path/to/barn
"""

from __future__ import annotations

import argparse
import itertools
import time
import warnings
from pathlib import Path

import numpy as np
from timing import print_table

from trundle.geometry import FloatArray
from trundle.maps import FREE, OccupancyGrid
from trundle.worlds import World

BOUNDS = ((-5.0, -0.5), (0.5, 15.5))
Z_RANGE = (0.05, 0.5)


def path_in_metres(cells: np.ndarray) -> FloatArray:
    """Centres of a reference path's cells [m]: x = 0.15 a − 4.575, y = 0.15 b + 5.075."""
    return np.asarray(cells, dtype=np.float64) * 0.15 + (-4.575, 5.075)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--resolution", type=float, default=0.05)
    arguments = parser.parse_args()
    rows: list[tuple[str, ...]] = []
    bad = 0
    for file in sorted(arguments.folder.glob("world_*.world"), key=lambda path: int(path.stem.split("_")[1])):
        number = file.stem.split("_")[1]
        began = time.perf_counter()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            world = World.load(file)
        loaded = time.perf_counter()
        path = path_in_metres(np.load(arguments.folder / f"path_{number}.npy"))
        grid = OccupancyGrid.from_world(
            world, resolution=arguments.resolution, z_range=Z_RANGE, bounds=BOUNDS, seeds=[tuple(path[0])]
        )
        made = time.perf_counter()
        dense = np.vstack([np.linspace(a, b, 20) for a, b in itertools.pairwise(path)])
        cells = np.floor((dense - (grid.origin.x, grid.origin.y)) / grid.resolution).astype(int)
        off = int((grid.data[cells[:, 1], cells[:, 0]] != FREE).sum())
        centres = np.array([solid.pose.position[:2] for solid in world.solids])
        clearance = float(np.linalg.norm(dense[:, None] - centres[None], axis=-1).min()) - 0.075
        bad += off > 0
        rows.append(
            (
                number,
                str(len(world.solids)),
                f"{1000 * (loaded - began):.0f}",
                f"{1000 * (made - loaded):.1f}",
                f"{clearance:.3f}",
                "free" if off == 0 else f"{off} of {len(dense)} points are not free",
            )
        )
    print_table(("world", "cylinders", "load ms", "map ms", "path's clearance m", "path"), rows)
    print(f"\n{len(rows)} worlds load; the reference paths of {len(rows) - bad} lie in free space")
    raise SystemExit(1 if bad else 0)


if __name__ == "__main__":
    main()
