"""Drives in trundle's kinematic simulator, recorded once: true poses, exact odometry and the scans of both lidars."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import sample_mission
from trundle.navigation import Navigator
from trundle.navigation.state import NavigationStatus
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

LIDAR_NOISE_M = 0.02
LIDAR_RATE_HZ = 10.0
WORLDS = ("warehouse", "office", "corridors", "cylinders", "maze", "lot")


@dataclass(frozen=True)
class Moment:
    """One control period: when, where the robot truly is, how it moves, and what its lidars saw."""

    time: float
    pose: Pose2D
    twist: Twist2D
    scans: tuple[Scan, ...]


@dataclass(frozen=True)
class Drive:
    """A recorded drive on its map."""

    name: str
    grid: OccupancyGrid
    robot: Robot
    moments: tuple[Moment, ...]


def load_robot() -> Robot:
    """Nova Carter with lidars of 10 Hz and 2 cm of noise."""
    robot = Robot.load("nova_carter")
    lidars = {
        name: lidar.model_copy(update={"rate": LIDAR_RATE_HZ, "noise": LIDAR_NOISE_M})
        for name, lidar in robot.lidars.items()
    }
    return robot.model_copy(update={"lidars": lidars})


def make_place(name: str, seed: int) -> tuple[World, OccupancyGrid]:
    """A generated world and its map, or a map file and the world that its cells are extruded to."""
    robot = load_robot()
    if name.endswith((".yaml", ".yml")):
        grid = OccupancyGrid.load(name)
        return World.from_map(grid), grid
    world = World.generate(name, seed=seed)
    return world, OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)


def record_drive(name: str, seed: int, *, seconds: float = 120.0, cache: Path | None = None) -> Drive:
    """Drive from goal to goal with the true pose, and keep what was seen."""
    file = None if cache is None else cache / f"{Path(name).stem}_{seed}_{seconds:g}.pickle"
    if file is not None and file.exists():
        with file.open("rb") as stream:
            return pickle.load(stream)
    robot = load_robot()
    world, grid = make_place(name, seed)
    navigator = Navigator(grid, robot)
    start, _ = sample_mission(navigator.costmap, seed=seed)
    moments: list[Moment] = []
    with KinematicSimulator(world, robot, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        draw = np.random.default_rng(seed)
        while state.time < seconds:
            moments.append(Moment(state.time, state.pose, state.twist, state.scans))
            if navigator.status not in (NavigationStatus.DRIVING, NavigationStatus.BLOCKED):
                _, goal = sample_mission(navigator.costmap, seed=int(draw.integers(1 << 31)))
                navigator.set_goal(goal)
            command = navigator.update(state.pose, state.twist, time=state.time)
            state = sim.step(command, navigator.dt)
    drive = Drive(f"{Path(name).stem} {seed}", grid, robot, tuple(moments))
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("wb") as stream:
            pickle.dump(drive, stream)
    return drive
