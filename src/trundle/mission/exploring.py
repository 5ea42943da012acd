"""`explore`: a robot drives through an unknown world until nothing is left to see, and returns its map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, cast

from trundle.errors import InputError, ScenarioError
from trundle.mapping.pose_graph import PoseGraph
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode, Outcome
from trundle.mission.fields import WorldChoice
from trundle.mission.observers import Observer
from trundle.mission.own_map import Correction
from trundle.mission.scenario import Mission, Scenario
from trundle.navigation.exploration import Explorer, Frontier, GivenUp
from trundle.worlds.world import world_options

EXPLORER = "explorer"
INSTEAD: Mapping[str, object] = MappingProxyType({"lidar": True, "localizer": "slam", "agent": EXPLORER})
"""What the fields of an exploration are where nothing else is given."""

_LOW_OBJECTS = "low_objects"
"""Option of generators whose worlds have objects that the beams of a planar lidar pass over or under."""


@dataclass(frozen=True, slots=True, eq=False)
class Exploration:
    """What came of an exploration.

    Attributes:
        episode: The run: FINISHED where nothing is left to see.
        grid: The map; None where the run ended before there was one.
        graph: Poses, scans and loops that the map was drawn from; None where the localizer does not say.
        given_up: Frontiers that could not be looked at, each with the reason.
        open: Frontiers that were left when the run ended: none, unless it was stopped.
        corrections: The largest corrections of the estimate, the largest first.
    """

    episode: Episode
    grid: OccupancyGrid | None
    graph: PoseGraph | None
    given_up: tuple[GivenUp, ...]
    open: tuple[Frontier, ...]
    corrections: tuple[Correction, ...]

    @property
    def finished(self) -> bool:
        """Whether nothing that the robot can reach is left to see."""
        return self.episode.outcome is Outcome.FINISHED

    @property
    def message(self) -> str:
        """How it ended, in words."""
        return self.episode.message


def explore(
    world: str | Scenario, robot: str | None = None, *, observers: Sequence[Observer] = (), **settings: Any
) -> Exploration:
    """Explore a world that the robot does not know: it drives to frontiers, and maps what it sees.

        exploration = trundle.explore("warehouse", seed=3, time_limit_s=600)
        exploration.grid.save("map.yaml")

    Args:
        world: A generated world by name, a world's file, or a whole scenario.
        robot: The robot, by catalogue name or file; by default that of the scenario.
        observers: Notified of the run.
        settings: Fields of a `Scenario`, such as `seed`, `start`, `controller`, `odometry`, `movers`, `localizer` and
            `time_limit_s`.

    Returns:
        The map, and what was left. A time limit and a contact are outcomes, not exceptions.

    Raises:
        InputError: If a setting cannot be used; see `Scenario.make`.
    """
    base: dict[str, Any] = world.model_dump() if isinstance(world, Scenario) else {"world": {"name": world}}
    unset = {name: value for name, value in INSTEAD.items() if not base.get(name)}
    changes = settings if robot is None else {"robot": robot, **settings}
    with exploring(Scenario.make(**{**base, **unset, **changes})).build() as mission:
        return conclude(mission, mission.run(observers=observers))


def exploring(scenario: Scenario) -> Scenario:
    """Return a scenario in which the robot explores: without a map or goals, with lidars, `slam` and the explorer.

    Generated worlds get no objects that the lidars do not see, unless their option `low_objects` is given.

    Raises:
        ScenarioError: If it has goals, or another agent.
    """
    if scenario.goal is not None or scenario.goals is not None:
        raise ScenarioError("an exploration has no goal: it ends when nothing is left to see; leave the goal out")
    if scenario.agent is not None and scenario.agent.name != EXPLORER:
        raise ScenarioError(f"an exploration is driven by the agent {EXPLORER!r}, not by {scenario.agent.name!r}")
    if scenario.map_errors is not None:
        raise ScenarioError("an exploration begins without a map: leave map_errors out")
    changes = {name: value for name, value in INSTEAD.items() if not getattr(scenario, name)} | {"known_map": False}
    world = scenario.world
    takes = () if world is None or world.is_file else world_options(world.name) or ()
    if world is not None and _LOW_OBJECTS in takes and _LOW_OBJECTS not in world.options:
        options = {**cast("dict[str, object]", world.options), _LOW_OBJECTS: False}
        changes["world"] = WorldChoice(name=world.name, options=cast("Any", options), seed=world.seed)
    return Scenario.make(**{**scenario.model_dump(), **changes})


def conclude(mission: Mission, episode: Episode) -> Exploration:
    """Return what came of a mission of `exploring(…)`.

    Raises:
        InputError: If another agent drove.
    """
    agent = mission.agent
    if not isinstance(agent, Explorer):
        raise InputError(f"an exploration is driven by an Explorer, not by {type(agent).__name__}")
    own = episode.own_map
    lost = agent.given_up
    places = {(one.x, one.y) for one in lost}
    left = (
        ()
        if episode.outcome is Outcome.FINISHED
        else tuple(one for one in agent.frontiers if (one.x, one.y) not in places)
    )
    return Exploration(
        episode,
        None if own is None else own.grid,
        None if own is None else own.graph,
        lost,
        left,
        () if own is None else tuple(own.corrections),
    )
