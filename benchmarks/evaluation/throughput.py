"""Episodes per second on many cores, and how much of what the cores could do that is.

    python -m benchmarks.evaluation.throughput MAP.yaml --workers 16 [--episodes 2000] [--rounds 1]

The most that cores can do is their number over the CPU time of an episode, taken from the same run. Nothing else may
run. A bare ProcessPoolExecutor does the same episodes.
"""

from __future__ import annotations

import argparse

from benchmarks.evaluation.pools import make_task, run_executor, run_pool
from benchmarks.timing import describe_machine, print_table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", nargs="?", help="of the carter warehouse; without it, jobs only use CPU")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--episodes", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=0.25, help="CPU time of a job without a map")
    parser.add_argument("--workers", type=int, default=16)
    parser.add_argument("--rounds", type=int, default=1)
    options = parser.parse_args()
    task = make_task(options.map, options.backend, options.episodes, options.seconds)
    rows = []
    for _ in range(options.rounds):
        for name, run in {"pool": run_pool, "ProcessPoolExecutor": run_executor}.items():
            cost = run(task, options.episodes, options.workers)
            most = options.workers / (cost.job_cpu_s / cost.jobs)
            rows.append(
                (
                    name,
                    f"{cost.rate:.1f}",
                    f"{cost.rate / most:.3f}",
                    f"{cost.steady_rate:.1f}",
                    f"{cost.steady_rate / most:.3f}",
                    f"{cost.job_cpu_s / cost.jobs:.3f} s",
                )
            )
    print(describe_machine())
    print_table(("", "episodes/s", "of cores / CPU", "after the first", "of cores / CPU", "CPU time per episode"), rows)


if __name__ == "__main__":
    main()
