"""From the start of the process to the report: `trundle evaluate MAP` of 20 kinematic episodes.

python -m benchmarks.evaluation.start MAP [--rounds 5]
"""

import argparse
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.timing import describe_machine


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    walls: list[float] = []
    cpus: list[float] = []
    with tempfile.TemporaryDirectory() as folder:
        for turn in range(options.rounds + 1):  # the first compiles Python and fills the disk's cache
            out = Path(folder) / str(turn)
            command = [sys.executable, "-m", "trundle", "evaluate", options.map, "--backends", "kinematic"]
            began, before = time.perf_counter(), _cpu_s()
            done = subprocess.run([*command, "--seeds", "0:20", "-o", out, "--quiet"], capture_output=True, check=False)
            walls.append(time.perf_counter() - began)
            cpus.append(_cpu_s() - before)
            if not (out / "report.html").exists():
                raise SystemExit(f"no report was written:\n{done.stderr.decode()}")
    print(describe_machine())
    texts = [
        f"{statistics.median(each[1:]):.2f} s ({min(each[1:]):.2f} to {max(each[1:]):.2f})" for each in (walls, cpus)
    ]
    print(f"20 episodes, median of {options.rounds}: {texts[0]} from start to report, {texts[1]} of CPU time")


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main()
