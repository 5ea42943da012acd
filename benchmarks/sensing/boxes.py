"""Missions among boxes that are not on the map: how many arrive, and how many touch something.

    python benchmarks/sensing/boxes.py --missions 40 --backend kinematic --monitor

A mission counts where `least_cost` finds a path on the costmap of the world with its boxes.
"""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Iterator, Sequence

import numpy as np

import trundle
from trundle.control import CollisionMonitor
from trundle.costmap import Costmap
from trundle.errors import TrundleError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission.obstacles import Unmapped
from trundle.mission.sampling import sample_mission
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.state import FINAL
from trundle.planning import create_planner
from trundle.robots import Robot
from trundle.worlds import World


def missions(worlds: Sequence[str], count: int, first: int) -> Iterator[tuple[str, int]]:
    """Worlds and seeds in turn."""
    for number in range(first, first + count):
        yield worlds[number % len(worlds)], number


def drive(kind: str, seed: int, robot: Robot, options: argparse.Namespace) -> dict[str, object] | str:
    """Drive one mission; or say why it does not count."""
    world = World.generate(kind, seed=seed)
    grid = OccupancyGrid.from_world(world)
    costmap = Costmap.from_grid(grid, robot)
    start, goal = sample_mission(costmap, seed)
    try:
        filled = Unmapped(boxes=tuple(options.boxes), height=(1.0, 1.0)).add_to(
            world, costmap, [start.as_tuple(), goal.as_tuple()], seed
        )
        truth = Costmap.from_grid(OccupancyGrid.from_world(filled), robot)
        create_planner("least_cost").plan(truth, start, goal)
    except TrundleError as error:
        return str(error)
    lidars = {name: lidar.model_copy(update={"noise": options.noise}) for name, lidar in robot.lidars.items()}
    noisy = robot.model_copy(update={"lidars": lidars})
    navigator = Navigator(None if options.no_map else grid, noisy, planner=options.planner)
    monitor = CollisionMonitor(noisy) if options.monitor else None
    ticks: list[float] = []
    actions: dict[str, int] = {}
    with trundle.simulate(filled, noisy, backend=options.backend, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        navigator.set_goal(goal)
        contact = ""
        while state.time < options.limit:
            began = clock.thread_time()
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            if monitor is not None:
                report = monitor.check(command, state.twist, state.scans, state.time, state.odometry)
                command = report.command
                actions[report.action] = actions.get(report.action, 0) + 1
            ticks.append(1e3 * (clock.thread_time() - began))
            if navigator.status in FINAL:
                break
            state = sim.step(command, navigator.dt)
            if state.contacts:
                contact = state.contacts[0].other
                break
    return {
        "arrived": navigator.status is NavigationStatus.ARRIVED,
        "contact": contact,
        "status": navigator.status.value,
        "message": navigator.message,
        "error": str(navigator.error or ""),
        "time": state.time,
        "replans": navigator.replans,
        "planning_s": navigator.planning_time_s,
        "median_ms": float(np.median(ticks)),
        "p99_ms": float(np.percentile(ticks, 99)),
        "pose": state.pose,
        "start": start,
        "goal": goal,
        "actions": actions,
    }


def words(pose: object) -> str:
    """A pose in short."""
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})" if isinstance(pose, Pose2D) else str(pose)


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--missions", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--backend", default="kinematic")
    parser.add_argument("--planner", default="auto")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--boxes", type=int, nargs=2, default=(5, 30))
    parser.add_argument("--worlds", nargs="+", default=("office", "warehouse", "lot"))
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--limit", type=float, default=240.0)
    parser.add_argument("--monitor", action="store_true")
    parser.add_argument("--no-map", action="store_true")
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    done: list[dict[str, object]] = []
    for kind, seed in missions(options.worlds, options.missions, options.first):
        result = drive(kind, seed, robot, options)
        if isinstance(result, str):
            print(f"{kind} {seed}: does not count, {result}", flush=True)
            continue
        done.append(result)
        print(
            f"{kind} {seed}: {result['status']} {result['contact']} after {result['time']:.1f} s, "
            f"{result['replans']} replans in {result['planning_s']:.2f} s, tick {result['median_ms']:.2f} ms, "
            f"p99 {result['p99_ms']:.1f} ms, {result['actions']}",
            flush=True,
        )
        if not result["arrived"]:
            print(
                f"    from {words(result['start'])} to {words(result['goal'])}, at {words(result['pose'])}: "
                f"{result['message']} | {result['error']}",
                flush=True,
            )
    arrived = sum(bool(result["arrived"]) for result in done)
    contacts = sum(bool(result["contact"]) for result in done)
    print(f"{arrived} of {len(done)} arrived, {contacts} with a contact")


if __name__ == "__main__":
    main()
