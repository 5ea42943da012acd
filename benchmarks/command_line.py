"""Start-up and whole-run times of the command line, from process start to exit, and the peak memory.

    python benchmarks/command_line.py MAP.yaml [--start X,Y,YAW] [--goal X,Y …] [--repeat N]

`trundle --help` is to stay under 0.25 s; `trundle run` of at least 50 simulated seconds over two goals, without a
screen and without a video, under 2 s and 250 MB. Run it on a quiet machine.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

PROGRAM = [sys.executable, "-m", "trundle"]


@dataclass(frozen=True)
class Measured:
    """One command: wall and processor time [s], peak memory [MB], and what it printed."""

    wall: float
    cpu: float
    memory: float
    text: str


def measure(arguments: list[str], folder: str) -> Measured:
    began = time.perf_counter()
    with (Path(folder) / "output").open("w+") as output:
        process = subprocess.Popen([*PROGRAM, *arguments], cwd=folder, stdout=output)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - began
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        text = output.read()
    if process.returncode:
        raise SystemExit(f"trundle {' '.join(arguments)} ended with exit code {process.returncode}:\n{text}")
    kilobytes = usage.ru_maxrss / 1024 if sys.platform == "darwin" else usage.ru_maxrss
    return Measured(wall, usage.ru_utime + usage.ru_stime, kilobytes / 1024, text)


def report(name: str, measured: list[Measured], limit_s: float, limit_mb: float) -> None:
    wall = statistics.median(item.wall for item in measured)
    cpu = statistics.median(item.cpu for item in measured)
    memory = max(item.memory for item in measured)
    print(
        f"{name:<20} wall {wall:.3f} s (best {min(item.wall for item in measured):.3f}), processor {cpu:.3f} s; "
        f"limit {limit_s:g} s, ratio {wall / limit_s:.2f}; "
        f"peak {memory:.0f} MB of {limit_mb:g}; medians of {len(measured)}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("map", type=Path, help="the YAML of a ROS map")
    parser.add_argument("--start", help="left out: picked by seed")
    parser.add_argument("--goal", action="append", help="repeat it; left out: picked by seed")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--repeat", type=int, default=7)
    options = parser.parse_args()
    run = ["run", str(options.map.resolve()), "--no-video", "--json", "--quiet", f"--seed={options.seed}"]
    run += [f"--start={options.start}"] if options.start else []
    run += [f"--goal={goal}" for goal in options.goal or []]
    with tempfile.TemporaryDirectory() as folder:
        helps = [measure(["--help"], folder) for _ in range(options.repeat)]
        verbs = [measure(["run", "--help"], folder) for _ in range(options.repeat)]
        runs = [measure(run, folder) for _ in range(options.repeat)]
    report("trundle --help", helps, 0.25, 250)
    report("trundle run --help", verbs, 0.5, 250)
    report("trundle run", runs, 2.0, 250)
    result = json.loads(runs[-1].text)
    print(
        f"{'':<20} {result['outcome']} after {result['time_s']:.1f} simulated s, {result['distance_m']:.1f} m, "
        f"planning {result['planning_ms']:.0f} ms, real-time factor {result['real_time_factor']:.0f}"
    )
    if result["time_s"] < 50.0:
        print("this run is shorter than 50 simulated seconds: choose goals that are farther apart")


if __name__ == "__main__":
    main()
