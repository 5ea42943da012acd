"""The simulator of a scenario, with its lidars and errors, and what stands between it and the navigator."""

from __future__ import annotations

from typing import Any, TypedDict

from trundle.control import CollisionMonitor
from trundle.control.latency import Latency
from trundle.errors import InputError
from trundle.files.choice import Choice
from trundle.localization import create_localizer
from trundle.localization.localizer import LocalizerLike
from trundle.maps import OccupancyGrid
from trundle.mission.fields import BY_SCANS, Rules, ScenarioFields, StartError
from trundle.mission.running.robot_stack import SomeMonitor
from trundle.robots import Robot
from trundle.sim import Simulator, simulate
from trundle.sim.wrapper import SimulatorWrapper
from trundle.worlds import World


class SessionOptions(TypedDict, total=False):
    """Keywords of `Session` and `run` that say what is between the simulator and the agent."""

    localizer: LocalizerLike | None
    start_error: StartError | None
    latency: Latency | None
    monitor: SomeMonitor | bool | None
    rules: Rules | None
    through: bool


def session_options(scenario: ScenarioFields, grid: OccupancyGrid, robot: Robot) -> SessionOptions:
    """What a scenario puts between the simulator and the navigator.

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
    """Options that the backend is started with."""
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
    """The backend that `wrap_backend` was given."""
    while isinstance(simulator, SimulatorWrapper):
        simulator = simulator.inner
    return simulator
