"""`Expansion`: the episodes of a suite by number, each made only when it is asked for."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, cast

from trundle.costmap.costmap_settings import check_unknown_cost
from trundle.errors import InputError
from trundle.evaluation.row import NAVIGATOR
from trundle.evaluation.suite.fields import PluginChoice, SuiteFields, identity_of
from trundle.evaluation.suite.identity import EpisodeSpec, digest, robot_content, short, world_content, world_of_seed
from trundle.evaluation.suite.parts import ListedMission, Missions, SuiteWorld
from trundle.evaluation.suite.vary import apply
from trundle.files.choice import Choice
from trundle.files.yaml_config import Config
from trundle.mission import Scenario
from trundle.mission.batch.needs import BATCH, CONTROLLERS, needs_python
from trundle.registry import is_model_file

_MOST_CHECKED = 1000

NO_PLANNER = "none"
"""The planner in the rows of agents."""


@dataclass(frozen=True, slots=True)
class _Driver:
    """The driver of an episode: a planner with a controller and a smoother, or an agent instead."""

    planner: int = 0
    controller: int = 0
    smoother: int = 0
    agent: int | None = None


@dataclass(frozen=True, slots=True)
class _Case:
    """One combination of what drives, backend and settings."""

    driver: _Driver
    backend: int
    settings: tuple[int, ...]


class Expansion:
    """The episodes of a suite, numbered: worlds outside, then robots, missions, planners, controllers, and settings.

    So episodes of one place follow one another. Nothing is expanded: each episode is computed from its number.

    Args:
        suite: The suite.

    Attributes:
        total: Number of episodes.
        cases: Number of combinations of what drives, smoother, backend and settings: the episodes of a mission.
        worlds, robots, planners, controllers, backends: Labels; agents are among the controllers, with NO_PLANNER.
    """

    def __init__(self, suite: SuiteFields) -> None:
        self._suite = suite
        self._missions: list[Missions] = [world.missions or suite.missions for world in suite.worlds]
        self._settings = suite.crossed()
        crossed = (suite.planners, suite.controllers, suite.smoothers)
        self._drivers = [_Driver(*places) for places in itertools.product(*(range(len(axis)) for axis in crossed))]
        if suite.agents:
            alone = suite.model_fields_set.isdisjoint(("planners", "controllers", "smoothers"))
            agents = [_Driver(agent=k) for k in range(len(suite.agents))]
            self._drivers = agents if alone else self._drivers + agents
        self._sizes = [
            len(self._drivers),
            len(suite.backends),
            *(len(values) for values in self._settings.values()),
        ]
        self.cases = math.prod(self._sizes)
        per_world = [len(suite.robots) * missions.count * self.cases for missions in self._missions]
        self._ends = list(itertools.accumulate(per_world))
        self.total = self._ends[-1]
        self.worlds = _labels("worlds", [_world_names(world) for world in suite.worlds])
        self.robots = _labels("robots", [(Path(robot).stem, robot) for robot in suite.robots])
        planners, controllers = (suite.planners, suite.controllers) if self._drivers[0].agent is None else ((), ())
        self.planners = _labels("planners", [_choice_names(choice) for choice in planners])
        driving = [_choice_names(choice) for choice in (*controllers, *suite.agents)]
        self.controllers = _labels("controllers or agents" if suite.agents else "controllers", driving)
        self.backends = _labels("backends", [_choice_names(choice) for choice in suite.backends])
        self._first_agent = len(controllers)
        self._rules: dict[tuple[int, int], bytes] = {}
        self._found_digests: dict[int, bytes] = {}
        if suite.agents:
            self.planners.append(NO_PLANNER)

    def factors(self) -> dict[str, int]:
        """Return the sizes of what is crossed, by name."""
        suite = self._suite
        missions = sum(missions.count for missions in self._missions)
        driving = "planners, controllers and agents" if suite.agents else "planners and controllers"
        names = (driving, "backends", *self._settings)
        sizes = {
            "missions in all worlds": missions,
            "robots": len(suite.robots),
            **dict(zip(names, self._sizes, strict=True)),
        }
        return {name: size for name, size in sizes.items() if size != 1}

    @property
    def agents(self) -> list[str]:
        """Labels of what drives, as rows have them under `agent`."""
        own = self.controllers[self._first_agent :]
        return own if len(own) == len(self._drivers) else [NAVIGATOR, *own]

    def missions(self) -> Iterator[tuple[SuiteWorld, Missions]]:
        """Yield each world with its missions, which each robot drives, in the order of the episodes."""
        return zip(self._suite.worlds, self._missions, strict=True)

    def world_of(self, index: int) -> int:
        """Return which of the suite's worlds an episode is in."""
        return self._locate(index)[0]

    def id_of(self, index: int) -> str:
        """Return the hash of everything that decides an episode."""
        world, robot, mission, case = self._locate(index)
        seed, listed = self._missions[world].at(mission)
        return self._id(world, robot, seed, listed, case)

    def spec(self, index: int) -> EpisodeSpec:
        """Return everything that decides an episode.

        Raises:
            InputError: If there is no episode of that number, or a file is not there.
        """
        suite = self._suite
        at_world, at_robot, mission, case = self._locate(index)
        world, missions = suite.worlds[at_world], self._missions[at_world]
        seed, listed = missions.at(mission)
        driver = case.driver
        settings = {
            name: _unlabelled(values[k])
            for (name, values), k in zip(self._settings.items(), case.settings, strict=True)
        }
        scenario = Scenario.make(
            **world.settings(seed),
            **settings,
            **({} if listed is None else listed.model_dump(exclude_none=True)),
            robot=suite.robots[at_robot],
            **self._driving(driver),
            backend=suite.backends[case.backend].plain(),
            seed=seed,
            time_limit_s=suite.limits.time_limit_s,
        )
        drawn = suite.vary.draw(seed)
        return EpisodeSpec(
            index=index,
            id=self._id(at_world, at_robot, seed, listed, case),
            world=self.worlds[at_world],
            robot=self.robots[at_robot],
            planner=self.planners[driver.planner if driver.agent is None else -1],
            controller=self.controllers[
                driver.controller if driver.agent is None else self._first_agent + driver.agent
            ],
            agent=NAVIGATOR if driver.agent is None else self.controllers[self._first_agent + driver.agent],
            backend=self.backends[case.backend],
            settings=self._describe(case),
            seed=seed,
            scenario=apply(scenario, drawn),
            missions=missions,
            listed=listed,
            vary=drawn,
            reference=world.reference,
            content=(
                world_of_seed(world, self._world_digest(at_world), seed).hex(),
                self._robot_digests[at_robot].hex(),
            ),
        )

    def check_identities(self) -> None:
        """Refuse what is given twice: each episode would be there twice.

        Raises:
            InputError: If something is.
        """
        digests = self._choice_digests
        in_world = [digest(missions.model_dump(mode="json")) for missions in self._missions]
        own = [self._world_digest(world) for world in range(len(in_world))]
        worlds = [world + missions for world, missions in zip(own, in_world, strict=True)]
        smoothers = [_label_of(smoother) for smoother in self._suite.smoothers]
        agents = [_label_of(agent) for agent in self._suite.agents]
        _refuse_twice("world", self.worlds, worlds)
        _refuse_twice("robot", self.robots, self._robot_digests)
        _refuse_twice("planner", self.planners[: len(digests[0])], digests[0])
        _refuse_twice("controller", self.controllers[: len(digests[1])], digests[1])
        _refuse_twice("smoother", smoothers, digests[2])
        _refuse_twice("backend", self.backends, digests[3])
        _refuse_twice("agent", agents, digests[4])
        for name, values in self._settings.items():
            texts = [_text(value) for value in values]
            _refuse_twice(name, texts, [digest(_content(value)) for value in values])
            _labels(f"{name}s" if name == "localizer" else f"values of {name}", [(text, text) for text in texts])

    def check_settings(self) -> None:
        """Refuse settings that do not go together, and what a backend cannot vary.

        All cases of the first mission are looked at, and the first mission of each world.

        Raises:
            InputError: If there are any.
        """
        for index in {*range(min(self.cases, _MOST_CHECKED)), *self._ends[:-1]}:
            scenario = self.spec(index).scenario
            check_unknown_cost(scenario)
            if scenario.backend.name == BATCH and (needs := needs_python(scenario)):
                raise InputError(
                    f"the backend {BATCH!r} drives missions that need nothing but to follow a path by "
                    f"{' or '.join(CONTROLLERS)}; this suite has {', '.join(needs)}: take that out, or give "
                    "--backends kinematic"
                )

    # Numbers --------------------------------------------------------------------------------------------------------

    def _locate(self, index: int) -> tuple[int, int, int, _Case]:
        """Return the world, robot, mission and case of an episode."""
        if not 0 <= index < self.total:
            raise InputError(f"there is no episode {index}: the suite has {self.total:,}")
        world = bisect.bisect_right(self._ends, index)
        rest = index - (self._ends[world - 1] if world else 0)
        rest, case = divmod(rest, self.cases)
        robot, mission = divmod(rest, self._missions[world].count)
        at: list[int] = []
        for size in reversed(self._sizes):
            case, one = divmod(case, size)
            at.append(one)
        driver, backend, *settings = reversed(at)
        return world, robot, mission, _Case(self._drivers[driver], backend, tuple(settings))

    def _driving(self, driver: _Driver) -> dict[str, Choice | None]:
        """Return the fields of a scenario that say what drives."""
        suite = self._suite
        if driver.agent is not None:
            return {"agent": suite.agents[driver.agent].plain()}
        smoother = suite.smoothers[driver.smoother]
        return {
            "planner": suite.planners[driver.planner].plain(),
            "controller": suite.controllers[driver.controller].plain(),
            "smoother": None if smoother is None else smoother.plain(),
        }

    def _describe(self, case: _Case) -> str:
        """Return the label of the settings that are crossed beside planners, controllers and backends."""
        parts = [
            f"{name}={_text(values[k])}"
            for (name, values), k in zip(self._settings.items(), case.settings, strict=True)
            if len(values) > 1
        ]
        if len(self._suite.smoothers) > 1 and case.driver.agent is None:
            parts.insert(0, f"smoother={_label_of(self._suite.smoothers[case.driver.smoother])}")
        return " ".join(parts)

    # Hashes ---------------------------------------------------------------------------------------------------------

    def _id(self, world: int, robot: int, seed: int, listed: ListedMission | None, case: _Case) -> str:
        digests = self._choice_digests
        settings = [values[k] for values, k in zip(self._setting_digests, case.settings, strict=True)]
        driver = case.driver
        axes = ((0, driver.planner), (1, driver.controller), (2, driver.smoother))
        return short(
            [
                self._common_digest,
                self._world_digest(world),
                self._robot_digests[robot],
                self._rule_digest(world, listed),
                *(digests[axis][k] for axis, k in (axes if driver.agent is None else ((4, driver.agent),))),
                digests[3][case.backend],
                *sorted(settings),
                seed.to_bytes(16, "big"),
            ]
        )

    def _rule_digest(self, world: int, listed: ListedMission | None) -> bytes:
        key = (world, id(listed))
        if key not in self._rules:
            self._rules[key] = digest(self._missions[world].rule(listed))
        return self._rules[key]

    def _world_digest(self, world: int) -> bytes:
        """Return the hash of one world's content; of one alone, as the files of others may be missing."""
        if world not in self._found_digests:
            self._found_digests[world] = world_content(self._suite.worlds[world])
        return self._found_digests[world]

    @cached_property
    def _robot_digests(self) -> list[bytes]:
        return [robot_content(robot) for robot in self._suite.robots]

    @cached_property
    def _choice_digests(self) -> list[list[bytes]]:
        suite = self._suite
        axes: Sequence[Sequence[PluginChoice | None]] = (
            suite.planners,
            suite.controllers,
            suite.smoothers,
            suite.backends,
            suite.agents,
        )
        return [[digest(None if choice is None else identity_of(choice)) for choice in axis] for axis in axes]

    @cached_property
    def _setting_digests(self) -> list[list[bytes]]:
        """The hashes of each setting's values; a default counts as none, so that it may be written out or not."""
        defaults = Scenario.model_fields
        return [
            [b"" if value == defaults[name].default else digest([name, _content(value)]) for value in values]
            for name, values in self._settings.items()
        ]

    @cached_property
    def _common_digest(self) -> bytes:
        suite = self._suite
        return digest([suite.vary.model_dump(mode="json", exclude_none=True), suite.limits.time_limit_s])


def _content(value: object) -> object:
    """Return what decides how a setting's value acts."""
    value = _unlabelled(value)
    return identity_of(value) if isinstance(value, Choice) and value.is_python else value


def _unlabelled(value: Any) -> Any:
    """Return a setting's value as a scenario has it."""
    return value.plain() if isinstance(value, PluginChoice) else value


def _text(value: object) -> str:
    """Return a value as it stands in tables, without spaces."""
    if isinstance(value, PluginChoice) and value.label is not None:
        return value.label.replace(" ", "_")
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, Choice):
        inner = ",".join(f"{name}={_text(one)}" for name, one in value.options.items())
        return f"{value.short_name}({inner})" if inner else value.short_name
    if isinstance(value, Config):
        given = value.model_dump(exclude_defaults=True)
        return "{" + ",".join(f"{name}:{_text(getattr(value, name))}" for name in given) + "}"
    if isinstance(value, list | tuple):
        return "+".join(_text(one) for one in cast("Sequence[object]", value)) or "none"
    return "none" if value is None else str(value)


def _label_of(choice: PluginChoice | None) -> str:
    return "none" if choice is None else choice.label or choice.short_name


def _choice_names(choice: PluginChoice) -> tuple[str, str]:
    if choice.label is not None:
        return choice.label, choice.label
    if is_model_file(choice.name):
        return choice.short_name, f"{choice.name}{_options(choice.options)}"
    name = choice.name.rpartition(":")[2]
    return name, f"{choice.short_name}{_options(choice.options)}"


def _world_names(world: SuiteWorld) -> tuple[str, str]:
    if world.label is not None:
        return world.label, world.label
    name = Path(world.name).stem if world.is_file else world.name
    seed = "" if world.seed is None else f" {world.seed}"
    return name, f"{world.name if world.is_file else name}{seed}{_options(world.options)}"


def _options(options: dict[str, Any]) -> str:
    return f"({', '.join(f'{name}={_text(value)}' for name, value in options.items())})" if options else ""


def _labels(kinds: str, names: list[tuple[str, str]]) -> list[str]:
    """Return a label for each: the short name, or where several have that, the long one."""
    shorts = [name for name, _ in names]
    labels = [name if shorts.count(name) == 1 else long for name, long in names]
    for label in labels:
        if labels.count(label) > 1:
            raise InputError(f"two {kinds} are called {label!r}: leave one out, or give one of them a label")
    return labels


def _refuse_twice(kind: str, names: Sequence[str], digests: Sequence[bytes]) -> None:
    seen: dict[bytes, str] = {}
    for name, its in zip(names, digests, strict=True):
        if its in seen:
            also = "" if seen[its] == name else f", also as {seen[its]}"
            raise InputError(f"{kind} {name} is given twice{also}: each episode would be there twice")
        seen[its] = name
