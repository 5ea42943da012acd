"""Cost and size of a recording with two lidars of 720 beams, and what is left of one that is killed.

python benchmarks/recording/measure.py cost
python benchmarks/recording/measure.py kill --times 100
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import statistics
import struct
import tempfile
import time
from pathlib import Path

from trundle.bags import Recorder, recover
from trundle.mission import Episode, RunInfo, Scenario, Step

LOST_S = 1.2
PACE = 20.0
"""How much faster than real time the run goes on that is killed."""


class Keep:
    """An observer that keeps what it gets."""

    def __init__(self) -> None:
        self.steps: list[Step] = []

    def on_start(self, run: RunInfo) -> None:
        self.info = run

    def on_step(self, step: Step) -> None:
        self.steps.append(step)

    def on_end(self, episode: Episode) -> None:
        self.episode = episode


def record_steps() -> Keep:
    """The steps of a run with two lidars of 720 beams."""
    keep = Keep()
    with Scenario.make(world="warehouse", seed=4, lidar=True).build() as mission:
        mission.run(observers=[keep])
    return keep


def measure_cost(folder: Path, times: int) -> None:
    """Record the same steps several times; the run is not measured."""
    keep = record_steps()
    beams = [len(scan.ranges) for scan in keep.steps[-1].scans]
    figures = []
    for number in range(times):
        path = folder / f"{number}.mcap"
        recorder = Recorder(path)
        began = time.process_time()
        recorder.on_start(keep.info)
        for step in keep.steps:
            recorder.on_step(step)
        recorder.on_end(keep.episode)
        figures.append((time.process_time() - began) / len(keep.steps) * 1e3)
    seconds, size = keep.steps[-1].state.time, path.stat().st_size
    print(f"lidars with {beams} beams, {len(keep.steps)} steps, {seconds:.1f} s")
    print(f"CPU a step, start and end included: {statistics.median(figures):.2f} ms ({min(figures):.2f} least)")
    print(f"file: {size / 1e6:.2f} MB, {size / 1e6 / seconds * 60.0:.2f} MB a minute")


def measure_kills(folder: Path, times: int) -> None:
    """Kill a process that records the steps of a run at random moments, and recover its file."""
    keep = record_steps()
    lost = []
    for number in range(times):
        path = folder / "run.mcap"
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            write_steps(keep, path, writer)
            os._exit(0)
        os.close(writer)
        first = os.read(reader, 8)
        time.sleep(random.Random(number).uniform(0.0, keep.steps[-1].state.time / PACE))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        with os.fdopen(reader, "rb") as times_of_steps:
            (last,) = struct.unpack("d", (first + times_of_steps.read())[-8:])
        done = recover(path.with_suffix(".partial.mcap"), path, overwrite=True)
        lost.append(last - done.end_s)
        path.unlink()
        done.path.with_suffix(".partial.mcap").unlink()
    within = sum(one <= LOST_S for one in lost)
    print(f"killed {times} times; all but the last {LOST_S} s recovered {within} times")
    print(f"lost: median {statistics.median(lost):.2f} s, most {max(lost):.2f} s")


def write_steps(keep: Keep, path: Path, pipe: int) -> None:
    """Record steps, faster than they happened, and send the time of each one that was recorded."""
    recorder = Recorder(path)
    recorder.on_start(keep.info)
    for step in keep.steps:
        recorder.on_step(step)
        os.write(pipe, struct.pack("d", step.state.time))
        time.sleep(keep.info.dt / PACE)
    time.sleep(60.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["cost", "kill"])
    parser.add_argument("--times", type=int, default=5)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        (measure_cost if given.what == "cost" else measure_kills)(Path(folder), given.times)


if __name__ == "__main__":
    main()
