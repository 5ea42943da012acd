"""`amcl` beside the package of that name on PyPI (0.1.2, an adaptation of Nav2's), on the same recorded drives.

python -m benchmarks.localization.peer --runs 5 --seconds 60

The other package (GPL-3) is a tool for this comparison alone: `pip install amcl==0.1.2` in an environment of your own.
It takes one lidar, so both get the scans of the front one. It is updated after 0.25 m or 0.2 rad, as Nav2 does by
default; in between its pose goes on by the odometry. 500 to 2,000 particles, 120 beams, the likelihood field and the
noise of Nav2's defaults. CPU time is that of an update with a scan.
"""

from __future__ import annotations

import argparse
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from benchmarks.localization.conditions import CONDITIONS, observe, start_of
from benchmarks.localization.drives import WORLDS, Drive, record_drive
from benchmarks.timing import describe_machine, print_table

from trundle.geometry import Pose2D, wrap_angle
from trundle.localization import create_localizer
from trundle.observation import Observation

GATE_M, GATE_RAD = 0.25, 0.2
SETTLED_S, BAD_M = 2.0, 0.5
MISSING = (
    "the package amcl is not installed (pip install amcl==0.1.2 in an environment of your own): nothing is compared"
)


class Follows(Protocol):
    """What is compared: where it puts the robot, and the CPU time of an update [s], None without one."""

    def follow(self, observation: Observation) -> tuple[Pose2D, float | None]:
        """Take an observation."""
        ...


class Trundle:
    """This package's `amcl`, at every scan, or with the other one's gates."""

    def __init__(self, drive: Drive, start: Pose2D, *, gates: bool) -> None:
        options = {"update_min_d": GATE_M, "update_min_a": GATE_RAD} if gates else {}
        self._localizer = create_localizer("amcl", drive.grid, drive.robot, **options)
        self._localizer.reset(start, seed=0)

    def follow(self, observation: Observation) -> tuple[Pose2D, float | None]:
        """Take an observation."""
        began = time.process_time()
        pose = self._localizer.update(observation).pose
        spent = time.process_time() - began
        return pose, spent if observation.scans else None


class Peer:
    """The other package's."""

    def __init__(self, package: Any, drive: Drive, start: Pose2D) -> None:
        self._package = package
        motion = package.MotionParameters(0.2, 0.2, 0.2, 0.2, 0.2)
        laser = package.LaserParameters(0.5, 0.05, 0.05, 0.5, 0.2, 0.1, 0.0, 120)
        self._filter = package.AMCL(500, 2000, 0.0, 0.0, motion, laser, "differential")
        grid = drive.grid
        cells = np.where(grid.data >= 65, 100, np.where(grid.data < 0, -1, 0))
        self._filter.set_map(
            package.create_occupancy_grid_from_list(cells.tolist(), grid.resolution, grid.origin.x, grid.origin.y)
        )
        covariance = package.Matrix3D()
        for axis, variance in enumerate((0.25, 0.25, 0.0685)):
            covariance.set(axis, axis, variance)
        self._filter.set_initial_pose(package.Vector3D(*start.as_tuple()), covariance)
        self._T_map_odom: Pose2D | None = None
        self._start, self._last, self._is_placed = start, Pose2D(0.0, 0.0), False

    def follow(self, observation: Observation) -> tuple[Pose2D, float | None]:
        """Take an observation."""
        odometry = observation.odometry
        if self._T_map_odom is None:
            self._T_map_odom, self._last = self._start @ odometry.inverse(), odometry
        moved = self._last.distance_to(odometry) >= GATE_M
        moved = moved or abs(wrap_angle(odometry.yaw - self._last.yaw)) >= GATE_RAD or not self._is_placed
        spent = None
        if moved and observation.scans:
            [scan] = observation.scans
            if not self._is_placed:
                self._filter.set_laser_pose(self._package.Vector3D(*scan.mount.as_tuple()))
                self._is_placed = True
            # What met nothing is at the longest range, as in Nav2.
            ranges = np.where(np.isfinite(scan.ranges), scan.ranges, scan.range_max)
            began = time.process_time()
            pairs = np.column_stack([ranges, scan.angles]).tolist()
            seen = self._package.create_laser_scan_from_list(pairs, scan.range_max)
            self._filter.update(seen, self._package.Vector3D(*odometry.as_tuple()))
            spent = time.process_time() - began
            mean = self._filter.get_pose_mean()
            self._T_map_odom, self._last = Pose2D(mean.x, mean.y, mean.theta) @ odometry.inverse(), odometry
        return self._T_map_odom @ odometry, spent


def one_lidar(observation: Observation) -> Observation:
    """Return an observation with the front lidar's scan alone."""
    return replace(observation, scans=tuple(scan for scan in observation.scans if scan.lidar == "front"))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="*", default=list(WORLDS[:5]), help="generators, or map files")
    parser.add_argument("--conditions", nargs="*", default=["A", "B"], choices=["A", "B"])
    parser.add_argument("--runs", type=int, default=5, help="drives of each condition")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of a drive")
    parser.add_argument("--cache", type=Path, default=None, help="folder that keeps recorded drives")
    options = parser.parse_args()
    try:
        import amcl
    except ImportError:
        print(MISSING, file=sys.stderr)
        return 0
    warnings.simplefilter("ignore")
    rows = []
    for condition in (CONDITIONS[name] for name in options.conditions):
        errors: dict[str, list[float]] = {}
        times: dict[str, list[float]] = {}
        for index in range(options.runs):
            world = options.worlds[index % len(options.worlds)]
            drive = record_drive(world, 1 + index // len(options.worlds), seconds=options.seconds, cache=options.cache)
            rng = np.random.default_rng([index, ord(condition.name)])
            start = start_of(drive, condition, rng)
            compared: dict[str, Follows] = {
                "trundle, every scan": Trundle(drive, start, gates=False),
                "trundle, 0.25 m or 0.2 rad": Trundle(drive, start, gates=True),
                "PyPI's amcl 0.1.2, 0.25 m or 0.2 rad": Peer(amcl, drive, start),
            }
            for moment, observation in observe(drive, condition, rng):
                for name, one in compared.items():
                    pose, spent = one.follow(one_lidar(observation))
                    if moment.time >= SETTLED_S:
                        errors.setdefault(name, []).append(pose.distance_to(moment.pose))
                    if spent is not None:
                        times.setdefault(name, []).append(1e3 * spent)
        for name, values in errors.items():
            error = np.array(values)
            rows.append(
                (
                    *(condition.name, name, f"{1e3 * np.median(error):.0f}", f"{1e3 * np.percentile(error, 95):.0f}"),
                    *(f"{100 * np.mean(error > BAD_M):.1f} %", str(len(times[name]))),
                    *(f"{np.median(times[name]):.2f}", f"{np.percentile(times[name], 99):.2f}"),
                    f"{sum(times[name]) / (1e3 * options.runs * options.seconds) * 1e3:.2f}",
                )
            )
    print(describe_machine() + "\n")
    heads = ("condition", "localizer", "median [mm]", "p95 [mm]", "bad", "calls", "CPU median [ms]", "p99 [ms]")
    print_table((*heads, "CPU per second [ms]"), rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
