"""Intel's log by `Mapper` and by Karto's scan matcher (PyPI's karto-scanmatcher) on the same scans, interleaved.

python -m benchmarks.mapping.peer FOLDER [--rounds 3]

Karto's is a front end alone: a window of the last scans, as slam_toolbox has it, and no loops. So the mapper's path is
given before its loops are closed (`online`) and after (`mapped`). FOLDER is that of slam.py.
"""

from __future__ import annotations

import argparse
import math
import statistics
import time
import warnings
from collections import deque
from pathlib import Path

import karto_scanmatcher as karto
import numpy as np
from benchmarks.mapping.logs import Log, read_intel
from benchmarks.mapping.slam import aligned_error, run

from trundle import Pose2D, Robot

_WINDOW = 70  # scans; of several windows and gates that were tried the best
_LEAST_M, _LEAST_RAD = 0.2, math.radians(10.0)


def run_karto(log: Log) -> tuple[float, float]:
    """Return the error of the path [m] and the CPU time of a scan [ms]; each scan that moved is matched and kept."""
    angles = log.angles
    laser = karto.LaserScanConfig(
        float(angles[0]), float(angles[-1]), float(angles[1] - angles[0]), 0.05, log.range_max, 12.0, "laser"
    )
    matcher = karto.Wrapper(karto.ScanMatcherConfig())
    kept: deque[karto.LocalizedRangeScan] = deque(maxlen=_WINDOW)
    poses: list[tuple[float, float, float]] = []
    last: tuple[Pose2D, Pose2D] | None = None
    began = time.process_time()
    for i, ranges in enumerate(log.ranges):
        odometry = Pose2D(*log.odometry[i].tolist())
        pose = odometry if last is None else last[1] @ (last[0].inverse() @ odometry)
        moved = None if last is None else last[0].inverse() @ odometry
        if moved is None or math.hypot(moved.x, moved.y) >= _LEAST_M or abs(moved.yaw) >= _LEAST_RAD:
            at = karto.Pose2(*pose.as_tuple())
            scan = karto.LocalizedRangeScan(laser, ranges.tolist(), karto.Pose2(*odometry.as_tuple()), at, i, float(i))
            if kept:
                found = matcher.match_scan(scan, list(kept), True, True).best_pose
                pose = Pose2D(found.x, found.y, found.yaw)
                scan.corrected_pose = found
            kept.append(scan)
            last = odometry, pose
        poses.append(pose.as_tuple())
    took = time.process_time() - began
    known = np.isfinite(log.reference[:, 0])
    error = aligned_error(np.array(poses)[known], log.reference[known])
    return error, took * 1e3 / len(log.ranges)


def main() -> None:
    """Run both in turns, and print the medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    log, robot = read_intel(options.folder), Robot.load("nova_carter")
    ours, theirs = [], []
    for _ in range(options.rounds):
        ours.append(run(log, robot))
        theirs.append(run_karto(log))
    mine, other = statistics.median(one.ms for one in ours), statistics.median(ms for _, ms in theirs)
    print(f"{len(log.ranges)} scans, medians of {options.rounds} rounds, CPU time")
    print("                     error [m]   ms a scan")
    print(f"Mapper, online       {ours[0].online:9.3f}")
    print(f"Mapper, mapped       {ours[0].ate:9.3f} {mine:11.2f}")
    print(f"karto-scanmatcher    {theirs[0][0]:9.3f} {other:11.2f}   ({other / mine:.1f} times as long)")


if __name__ == "__main__":
    main()
