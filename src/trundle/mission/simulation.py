"""The simulator of a scenario: the backend with its options and lidars, and the errors of robot and odometry."""

from __future__ import annotations

from typing import Any

from trundle.mission.fields import ScenarioFields
from trundle.robots import Robot
from trundle.sim import Simulator, simulate
from trundle.worlds import World


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
    """The backend with the errors of the robot's motion and odometry; itself where the scenario has none."""
    sim = backend if scenario.actuation is None else scenario.actuation.simulate(backend)
    return sim if scenario.odometry is None else scenario.odometry.simulate(sim)


def backend_of(simulator: Simulator) -> Simulator:
    """The backend that `wrap_backend` was given."""
    while (inner := getattr(simulator, "inner", None)) is not None:
        simulator = inner
    return simulator
