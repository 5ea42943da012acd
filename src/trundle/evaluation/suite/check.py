"""`check_suite`: everything that can be checked of a suite before any of its episodes runs."""

from __future__ import annotations

import inspect
import json
from collections.abc import Callable
from typing import Any, cast

import numpy as np

from trundle.control import create_controller
from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.public.reference import load_reference
from trundle.evaluation.statistics import Gate
from trundle.evaluation.suite.expand import Expansion
from trundle.evaluation.suite.fields import PluginChoice, SuiteFields
from trundle.evaluation.suite.parts import SuiteWorld
from trundle.localization import create_localizer
from trundle.maps import OCCUPIED, OccupancyGrid
from trundle.mission.fields import MapOptions
from trundle.mission.setup import check_sees
from trundle.navigation.agent import Agent
from trundle.navigation.agents import create_agent
from trundle.navigation.policies.policy import Policy
from trundle.planning import create_planner, create_smoother
from trundle.registry import keywords_taken
from trundle.robots import Robot
from trundle.sim.simulator import SIMULATORS
from trundle.worlds.options import check_options
from trundle.worlds.world import WORLDS

MOST_EPISODES = 10_000_000
"""More than this is a mistake, or several evaluations."""


def check_suite(suite: SuiteFields, expansion: Expansion) -> None:
    """Check the number of episodes, names, options and files of a suite.

    Raises:
        InputError: What is wrong, and what to do.
    """
    if expansion.total > MOST_EPISODES:
        product = " × ".join(f"{size:,} {name}" for name, size in expansion.factors().items())
        raise InputError(
            f"the suite has {expansion.total:,} episodes ({product}), and an evaluation at most {MOST_EPISODES:,}: "
            "take fewer seeds, or cross fewer settings"
        )
    for world in suite.worlds:
        _check_world_options(world)
        if world.reference is not None:
            load_reference(world.reference)
    robots = [Robot.load(robot) for robot in suite.robots]
    _check_plugins(suite, robots)
    for backend in suite.backends:
        _check_backend_options(backend)
    for lidars in suite.crossed().get("lidar", ()):
        _check_lidars(lidars, robots)
    for text in suite.require:
        _check_requirement(Gate.parse(text), expansion)
    expansion.check_identities()
    expansion.check_settings()


def _check_plugins(suite: SuiteFields, robots: list[Robot]) -> None:
    """Make each of them once for each robot, with a small map that is empty, for localizers with walls around it."""
    cells = np.zeros((20, 20), np.int8)
    grid = OccupancyGrid(cells, 0.05)
    walled = OccupancyGrid(np.pad(cells, 1, constant_values=OCCUPIED), 0.05)  # a localizer needs something to see
    for robot in robots:
        for planner in suite.planners:
            create_planner(planner, robot, grid)
        for controller in suite.controllers:
            create_controller(controller, robot, grid)
        for agent in suite.agents:
            _check_sensed(create_agent(agent, robot, grid), suite)
        for localizer in suite.crossed().get("localizer", ()):
            if localizer is not None:
                check_sees(localizer, robot)
                create_localizer(localizer, walled, robot)
    for smoother in suite.smoothers:
        if smoother is not None:
            create_smoother(smoother)


def _check_sensed(agent: Agent, suite: SuiteFields) -> None:
    """Refuse a policy that needs scans which no simulator of the suite takes."""
    if not isinstance(agent, Policy) or not agent.lidars:
        return
    for backend in suite.backends:
        for lidars in suite.crossed().get("lidar", (False,)):
            chosen = backend.options.get("lidar", False) if lidars is False else lidars
            every = tuple(agent.lidars) if chosen is True else ()
            names = (chosen,) if isinstance(chosen, str) else chosen if isinstance(chosen, list | tuple) else every
            missing = [name for name in agent.lidars if name not in names]
            if missing:
                raise InputError(
                    f"{agent.file.path}: the policy needs scans of the lidar {missing[0]}, and the suite has "
                    f"lidar: {json.dumps(chosen)}; give lidar: true"
                )


def _check_lidars(names: bool | tuple[str, ...], robots: list[Robot]) -> None:
    for robot in robots:
        for name in () if isinstance(names, bool) else names:
            if name not in robot.lidars:
                raise UnknownNameError(f"lidar of {robot.name}", name, robot.lidars)


def _check_requirement(gate: Gate, expansion: Expansion) -> None:
    """Refuse a requirement of a group that the suite does not have."""
    labels = {
        "world": expansion.worlds,
        "robot": expansion.robots,
        "planner": expansion.planners,
        "controller": expansion.controllers,
        "agent": expansion.agents,
        "backend": expansion.backends,
    }
    for label, name in gate.labels.items():
        if label in labels and name not in labels[label]:
            raise UnknownNameError(f"{label} in a requirement of this suite", name, labels[label])


def _check_backend_options(backend: PluginChoice) -> None:
    """Refuse options that a simulator does not take; their values are checked when it is made."""
    if not backend.options:
        return
    maker = cast("Callable[..., object]", SIMULATORS.load(backend.name))
    taken = keywords_taken(maker, backend.options)
    unknown = [name for name in backend.options if name not in taken]
    if unknown:
        raise InputError(f"backend {backend.name!r} has no option {unknown[0]!r}")


def _check_world_options(world: SuiteWorld) -> None:
    if world.is_map:
        check_options(world.name, "a map", world.options, list(MapOptions.model_fields))
    elif not world.is_file:
        parameters = inspect.signature(cast("Any", WORLDS.load(world.name))).parameters.values()
        if not any(parameter.kind is inspect.Parameter.VAR_KEYWORD for parameter in parameters):
            known = [parameter.name for parameter in parameters if parameter.name != "seed"]
            check_options(f"world {world.name!r}", "it", world.options, [*known, "exclude"])
