"""Ten thousand missions on a map by the backend `batch`, and some by `kinematic`: from sampling to rows and a report.

    python -m benchmarks.batch.missions MAP.yaml [--missions 10000] [--workers 1] [--kinematic 300] [--sensing layers]
                                                 [--controller mppi]

Wall time is that of `trundle evaluate` as a whole, with its report; CPU time is of all its processes. Rows of missions
that both backends drive are compared.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from pathlib import Path

from benchmarks.timing import describe_machine, print_table

from trundle.evaluation import Evaluation
from trundle.evaluation.engine import run_suite
from trundle.evaluation.report.summary import count_handed_over
from trundle.evaluation.suite import Suite

SENSING = {
    "none": {},
    "scans": {"lidar": True, "layers": {"obstacle": None}, "collision_monitor": False},
    "layers": {"lidar": True, "collision_monitor": False},
    "monitor": {"lidar": True, "layers": {"obstacle": None}, "collision_monitor": True},
    "all": {"lidar": True},
}
"""What the robot senses by its lidars, and what its software makes of that."""

_OWN = ("id", "index", "backend", "handed_over")


def cpu_s() -> float:
    """CPU time of this process and of those that it has waited for [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def measure(
    grid: str, backend: str, missions: int, workers: int, folder: Path, sensing: str, controller: str
) -> tuple[Evaluation, float, float]:
    """Evaluate missions; return the evaluation, its wall time [s] and its CPU time [s]."""
    suite = Suite.make(
        worlds=[grid], missions=f"0:{missions}", backends=[backend], controllers=[controller], **SENSING[sensing]
    )
    wall, cpu = time.perf_counter(), cpu_s()
    run_suite(suite, folder / backend, workers=workers)
    evaluation = Evaluation(folder / backend, suite=suite)
    evaluation.write_report()
    return evaluation, time.perf_counter() - wall, cpu_s() - cpu


def count_different(ours: Evaluation, theirs: Evaluation) -> tuple[int, int]:
    """Return how many missions both have, and how many of those have another row."""
    rows = {row.mission: row for row in theirs.rows()}
    pairs = [(row, rows[row.mission]) for row in ours.rows() if row.mission in rows]
    values = [(one.unmeasured(), other.unmeasured()) for one, other in pairs]
    return len(pairs), sum(any(one[name] != other[name] for name in one if name not in _OWN) for one, other in values)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", help="a ROS map's YAML, e.g. of the carter warehouse")
    parser.add_argument("--missions", type=int, default=10_000)
    parser.add_argument("--kinematic", type=int, default=300, help="missions of the backend kinematic")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--sensing", choices=SENSING, default="none", help="what the robot makes of its lidars")
    parser.add_argument("--controller", default="regulated_pure_pursuit")
    options = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        ends = []
        for backend, missions in (("batch", options.missions), ("kinematic", options.kinematic)):
            evaluation, wall, cpu = measure(
                *(options.map, backend, missions, options.workers, Path(folder), options.sensing, options.controller)
            )
            ends.append(evaluation)
            per_10_000 = f"{cpu / missions * 1e4:.0f} s"
            lines.append((backend, f"{missions:,}", f"{wall:.1f} s", f"{cpu:.1f} s", per_10_000))
        print(describe_machine())
        print(f"{options.workers} workers")
        print_table(("backend", "missions", "wall time", "CPU time", "CPU time of 10,000"), lines)
        print("outcomes:", dict(ends[0].outcomes), "handed over:", count_handed_over(ends[0].table))
        print("{} missions driven by both, {} with another row".format(*count_different(*ends)))
        for evaluation in ends:
            evaluation.close()


if __name__ == "__main__":
    main()
