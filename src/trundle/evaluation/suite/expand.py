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

from trundle.costmap.settings import check_unknown_cost
from trundle.errors import InputError
from trundle.evaluation.suite.fields import SuiteFields
from trundle.evaluation.suite.identity import digest, robot_content, short, world_content, world_of_seed
from trundle.evaluation.suite.parts import ListedMission, Missions, SuiteWorld
from trundle.evaluation.suite.plugin import PluginChoice
from trundle.evaluation.suite.spec import EpisodeSpec
from trundle.evaluation.suite.vary import apply
from trundle.files.choice import Choice
from trundle.files.yaml_config import Config
from trundle.mission import Scenario

_MOST_CHECKED = 1000
_ROLES = ("planner", "controller", "backend")


@dataclass(frozen=True, slots=True)
class _Case:
    """One combination of planner, controller, backend and settings."""

    planner: int
    controller: int
    smoother: int
    backend: int
    settings: tuple[int, ...]


class Expansion:
    """The episodes of a suite, numbered: worlds outside, then robots, missions, planners, controllers, and settings.

    So episodes of one place follow one another. Nothing is expanded: each episode is computed from its number.

    Args:
        suite: The suite.

    Attributes:
        total: Number of episodes.
        cases: Number of combinations of planner, controller, smoother, backend and settings: the episodes of a mission.
        worlds, robots, planners, controllers, backends: Labels.
    """

    def __init__(self, suite: SuiteFields) -> None:
        self._suite = suite
        self._missions: list[Missions] = [world.missions or suite.missions for world in suite.worlds]
        self._settings = suite.crossed()
        self._sizes = [
            len(suite.planners),
            len(suite.controllers),
            len(suite.smoothers),
            len(suite.backends),
            *(len(values) for values in self._settings.values()),
        ]
        self.cases = math.prod(self._sizes)
        per_world = [len(suite.robots) * missions.count * self.cases for missions in self._missions]
        self._ends = list(itertools.accumulate(per_world))
        self.total = self._ends[-1]
        self.worlds = _labels("world", [_world_names(world) for world in suite.worlds])
        self.robots = _labels("robot", [(Path(robot).stem, robot) for robot in suite.robots])
        self.planners, self.controllers, self.backends = (
            _labels(role, [_choice_names(choice) for choice in getattr(suite, f"{role}s")]) for role in _ROLES
        )

    def factors(self) -> dict[str, int]:
        """Sizes of what is crossed, by name."""
        suite = self._suite
        missions = sum(missions.count for missions in self._missions)
        names = ("planners", "controllers", "smoothers", "backends", *self._settings)
        sizes = {
            "missions in all worlds": missions,
            "robots": len(suite.robots),
            **dict(zip(names, self._sizes, strict=True)),
        }
        return {name: size for name, size in sizes.items() if size != 1}

    def missions(self) -> Iterator[tuple[SuiteWorld, Missions]]:
        """Each world with its missions, which each robot drives, in the order of the episodes."""
        return zip(self._suite.worlds, self._missions, strict=True)

    def world_of(self, index: int) -> int:
        """Which of the suite's worlds an episode is in."""
        return self._locate(index)[0]

    def id_of(self, index: int) -> str:
        """Hash of everything that decides an episode."""
        world, robot, mission, case = self._locate(index)
        seed, listed = self._missions[world].at(mission)
        return self._id(world, robot, seed, listed, case)

    def spec(self, index: int) -> EpisodeSpec:
        """Everything that decides an episode.

        Raises:
            InputError: If there is no episode of that number, or a file is not there.
        """
        suite = self._suite
        at_world, at_robot, mission, case = self._locate(index)
        world, missions = suite.worlds[at_world], self._missions[at_world]
        seed, listed = missions.at(mission)
        planner, smoother = suite.planners[case.planner], suite.smoothers[case.smoother]
        settings = {name: values[k] for (name, values), k in zip(self._settings.items(), case.settings, strict=True)}
        scenario = Scenario.make(
            **world.settings(seed),
            **settings,
            **({} if listed is None else listed.model_dump(exclude_none=True)),
            robot=suite.robots[at_robot],
            planner=_named(planner),
            controller=_named(suite.controllers[case.controller]),
            smoother=None if smoother is None else _named(smoother),
            backend=_named(suite.backends[case.backend]),
            seed=seed,
            time_limit_s=suite.limits.time_limit_s,
        )
        drawn = suite.vary.draw(seed)
        return EpisodeSpec(
            index=index,
            id=self._id(at_world, at_robot, seed, listed, case),
            world=self.worlds[at_world],
            robot=self.robots[at_robot],
            planner=self.planners[case.planner],
            controller=self.controllers[case.controller],
            backend=self.backends[case.backend],
            settings=self._describe(case),
            seed=seed,
            scenario=apply(scenario, drawn),
            missions=missions,
            listed=listed,
            plugin=planner,
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
        _refuse_twice("world", self.worlds, worlds)
        _refuse_twice("robot", self.robots, self._robot_digests)
        _refuse_twice("planner", self.planners, digests[0])
        _refuse_twice("controller", self.controllers, digests[1])
        _refuse_twice("smoother", smoothers, digests[2])
        _refuse_twice("backend", self.backends, digests[3])
        for name, values in self._settings.items():
            _refuse_twice(name, [_text(value) for value in values], [digest(value) for value in values])

    def check_settings(self) -> None:
        """Refuse settings that do not go together, and what a backend cannot vary.

        All cases of the first mission are looked at, and the first mission of each world.

        Raises:
            InputError: If there are any.
        """
        for index in {*range(min(self.cases, _MOST_CHECKED)), *self._ends[:-1]}:
            check_unknown_cost(self.spec(index).scenario)

    # Numbers --------------------------------------------------------------------------------------------------------

    def _locate(self, index: int) -> tuple[int, int, int, _Case]:
        """World, robot, mission and case of an episode."""
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
        planner, controller, smoother, backend, *settings = reversed(at)
        return world, robot, mission, _Case(planner, controller, smoother, backend, tuple(settings))

    def _describe(self, case: _Case) -> str:
        """What is crossed beside planners, controllers and backends."""
        parts = [
            f"{name}={_text(values[k])}"
            for (name, values), k in zip(self._settings.items(), case.settings, strict=True)
            if len(values) > 1
        ]
        if len(self._suite.smoothers) > 1:
            parts.insert(0, f"smoother={_label_of(self._suite.smoothers[case.smoother])}")
        return " ".join(parts)

    # Hashes ---------------------------------------------------------------------------------------------------------

    def _id(self, world: int, robot: int, seed: int, listed: ListedMission | None, case: _Case) -> str:
        digests = self._choice_digests
        settings = [values[k] for values, k in zip(self._setting_digests, case.settings, strict=True)]
        return short(
            [
                self._common_digest,
                self._world_digest(world),
                self._robot_digests[robot],
                self._rule_digest(world, listed),
                digests[0][case.planner],
                digests[1][case.controller],
                digests[2][case.smoother],
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

    @cached_property
    def _rules(self) -> dict[tuple[int, int], bytes]:
        return {}

    @cached_property
    def _found_digests(self) -> dict[int, bytes]:
        return {}

    def _world_digest(self, world: int) -> bytes:
        """Of one world, so that an episode can be made where the files of others are missing."""
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
        )
        return [[digest(None if choice is None else choice.identity()) for choice in axis] for axis in axes]

    @cached_property
    def _setting_digests(self) -> list[list[bytes]]:
        """Of each setting's values; a default one counts as none, so that it may be written out or not."""
        defaults = Scenario.model_fields
        return [
            [b"" if value == defaults[name].default else digest([name, value]) for value in values]
            for name, values in self._settings.items()
        ]

    @cached_property
    def _common_digest(self) -> bytes:
        suite = self._suite
        return digest([suite.vary.model_dump(mode="json", exclude_none=True), suite.limits.time_limit_s])


def _named(choice: PluginChoice) -> dict[str, Any]:
    return {"name": choice.name, "options": choice.options}


def _text(value: object) -> str:
    """A value as it stands in tables, without spaces."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, Choice):
        inner = ",".join(f"{name}={_text(one)}" for name, one in value.options.items())
        return f"{value.name}({inner})" if inner else value.name
    if isinstance(value, Config):
        given = value.model_dump(exclude_defaults=True)
        return "{" + ",".join(f"{name}:{_text(getattr(value, name))}" for name in given) + "}"
    if isinstance(value, list | tuple):
        return "+".join(_text(one) for one in cast("Sequence[object]", value)) or "none"
    return "none" if value is None else str(value)


def _label_of(choice: PluginChoice | None) -> str:
    return "none" if choice is None else choice.label or choice.name


def _choice_names(choice: PluginChoice) -> tuple[str, str]:
    if choice.label is not None:
        return choice.label, choice.label
    name = choice.name.rpartition(":")[2]
    return name, f"{choice.name}{_options(choice.options)}"


def _world_names(world: SuiteWorld) -> tuple[str, str]:
    if world.label is not None:
        return world.label, world.label
    name = Path(world.name).stem if world.is_file else world.name
    seed = "" if world.seed is None else f" {world.seed}"
    return name, f"{world.name if world.is_file else name}{seed}{_options(world.options)}"


def _options(options: dict[str, Any]) -> str:
    return f"({', '.join(f'{name}={_text(value)}' for name, value in options.items())})" if options else ""


def _labels(kind: str, names: list[tuple[str, str]]) -> list[str]:
    """One label for each: the short name, or where several have that, the long one."""
    shorts = [name for name, _ in names]
    labels = [name if shorts.count(name) == 1 else long for name, long in names]
    for label in labels:
        if labels.count(label) > 1:
            raise InputError(f"two {kind}s are called {label!r}: leave one out, or give one of them a label")
    return labels


def _refuse_twice(kind: str, names: Sequence[str], digests: Sequence[bytes]) -> None:
    seen: dict[bytes, str] = {}
    for name, its in zip(names, digests, strict=True):
        if its in seen:
            also = "" if seen[its] == name else f", also as {seen[its]}"
            raise InputError(f"{kind} {name} is given twice{also}: each episode would be there twice")
        seen[its] = name
