"""Late scans and commands, with and without prediction over the delay of commands, in BARN's worlds without a map.

Give the folder with `world_N.world` of the BARN data set (Perille et al., 2020):

    python -m benchmarks.sensing.latency path/to/barn --speed 2.0 --delay 0.1 --age 0.05
"""

from __future__ import annotations

import argparse
import tempfile
import time as clock
from pathlib import Path

import trundle
from trundle.control import CollisionMonitor
from trundle.control.latency import Latency
from trundle.evaluation.public.barn import GOAL, START
from trundle.evaluation.public.conditions import benchmark_robot, write_robot
from trundle.mission import Episode, Outcome, Session
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.worlds import World


class UnawareNavigator(Navigator):
    """A navigator that takes its commands to arrive at once."""

    def set_latency(self, latency: Latency) -> None:
        """Do nothing."""


class UnawareMonitor(CollisionMonitor):
    """A collision monitor that takes its commands to arrive at once."""

    def set_latency(self, latency: Latency) -> None:
        """Do nothing."""


def drive(world: World, robot: Robot, seed: int, options: argparse.Namespace, *, aware: bool) -> Episode:
    """One run without a map."""
    navigator = (Navigator if aware else UnawareNavigator)(None, robot, planner="least_cost")
    monitor = (CollisionMonitor if aware else UnawareMonitor)(robot) if options.monitor else False
    latency = Latency(scan_age_s=options.age, command_delay_s=options.delay)
    with trundle.simulate(world, robot, backend=options.backend, lidar=True) as sim:
        session = Session(
            sim,
            navigator,
            START,
            GOAL,
            latency=latency,
            monitor=monitor,
            time_limit_s=options.limit,
            seed=seed,
            measure=None,
        )
        return session.run()


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--worlds", type=int, default=20)
    parser.add_argument("--robot", default="jackal")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--limit", type=float, default=100.0)
    parser.add_argument("--age", type=float, default=0.0, help="age of scans when they arrive [s]")
    parser.add_argument("--delay", type=float, default=0.1, help="time until a command takes effect [s]")
    parser.add_argument("--monitor", action="store_true", help="with a collision monitor")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        settings = benchmark_robot(options.robot, speed=options.speed, noise=options.noise)
        robot = Robot.load(write_robot(place, settings))
    files = sorted(options.folder.glob("world_*.world"), key=lambda path: int(path.stem.split("_")[1]))
    runs: dict[bool, list[Episode]] = {True: [], False: []}
    began = clock.perf_counter()
    for file in files[: options.worlds]:
        world = World.load(file)
        for seed in range(options.seeds):
            for aware, episodes in runs.items():
                episodes.append(drive(world, robot, seed, options, aware=aware))
                name = "predicted" if aware else "not"
                print(f"{file.stem} {seed} {name}: {episodes[-1].message}", flush=True)
    for aware, episodes in runs.items():
        arrived = [episode for episode in episodes if episode.outcome is Outcome.ARRIVED]
        contacts = sum(bool(episode.metrics.contacts) for episode in episodes)
        mean = sum(episode.metrics.time_s for episode in arrived) / max(1, len(arrived))
        print(
            f"{'predicted' if aware else 'not predicted'}: {len(arrived)} of {len(episodes)} arrived, "
            f"{contacts} with a contact, {mean:.1f} s on average"
        )
    print(f"{clock.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
