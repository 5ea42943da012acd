"""Known missions in MuJoCo, each by two controllers from the same start: time, jerk and clearance, paired.

    python benchmarks/control/missions.py --map carter_warehouse_navigation.yaml --missions 100
    python benchmarks/control/missions.py --missions 100

With a map, start and goal are drawn on it. Without one, each mission has a generated warehouse of its own, with aisles
of 1.1 to 1.8 m. The smallest clearance is also given over the missions in which a turn on the spot at the start and at
the goal, as far from it as the robot may stop, keeps --room: in others no controller can.
"""

from __future__ import annotations

import argparse
import json
import time as clock
from dataclasses import dataclass

import numpy as np

import trundle
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import sample_mission
from trundle.navigation import Choice, Navigator
from trundle.navigation.state import FINAL
from trundle.robots import Robot
from trundle.sim.clearance import least_clearance
from trundle.worlds import World

_STOPS_WITHIN_M = 0.05
"""Of the end of its path: the tolerance of both controllers."""


@dataclass(frozen=True, slots=True)
class Drive:
    """What became of one mission.

    Attributes:
        status: How it ended.
        seconds: How long it took [s].
        jerk: Mean of the second differences of the speed [m/s³].
        turning_jerk: The same of the turning speed [rad/s³].
        clearance: Smallest distance to a solid of the world, or of the map [m].
        at_ends: The same of a turn on the spot at the start, and at the goal or as far from it as it may stop: what no
            controller can be sure to keep more of.
        contact: Whether something was touched.
        tick_ms: Median time of a tick on one core [ms].
    """

    status: str
    seconds: float
    jerk: float
    turning_jerk: float
    clearance: float
    at_ends: float
    contact: bool
    tick_ms: float


def drive(world: World, grid: OccupancyGrid, robot: Robot, seed: int, controller: Choice, backend: str) -> Drive:
    start, goal = sample_mission(Costmap.from_grid(grid, robot), seed)
    navigator = Navigator(grid, robot, controller=controller)
    poses = [start.as_tuple()]
    twists: list[tuple[float, float]] = []
    ticks: list[float] = []
    contact = False
    with trundle.simulate(world, robot, backend=backend) as sim:
        state = sim.reset(start, seed=seed)
        navigator.set_goal(goal)
        while state.time < 200.0:
            began = clock.thread_time()
            command = navigator.update(state.pose, state.twist, time=state.time)
            ticks.append(1e3 * (clock.thread_time() - began))
            if navigator.status in FINAL:
                break
            state = sim.step(command, navigator.dt)
            poses.append(state.pose.as_tuple())
            twists.append((state.twist.v, state.twist.w))
            contact = contact or bool(state.contacts)
    if navigator.status.value != "arrived":
        print(f"    {_words(state.pose)} to {_words(goal)}: {navigator.message} | {navigator.error}", flush=True)
    jerks = np.abs(np.diff(np.array(twists), n=2, axis=0)).mean(axis=0) / navigator.dt**2
    return Drive(
        navigator.status.value,
        state.time,
        float(jerks[0]),
        float(jerks[1]),
        _clearance(world, grid, robot, np.array(poses)),
        min(_turning(world, grid, robot, start), _turning(world, grid, robot, goal) - _STOPS_WITHIN_M),
        contact,
        float(np.median(ticks)),
    )


def _clearance(world: World, grid: OccupancyGrid, robot: Robot, poses: FloatArray) -> float:
    coarse = Costmap.from_grid(grid, robot).clearance(poses)
    return least_clearance(world, robot, poses, coarse, resolution=grid.resolution, cap=2.0)


def _turning(world: World, grid: OccupancyGrid, robot: Robot, pose: Pose2D) -> float:
    yaws = np.linspace(-np.pi, np.pi, 73)
    return _clearance(world, grid, robot, np.column_stack([np.full(73, pose.x), np.full(73, pose.y), yaws]))


def _words(pose: Pose2D) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}, {pose.yaw:.2f})"


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map")
    parser.add_argument("--missions", type=int, default=10)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--controller", default="mppi")
    parser.add_argument("--options", type=json.loads, default={}, help="of the controller, as JSON")
    parser.add_argument("--room", type=float, default=0.1, help="[m], see above")
    parser.add_argument("--against", default="regulated_pure_pursuit")
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    world = grid = None
    if options.map:
        grid = OccupancyGrid.load(options.map)
        world = World.from_map(grid)
    choices = [Choice.of(options.against), Choice(name=options.controller, options=options.options)]
    rows: list[tuple[Drive, Drive]] = []
    for seed in range(options.first, options.first + options.missions):
        if not options.map:
            width = float(np.random.default_rng(seed).uniform(1.1, 1.8))
            world = World.generate("warehouse", seed=seed, aisle_width=width)
            grid = OccupancyGrid.from_world(world)
        one, other = (drive(world, grid, robot, seed, choice, options.backend) for choice in choices)  # type: ignore[arg-type]
        rows.append((one, other))
        print(
            f"{seed}: {other.status} {other.seconds:.1f} s of {one.seconds:.1f}, jerk {other.jerk / one.jerk:.2f}, "
            f"turning jerk {other.turning_jerk / one.turning_jerk:.2f}, clearance {other.clearance:.3f} "
            f"({one.clearance:.3f}; {one.at_ends:.3f} in turns at its ends), "
            f"tick {other.tick_ms:.1f} ms{' CONTACT' if other.contact else ''}",
            flush=True,
        )
    print(_summary(rows, options.room))


def _summary(rows: list[tuple[Drive, Drive]], room: float) -> str:
    def mean(name: str, which: int) -> float:
        return float(np.mean([getattr(row[which], name) for row in rows]))

    def ratio(name: str) -> float:
        return mean(name, 1) / mean(name, 0)

    arrived = sum(row[1].status == "arrived" and not row[1].contact for row in rows)
    least = [min(row[which].clearance for row in rows) for which in (1, 0)]
    roomy = [row[1].clearance for row in rows if row[1].at_ends >= room]
    ticks = float(np.median([row[1].tick_ms for row in rows]))
    return (
        f"{arrived} of {len(rows)} arrived without contact; time {ratio('seconds'):.3f}, jerk {ratio('jerk'):.3f} "
        f"({mean('jerk', 1):.3f} m/s³), turning jerk {ratio('turning_jerk'):.3f} "
        f"({mean('turning_jerk', 1):.3f} rad/s³) of the other's; smallest clearance {least[0]:.3f} m "
        f"({least[1]:.3f} m), {min(roomy, default=np.nan):.3f} m in the {len(roomy)} with room "
        f"at both ends; tick {ticks:.2f} ms"
    )


if __name__ == "__main__":
    main()
