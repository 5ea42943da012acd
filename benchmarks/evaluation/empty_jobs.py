"""CPU time of the driving process for each of a million jobs that do nothing.

python -m benchmarks.evaluation.empty_jobs [--jobs 1000000] [--workers 2]
"""

from __future__ import annotations

import argparse
import resource
import time

from benchmarks.evaluation.pools import Burn
from benchmarks.timing import describe_machine

from trundle.evaluation.pool import Pool


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=1_000_000)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    wall, cpu = time.perf_counter(), time.process_time()
    with Pool(Burn(0.0), workers=options.workers, deadline_s=60.0, memory_mb=1000.0) as pool:
        done = sum(1 for _ in pool.run(range(options.jobs)))
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    print(describe_machine())
    print(f"{done:,} jobs: {1e3 * cpu / done:.3f} ms of the driver's CPU time and {1e3 * wall / done:.3f} ms each")
    print(f"the driver took {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB at most")


if __name__ == "__main__":
    main()
