"""What a scenario is set up with: `Place`, its world, robot and map, and its simulator with what stands before it."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any, TypeAlias, TypedDict

import numpy as np

from trundle.control import CollisionMonitor
from trundle.control.latency import Latency
from trundle.errors import InputError, ScenarioError
from trundle.files.choice import Choice
from trundle.geometry import Pose2D
from trundle.localization import create_localizer
from trundle.localization.localizer import LocalizerLike
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.mission.fields import BY_SCANS, MapOptions, Rules, ScenarioFields, StartError
from trundle.mission.goal_fields import position_of
from trundle.mission.running.robot_stack import SomeMonitor
from trundle.robots import Robot
from trundle.sim import Simulator, simulate
from trundle.sim.wrapper import SimulatorWrapper
from trundle.worlds import World
from trundle.worlds.floors import find_common_floor, find_floor, lower_world

Bounds: TypeAlias = tuple[tuple[float, float], tuple[float, float]]

_FAR_OUT = 30.0
"""A start or goal that is farther than this from all solids [m] is a mistake, and no map is made that reaches it."""

_ROOM = 1.0
"""Around a start or goal that lies outside the world's solids [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """Where a scenario takes place. Scenarios of one `place_key` can share it: nothing changes it.

    Attributes:
        world: The world, its floor at z = 0.
        robot: The robot.
        grid: The map.
        floor_z: How high the floor was in the world's file [m].
        keepout: Where the robot must not go, or None.
        speed_mask: How fast it may drive where, or None.
    """

    world: World
    robot: Robot
    grid: OccupancyGrid
    floor_z: float
    keepout: KeepoutMask | None
    speed_mask: SpeedMask | None


def make_place(scenario: ScenarioFields) -> Place:
    """Make the world, the robot and the map of a scenario.

    Raises:
        UnknownNameError: If a name is not known; the nearest is offered.
        InputError: If a file or an option cannot be used.
    """
    robot = Robot.load(scenario.robot)
    world, grid, floor_z = _make_world(scenario, robot)
    if scenario.movers:
        world = replace(world, movers=(*world.movers, *(choice.make() for choice in scenario.movers)))
    return Place(world, robot, grid, floor_z, *load_masks(scenario))


def load_masks(scenario: ScenarioFields) -> tuple[KeepoutMask | None, SpeedMask | None]:
    """Load where the robot of a scenario must not go, and how fast it may drive where.

    Raises:
        InputError: If a file cannot be used.
    """
    compat, limit = scenario.compat, None if scenario.map_options is None else scenario.map_options.max_cells
    keepout, speeds = scenario.keepout, scenario.speed_mask
    return (
        None if keepout is None else KeepoutMask.load(keepout, compat=compat, max_cells=limit),
        None if speeds is None else SpeedMask.load(speeds, compat=compat, max_cells=limit),
    )


def place_key(scenario: ScenarioFields) -> str:
    """Return what `make_place` depends on, as JSON: scenarios of one key have one place."""
    fields = ("map", "map_options", "compat", "keepout", "speed_mask", "robot", "resolution", "floor_z", "movers")
    key = scenario.model_dump(mode="json", include={"world", *fields})
    if scenario.world is None:
        key["unknown"] = _unknown(scenario)
    elif scenario.world.is_file:
        key |= scenario.model_dump(mode="json", include={"start", "goal", "goals"})
        key["backend"] = scenario.backend.name
    elif scenario.world.seed is None:
        key["world"]["seed"] = scenario.seed
    return json.dumps(key, sort_keys=True)


def _unknown(scenario: ScenarioFields) -> Any:
    walls = scenario.map_options or MapOptions()
    return walls.unknown or ("solid" if scenario.unknown == "blocked" else "free")


def _make_world(scenario: ScenarioFields, robot: Robot) -> tuple[World, OccupancyGrid, float]:
    """Return the world with its floor at z = 0, its map, and how high the floor was before [m]."""
    if scenario.map is not None:
        walls = scenario.map_options or MapOptions()
        grid = OccupancyGrid.load(scenario.map, compat=scenario.compat, max_cells=walls.max_cells)
        world = World.from_map(grid, height=walls.height, unknown=_unknown(scenario))
        # The walls of this world end at the borders of the map's cells, wherever those of the true one do.
        return world, replace(grid, surface="border"), 0.0
    if scenario.world is None:
        raise ScenarioError("give either world or map")
    choice = scenario.world
    if choice.is_file:
        world = World.load(choice.name, **dict[str, Any](choice.options))
    else:
        seed = scenario.seed if choice.seed is None else choice.seed
        world = World.generate(choice.name, **{"seed": seed, **dict[str, Any](choice.options)})
    floor_z = _choose_floor(scenario, world, robot)
    world = lower_world(world, floor_z)
    bounds = _map_bounds(scenario, world, robot)
    grid = OccupancyGrid.from_world(world, resolution=scenario.resolution, z_range=robot.z_range, bounds=bounds)
    return world, grid, floor_z


def _choose_floor(scenario: ScenarioFields, world: World, robot: Robot) -> float:
    """Return the height of the floor [m]; that of a generated world is 0."""
    choice = scenario.world
    if scenario.floor_z is not None or choice is None or not choice.is_file or _opens_file(scenario):
        return scenario.floor_z or 0.0
    if scenario.start is None:
        return find_common_floor(world, robot)
    return find_floor(world, robot, Pose2D.of(scenario.start))


def _opens_file(scenario: ScenarioFields) -> bool:
    """Return whether the backend simulates the world's file itself, on its own floor."""
    return scenario.backend.name == "isaac" or "environment" in scenario.backend.options


def _map_bounds(scenario: ScenarioFields, world: World, robot: Robot) -> Bounds | None:
    """Return bounds of a file's world with the robot at its start and goals near it; None for the world's own.

    A file's world may have no walls around it, and a robot comes from outside.
    """
    given = [position_of(end) for end in (scenario.start, scenario.goal, *(scenario.goals or ())) if end is not None]
    low, high = (np.asarray(corner)[:2] for corner in world.bounds)
    off = [float(np.maximum(low - end, end - high).max()) for end in given]
    ends = [end for end, distance in zip(given, off, strict=True) if 0.0 < distance <= _FAR_OUT]
    if not ends or not world.solids or scenario.world is None or not scenario.world.is_file:
        return None
    reach = robot.circumscribed_radius + _ROOM
    low, high = (
        np.min([low, *(np.array(end) - reach for end in ends)], axis=0),
        np.max([high, *(np.array(end) + reach for end in ends)], axis=0),
    )
    edge = scenario.resolution
    low, high = np.floor(low / edge) * edge, np.ceil(high / edge) * edge
    return (float(low[0]), float(low[1])), (float(high[0]), float(high[1]))


class SessionOptions(TypedDict, total=False):
    """Keywords of `Session` and `run` that say what is between the simulator and the agent."""

    localizer: LocalizerLike | None
    start_error: StartError | None
    latency: Latency | None
    monitor: SomeMonitor | bool | None
    rules: Rules | None
    through: bool


def session_options(scenario: ScenarioFields, grid: OccupancyGrid, robot: Robot) -> SessionOptions:
    """Return what a scenario puts between the simulator and the navigator.

    Raises:
        UnknownNameError: If there is no such localizer, or the robot has no lidar of a given name.
        InputError: If the localizer does not take an option, or needs a map that the robot does not know, or lidars
            that it does not have.
    """
    choice, monitor = scenario.localizer, scenario.collision_monitor
    check_sees(choice, robot)
    localizer = None if choice is None else create_localizer(choice, grid if scenario.known_map else None, robot)
    return {
        "localizer": localizer,
        "start_error": scenario.start_error,
        "latency": scenario.latency,
        "rules": scenario.rules,
        "through": scenario.through,
        "monitor": monitor if monitor is None or isinstance(monitor, bool) else CollisionMonitor(robot, monitor),
    }


def check_sees(localizer: Choice | None, robot: Robot) -> None:
    """Refuse a localizer that finds the robot by its scans, on a robot without lidars.

    Raises:
        InputError: If it is one.
    """
    if localizer is not None and localizer.name in BY_SCANS and not robot.lidars:
        raise InputError(
            f"the localizer {localizer.name} finds the robot by the scans of its lidars, and {robot.name} has none: "
            "give a robot with lidars, or another localizer"
        )


def backend_options(scenario: ScenarioFields) -> dict[str, Any]:
    """Return options that the backend is started with."""
    options = dict[str, Any](scenario.backend.options)
    if scenario.lidar:
        options["lidar"] = scenario.lidar
    return options


def start_backend(scenario: ScenarioFields, world: World, robot: Robot) -> Simulator:
    """Start the backend alone.

    Raises:
        UnknownNameError: If there is no such backend, or the robot has no lidar of a given name.
        InputError: If the backend does not take an option.
    """
    return simulate(world, robot, backend=scenario.backend.name, **backend_options(scenario))


def wrap_backend(scenario: ScenarioFields, backend: Simulator) -> Simulator:
    """The backend with the errors of the robot's motion, odometry and lidars; itself where the scenario has none."""
    sim = backend if scenario.actuation is None else scenario.actuation.simulate(backend)
    sim = sim if scenario.odometry is None else scenario.odometry.simulate(sim)
    return sim if scenario.lidar_errors is None else scenario.lidar_errors.simulate(sim)


def backend_of(simulator: Simulator) -> Simulator:
    """Return the backend that `wrap_backend` was given."""
    while isinstance(simulator, SimulatorWrapper):
        simulator = simulator.inner
    return simulator
