"""`Suite`: thousands of episodes as one YAML file; `SuiteKeywords`: what it takes, for type checkers."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self, TypeAlias, TypedDict, TypeVar

import yaml

from trundle.errors import InputError, UnknownNameError
from trundle.evaluation.suite.check import check_suite
from trundle.evaluation.suite.expand import Expansion
from trundle.evaluation.suite.fields import SuiteFields
from trundle.evaluation.suite.identity import EpisodeSpec
from trundle.files.choice import shorten
from trundle.files.field_docs import describe_fields
from trundle.files.kinds import MAP, SUITE, find_kind
from trundle.files.opening import exists
from trundle.files.writing import path_beside, write_text
from trundle.files.yaml_config import build, load_config
from trundle.registry import is_model_file
from trundle.robots import is_robot_file
from trundle.values import as_path

if TYPE_CHECKING:
    from typing import Unpack


if TYPE_CHECKING:
    import os

    from trundle.control.collision_monitor import MonitorSettings
    from trundle.control.controller import ControllerLike
    from trundle.control.latency import Latency
    from trundle.costmap.layers.layered_costmap import LayersSettings
    from trundle.evaluation.suite.parts import Limits, ListedMission, Missions, SuiteWorld
    from trundle.evaluation.suite.vary import Vary
    from trundle.files.choice import Choice
    from trundle.localization.localizer import LocalizerLike
    from trundle.mission.fields import Assumed, Rules, StartError, WorldChoice
    from trundle.mission.obstacles import MapErrors, MoverChoice, Unmapped
    from trundle.navigation.agents import AgentLike
    from trundle.navigation.behaviors.behavior import BehaviorChoice
    from trundle.planning.planner import PlannerLike
    from trundle.planning.smoother import SmootherLike
    from trundle.sim.lidar_errors import LidarErrors
    from trundle.sim.odometry_errors import OdometryErrors

    _World: TypeAlias = str | os.PathLike[str] | WorldChoice | SuiteWorld | Mapping[str, Any]
    _Steps: TypeAlias = Sequence[str | BehaviorChoice | Mapping[str, Any]]

_T = TypeVar("_T")
_Some: TypeAlias = _T | Sequence[_T]
_Fields: TypeAlias = Mapping[str, Any]
_Seeds: TypeAlias = int | str | range | Sequence[int]


class SuiteKeywords(TypedDict, total=False):
    """The fields of a suite as they are given: one value or several, objects or what YAML would say; see `Suite`."""

    name: str | None
    worlds: _Some[_World]
    maps: _Some[str | os.PathLike[str]]
    robots: _Some[str]
    planners: _Some[PlannerLike | _Fields]
    controllers: _Some[ControllerLike | _Fields]
    smoothers: _Some[SmootherLike | _Fields | None]
    agents: _Some[AgentLike | _Fields]
    backends: _Some[str | Choice | _Fields]
    missions: _Seeds | Missions | _Fields | Sequence[ListedMission | _Fields]
    seeds: _Seeds | None
    vary: Vary | _Fields
    limits: Limits | _Fields
    require: _Some[str]

    # Settings of a scenario, which are crossed: costmap and navigator.
    inflation_radius: _Some[float | None]
    cost_scaling_factor: _Some[float]
    unknown: _Some[Literal["blocked", "free", "costly"]]
    unknown_cost: _Some[int | None]
    goal_tolerance: _Some[float]
    goal_yaw_tolerance: _Some[float | str]
    through_tolerance: _Some[float]
    required_movement_radius: _Some[float]
    movement_time_allowance: _Some[float]
    control_frequency: _Some[float]
    replan_interval_s: _Some[float | None]
    replan_margin: _Some[float]
    replan_rate: _Some[float | None]
    replan_expansions: _Some[int | None]
    wait_s: _Some[float]
    patience_s: _Some[float]
    mover_patience_s: _Some[float]
    recovery: str | _Steps | Sequence[str | _Steps]
    recovery_retries: _Some[int]
    resolution: _Some[float]

    # Robot, sensors and what is to be borne.
    assumed: _Some[Assumed | _Fields | None]
    lidar: _Some[bool | str | Sequence[str]]
    lidar_errors: _Some[LidarErrors | _Fields | None]
    odometry: _Some[OdometryErrors | _Fields | None]
    unmapped: _Some[Unmapped | _Fields | None]
    movers: _Some[Sequence[MoverChoice | _Fields]] | Sequence[MoverChoice | _Fields]
    known_map: _Some[bool]
    map_errors: _Some[MapErrors | _Fields | None]
    localizer: _Some[LocalizerLike | _Fields | None]
    start_error: _Some[StartError | Literal["unknown"] | _Fields | None]
    layers: _Some[LayersSettings | _Fields | None]
    latency: _Some[Latency | _Fields | None]
    collision_monitor: _Some[bool | MonitorSettings | _Fields | None]
    rules: _Some[Rules | _Fields | None]


MAPS = "maps"
"""The suite of all ROS maps of a folder; see `maps_suite`."""

_SUFFIXES = (".yaml", ".yml")

MAPS_SEEDS = "0:20"
_MAPS_BOXES = (5, 30)
_PLUGINS = ("planners", "controllers", "smoothers", "agents")


class Suite(SuiteFields):
    """Which episodes an evaluation runs: every world with its missions, crossed with robots, planners and settings.

    Its fields are those of `SuiteFields`, and settings of a scenario; one that is given as a list is crossed. Every
    field that takes a list takes a single value as well: `Suite(worlds="warehouse", planners=["auto", plan],
    seeds="0:500")`.

    Raises:
        InputError: If a field cannot be used; one line for each.
    """

    if TYPE_CHECKING:
        # What the fields' validators take; pydantic shows type checkers what the fields hold.
        def __init__(self, **settings: Unpack[SuiteKeywords]) -> None: ...

    @classmethod
    def make(cls, **settings: Unpack[SuiteKeywords]) -> Self:
        """Make a suite from its fields, as `Suite(…)` does.

        Args:
            **settings: Its fields.

        Raises:
            InputError: If a setting cannot be used; one line for each.

        Warns:
            AngleWarning: For an angle larger than a full turn, which is probably in degrees; with the field's name.
        """
        return build({**settings}, cls)

    def with_fields(self, **changes: Unpack[SuiteKeywords]) -> Self:
        """Return the suite with some fields changed.

        Args:
            **changes: Those fields.

        Raises:
            InputError: As `make`.
        """
        given = {name: getattr(self, name) for name in self.model_fields_set}
        return build({**given, **changes}, type(self))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a suite from YAML, or one of those that trundle ships: `smoke`, `tight`, `warehouses`.

        Relative paths in a file are relative to its folder.

        Raises:
            InputError: If it cannot be used; every mistake is listed as file:line:column. `maps` needs a folder: see
                `maps_suite`.
            UnknownNameError: If there is neither such a file nor such a suite.
        """
        text = as_path(path, "a suite's file")
        file = Path(text)
        if text == MAPS:
            raise InputError(
                "the suite maps drives in the ROS maps of a folder: trundle.evaluation.maps_suite(['FOLDER']), or "
                "trundle evaluate maps FOLDER"
            )
        if text in suite_names():
            file = shipped_folder() / f"{text}.yaml"
        elif file.suffix.lower() not in _SUFFIXES and not exists(file):
            raise UnknownNameError("suite", text, suite_names())
        suite = load_config(file, cls, kind=SUITE)
        return suite.with_paths(lambda name: str(file.parent / name))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as YAML that `load` reads back as the same suite; of a Python object, only its name is kept.

        Files below the current folder are named relative to the YAML, where that is below it too; others in full.

        Raises:
            OutputError: If it cannot be written.
        """
        write_text(path, self.to_yaml(path), durable=True)

    def to_yaml(self, path: str | os.PathLike[str]) -> str:
        """Return the text that `save` writes at this path."""
        plain = self.with_paths(lambda name: path_beside(name, path))._plain()
        return yaml.safe_dump(plain, sort_keys=False, default_flow_style=None, allow_unicode=True)

    @property
    def title(self) -> str:
        """Its name, or else the worlds that it drives in, fit for a folder's name."""
        if self.name is not None:
            return self.name
        return "-".join(dict.fromkeys(Path(world.name).stem for world in self.worlds[:3]))

    @cached_property
    def expansion(self) -> Expansion:
        """Its episodes by number, each made when it is asked for."""
        return Expansion(self)

    def __len__(self) -> int:
        """Return the number of its episodes."""
        return self.expansion.total

    def spec(self, index: int) -> EpisodeSpec:
        """Return everything that decides one of its episodes.

        Raises:
            InputError: If there is no episode of that number.
        """
        return self.expansion.spec(index)

    def id_of(self, index: int) -> str:
        """Return the hash of everything that decides one of its episodes, as `spec(index).id`, without the rest."""
        return self.expansion.id_of(index)

    def check(self) -> None:
        """Check what can be checked before an episode runs: the number of episodes, names, options and files.

        Raises:
            InputError: What is wrong, and what to do.
        """
        check_suite(self, self.expansion)

    def __repr__(self) -> str:
        return f"Suite({self.title!r}, {self.expansion.total:,} episodes)"

    def __str__(self) -> str:
        return repr(self)

    def with_paths(self, moved: Callable[[str], str]) -> Self:
        """Return the suite with other paths of its files: `moved` gives the new one of each."""
        worlds = [
            world.model_copy(update={field: moved(path) for field, path in world.files().items()})
            for world in self.worlds
        ]
        robots = tuple(moved(robot) if is_robot_file(robot) else robot for robot in self.robots)
        update: dict[str, object] = {"worlds": tuple(worlds), "robots": robots}
        if any(is_model_file(agent.name) for agent in self.agents):
            update["agents"] = tuple(
                agent.model_copy(update={"name": moved(agent.name)}) if is_model_file(agent.name) else agent
                for agent in self.agents
            )
        return self.model_copy(update=update)

    def _plain(self) -> dict[str, Any]:
        dumped = self.model_dump(mode="json", exclude_defaults=True)
        plain = {key: dumped[key] for key in describe_fields(type(self)) if key in dumped}
        for key in ("worlds", *_PLUGINS, "backends", "localizer"):
            if key in plain:
                plain[key] = [None if each is None else shorten(each) for each in plain[key]]
        return plain


def suite_names() -> list[str]:
    """Return the names of the suites that trundle ships, sorted."""
    return sorted(path.stem for path in shipped_folder().glob("*.yaml"))


def shipped_folder() -> Path:
    """Return the folder of the suites that trundle ships."""
    return Path(str(resources.files("trundle.evaluation.suite") / "shipped"))


def maps_suite(folders: Sequence[str | os.PathLike[str]], **fields: Unpack[SuiteKeywords]) -> Suite:
    """Make the suite of all maps in some folders, and in folders in these; masks (`keepout_mask.yaml`) are left out.

    In each map there are missions with roomy and with tight ends, each without boxes and with 5 to 30 of them that only
    the lidars see.

    Args:
        folders: The folders.
        **fields: Fields of the suite; `seeds` are those of the missions in each map.

    Raises:
        InputError: If there is no folder, or no map in one.
    """
    seeds = fields.pop("seeds", MAPS_SEEDS)
    if not folders:
        raise InputError("give a folder of ROS maps: trundle evaluate maps FOLDER")
    worlds: list[dict[str, Any]] = []
    for folder in folders:
        place = Path(folder)
        if not place.is_dir():
            raise InputError(f"{place}: this is no folder: trundle evaluate maps takes folders of ROS maps")
        files = [path for path in sorted(place.rglob("*")) if path.suffix.lower() in _SUFFIXES]
        found = [path for path in files if not path.stem.endswith("mask") and find_kind(path) == MAP]
        if not found:
            raise InputError(f"{place}: there is no ROS map in it: a YAML file with image: and resolution:")
        for path in found:
            label = path.relative_to(place).with_suffix("").as_posix()
            label = label if len(folders) == 1 else f"{place.name}/{label}"
            worlds.append({"name": str(path), "label": label, "missions": {"seeds": seeds}})
            worlds.append(
                {"name": str(path), "label": f"{label}, tight", "missions": {"seeds": seeds, "ends": "tight"}}
            )
    settings = {"name": MAPS, "lidar": True, "unmapped": [None, {"boxes": _MAPS_BOXES}], **fields}
    return Suite.make(worlds=worlds, **settings)
