"""Aisles and doors that are closed, which the map does not know: does the robot take the path round them?

    python -m benchmarks.sensing.closed --missions 20

In each mission the planned path leads through an aisle or a door that a barrier closes, from wall to wall. A mission
counts where `least_cost` still finds a path to the goal in the world with the barrier, and that is longer by 1 m.
"""

from __future__ import annotations

import argparse
import math
import time as clock
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

import trundle
from trundle.costmap import Costmap
from trundle.errors import PlanningError, TrundleError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, sample_mission
from trundle.navigation import Navigator
from trundle.path import Path
from trundle.planning import create_planner
from trundle.robots import Robot
from trundle.worlds import World

_WORLDS = {"warehouse": {"low_objects": False}, "office": {"low_objects": False}, "maze": {}}
_FROM_ENDS_M = 2.5
_WIDEST_M = 1.6  # clearance on each side of an aisle or a door
_LONGER_M = 1.0


@dataclass(frozen=True)
class Mission:
    """A mission whose path is closed: how long the path was [m], and how long the one round it is."""

    name: str
    world: World
    grid: OccupancyGrid
    start: Pose2D
    goal: Pose2D
    length: float
    round: float


def missions(robot: Robot, wanted: int) -> Iterator[Mission]:
    """Missions of generated worlds in turn, by seed, until there are enough."""
    found = seed = 0
    while found < wanted and seed < 20 * wanted:
        kind = list(_WORLDS)[seed % len(_WORLDS)]
        mission = _close(kind, seed, robot)
        seed += 1
        if mission is not None:
            found += 1
            yield mission


def _close(kind: str, seed: int, robot: Robot) -> Mission | None:
    """Close the narrowest place on the path that has another path round it."""
    world = World.generate(kind, seed=seed, **_WORLDS[kind])
    grid = OccupancyGrid.from_world(world, z_range=robot.z_range)
    costmap = Costmap.from_grid(grid, robot)
    try:
        start, goal = sample_mission(costmap, seed)
        path = create_planner("auto").plan(costmap, start, goal)
    except TrundleError:
        return None
    for barrier in _barriers(path, costmap):
        closed = replace(world, solids=(*world.solids, barrier))
        truth = Costmap.from_grid(OccupancyGrid.from_world(closed, z_range=robot.z_range), robot)
        try:
            around = create_planner("least_cost").plan(truth, start, goal)
        except PlanningError:
            continue
        if around.length > path.length + _LONGER_M:
            return Mission(f"{kind} {seed}", closed, grid, start, goal, path.length, around.length)
    return None


def _barriers(path: Path, costmap: Costmap) -> Iterator[Solid]:
    """Barriers across the narrow places of a path, the narrowest first, no two within 2 m."""
    points = path.poses[:, :2]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    places = np.arange(_FROM_ENDS_M, along[-1] - _FROM_ENDS_M, 0.25)
    if len(places) == 0:
        return
    x, y = np.interp(places, along, points[:, 0]), np.interp(places, along, points[:, 1])
    ahead = np.interp(places + 0.3, along, points[:, 0]), np.interp(places + 0.3, along, points[:, 1])
    yaws = np.arctan2(ahead[1] - y, ahead[0] - x)
    clearance = costmap.clearance(np.column_stack([x, y, yaws]), 2.0 * _WIDEST_M) + 0.5 * costmap.inscribed_radius
    taken: list[float] = []
    for index in np.argsort(clearance, kind="stable").tolist():
        place = float(places[index])
        if clearance[index] > _WIDEST_M or any(abs(place - other) < 2.0 for other in taken):
            continue
        taken.append(place)
        size = (0.1, 2.0 * (float(clearance[index]) + costmap.circumscribed_radius), 1.0)
        yield Solid("barrier", Box(size), Pose3D.planar(float(x[index]), float(y[index]), 0.5, yaw=float(yaws[index])))
        if len(taken) == 4:
            return


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=20)
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--robot", default="benchmarks/sensing/carter.yaml")
    options = parser.parse_args()
    robot = Robot.load(options.robot)
    arrived = contacts = count = 0
    for mission in missions(robot, options.missions):
        began = clock.process_time()
        with trundle.simulate(mission.world, robot, backend=options.backend, lidar=True) as sim:
            episode = trundle.run(sim, Navigator(mission.grid, robot), mission.start, mission.goal)
        count += 1
        arrived += episode.outcome is Outcome.ARRIVED
        contacts += bool(episode.metrics.contacts)
        print(
            f"{mission.name}: {episode.message}; path {mission.length:.1f} m, round the barrier {mission.round:.1f} m, "
            f"driven {episode.metrics.distance_m:.1f} m, {clock.process_time() - began:.0f} s of CPU",
            flush=True,
        )
    share = arrived / count if count else math.nan
    print(f"{arrived} of {count} took the path round it ({100.0 * share:.0f} %), {contacts} with a contact")


if __name__ == "__main__":
    main()
