"""`Scenario`: a mission as a YAML file, and what it is made into before it runs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import yaml

from trundle.costmap import Costmap, CostmapSettings
from trundle.errors import InputError, ScenarioError
from trundle.files.choice import shorten
from trundle.files.field_docs import commented_yaml, describe_fields
from trundle.files.kinds import SCENARIO
from trundle.files.opening import exists
from trundle.files.writing import path_beside, write_text
from trundle.files.yaml_config import build, load_config
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode
from trundle.mission.fields import ScenarioFields
from trundle.mission.goal_fields import exact_goals, make_goal, shorten_goal
from trundle.mission.observers import Observer
from trundle.mission.run_files import load_directives
from trundle.mission.running.session import Session
from trundle.mission.sampling import sample_mission
from trundle.mission.setup import Place, make_place, session_options, start_backend, wrap_backend
from trundle.mission.steering.queue import Steering
from trundle.navigation import Agent, Navigator, NavigatorSettings
from trundle.navigation.agents import create_agent
from trundle.navigation.behaviors.behavior import shorten_behavior
from trundle.registry import is_model_file
from trundle.robots import Robot, is_robot_file
from trundle.sim import Simulator
from trundle.values import as_path
from trundle.worlds import World

PLUGINS = ("planner", "controller", "smoother", "agent", "localizer")
"""Fields of a scenario that choose a plug-in."""


class Scenario(ScenarioFields):
    """Everything that a run depends on. The same scenario gives the same run, bit for bit, on one machine.

    Its fields are those of `ScenarioFields`, with those of `CostmapSettings` and `RunSettings`.
    """

    @classmethod
    def make(cls, **settings: Any) -> Self:
        """Make a scenario from keywords; `Scenario(…)` with errors as everywhere in trundle.

        Raises:
            ScenarioError: If a setting cannot be used; one line for each.
        """
        try:
            return build(settings, cls)
        except InputError as error:
            raise ScenarioError(str(error)) from error

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a scenario from YAML. Relative paths in it are relative to its folder.

        Args:
            path: The file, or the folder of a run, which has its exact scenario.

        Raises:
            ScenarioError: If it cannot be used; every mistake is listed as file:line:column.
        """
        try:
            place = Path(as_path(path, "a scenario's file"))
            if exists(place) and place.is_dir():
                path = Path(path) / "scenario.yaml"
            scenario = load_config(path, cls, kind=SCENARIO)
        except InputError as error:
            raise ScenarioError(str(error)) from error
        folder = Path(path).parent
        return scenario._with_paths({name: str(folder / value) for name, value in scenario._paths().items()})

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as YAML that `load` reads back as the same scenario.

        Files below the current folder are named relative to the YAML, where that is below it too; others in full.

        Raises:
            OutputError: If it cannot be written.
        """
        settings = self._plain_for(path)
        write_text(
            path, yaml.safe_dump(settings, sort_keys=False, default_flow_style=None, allow_unicode=True), durable=True
        )

    def save_commented(self, path: str | os.PathLike[str]) -> None:
        """Write it as `save` does, for a person to edit: with a comment on every field there is.

        Fields that have their default are commented out.

        Raises:
            OutputError: If it cannot be written.
        """
        head = "# A scenario. `trundle run FILE` drives it; a line that begins with # shows a field's default.\n"
        write_text(path, head + commented_yaml(self, self._plain_for(path)), durable=True)

    def _plain_for(self, path: str | os.PathLike[str]) -> dict[str, Any]:
        """Plain values for a YAML at this path, which its files are named relative to; its own fields first."""
        paths = {key: path_beside(value, path) for key, value in self._paths().items()}
        if self.directives is not None and Path(self.directives).absolute().parent == Path(path).absolute().parent:
            paths["directives"] = Path(self.directives).name  # of a run's folder, which may be moved
        return self._with_paths(paths).plain()

    def plain(self) -> dict[str, Any]:
        """Return its settings as plain values, in the short forms of its YAML."""
        dumped = self.model_dump(mode="json", exclude_none=True)
        settings = {key: dumped[key] for key in describe_fields(type(self)) if key in dumped}
        for key in ("world", *PLUGINS, "backend", "record"):
            if key in settings:
                settings[key] = shorten(settings[key])
        if "goals" in settings:
            settings["goals"] = [shorten_goal(goal) for goal in settings["goals"]]
        if "recovery" in settings:
            settings["recovery"] = [shorten_behavior(step) for step in settings["recovery"]]
        if self.layers is not None and self.layers.obstacle is None:
            settings["layers"]["obstacle"] = None  # its default is something else
        return settings

    def __repr__(self) -> str:
        place = self.map if self.world is None else self.world.name
        return f"Scenario({self.title!r}, {self.robot} in {place}, {self.backend.name}, seed {self.seed})"

    def __str__(self) -> str:
        return repr(self)

    def prepare(
        self, place: Place | None = None, *, costmap: Costmap | None = None, navigator: Navigator | None = None
    ) -> Setting:
        """Make world, robot, map and navigator, and pick the start and the goal that are not given.

        Args:
            place: World, robot and map, where they were made before, by `make_place` of a scenario that has the same.
            costmap: What `make_costmap` made of that place before.
            navigator: What was made before for a scenario with the same planner, controller, smoother and settings, of
                this costmap; it forgets everything when a run begins.

        Raises:
            UnknownNameError: If a name is not known; the nearest is offered.
            InputError: If a file or an option cannot be used.
            ScenarioError: If no start or goal can be picked.
        """
        place = make_place(self) if place is None else place
        robot = self.assumed_robot(place.robot)
        seen = self.part(CostmapSettings)
        if costmap is None:
            costmap = seen.make_costmap(place.grid, robot, keepout=place.keepout)
        start, goals = self._pick_ends(costmap)
        ends = (start.as_tuple(), *goals)
        world = place.world
        if self.unmapped is not None:
            world = self.unmapped.add_to(world, costmap, ends, self.seed)
        grid = place.grid
        if self.map_errors is not None:
            grid = self.map_errors.change(grid, costmap, ends, self.seed)
            costmap = seen.make_costmap(grid, robot, keepout=place.keepout)
        if not self.known_map and seen.unknown == "blocked":
            seen = seen.model_copy(update={"unknown": "costly"})
        navigator = navigator or Navigator(
            (grid, costmap) if self.known_map else None,
            robot,
            costmap=None if self.known_map else seen,
            layers=self.layers,
            planner=self.planner,
            controller=self.controller,
            smoother=self.smoother,
            settings=self.part(NavigatorSettings),
            speed_mask=place.speed_mask,
        )
        agent = (
            navigator if self.agent is None else create_agent(self.agent, robot, navigator.grid, navigator=navigator)
        )
        goals = goals if agent.takes_goals else ()
        exact = self.model_copy(
            update={
                "floor_z": self.floor_z if place.floor_z == 0.0 else place.floor_z,
                "start": start.as_tuple(),
                **(exact_goals(goals, self.goals) if goals else {"goal": None, "goals": None}),
            }
        )
        return Setting(exact, world, place.robot, grid, navigator, agent, start, goals)

    def build(self) -> Mission:
        """Prepare it, and start its simulator; see `prepare` for the errors."""
        setting = self.prepare()
        sim = wrap_backend(self, start_backend(self, setting.world, setting.robot))
        return setting.with_simulator(sim)

    def assumed_robot(self, robot: Robot) -> Robot:
        """Return what its software takes a robot for: the robot itself, unless `assumed` says otherwise."""
        return robot if self.assumed is None else self.assumed.of(robot)

    @property
    def title(self) -> str:
        """Its name, or robot and place, fit for a folder's name."""
        if self.name is not None:
            return self.name
        place = Path(self.map or "").stem if self.world is None else Path(self.world.name).stem
        return f"{Path(self.robot).stem}-{place}"

    def _paths(self) -> dict[str, str]:
        files = {
            "map": self.map,
            "keepout": self.keepout,
            "speed_mask": self.speed_mask,
            "directives": self.directives,
        }
        paths = {key: path for key, path in files.items() if path is not None}
        if is_robot_file(self.robot):
            paths["robot"] = self.robot
        if self.world is not None and self.world.is_file:
            paths["world"] = self.world.name
        if self.agent is not None and is_model_file(self.agent.name):
            paths["agent"] = self.agent.name
        return paths

    def _with_paths(self, paths: dict[str, str]) -> Self:
        update: dict[str, object] = dict(paths)
        if self.world is not None and "world" in paths:
            update["world"] = self.world.model_copy(update={"name": paths["world"]})
        if self.agent is not None and "agent" in paths:
            update["agent"] = self.agent.model_copy(update={"name": paths["agent"]})
        return self.model_copy(update=update)

    def _pick_ends(self, costmap: Costmap) -> tuple[Pose2D, tuple[Goal, ...]]:
        given = self.goals if self.goals is not None else () if self.goal is None else (self.goal,)
        goals = tuple(make_goal(one) for one in given)
        start = None if self.start is None else Pose2D.of(self.start)
        if start is not None and goals:
            return start, goals
        first, last = sample_mission(
            costmap, self.seed, start=start, goal=goals[0] if start is None and goals else None
        )
        return first, goals or (Goal.of(last),)


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What a scenario is made into before anything moves.

    Attributes:
        scenario: The exact scenario, with the start and the goals that were picked.
        world: The world.
        robot: The robot.
        grid: The map that the robot has, with its errors.
        navigator: Planner, controller and recovery.
        agent: What drives: the navigator, unless the scenario has another agent.
        start: The start pose.
        goals: The goals, in order; none for an agent that drives without them.
    """

    scenario: Scenario
    world: World
    robot: Robot
    grid: OccupancyGrid
    navigator: Navigator
    agent: Agent
    start: Pose2D
    goals: tuple[Goal, ...]

    def with_simulator(self, sim: Simulator) -> Mission:
        """Return the mission that is driven in a simulator, which it closes."""
        return Mission(**{field.name: getattr(self, field.name) for field in fields(self)}, sim=sim)


@dataclass(frozen=True, slots=True, eq=False)
class Mission(Setting):
    """A scenario that is ready to run; close it, or use it in a `with` block.

    Attributes:
        sim: The simulator.
    """

    sim: Simulator

    def run(self, *, observers: Sequence[Observer] = (), stop_on_contact: bool = True) -> Episode:
        """Run it once; see `trundle.run` for the errors."""
        return self.session(observers=observers, stop_on_contact=stop_on_contact).run()

    def session(
        self,
        *,
        observers: Sequence[Observer] = (),
        stop_on_contact: bool = True,
        steering: Steering | None = None,
    ) -> Session:
        """Begin to run it, steered by directives where `steering` is given; see `Session` for the errors."""
        return Session(
            self.sim,
            self.agent,
            self.start,
            self.goals or None,
            time_limit_s=self.scenario.time_limit_s,
            observers=observers,
            seed=self.scenario.seed,
            stop_on_contact=stop_on_contact,
            name=self.scenario.title,
            steering=steering,
            directives=() if self.scenario.directives is None else load_directives(self.scenario.directives),
            **session_options(self.scenario, self.grid, self.navigator.robot),
        )

    def close(self) -> None:
        """Close the simulator."""
        self.sim.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
