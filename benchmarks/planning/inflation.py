"""Inflation of a map to cost bytes, against OpenCV's exact distance transform and NumPy, one thread each.

    python -m benchmarks.planning.inflation [--size 2000] [--radius 1.0] [--rounds 15]

Both give Nav2's costs; that they give the same ones is checked first.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from benchmarks.timing import describe_machine, interleaved_medians, load_peer, print_table

from trundle import _core
from trundle.costmap import Costmap
from trundle.costmap.costs import cost_table
from trundle.maps.grid import OccupancyGrid

RESOLUTION = 0.05
INSCRIBED = 0.14
FACTOR = 3.0


def make_map(size: int, seed: int = 0) -> np.ndarray:
    """Free space with boxes of 2 to 60 cells; a tenth of the cells is occupied at 2000 × 2000."""
    rng = np.random.default_rng(seed)
    data = np.zeros((size, size), np.int8)
    for _ in range(size * size // 10_000):
        row, col = rng.integers(0, size, 2)
        height, width = rng.integers(2, 60, 2)
        data[row : row + height, col : col + width] = 100
    return data


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=2000, help="edge of the map [cells]")
    parser.add_argument("--radius", type=float, default=1.0, help="inflation radius [m]")
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    cv2 = load_peer("cv2", "OpenCV")
    cv2.setNumThreads(1)

    data = make_map(options.size)
    table = cost_table(INSCRIBED, options.radius, FACTOR, RESOLUTION)

    def opencv() -> np.ndarray:
        cells = cv2.distanceTransform((data == 0).view(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
        distances = cells * np.float32(RESOLUTION)
        costs = np.zeros(data.shape, np.uint8)
        near = distances <= options.radius + 1e-6
        costs[near] = 252.0 * np.exp(-FACTOR * (distances[near] - np.float32(INSCRIBED)))
        costs[distances <= INSCRIBED] = 253
        costs[data == 100] = 254
        return costs

    ours, theirs = _core.inflate(data, table), opencv()
    # OpenCV's distances are float32: a cost may differ by one where the exponential is near a whole number.
    if np.abs(ours.astype(int) - theirs.astype(int)).max() > 1:
        raise SystemExit("the two do not agree: this is no comparison")

    grid = OccupancyGrid(data, RESOLUTION)
    square = INSCRIBED * np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    medians = interleaved_medians(
        {
            "trundle, the kernel": lambda: _core.inflate(data, table),
            "trundle, Costmap.from_grid": lambda: Costmap.from_grid(grid, square, options.radius, FACTOR),
            "OpenCV exact distance + NumPy": opencv,
        },
        options.rounds,
    )
    base = medians["OpenCV exact distance + NumPy"]
    reach = math.floor(options.radius / RESOLUTION)
    print(f"Inflation, {options.size} x {options.size}, {reach} cells far, medians of {options.rounds} turns")
    print(describe_machine() + "\n")
    print_table(
        ("what", "ms", "of OpenCV + NumPy"),
        [(name, f"{1e3 * value:.2f}", f"{value / base:.3f}") for name, value in medians.items()],
    )


if __name__ == "__main__":
    main()
