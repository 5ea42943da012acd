"""Whose poses align scans better: the mapper's, or those of a log's reference? The same measure for both.

python -m benchmarks.mapping.neighbours FOLDER [--only fr079 csail] [--drift 0.5] [--seed 0]

Pairs of scans that see the same are laid over each other by either's poses: scans that follow each other, and scans
from within half a metre and 30 degrees of each other, at least 100 scans apart (by the reference). Each point of one is
measured along the normal of the nearest point of the other; points without one within 0.5 m are left out.
"""

from __future__ import annotations

import argparse
import math
import warnings
from pathlib import Path

import numpy as np
from benchmarks.mapping.logs import Log, read_corrected
from benchmarks.mapping.slam import LOGS, run
from scipy.spatial import cKDTree

from trundle import Pose2D, Robot
from trundle.mapping.nodes import Surface, make_surface

REACH_M = 0.5
MOST_PAIRS = 2000


def surface_of(log: Log, index: int) -> Surface:
    """What a scan saw, seen from the robot."""
    ranges = log.ranges[index]
    met = np.isfinite(ranges) & (ranges < log.range_max)
    points = np.column_stack((ranges * np.cos(log.angles), ranges * np.sin(log.angles)))[met]
    return make_surface(np.ascontiguousarray(points), np.zeros_like(points))


def revisits(reference: np.ndarray) -> np.ndarray:
    """Pairs of scans of one place that are far apart in time, shape (N, 2)."""
    pairs = cKDTree(reference[:, :2]).query_pairs(0.5, output_type="ndarray")
    turn = np.abs(np.remainder(reference[pairs[:, 0], 2] - reference[pairs[:, 1], 2] + math.pi, 2 * math.pi) - math.pi)
    pairs = pairs[(np.abs(pairs[:, 0] - pairs[:, 1]) >= 100) & (turn < math.radians(30.0))]
    return pairs[np.lexsort(pairs.T)]


def misfit(surfaces: list[Surface], pairs: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Distances of points from the surface that the other scan saw [m]."""
    found = []
    for first, second in pairs[:: -(-len(pairs) // MOST_PAIRS)].tolist():
        seen = Pose2D(*poses[first].tolist()).inverse() @ Pose2D(*poses[second].tolist())
        known, points = surfaces[first], seen.transform_points(surfaces[second].points)
        if len(known.points) < 10:
            continue
        far, nearest = cKDTree(known.points).query(points, distance_upper_bound=REACH_M)
        good = np.isfinite(far)
        good[good] = np.abs(known.normals[nearest[good]]).sum(axis=1) > 0.5
        off = points[good] - known.points[nearest[good]]
        found.append(np.abs((off * known.normals[nearest[good]]).sum(axis=1)))
    return np.concatenate(found) if found else np.full(1, np.nan)


def main() -> None:
    """Compare on the logs that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="*", choices=[name for name in LOGS if name != "intel"], default=["fr079"])
    parser.add_argument("--drift", type=float, default=0.5, help="degrees per metre")
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    print("log          pairs           reference: mean, p90 [mm]    mapper: mean, p90 [mm]")
    for name in options.only:
        path = options.folder / f"{LOGS[name]}-corrected.log.gz"
        log = read_corrected(path, options.seed, 0.02, math.radians(options.drift))
        surfaces = [surface_of(log, index) for index in range(len(log.ranges))]
        mapped = run(log, Robot.load("nova_carter")).path
        after = np.column_stack((np.arange(len(surfaces) - 1), np.arange(1, len(surfaces))))
        for what, pairs in (("neighbours", after), ("same place", revisits(log.reference))):
            theirs, ours = (1e3 * misfit(surfaces, pairs, poses) for poses in (log.reference, mapped))
            print(
                f"{name:12} {what:12} {len(pairs):6}  {theirs.mean():8.1f} {np.percentile(theirs, 90):8.1f}"
                f"              {ours.mean():8.1f} {np.percentile(ours, 90):8.1f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
