"""Parts of a suite: its worlds, its missions with their seeds, and its limits."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeAlias, cast

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from trundle.errors import UnknownNameError
from trundle.evaluation.suite.vary import Distribution, draw
from trundle.files.choice import Choice, Option
from trundle.files.yaml_config import Config, NotNegative, PoseNumbers, Positive
from trundle.mission.fields import WorldChoice
from trundle.mission.goal_fields import GoalFields
from trundle.mission.sampling import MIN_DISTANCE
from trundle.worlds.load import is_world_file
from trundle.worlds.world import WORLDS

_MAP_SUFFIXES = (".yaml", ".yml", ".map")


def as_items(given: object) -> object:
    """Convert a single value to a list of one, and a generator or a set to a list."""
    if isinstance(given, list | tuple | range | set | frozenset):
        return cast("object", tuple(cast("Any", given)))
    return (given,)


def read_items(given: object) -> object:
    """Convert a single value to a list of one, and refuse an empty list."""
    items = as_items(given)
    if items == ():
        raise PydanticCustomError("empty", "an empty list: the cross product has no episodes", {})
    return items


def read_lists(given: object) -> object:
    """Read values that are lists themselves: a list of lists is several values, any other list is one."""
    if isinstance(given, list | tuple):
        ones = cast("Sequence[object]", given)
        if ones and all(isinstance(one, list | tuple) for one in ones):
            return tuple(ones)
    return (given,)


_SEED_RANGE = re.compile(r"(\d+):(\d+)(?::(\d+))?")
_SEED_ADVICE = 'a number of seeds, a range "0:500", or a list of integers of 0 or more'
_SEED_BOUND = 2**63
"""Seeds are below it: a row holds them in 64 bits."""


def read_seeds(given: object) -> range | tuple[int, ...]:
    """Read seeds as a suite has them; a range is not expanded.

    Raises:
        ValueError: If these are no seeds; the message says what is.
    """
    if isinstance(given, bool):
        raise ValueError(f"must be {_SEED_ADVICE}, got {given}")
    if isinstance(given, int):
        if given < 0:
            raise ValueError(f"must be {_SEED_ADVICE}, got {given}")
        return range(given)
    if isinstance(given, range):
        return given
    if isinstance(given, str):
        match = _SEED_RANGE.fullmatch(given.strip())
        if match is None or match[3] == "0":
            raise ValueError(f"must be {_SEED_ADVICE}, got {given!r}")
        return range(int(match[1]), int(match[2]), int(match[3] or 1))
    if not isinstance(given, list | tuple):
        raise ValueError(f"must be {_SEED_ADVICE}, got {given!r}")
    seeds = tuple(cast("Sequence[Any]", given))
    if not all(isinstance(seed, int) and not isinstance(seed, bool) and seed >= 0 for seed in seeds):
        raise ValueError(f"must be {_SEED_ADVICE}, got {given!r}")
    if len(set(seeds)) < len(seeds):
        twice = next(seed for seed in seeds if seeds.count(seed) > 1)
        raise ValueError(f"seed {twice} is given twice")
    return seeds


def _check_seeds(given: object) -> object:
    try:
        seeds = read_seeds(given)
        if (seeds.stop if isinstance(seeds, range) else max(seeds, default=0)) > _SEED_BOUND:
            raise ValueError("seeds must be below 2^63")
    except ValueError as error:
        raise PydanticCustomError("seeds", "{message}", {"message": str(error)}) from None
    if not seeds:
        raise PydanticCustomError("no_seeds", "no seeds: the cross product has no episodes", {})
    if isinstance(given, range):
        return f"{given.start}:{given.stop}:{given.step}" if given.step != 1 else f"{given.start}:{given.stop}"
    return given if isinstance(given, int | str) else seeds


Seeds: TypeAlias = Annotated[
    int | str | tuple[int, ...], BeforeValidator(_check_seeds, json_schema_input_type=int | str | list[int])
]
"""Seeds of missions: 20 (0 to 19), "0:500" (0 to 499), "0:500:5", or [1, 2, 3]."""


class ListedMission(Config):
    """A mission by its start and goal.

    Attributes:
        start: (x, y) or (x, y, yaw) [m, m, rad], map frame.
        goal: (x, y), to be reached with any yaw, or (x, y, yaw). Either this or `goals`.
        goals: Several of these, to be reached in order; or waypoints with tasks, `{pose: [5, 3], wait: 2.0}`.
        through: Whether the robot drives through the goals without stopping; by default it stops.
    """

    start: PoseNumbers
    goal: PoseNumbers | None = None
    goals: Annotated[tuple[GoalFields, ...], Field(min_length=1)] | None = None
    through: bool | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.goal is None) == (self.goals is None):
            raise ValueError("give either goal or goals")
        return self


class Missions(Config):
    """Where the robot is to go: sampled from each map by seed, or listed. `"0:500"` stands for `{seeds: "0:500"}`.

    Attributes:
        seeds: Seeds of missions: 20 (0 to 19), "0:500" (0 to 499), "0:500:5" or a list. Everything random in an episode
            follows its seed. Where missions are listed, each is driven with each seed.
        ends: What sampled starts and goals are like: "roomy" with room for a turn on the spot, "tight" free by 0.03 to
            0.25 m.
        min_distance: Between the start and the goal of a roomy mission, in a straight line [m].
        listed: Missions by start and goal, instead of sampled ones.
    """

    seeds: Seeds = 1
    ends: Literal["roomy", "tight"] = "roomy"
    min_distance: NotNegative = MIN_DISTANCE
    listed: Annotated[tuple[ListedMission, ...], BeforeValidator(read_items)] | None = None

    @cached_property
    def _seeds(self) -> range | tuple[int, ...]:
        return read_seeds(self.seeds)

    @cached_property
    def count(self) -> int:
        """Number of missions."""
        seeds = self._seeds
        # A range may be longer than len() can say.
        number = (seeds.stop - seeds.start + seeds.step - 1) // seeds.step if isinstance(seeds, range) else len(seeds)
        return number * (1 if self.listed is None else len(self.listed))

    def at(self, index: int) -> tuple[int, ListedMission | None]:
        """Return the seed and listed mission, if there are any, of one of them."""
        seeds = self._seeds
        if self.listed is None:
            return seeds[index], None
        listed, seed = divmod(index, self.count // len(self.listed))
        return seeds[seed], self.listed[listed]

    def rule(self, listed: ListedMission | None) -> dict[str, Any]:
        """Return how start and goal are chosen, as plain values."""
        if listed is not None:
            return listed.model_dump(mode="json", exclude_none=True)
        return self.model_dump(mode="json", include={"ends", "min_distance"} if self.ends == "roomy" else {"ends"})


def _read_missions(given: object) -> object:
    if isinstance(given, list | tuple) and given and all(isinstance(each, Mapping) for each in given):
        return {"listed": given}
    return given if isinstance(given, Mapping | Missions) or given is None else {"seeds": given}


MissionsField: TypeAlias = Annotated[
    Missions,
    BeforeValidator(_read_missions, json_schema_input_type=int | str | list[int] | list[ListedMission] | Missions),
]


class SuiteWorld(Config):
    """A world of a suite: `warehouse`, `maps/hall.yaml`, `{name: warehouse, options: {…}}`.

    Attributes:
        name: Name of a generated world, or the path of a map's YAML or of a world's file; in a suite's file, relative
            to that file.
        label: What it is called in tables; by default its name.
        seed: Seed of a generated world; by default the mission's, so that each mission has its own world.
        options: Options of the generator, of the file's loader or of a map (height, unknown). Those of a world that is
            no map may be drawn by the mission's seed: `{uniform: [lowest, highest]}`, `{normal: [mean, deviation]}`.
        missions: Missions in this world, instead of the suite's.
        compat: "humble" reads the map and the masks as ROS 2 Humble does.
        keepout: Path of a keep-out mask's YAML.
        speed_mask: Path of a speed mask's YAML.
        floor_z: Height [m] of the floor in the world's file; by default the one under most of the world.
        reference: Path of the file of BARN's reference path in this world, `path_0.npy`: its rows have a `barn_score`.
    """

    name: str
    label: str | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    options: dict[str, Option | Distribution] = Field(default_factory=dict)
    missions: MissionsField | None = None
    compat: Literal["humble"] | None = None
    keepout: str | None = None
    speed_mask: str | None = None
    floor_z: float | None = None
    reference: str | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        drawn = [name for name, value in self.options.items() if isinstance(value, Distribution)]
        if self.is_map and drawn:
            raise ValueError(f"option {drawn[0]} is drawn: that is for worlds; this one is a map")
        if self.is_file and self.seed is not None:
            raise ValueError("seed is for generated worlds; this one is a file")
        if self.compat is not None and not self.is_map:
            raise ValueError("compat says how a map is read; this is none")
        if self.floor_z is not None and self.is_map:
            raise ValueError("floor_z is the height of the floor in a world; this is a map")
        return self

    @property
    def is_file(self) -> bool:
        """Whether it is read from a file."""
        return is_world_file(self.name)

    @property
    def is_map(self) -> bool:
        """Whether it is a map, extruded into a world."""
        return Path(self.name).suffix.lower() in _MAP_SUFFIXES

    @property
    def is_seeded(self) -> bool:
        """Whether each seed has its own world."""
        drawn = any(isinstance(value, Distribution) for value in self.options.values())
        return drawn or (not self.is_file and self.seed is None)

    def files(self) -> dict[str, str]:
        """Return paths of its files, by field."""
        files = {
            "name": self.name if self.is_file else None,
            "keepout": self.keepout,
            "speed_mask": self.speed_mask,
            "reference": self.reference,
        }
        return {field: path for field, path in files.items() if path is not None}

    def draw_options(self, seed: int) -> dict[str, Option]:
        """Return its options with what is drawn by seed, in the order in which they stand."""
        if not any(isinstance(value, Distribution) for value in self.options.values()):
            return cast("dict[str, Option]", dict(self.options))
        rng = np.random.default_rng(seed)
        return {
            name: draw(value, rng) if isinstance(value, Distribution) else value for name, value in self.options.items()
        }

    def settings(self, seed: int) -> dict[str, Any]:
        """Return the fields of a scenario in this world."""
        options = self.draw_options(seed)
        settings: dict[str, Any] = {
            name: getattr(self, name)
            for name in ("compat", "keepout", "speed_mask", "floor_z")
            if getattr(self, name) is not None
        }
        if self.is_map:
            return settings | {"map": self.name} | ({"map_options": options} if options else {})
        return settings | {"world": WorldChoice(name=self.name, options=options, seed=self.seed)}


def _read_world(given: object) -> object:
    if isinstance(given, str | Path):
        return {"name": str(given)}
    if isinstance(given, WorldChoice):
        return given.model_dump(exclude_none=True)
    return given.model_dump() if isinstance(given, Choice) else given


def _check_world(world: SuiteWorld) -> SuiteWorld:
    try:
        if not world.is_file:
            WORLDS.check(world.name)
    except UnknownNameError as error:
        raise PydanticCustomError("unknown_name", "{what}", {"what": str(error)}) from None
    return world


SuiteWorldField: TypeAlias = Annotated[
    SuiteWorld,
    BeforeValidator(_read_world, json_schema_input_type=str | SuiteWorld),
    AfterValidator(_check_world),
]


class Limits(Config):
    """What an episode may take.

    Attributes:
        time_limit_s: Simulated time [s]; by default that of `trundle.run`.
        wall_s: Time on the clock [s] after which an episode is stopped as `hung`.
        memory_mb: Memory [MB] that an episode may take beyond its worker's size; more is `out_of_memory`.
    """

    time_limit_s: Positive | None = None
    wall_s: Positive = 300.0
    memory_mb: Positive = 2000.0
