"""What the pool costs beside the episodes: CPU time of all processes over that of the episodes, start-up included.

    python -m benchmarks.evaluation.pool_overhead MAP.yaml [--episodes 500] [--workers 2] [--rounds 3]

Without a map, jobs only use CPU. A bare ProcessPoolExecutor does the same jobs, in turns with the pool.
"""

from __future__ import annotations

import argparse
import statistics

from benchmarks.evaluation.pools import make_task, run_executor, run_pool
from benchmarks.timing import describe_machine, print_table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", nargs="?", help="of the carter warehouse")
    parser.add_argument("--backend", default="kinematic")
    parser.add_argument("--episodes", type=int, default=500)
    parser.add_argument("--seconds", type=float, default=0.18, help="CPU time of a job without a map")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    task = make_task(options.map, options.backend, options.episodes, options.seconds)
    contestants = {"pool": run_pool, "ProcessPoolExecutor": run_executor}
    costs = {name: [] for name in contestants}
    for _ in range(options.rounds):
        for name, run in contestants.items():
            costs[name].append(run(task, options.episodes, options.workers))
    print(describe_machine())
    print_table(
        ("", "CPU time beyond the episodes'", "its range", "CPU time per episode", "episodes/s"),
        [
            (
                name,
                f"{statistics.median(cost.overhead for cost in each):.1%}",
                f"{min(cost.overhead for cost in each):.1%} to {max(cost.overhead for cost in each):.1%}",
                f"{statistics.median(cost.job_cpu_s / cost.jobs for cost in each):.3f} s",
                f"{statistics.median(cost.rate for cost in each):.1f}",
            )
            for name, each in costs.items()
        ],
    )


if __name__ == "__main__":
    main()
