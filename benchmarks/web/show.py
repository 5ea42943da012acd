"""What `trundle.show` costs a loop: CPU time of the process at 20 Hz, with a page, with none and without a view.

python benchmarks/web/show.py [--seconds 20] [--rounds 3]

The loop replays a drive through the warehouse, so that it costs next to nothing itself: poses, the lidars' scans,
the paths, and the navigator's costmaps as they were. The page is a client in another process.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from contextlib import ExitStack
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from pages import open_pages

import trundle
from trundle.mission import Step

DT = 0.05


class Steps:
    """An observer that keeps the steps of a run."""

    def __init__(self) -> None:
        self.kept: list[Step] = []

    def on_start(self, run: object) -> None:
        pass

    def on_step(self, step: Step) -> None:
        self.kept.append(step)

    def on_end(self, episode: object) -> None:
        pass


def record(seconds: float) -> tuple[trundle.World | None, trundle.Robot, list[Step]]:
    steps = Steps()
    scenario = trundle.Scenario.make(
        world="warehouse", seed=4, lidar=True, start=(-13.0, 0.0, 0.0), goal=(13.0, 0.0, 1.57), time_limit_s=seconds
    )
    with scenario.build() as mission:
        mission.run(observers=[steps])
        return mission.sim.world, mission.navigator.robot, steps.kept


def replay(steps: list[Step], view: trundle.serve.View | None) -> float:
    """Show the steps at 20 Hz; return the share of a core."""
    began, busy = time.perf_counter(), time.process_time()
    for i, step in enumerate(steps):
        if view is not None:
            _ = view.keys, view.take_goal()
            view.update(step.state.pose, path=step.path, scan=step.scans, costmap=step.costmap, text=str(step.status))
        time.sleep(max(0.0, began + DT * (i + 1) - time.perf_counter()))
    return (time.process_time() - busy) / (time.perf_counter() - began)


def main(seconds: float, rounds: int) -> None:
    world, robot, steps = record(seconds)
    shares: dict[str, list[float]] = {"no view": [], "no page": [], "1 page": []}
    for _ in range(rounds):
        for name, found in shares.items():
            with ExitStack() as opened:
                view = None
                if name != "no view":
                    view = opened.enter_context(trundle.show(world, robot, open_browser=False))
                close = None
                if view is not None and name == "1 page":
                    close = opened.enter_context(open_pages(view.address, 1))
                    view.update(steps[0].state.pose)
                    time.sleep(1.0)  # the scene has been sent
                found.append(replay(steps, view))
                size, frames = (0, 0) if close is None else close()
                note = f", {frames / (DT * len(steps)):.1f} frames/s, {size / (DT * len(steps)) / 1e3:.0f} kB/s"
                print(f"{name}: {found[-1]:.2%} of a core{note if close else ''}", flush=True)
    base = statistics.median(shares["no view"])
    for name in ("no page", "1 page"):
        print(f"{name}: {statistics.median(shares[name]) - base:+.2%} of a core more than the loop alone")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    main(given.seconds, given.rounds)
