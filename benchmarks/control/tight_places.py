"""Generated tight places: of what can be planned, how much arrives?

    python benchmarks/control/tight_places.py --places 200 --controller mppi

Dead ends that the robot stands in, corridors in which it must turn round, doors of 0.75 m, and goals beside walls, a
quarter of each, by seed. The map is known. A place counts if `least_cost` or `hybrid_astar` plans a path there.
"""

from __future__ import annotations

import argparse
import json
import math
from collections import Counter

import numpy as np
import numpy.typing as npt

import trundle
from trundle.costmap import Costmap
from trundle.errors import PlanningError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Choice, Navigator
from trundle.navigation.state import FINAL
from trundle.planning import create_planner
from trundle.robots import Robot
from trundle.worlds import World

CELL_M = 0.05
DOOR_M = 0.75
ROOM_M = 10.0
Cells = npt.NDArray[np.int8]
Place = tuple[Cells, Pose2D, Pose2D]


def box(cells: Cells, x0: float, y0: float, x1: float, y1: float) -> None:
    """Occupy a rectangle [m]."""
    cells[round(y0 / CELL_M) : round(y1 / CELL_M), round(x0 / CELL_M) : round(x1 / CELL_M)] = 100


def room() -> Cells:
    """An empty room with walls."""
    cells = np.full((round(ROOM_M / CELL_M),) * 2, 0, np.int8)
    cells[:2] = cells[-2:] = cells[:, :2] = cells[:, -2:] = 100
    return cells


def dead_end(rng: np.random.Generator) -> Place:
    """A corridor that is closed at one end, in which the robot stands."""
    cells, width, depth = room(), rng.uniform(0.9, 1.6), rng.uniform(2.0, 4.0)
    middle = ROOM_M / 2.0
    box(cells, 0.0, middle + width / 2.0, depth + 0.1, ROOM_M)
    box(cells, 0.0, 0.0, depth + 0.1, middle - width / 2.0)
    yaw = rng.choice([math.pi, 0.0]) + rng.uniform(-0.2, 0.2)
    inside = rng.uniform(0.9, depth - 0.6)
    return cells, Pose2D(inside, middle, yaw), Pose2D(7.0, rng.uniform(2.0, 8.0), rng.uniform(-3.0, 3.0))


def corridor(rng: np.random.Generator) -> Place:
    """A corridor in which the goal lies behind the robot."""
    cells, width = room(), rng.uniform(1.3, 2.0)
    middle = ROOM_M / 2.0
    box(cells, 0.0, middle + width / 2.0, ROOM_M, ROOM_M)
    box(cells, 0.0, 0.0, ROOM_M, middle - width / 2.0)
    y = middle + rng.uniform(-0.1, 0.1)
    return (
        cells,
        Pose2D(rng.uniform(3.0, 4.0), y, math.pi),
        Pose2D(rng.uniform(6.0, 8.5), y, rng.choice([0.0, math.pi])),
    )


def door(rng: np.random.Generator) -> Place:
    """Two rooms with a door of 0.75 m between them."""
    cells = room()
    at, beside = rng.uniform(4.0, 6.0), round(rng.uniform(1.5, 8.0) / CELL_M) * CELL_M
    box(cells, at, 0.0, at + rng.choice([0.1, 0.3]), beside)
    box(cells, at, beside + DOOR_M, at + 0.3, ROOM_M)
    start = Pose2D(rng.uniform(1.2, at - 1.2), rng.uniform(1.2, 8.8), rng.uniform(-3.0, 3.0))
    return cells, start, Pose2D(rng.uniform(at + 1.5, 8.8), rng.uniform(1.2, 8.8), rng.uniform(-3.0, 3.0))


def beside_wall(rng: np.random.Generator) -> Place:
    """A goal with its side, its front or its rear near a wall."""
    cells, gap = room(), rng.uniform(0.05, 0.15)
    start = Pose2D(rng.uniform(3.0, 7.0), rng.uniform(3.0, 5.0), rng.uniform(-3.0, 3.0))
    x, wall = rng.uniform(2.0, 8.0), 2 * CELL_M
    way, side = (0.25 + gap, rng.choice([0.0, math.pi])), (0.14 + gap, -math.pi / 2.0)
    rear = 0.607 + gap, math.pi / 2.0
    room_m, yaw = (way, side, rear)[int(rng.integers(3))]
    return cells, start, Pose2D(x, wall + room_m, yaw)


KINDS = (dead_end, corridor, door, beside_wall)


def can_be_planned(costmap: Costmap, start: Pose2D, goal: Pose2D) -> bool:
    for name in ("least_cost", "hybrid_astar"):
        try:
            create_planner(name).plan(costmap, start, goal, deadline_s=20.0)
        except PlanningError:
            continue
        return True
    return False


def drive(grid: OccupancyGrid, robot: Robot, start: Pose2D, goal: Pose2D, controller: Choice, backend: str) -> str:
    """How it ended: "arrived" without contact, or what went wrong."""
    navigator = Navigator(grid, robot, controller=controller)
    with trundle.simulate(World.from_map(grid), robot, backend=backend) as sim:
        state = sim.reset(start, seed=0)
        navigator.set_goal(goal)
        while state.time < 120.0:
            command = navigator.update(state.pose, state.twist, time=state.time)
            if navigator.status in FINAL:
                return f"{navigator.status.value} {navigator.message} {navigator.error or ''}".strip()
            state = sim.step(command, navigator.dt)
            if state.contacts:
                return f"contact with {state.contacts[0].other} at {state.pose}"
    return f"timeout at {state.pose}: {getattr(navigator.controller, 'reason', '')}"


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--places", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--robot", default="nova_carter")
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--controller", default="mppi")
    parser.add_argument("--options", type=json.loads, default={}, help="of the controller, as JSON")
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    planned: Counter[str] = Counter()
    arrived: Counter[str] = Counter()
    for seed in range(options.first, options.first + options.places):
        kind = KINDS[seed % len(KINDS)]
        cells, start, goal = kind(np.random.default_rng(seed))
        grid = OccupancyGrid(cells, CELL_M)
        if not can_be_planned(Costmap.from_grid(grid, robot), start, goal):
            continue
        planned[kind.__name__] += 1
        ended = drive(
            grid, robot, start, goal, Choice(name=options.controller, options=options.options), options.backend
        )
        arrived[kind.__name__] += ended == "arrived"
        if ended != "arrived":
            print(f"{seed} {kind.__name__}: {ended}", flush=True)
    for kind in KINDS:
        name = kind.__name__
        print(f"{name}: {arrived[name]} of {planned[name]} arrived")
    print(f"all: {arrived.total()} of {planned.total()} arrived without contact, of {options.places} places")


if __name__ == "__main__":
    main()
