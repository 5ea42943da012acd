"""The options of a mission, and the scenario that they make of a verb's first argument."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import make_dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, cast, get_args

from cyclopts import Parameter
from pydantic import BaseModel

from trundle.cli.shared import isaac, nav2, options, sources
from trundle.cli.shared.field_options import (
    EXAMPLES,
    PAIRS,
    CostmapOptions,
    OptionField,
    RunOptions,
    choose,
    given,
    option_for,
    option_name,
    options_class,
    pairs_option,
)
from trundle.cli.shared.sources import check_given
from trundle.costmap.layers import ObstacleLayerSettings
from trundle.errors import InputError, UnknownNameError
from trundle.files.kinds import MAP, ROBOT, SCENARIO, WORLD
from trundle.mission import Scenario
from trundle.mission.fields import MapOptions
from trundle.mission.scenario import PLUGINS
from trundle.worlds import world_names
from trundle.worlds.options import check_options

_PLUGIN = "a plug-in: its name, module:name or file.py:name"


def _field(field: str, help: str, *, name: str = "", path: bool = False) -> OptionField:
    return option_for(Scenario, field, help=help, name=name, path=path)


def _plugin(field: str, help: str, *, form: str = "as KEY=VALUE") -> tuple[OptionField, OptionField]:
    """Make the option of a field that chooses a plug-in, and the one of that plug-in's options."""
    pairs = f"An option of the {field}, {form}; repeatable."
    return _field(field, help), pairs_option(f"{field}_options", pairs, name=f"--{field}-option")


_OPTIONS: tuple[OptionField, ...] = (
    _field("robot", options.ROBOT_HELP),
    _field("start", "Start pose [m, m, rad or 90deg], map frame; default: picked from the free space by seed."),
    _field(
        "goals",
        "Goal; repeat it for several goals in order; default: picked from the free space by seed.",
        name="--goal",
    ),
    _field("through", "Drive through all goals but the last without stopping."),
    *_plugin(
        "planner",
        f"The planner: auto, least_cost, hybrid_astar, any_angle, astar, manhattan_astar or {_PLUGIN}.",
        form=f"for example {EXAMPLES['planner']}",
    ),
    *_plugin(
        "controller",
        f"The controller: regulated_pure_pursuit, mppi, lookahead or {_PLUGIN}.",
        form=f"for example {EXAMPLES['controller']}",
    ),
    *_plugin(
        "smoother",
        f"The smoother of planned paths: constrained or {_PLUGIN}.",
        form=f"for example {EXAMPLES['smoother']}",
    ),
    *_plugin("agent", f"What drives instead of planner and controller: {_PLUGIN}."),
    _field("backend", options.BACKEND_HELP),
    _field("lidar", "Simulate the robot's lidars, which sense obstacles."),
    _field(
        "lidar_errors",
        f"An error of the lidars, for example noise=0.02 or {EXAMPLES['lidar_errors']}; repeatable.",
    ),
    *_plugin(
        "localizer",
        f"What estimates the robot's pose: amcl or slam (by its lidars), odometry or {_PLUGIN}; default: none.",
    ),
    _field(
        "start_error",
        f"An error of the start that the localizer is told, for example {EXAMPLES['start_error']} [m], heading=10deg, "
        "or unknown=true for none; repeatable.",
    ),
    _field("known_map", "Start without a map, and drive by lidar alone; needs --lidar.", name="--no-map"),
    _field(
        "map_errors",
        f"An error of the robot's map, for example {EXAMPLES['map_errors']} or ghosts=12; repeatable.",
    ),
    _field("layers", f"How scans go into the costmap, for example {EXAMPLES['layers']}; repeatable."),
    _field("latency", "How late data arrives: scan_age_s=0.1 or command_delay_s=0.1 [s]; repeatable."),
    _field(
        "odometry",
        f"An error of the robot's odometry, for example scale=0.01, {EXAMPLES['odometry']} or slips=6; repeatable.",
    ),
    _field("collision_monitor", "Check every command against the scans; default: where there are scans."),
    pairs_option("monitor", f"A setting of the collision monitor, for example {EXAMPLES['monitor']}; repeatable."),
    _field("seed", "Random seed: the same seed gives the same run."),
    ("world_options", options.Settings, None),
    ("exclude", options.Exclude, None),
    ("floor_z", options.FloorZ, None),
    ("paths", options.Paths, None),
    ("compat", options.Compat, None),
    ("max_cells", options.MaxCells, None),
    _field(
        "keepout",
        "The YAML of a keep-out mask: a ROS map whose black areas the robot must not enter.",
        path=True,
    ),
    _field(
        "speed_mask",
        "The YAML of a speed mask: a ROS map of limits, with type, base and multiplier as in Nav2.",
        path=True,
    ),
    _field("time_limit_s", "Simulated time limit of the run [s]."),
    ("nav2_params", nav2.Nav2Params, None),
    ("costmap", CostmapOptions, None),
    ("navigation", RunOptions, None),
    ("isaac_options", isaac.IsaacOptions | None, None),
)
"""The options in the order of --help. A field of a scenario that is added here has its option, and no more is needed.

Those that are no field of a scenario are read by `ScenarioOptions.make`.
"""

PARAMETERS: dict[str, Parameter] = {
    name: get_args(kind)[-1] for name, kind, _ in _OPTIONS if isinstance(get_args(kind)[-1], Parameter)
}
"""Name and help of each option, for other verbs that have it."""

_PAIRS = {
    **{name: name for name, found in PARAMETERS.items() if name in Scenario.model_fields and found.metavar == PAIRS},
    "monitor": "collision_monitor",
}
"""Options whose pairs are added to what the scenario has, each with its field."""

_READ_APART = {"start", "goals", *PLUGINS, *_PAIRS}

_NOTHING: Mapping[str, object] = MappingProxyType({})


@Parameter(name="*")
class ScenarioOptions(options_class(_OPTIONS)):
    """The options of a mission that were given, with an attribute for each of `_OPTIONS`."""

    def make(
        self,
        source: str,
        report: nav2.Nav2Report | None = None,
        *,
        robot: str | None = None,
        instead: Mapping[str, object] = _NOTHING,
    ) -> Scenario:
        """Build the scenario from a map, a world by name or file, or another scenario.

        Args:
            source: The first argument.
            report: Where to put what became of --nav2-params; if None, it is printed.
            robot: The robot where neither the options nor the file of a scenario name one.
            instead: Values of fields that are none or false by default, where neither options nor the file of a
                scenario set them.

        Raises:
            InputError: If options are invalid; one line for each.
            UnknownNameError: If a name is unknown.
        """
        check_given(source, SCENARIO, MAP, WORLD)
        changes = self._changes()
        if robot is not None and self.robot is None and not sources.is_written(source):
            changes["robot"] = robot
        for name, kind in (("robot", ROBOT), ("keepout", MAP), ("speed_mask", MAP)):
            if name in changes:
                check_given(str(changes[name]), kind)
        source = isaac.world_of(source, self.backend, self.isaac_options)
        world_options = sources.read_settings(source, self.world_options, self.exclude, self.paths)
        if self.max_cells is not None:
            if not (sources.looks_like_file(source) and sources.is_map(Path(source))):
                raise InputError("--max-cells is for maps; in a scenario, write map_options: {max_cells: …}")
            world_options["max_cells"] = self.max_cells
        instead = {name: value for name, value in instead.items() if getattr(self, name) is None}
        base = _read(source, world_options, changes, instead)
        base = self._with_nav2(base, {**{name: getattr(base, name) for name in instead}, **changes}, report)
        chosen = {
            name: choose(name, getattr(self, name), getattr(self, f"{name}_options"), getattr(base, name))
            for name in PLUGINS
        }
        changed = {**base.model_dump(), **chosen, **self._sensing(base)}
        scenario = Scenario.make(**changed)
        if scenario.map is not None:
            sources.warn_of_units(scenario.map)
        return isaac.adapt(scenario, self.isaac_options)

    def _changes(self) -> dict[str, object]:
        """Return the fields that options give a value of their own, which replaces the scenario's."""
        changes: dict[str, object] = {}
        for name, _, default in _OPTIONS:
            value = getattr(self, name)
            if name not in Scenario.model_fields or name in _READ_APART or value == default:
                continue
            if default is False:  # a flag
                value = not Scenario.model_fields[name].default
            changes[name] = str(value) if isinstance(value, Path) else value
        if self.start:
            changes["start"] = options.parse_pose("--start", self.start).as_tuple()
        if self.goals:
            goals = [options.parse_goal("--goal", text) for text in self.goals]
            changes |= {"goal": goals[0], "goals": None} if len(goals) == 1 else {"goal": None, "goals": goals}
        return changes | given(self.costmap) | given(self.navigation)

    def _with_nav2(self, base: Scenario, changes: dict[str, object], report: nav2.Nav2Report | None) -> Scenario:
        """Return the scenario with Nav2's parameters: options come before them, and they before the scenario's own."""
        told = nav2.Nav2Report() if report is None else report
        found = nav2.translate(self.nav2_params, base, changes, told)
        if report is None:
            told.tell(quiet=False)
        return Scenario.make(**{**base.model_dump(), **found}) if found else base

    def _sensing(self, base: Scenario) -> dict[str, object]:
        """Return the settings of sensing that are given as pairs, added to those that the scenario has."""
        if self.monitor and self.collision_monitor is False:
            raise InputError("give --monitor or --no-collision-monitor, not both")
        chosen: dict[str, object] = {}
        for option, field in _PAIRS.items():
            pairs = getattr(self, option)
            if pairs:
                before = getattr(base, field)
                kept = before.model_dump(exclude_unset=True) if isinstance(before, BaseModel) else {}
                found: dict[str, object] = {
                    **options.parse_pairs(option_name(option), pairs, EXAMPLES.get(option, "key=value"))
                }
                chosen[field] = {**kept, **(_of_obstacles(found, kept) if field == "layers" else found)}
        return chosen


def _of_obstacles(given: dict[str, object], kept: dict[str, object]) -> dict[str, object]:
    """Return the settings of layers, with those of the obstacle layer in their own part."""
    inner = {name: value for name, value in given.items() if name in ObstacleLayerSettings.model_fields}
    rest = {name: value for name, value in given.items() if name not in inner}
    before = kept.get("obstacle")
    known = cast("dict[str, object]", before) if isinstance(before, dict) else {}
    return {**rest, "obstacle": {**known, **inner}} if inner else rest


DEFAULTS = ScenarioOptions()
"""The options if none is given."""


def adapted_options(texts: Mapping[str, str], *, hidden: Collection[str] = ()) -> type[ScenarioOptions]:
    """Make the base of a class of the options, for a verb where some mean something else.

    Args:
        texts: Their texts in --help, by the fields of the options.
        hidden: Those that --help does not show, as the verb refuses them with a reason.
    """
    changes = {**{name: Parameter(help=text) for name, text in texts.items()}, **dict.fromkeys(hidden, _HIDDEN)}
    fields = [(name, Annotated[kind, changes[name]], default) for name, kind, default in _OPTIONS if name in changes]
    return make_dataclass("Adapted", fields, bases=(ScenarioOptions,), frozen=True)


_HIDDEN = Parameter(show=False)


def _read(
    source: str,
    world_options: dict[str, bool | int | float | str],
    changes: dict[str, object],
    instead: Mapping[str, object],
) -> Scenario:
    """Build a scenario from the first argument, with the changes of the options; see `ScenarioOptions.make`."""
    fresh = {**instead, **changes}
    if source in world_names():
        return Scenario.make(world={"name": source, "options": world_options}, **fresh)
    if not sources.looks_like_file(source):
        raise UnknownNameError("world", source, world_names())
    if not sources.is_yaml(source) and not source.lower().endswith(".map"):
        return Scenario.make(world={"name": source, "options": world_options}, **fresh)
    if sources.is_map(Path(source)):
        if world_options:
            check_options(source, "a map", world_options, list(MapOptions.model_fields))
            fresh = {"map_options": world_options, **fresh}
        return Scenario.make(map=source, **fresh)
    if world_options:
        raise InputError(f"--set and --exclude are for worlds, by name or file; {source} is a scenario")
    loaded = Scenario.load(source).model_dump()
    unset = {name: value for name, value in instead.items() if not loaded[name]}
    return Scenario.make(**{**loaded, **unset, **changes})
