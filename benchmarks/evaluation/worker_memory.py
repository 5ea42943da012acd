"""Private memory of a worker that has driven some episodes in one place.

python -m benchmarks.evaluation.worker_memory MAP.yaml [--backend mujoco] [--workers 2] [--episodes 20]
"""

from __future__ import annotations

import argparse
import os

from benchmarks.evaluation.pools import descendants, make_task, preload_of, private_mb
from benchmarks.timing import print_table

from trundle.evaluation.pool import Done, Pool


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--episodes", type=int, default=20)
    options = parser.parse_args()
    task = make_task(options.map, options.backend, options.episodes, 0.0)
    with Pool(task, workers=options.workers, deadline_s=600.0, memory_mb=None, preload=preload_of(task)) as pool:
        done = sum(isinstance(outcome, Done) for outcome in pool.run(range(options.episodes)))
        server, *workers = descendants(os.getpid())
        rows = [("driver", f"{private_mb(os.getpid()):.0f} MB"), ("server", f"{private_mb(server):.0f} MB")]
        rows += [(f"worker {number}", f"{private_mb(pid):.0f} MB") for number, pid in enumerate(workers, 1)]
    print(f"{done} of {options.episodes} episodes done")
    print_table(("", "private memory"), rows)


if __name__ == "__main__":
    main()
