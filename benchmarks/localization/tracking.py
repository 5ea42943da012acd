"""How well a localizer tracks: recorded drives with odometry errors, slips and changed maps.

python -m benchmarks.localization.tracking --runs 8
python -m benchmarks.localization.tracking --worlds warehouse map.yaml --conditions D --localizer amcl

Errors are of the position, from two seconds after the start on; "bad" is the share of time with more than 0.5 m,
"cover" the share of true positions inside the 95 % ellipse. CPU time is that of whole calls of `update` with a scan.
"""

from __future__ import annotations

import argparse
import math
import time
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from benchmarks.localization.conditions import CONDITIONS, Condition, change_map, observe, start_of
from benchmarks.localization.drives import WORLDS, Drive, record_drive
from benchmarks.timing import print_table

from trundle.geometry import wrap_angle
from trundle.localization import create_localizer

BAD_M = 0.5
SETTLED_S = 2.0
INSIDE_95 = 5.991  # the 95 % quantile of chi² with two degrees of freedom


@dataclass
class Tally:
    """What was counted over runs."""

    errors: list[float] = field(default_factory=list)
    yaws: list[float] = field(default_factory=list)
    covered: list[bool] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    bad_late: list[bool] = field(default_factory=list)
    said_good: list[bool] = field(default_factory=list)
    bad_runs: int = 0
    runs: int = 0

    def row(self, name: str) -> tuple[str, ...]:
        """A row of the table."""
        errors, cpu = np.array(self.errors), np.array(self.cpu) * 1e3
        late = f"{100 * np.mean(self.bad_late):.0f} %" if self.bad_late else "–"
        return (
            name,
            str(self.runs),
            f"{1e3 * np.median(errors):.1f}",
            f"{1e3 * np.percentile(errors, 95):.0f}",
            f"{math.degrees(np.percentile(self.yaws, 95)):.2f}",
            f"{100 * np.mean(errors > BAD_M):.2f} %",
            str(self.bad_runs),
            f"{np.mean(self.covered):.2f}",
            f"{np.median(cpu):.2f}",
            f"{np.percentile(cpu, 99):.2f}",
            late,
            f"{100 * np.mean(self.said_good):.2f} %",
        )


HEADER = (
    *("condition", "runs", "median [mm]", "p95 [mm]", "yaw p95 [°]", "bad", "runs with bad", "cover"),
    *("CPU median [ms]", "p99", "said when bad", "said when good"),
)


def run(drive: Drive, condition: Condition, seed: int, name: str, tally: Tally) -> float:
    """Track one drive; return its p95 [m]."""
    rng = np.random.default_rng([seed, ord(condition.name[0])])
    grid = change_map(drive.grid, drive.moments, rng) if condition.changed else drive.grid
    localizer = create_localizer(name, grid, drive.robot)
    localizer.reset(start_of(drive, condition, rng), seed=seed)
    errors: list[float] = []
    bad_since: float | None = None
    for moment, observation in observe(drive, condition, rng):
        began = time.process_time()
        estimate = localizer.update(observation)
        spent = time.process_time() - began
        error = estimate.pose.distance_to(moment.pose)
        bad_since = None if error <= BAD_M else moment.time if bad_since is None else bad_since
        if observation.scans:
            tally.cpu.append(spent)
        if moment.time < SETTLED_S:
            continue
        errors.append(error)
        tally.yaws.append(abs(wrap_angle(estimate.pose.yaw - moment.pose.yaw)))
        said = estimate.state != "localized"
        if bad_since is None:
            tally.said_good.append(said)
        elif moment.time - bad_since > 2.0:
            tally.bad_late.append(said)
        if estimate.covariance is not None:
            off = np.array((estimate.pose.x - moment.pose.x, estimate.pose.y - moment.pose.y))
            tally.covered.append(bool(off @ np.linalg.solve(estimate.covariance[:2, :2], off) <= INSIDE_95))
    tally.errors += errors
    tally.runs += 1
    tally.bad_runs += bool(np.mean(np.array(errors) > BAD_M) > 0.0)
    return float(np.percentile(errors, 95))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="*", default=list(WORLDS), help="generators, or map files")
    parser.add_argument("--conditions", nargs="*", default=list(CONDITIONS), choices=list(CONDITIONS))
    parser.add_argument("--runs", type=int, default=6, help="drives of each condition")
    parser.add_argument("--seconds", type=float, default=120.0, help="length of a drive")
    parser.add_argument("--localizer", default="amcl")
    parser.add_argument("--cache", type=Path, default=None, help="folder that keeps recorded drives")
    parser.add_argument("--each", action="store_true", help="print each run")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    for name in options.conditions:
        tally = Tally()
        for index in range(options.runs):
            world = options.worlds[index % len(options.worlds)]
            seed = 1 + index // len(options.worlds)
            drive = record_drive(world, seed, seconds=options.seconds, cache=options.cache)
            p95 = run(drive, CONDITIONS[name], index, options.localizer, tally)
            if options.each:
                print(f"{name} {drive.name}: p95 {1e3 * p95:.0f} mm", flush=True)
        rows.append(tally.row(name))
    print_table(HEADER, rows)


if __name__ == "__main__":
    main()
