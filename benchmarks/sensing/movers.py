"""Missions among forklifts and people: how many arrive, and how many touch something while the robot drives.

python benchmarks/sensing/movers.py --missions 20 --speed 1.2
python benchmarks/sensing/movers.py --missions 20 --yield
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import trundle
from trundle.control import CollisionMonitor
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission.sampling import sample_mission
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.state import FINAL
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.movers import Crowd

DRIVES_MPS = 0.05


def drive(kind: str, seed: int, robot: Robot, options: argparse.Namespace) -> tuple[str, list[str], list[str], float]:
    """Drive one mission; return its status, what was touched while driving and while standing, and its length [s]."""
    crowds = tuple(
        Crowd(name, count, kind=name, speed=options.speed, sees_robot=options.yields)
        for name, count in (("forklift", options.forklifts), ("person", options.people))
        if count
    )
    world = replace(World.generate(kind, seed=seed), movers=crowds)
    grid = OccupancyGrid.from_world(world)
    start, goal = sample_mission(Costmap.from_grid(grid, robot), seed)
    navigator = Navigator(grid, robot)
    monitor = CollisionMonitor(robot) if options.monitor else None
    driving: list[str] = []
    standing: list[str] = []
    with trundle.simulate(world, robot, backend=options.backend, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        navigator.set_goal(goal)
        touched: set[str] = set()
        while state.time < options.limit and not driving:
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            if monitor is not None:
                command = monitor.check(command, state.twist, state.scans, state.time, state.odometry).command
            if navigator.status in FINAL:
                break
            before = state
            state = sim.step(command, navigator.dt)
            touches = {contact.other for contact in state.contacts}
            for name in sorted(touches - touched):  # the first touch counts: then the robot is pushed
                speed = max(abs(before.twist.v), abs(before.twist.w) * robot.circumscribed_radius)
                pushed = bool(before.contacts)
                (driving if speed > DRIVES_MPS and not pushed else standing).append(name)
            touched |= touches
    if navigator.status is not NavigationStatus.ARRIVED:
        print(f"    at {words(state.pose)} to {words(goal)}: {navigator.message} | {navigator.error}", flush=True)
    return navigator.status.value, driving, standing, state.time


def words(pose: Pose2D) -> str:
    """A pose in short."""
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})"


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--world", default="warehouse")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--speed", type=float, default=1.2)
    parser.add_argument("--forklifts", type=int, default=6)
    parser.add_argument("--people", type=int, default=8)
    parser.add_argument("--limit", type=float, default=240.0)
    parser.add_argument("--yield", dest="yields", action="store_true")
    parser.add_argument("--no-monitor", dest="monitor", action="store_false")
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    arrived = hit = run_into = 0
    for seed in range(options.first, options.first + options.missions):
        status, driving, standing, seconds = drive(options.world, seed, robot, options)
        arrived += status == "arrived"
        hit += bool(driving)
        run_into += bool(standing)
        print(f"{seed}: {status} after {seconds:.1f} s, driving {driving}, standing {standing}", flush=True)
    print(f"{arrived} of {options.missions} arrived, {hit} touched something while driving, {run_into} were run into")


if __name__ == "__main__":
    main()
