"""CPU time of a control period among movers: navigator and collision monitor, median and 99th percentile.

    python -m benchmarks.sensing.ticks [--missions 3] [--seconds 40] [--controller mppi]

Nova Carter with its two lidars of 720 beams and 1 cm of noise, in the generated warehouse with 6 forklifts and 8
people.
The tracker alone is measured once more, on the recorded scans.
"""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from benchmarks.timing import describe_machine, print_table

import trundle
from trundle.control import CollisionMonitor
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission.sampling import sample_mission
from trundle.navigation import Navigator
from trundle.navigation.state import FINAL
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.tracking import Tracker
from trundle.worlds import World
from trundle.worlds.movers import Crowd

CROWDS = (("forklift", 6), ("person", 8))
SPEED_MPS = 1.2

Seen = tuple[Sequence[Scan], float, Pose2D]


def noisy(robot: Robot, noise: float) -> Robot:
    """A robot whose lidars have this noise [m]."""
    lidars = {name: lidar.model_copy(update={"noise": noise}) for name, lidar in robot.lidars.items()}
    return robot.model_copy(update={"lidars": lidars})


def drive(seed: int, robot: Robot, controller: str, seconds: float) -> tuple[list[tuple[float, float]], list[Seen]]:
    """Times of the navigator and of the monitor [s] in each control period, and what they were given."""
    crowds = tuple(Crowd(kind, count, kind=kind, speed=SPEED_MPS) for kind, count in CROWDS)
    world = replace(World.generate("warehouse", seed=seed), movers=crowds)
    grid = OccupancyGrid.from_world(world)
    start, goal = sample_mission(Costmap.from_grid(grid, robot), seed)
    navigator, monitor = Navigator(grid, robot, controller=controller), CollisionMonitor(robot)
    times: list[tuple[float, float]] = []
    seen: list[Seen] = []
    with trundle.simulate(world, robot, backend="kinematic", lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        navigator.set_goal(goal)
        while state.time < seconds and navigator.status not in FINAL:
            began = clock.thread_time()
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            decided = clock.thread_time()
            report = monitor.check(command, state.twist, state.scans, state.time, state.odometry)
            times.append((decided - began, clock.thread_time() - decided))
            seen.append((state.scans, state.time, state.odometry))
            state = sim.step(report.command, navigator.dt)
    return times, seen


def track(seen: Sequence[Seen], robot: Robot) -> list[float]:
    """Times of a tracker [s]."""
    tracker, times = Tracker(robot), list[float]()
    for scans, time, odometry in seen:
        began = clock.thread_time()
        tracker.update(scans, time, odometry)
        times.append(clock.thread_time() - began)
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=40.0, help="of each mission")
    parser.add_argument("--controller", default="regulated_pure_pursuit")
    options = parser.parse_args()
    robot = noisy(Robot.load("nova_carter"), 0.01)
    both, tracker = list[tuple[float, float]](), list[float]()
    for seed in range(options.missions):
        times, seen = drive(seed, robot, options.controller, options.seconds)
        both += times
        tracker += track(seen, robot)
    parts = np.array(both)
    rows: list[tuple[str, ...]] = []
    for what, aim, found in (
        ("navigator and monitor", "2, 10", parts.sum(axis=1)),
        ("navigator", "", parts[:, 0]),
        ("monitor", "", parts[:, 1]),
        ("tracker, alone", "", np.array(tracker)),
    ):
        rows.append((what, aim, f"{1e3 * np.median(found):.2f}", f"{1e3 * np.percentile(found, 99):.2f}"))
    print(describe_machine() + "\n")
    print_table(("what", "aim [ms]", "median [ms]", "p99 [ms]"), rows)


if __name__ == "__main__":
    main()
