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
from pathlib import Path

PROGRAM = [sys.executable, "-m", "trundle"]


def measure(arguments: list[str], folder: str) -> tuple[float, float, str]:
    """Wall time [s] and peak memory [MB] of one command, and what it printed."""
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
    return wall, kilobytes / 1024, text


def report(name: str, measured: list[tuple[float, float, str]], limit_s: float, limit_mb: float) -> None:
    wall = statistics.median(item[0] for item in measured)
    memory = max(item[1] for item in measured)
    print(
        f"{name:<28} median {wall:.3f} s (limit {limit_s:g}, ratio {wall / limit_s:.2f}), "
        f"best {min(item[0] for item in measured):.3f} s, "
        f"peak {memory:.0f} MB (limit {limit_mb:g}, ratio {memory / limit_mb:.2f}), {len(measured)} times"
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
    result = json.loads(runs[-1][2])
    print(
        f"{'':<28} {result['outcome']} after {result['time_s']:.1f} simulated s, {result['distance_m']:.1f} m, "
        f"planning {result['planning_ms']:.0f} ms, real-time factor {result['real_time_factor']:.0f}"
    )
    if result["time_s"] < 50.0:
        print("this run is shorter than 50 simulated seconds: choose goals that are farther apart")


if __name__ == "__main__":
    main()
