"""BARN's worlds without a map, by one lidar alone: how many runs arrive, and how many touch something.

Give the folder with `world_N.world` of the BARN data set (Perille et al., 2020):

    python benchmarks/sensing/barn.py path/to/barn --seeds 5 --speed 1.0
"""

from __future__ import annotations

import argparse
import time as clock
from pathlib import Path

import numpy as np

import trundle
from trundle.control import CollisionMonitor
from trundle.geometry import Pose2D
from trundle.navigation import Choice, NavigationStatus, Navigator
from trundle.navigation.status import FINAL
from trundle.robots import Robot
from trundle.worlds import World

START, GOAL = Pose2D(-2.25, 3.0, 1.57), (-2.25, 13.0)


def robot_for(options: argparse.Namespace) -> Robot:
    """The robot with its lidar as in the benchmark: 270°, 720 beams, 10 m."""
    robot = Robot.load(options.robot)
    name, lidar = next(iter(robot.lidars.items()))
    seen = {"fov": 1.5 * np.pi, "beams": 720, "range_max": 10.0, "rate": 20.0, "noise": options.noise}
    limits = robot.limits.model_copy(update={"linear_speed": options.speed})
    return robot.model_copy(update={"lidars": {name: lidar.model_copy(update=seen)}, "limits": limits})


def drive(world: World, robot: Robot, seed: int, options: argparse.Namespace) -> tuple[str, str, float, list[float]]:
    """Drive one run; return its status, what was touched, its length [s] and the tick times [ms]."""
    navigator = Navigator(None, robot, planner=options.planner, controller=Choice.of("regulated_pure_pursuit"))
    monitor = CollisionMonitor(robot) if options.monitor else None
    rng = np.random.default_rng(seed)
    start = Pose2D(START.x + rng.normal(0.0, 0.05), START.y + rng.normal(0.0, 0.05), START.yaw + rng.normal(0.0, 0.05))
    ticks: list[float] = []
    contact = ""
    with trundle.simulate(world, robot, backend=options.backend, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        navigator.set_goal(*GOAL)
        while state.time < options.limit and not contact:
            began = clock.thread_time()
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            if monitor is not None:
                command = monitor.check(command, state.twist, state.scans, state.time, state.odometry).command
            ticks.append(1e3 * (clock.thread_time() - began))
            if navigator.status in FINAL:
                break
            state = sim.step(command, navigator.dt)
            contact = state.contacts[0].other if state.contacts else ""
    if navigator.status is not NavigationStatus.ARRIVED:
        print(f"    at {state.pose}: {navigator.message} | {navigator.error}", flush=True)
    return navigator.status.value, contact, state.time, ticks


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--worlds", type=int, default=20)
    parser.add_argument("--robot", default="jackal")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--planner", default="least_cost")
    parser.add_argument("--speed", type=float, default=1.0)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--limit", type=float, default=100.0)
    parser.add_argument("--monitor", action="store_true")
    options = parser.parse_args()
    robot = robot_for(options)
    files = sorted(options.folder.glob("world_*.world"), key=lambda path: int(path.stem.split("_")[1]))
    arrived = contacts = count = 0
    for file in files[: options.worlds]:
        world = World.load(file)
        for seed in range(options.seeds):
            status, contact, seconds, ticks = drive(world, robot, seed, options)
            count += 1
            arrived += status == "arrived"
            contacts += bool(contact)
            print(
                f"{file.stem} {seed}: {status} {contact} after {seconds:.1f} s, tick {np.median(ticks):.2f} ms, "
                f"p99 {np.percentile(ticks, 99):.1f} ms",
                flush=True,
            )
    print(f"{arrived} of {count} arrived, {contacts} with a contact")


if __name__ == "__main__":
    main()
