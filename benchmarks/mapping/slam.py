"""Mapping public logs: how far the mapped path is from the reference, and what it takes.

python -m benchmarks.mapping.slam FOLDER [--only intel aces] [--drift 0.5 2] [--seeds 0] [--picture DIR]

FOLDER has the CARMEN logs `*-corrected.log.gz`, read as `trundle map from-bag` reads them, and `intel.rawlog` with
`intel_ODO.txt`. References are poses that a particle-filter SLAM corrected: not the truth.
"""

from __future__ import annotations

import argparse
import math
import resource
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benchmarks.mapping.logs import Log, read_corrected, read_intel

from trundle import Mapper, Observation, Pose2D, Robot, Scan, Twist2D, draw_map

LOGS = {"intel": "intel", "fr079": "freiburg-079", "aces": "aces", "csail": "csail", "belgioioso": "belgioioso"}
_PERIOD_S = 2.0  # of the made-up clock: those of several logs are broken


@dataclass(frozen=True)
class Result:
    """What a run gave: root mean square errors of paths [m], CPU time a scan [ms], the path (N, 3), and the mapper."""

    odometry: float
    ate: float
    online: float
    ms: float
    path: np.ndarray
    mapper: Mapper


def align(path: np.ndarray, reference: np.ndarray) -> Pose2D:
    """Return the rigid motion that brings positions as close to the reference as it can."""
    (x, y), (u, v) = path[:, :2].mean(axis=0), reference[:, :2].mean(axis=0)
    a, b = path[:, :2] - (x, y), reference[:, :2] - (u, v)
    yaw = math.atan2(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()), float((a * b).sum()))
    return Pose2D(u, v, yaw) @ Pose2D(-x, -y)


def aligned_error(path: np.ndarray, reference: np.ndarray) -> float:
    """Root mean square distance of positions after the best rigid alignment [m]."""
    moved = align(path, reference).transform_points(path[:, :2])
    return float(np.sqrt(np.square(moved - reference[:, :2]).sum(axis=1).mean()))


def run(log: Log, robot: Robot) -> Result:
    """Map a log."""
    mapper = Mapper(robot)
    anchors, online = [], []
    ranges = [np.where(one >= log.range_max, np.inf, one) for one in log.ranges]
    began = time.process_time()
    for i, one in enumerate(ranges):
        at = i * _PERIOD_S
        scan = Scan("laser", at, Pose2D(0.0, 0.0), 0.3, log.angles, one, 0.05, log.range_max)
        estimate = mapper.update(Observation(at, Twist2D(0.0, 0.0), Pose2D(*log.odometry[i].tolist()), (scan,)))
        anchors.append(mapper.anchor)
        online.append(estimate.pose.as_tuple())
    mapper.finish()
    took = time.process_time() - began
    graph = mapper.graph()
    path = np.array([(Pose2D(*graph.poses[node]) @ seen).as_tuple() for node, seen in anchors])
    known = np.isfinite(log.reference[:, 0])
    errors = [aligned_error(one[known], log.reference[known]) for one in (log.odometry, path, np.array(online))]
    return Result(errors[0], errors[1], errors[2], took * 1e3 / len(ranges), path, mapper)


def main() -> None:
    """Run the logs that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="*", choices=list(LOGS), default=list(LOGS))
    parser.add_argument("--drift", nargs="*", type=float, default=[0.5, 2.0], help="degrees per metre")
    parser.add_argument("--seeds", nargs="*", type=int, default=[0])
    parser.add_argument("--picture", type=Path, help="folder for the maps")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    robot = Robot.load("nova_carter")
    print("log          drift  seed  odometry    ATE  online  ms/scan  nodes  loops  peak MB")
    for name in options.only:
        for drift in options.drift if name != "intel" else [math.nan]:
            for seed in options.seeds if name != "intel" else [0]:
                if name == "intel":
                    log = read_intel(options.folder)
                else:
                    path = options.folder / f"{LOGS[name]}-corrected.log.gz"
                    log = read_corrected(path, seed, 0.02, math.radians(drift))
                result = run(log, robot)
                graph = result.mapper.graph()
                peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
                print(
                    f"{name:12} {drift:5.1f} {seed:5} {result.odometry:9.2f} {result.ate:6.3f} {result.online:7.3f} "
                    f"{result.ms:8.2f} {len(graph.times):6} {int((graph.edges[:, 2] == 1).sum()):6} {peak:8.0f}",
                    flush=True,
                )
                if options.picture:
                    options.picture.mkdir(parents=True, exist_ok=True)
                    grid = draw_map(graph)
                    (options.picture / f"{name}-{drift:g}-{seed}.png").write_bytes(grid._repr_png_())


if __name__ == "__main__":
    main()
