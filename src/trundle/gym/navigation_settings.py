"""`NavigationSettings`: what an environment is made of, checked; `Variation`: what differs from episode to episode."""

from __future__ import annotations

import difflib
import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Literal, Self, TypeAlias

import numpy as np
from pydantic import ValidationError

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.suite.vary import RANGES as RANGES_OF_SUITES
from trundle.evaluation.suite.vary import Distribution
from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim.lidar import LidarChoice, choose_lidars
from trundle.sim.ramp import count_steps
from trundle.values import check_count, check_flag, check_number, show_value
from trundle.worlds import World

_NEUTRAL = {"wheel_radius": 1.0, "track": 1.0, "lidar_noise": 0.0, "lidar_dropout": 0.0}

RANGES = {name: RANGES_OF_SUITES[name] for name in _NEUTRAL}
"""What a kinematic environment varies, and its least and largest value; noise in metres, dropouts as a share."""

_ELSEWHERE = {
    "friction": "it needs physics: vary it in a suite with the backend mujoco",
    "mass": "it needs physics: vary it in a suite with the backend mujoco",
    "odometry_scale": "the environment observes the true pose; vary it in a suite",
    "odometry_heading": "the environment observes the true pose; vary it in a suite",
    "odometry_slip": "the environment observes the true pose; vary it in a suite",
    "start_pose": "each episode has another start anyway",
    "latency_s": "the environment has no latency yet; vary it in a suite",
}


class Variation:
    """Distributions by name, drawn for an episode by its robot's seed and the number of the episode.

    Args:
        distributions: For each name, one of `RANGES`, a number or a distribution.

    Raises:
        UnknownNameError: If a name is not known.
        InputError: If a name needs more than a kinematic model, or a value is out of range.
    """

    def __init__(self, distributions: Mapping[str, float | Distribution]) -> None:
        self._distributions = dict(distributions)

    @classmethod
    def of(cls, vary: Mapping[str, Any] | Variation) -> Self:
        """Create from a mapping as a suite's `vary` is: numbers, `{uniform: [low, high]}` or `{normal: […]}`."""
        if isinstance(vary, cls):
            return vary
        if not isinstance(vary, Mapping):
            raise InputError(f"vary must be a mapping from names to distributions, got {vary!r}")
        read: dict[str, float | Distribution] = {}
        for name, value in vary.items():
            if name in _ELSEWHERE:
                raise InputError(f"vary: {name} cannot be varied in an environment: {_ELSEWHERE[name]}")
            if name not in RANGES:
                raise UnknownNameError("name to vary", str(name), RANGES)
            read[name] = _read(name, value)
        return cls(read)

    def __bool__(self) -> bool:
        return bool(self._distributions)

    def draw(self, seed: int, episode: int) -> dict[str, float]:
        """Draw every value of an episode; what is not varied is neutral."""
        drawn = dict(_NEUTRAL)
        for name, value in self._distributions.items():
            if isinstance(value, Distribution):
                value = value.draw(np.random.default_rng([seed, episode, zlib.crc32(name.encode())]))
            drawn[name] = value
        return drawn

    def draw_many(self, seeds: Any, episodes: Any) -> dict[str, FloatArray]:
        """Draw for many robots, shape (n,) of each name."""
        if not self._distributions:
            return {name: np.full(len(seeds), value) for name, value in _NEUTRAL.items()}
        rows = [self.draw(int(seed), int(episode)) for seed, episode in zip(seeds, episodes, strict=True)]
        return {name: np.array([row[name] for row in rows]) for name in _NEUTRAL}


def _read(name: str, value: object) -> float | Distribution:
    if isinstance(value, Mapping):
        try:
            value = Distribution.model_validate(dict(value))
        except ValidationError as error:
            raise InputError(f"vary: {name}: {error.errors()[0]['msg']}") from None
    if isinstance(value, Distribution):
        low, high = value.support
    elif isinstance(value, int | float) and not isinstance(value, bool):
        low = high = float(value)
    else:
        raise InputError(f"vary: {name} must be a number, {{uniform: [low, high]}} or {{normal: […]}}, got {value!r}")
    least, most = RANGES[name]
    if not (least <= low <= high <= most):
        raise InputError(
            f"vary: {name} {low:.4g} to {high:.4g} is out of range: it must stay within {least:g} and {most:g}"
        )
    return value if isinstance(value, Distribution) else low


Split: TypeAlias = Literal["train", "validation", "test"]
SPLITS: tuple[Split, ...] = ("train", "validation", "test")

REWARDS = {"progress": 1.0, "success": 10.0, "contact": -10.0, "time": -0.01}
"""The reward terms of an environment that is given none, and their weights."""

REWARD_TERMS = {
    "progress": "metres that the shortest path to the goal has become shorter",
    "success": "1 on arrival",
    "contact": "1 on contact, or beyond the map",
    "time": "1 in every step",
    "smoothness": "squared change of the scaled action",
    "reverse": "metres driven backwards",
}
"""What each reward term measures; a weight multiplies it."""

WorldLike: TypeAlias = str | World | OccupancyGrid
"""The name of a generated world, the file of a world or a map, a `World`, or a map."""

_TIMESTEP = 0.005

_USED_BY = {"worlds": ("generated",), "world_options": ("generated",), "resolution": ("generated", "world")}
"""Which kinds of world have a use for an option."""


def kind_of(world: object) -> Literal["generated", "world", "map"]:
    """Return what a world is that an environment is given: a name to generate, a `World` or its file, or a map.

    Raises:
        InputError: If it is none of these.
    """
    if isinstance(world, OccupancyGrid):
        return "map"
    if isinstance(world, World):
        return "world"
    if not isinstance(world, str | Path):
        raise InputError(f"a world must be a name, a file, a World or an OccupancyGrid, got {type(world).__name__}")
    suffix = Path(world).suffix
    return "map" if suffix in (".yaml", ".map") else "world" if suffix else "generated"


@dataclass(frozen=True, slots=True, eq=False)
class NavigationSettings:
    """Settings of a navigation environment. All have a default.

    Attributes:
        world: Where to drive: the name of a generated world (`maze`, `office`, …), the file of a world or a map, a
            `World` or an `OccupancyGrid`; or several of them.
        robot: The robot, its name or its file.
        seed: Which generated worlds, 0 to 99,999.
        split: "train", "validation" or "test": their generated worlds, and their missions, are different ones.
        worlds: How many worlds are generated of each name, or a list with the number for each of `world`, which is 1
            for what is not generated; where none is generated, it is refused.
        world_options: Options of the generated worlds, as for `World.generate`; likewise.
        resolution: Edge of a cell of maps made of worlds [m]; refused where all are maps.
        lidar: Which lidars observe: True for all of the robot's, or names. If None, the first.
        beams: Beams of each lidar. If None, the lidar's own number.
        movers: How many people walk in each world that do not react to the robot.
        crowd: How many more walk there that see the robot and give way to it.
        path_points: How many points of the path ahead are observed, 0.5 m apart; 0 for none.
        unmapped_boxes: Boxes that stand in each world, and that `path` and `costmap` know nothing of.
        costmap_cells: Cells along an edge of the observed local costmap; 0 for none.
        critic: Whether `critic` is observed: what a robot without a map cannot know.
        scaled_actions: Whether actions are from −1 to 1, as shares of the robot's largest speeds, or [m/s, rad/s].
        period_s: Time of a step [s].
        max_time_s: Time after which an episode is truncated [s].
        goal_tolerance: Distance to the goal that counts as arrived [m].
        min_distance: Shortest path from start to goal, at least [m]; less where the world has no room for it.
        rewards: Weight of each reward term; see `REWARD_TERMS`.
        vary: What differs from episode to episode; see `Variation`.
        threads: Number of threads. If None, TRUNDLE_THREADS, or as many as there are processors.
        device: Where it computes: "cpu", or "cuda" or "cuda:1", a GPU of NVIDIA's, with PyTorch's tensors for many
            robots (extra `gpu`, and PyTorch).

    Raises:
        InputError: If a value is out of range.
        UnknownNameError: If a split, a reward term or a varied name is not known.
    """

    world: WorldLike | Sequence[WorldLike] = "maze"
    robot: Robot | str = "nova_carter"
    seed: int = 0
    split: Split = "train"
    worlds: int | Sequence[int] = 4
    world_options: Mapping[str, Any] = field(default_factory=dict)
    resolution: float = 0.05
    lidar: LidarChoice | None = None
    beams: int | None = 180
    movers: int = 0
    crowd: int = 0
    path_points: int = 0
    unmapped_boxes: int = 0
    costmap_cells: int = 0
    critic: bool = False
    scaled_actions: bool = True
    period_s: float = 0.2
    max_time_s: float = 120.0
    goal_tolerance: float = 0.3
    min_distance: float = 5.0
    rewards: Mapping[str, float] = field(default_factory=lambda: dict(REWARDS))
    vary: Mapping[str, Any] | Variation = field(default_factory=dict)
    threads: int | None = None
    device: str = "cpu"

    def __post_init__(self) -> None:
        if self.split not in SPLITS:
            raise UnknownNameError("split", str(self.split), SPLITS)
        check_count("seed", self.seed, 0, 99_999)
        self.given_worlds()
        check_count("movers", self.movers, 0, 500)
        check_count("crowd", self.crowd, 0, 500)
        check_count("path_points", self.path_points, 0, 200)
        check_count("unmapped_boxes", self.unmapped_boxes, 0, 1000)
        check_count("costmap_cells", self.costmap_cells, 0, 512)
        if not isinstance(self.world_options, Mapping) or not all(isinstance(name, str) for name in self.world_options):
            raise InputError(
                f"world_options must be a mapping from names to values, got {show_value(self.world_options)}"
            )
        if "seed" in self.world_options:
            raise InputError("world_options: the seeds of worlds come of the options seed and split")
        if self.beams is not None:
            check_count("beams", self.beams, 1, 100_000)
        if not isinstance(self.device, str):
            raise InputError(f"device must be cpu, cuda or cuda:1, got {self.device!r}")
        check_flag("critic", self.critic)
        check_flag("scaled_actions", self.scaled_actions)
        count_steps(self.period_s, _TIMESTEP)
        check_number("resolution", self.resolution, 0.005, 1.0, "m")
        check_number("max_time_s", self.max_time_s, self.period_s, 86_400.0, "s")
        check_number("goal_tolerance", self.goal_tolerance, 1e-3, 100.0, "m")
        check_number("min_distance", self.min_distance, 0.0, 1e5, "m")
        if not isinstance(self.rewards, Mapping):
            raise InputError(f"rewards must be a mapping from terms to weights, got {self.rewards!r}")
        for name, weight in self.rewards.items():
            if name not in REWARD_TERMS:
                raise UnknownNameError("reward term", str(name), REWARD_TERMS)
            check_number(f"the weight of the reward {name}", weight, -1e6, 1e6)
        object.__setattr__(self, "vary", Variation.of(self.vary))

    @classmethod
    def of(cls, options: Mapping[str, Any]) -> Self:
        """Create from options by name.

        Raises:
            InputError: If there is no such option, or it has no effect on what `world` is.
        """
        known = [each.name for each in fields(cls)]
        for name in options:
            if name not in known:
                nearest = difflib.get_close_matches(name, known, n=1)
                hint = f" (did you mean {nearest[0]}?)" if nearest else ""
                raise InputError(f"an environment has no option {name}{hint}; there are: {', '.join(known)}")
        settings = cls(**options)
        kinds = {kind_of(each) for each, _ in settings.given_worlds()}
        for name, users in _USED_BY.items():
            if name in options and not kinds.intersection(users):
                what = "a map" if kinds == {"map"} else "a map or a world"
                raise InputError(f"the option {name} has no effect where world is {what}: leave it out")
        return settings

    def given_worlds(self) -> Sequence[tuple[WorldLike, int]]:
        """Return what `world` holds, one or several, each with how many worlds are to be generated of it.

        Raises:
            InputError: If that is nothing, or a number is out of range.
        """
        given = self.world
        each = list(given) if isinstance(given, Sequence) and not isinstance(given, str) else [given]
        if not each:
            raise InputError("an environment needs at least one world")
        numbers = self.worlds.tolist() if isinstance(self.worlds, np.ndarray) else self.worlds
        if isinstance(numbers, int | np.integer):
            return [(one, check_count("worlds", numbers, 1, 10_000)) for one in each]
        if not isinstance(numbers, Sequence) or isinstance(numbers, str | bytes):
            raise InputError(f"worlds must be an integer or a list of integers, got {show_value(self.worlds)}")
        if len(numbers) != len(each):
            raise InputError(f"worlds has {len(numbers)} numbers for {len(each)} of world: give one for each")
        counts = [check_count(f"worlds[{place}]", count, 1, 10_000) for place, count in enumerate(numbers)]
        for place, (one, count) in enumerate(zip(each, counts, strict=True)):
            if count != 1 and kind_of(one) != "generated":
                raise InputError(f"worlds[{place}] must be 1, as world[{place}] is one world or map, got {count}")
        return list(zip(each, counts, strict=True))

    @property
    def timestep(self) -> float:
        """Length of a substep [s]."""
        return _TIMESTEP

    @property
    def max_steps(self) -> int:
        """Steps after which an episode is truncated."""
        return math.ceil(self.max_time_s / self.period_s - 1e-9)

    def load_robot(self) -> Robot:
        """Return the robot, with the beams that are asked for and the chosen lidars alone.

        Raises:
            InputError: If the lidars are no choice of the robot's, or none.
        """
        robot = Robot.load(self.robot)
        names = tuple(robot.lidars)[:1] if self.lidar is None else choose_lidars(robot, self.lidar)
        if not names:
            raise InputError(f"the robot {robot.name} has no lidar to observe with; choose a robot that has one")
        changed = {} if self.beams is None else {"beams": self.beams}
        return robot.model_copy(
            update={"lidars": {name: robot.lidars[name].model_copy(update=changed) for name in names}}
        )
