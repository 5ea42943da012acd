"""The scenario from the first argument and the options, for `run` and `scenario`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, cast

from cyclopts import Parameter
from pydantic import BaseModel

from trundle.cli.shared import isaac, nav2, options, settings, sources
from trundle.cli.shared.given import check_given
from trundle.costmap.layers import ObstacleLayerSettings
from trundle.errors import InputError, UnknownNameError
from trundle.files.kinds import MAP, ROBOT, SCENARIO, WORLD
from trundle.mission import Scenario
from trundle.mission.fields import MapOptions
from trundle.worlds import world_names
from trundle.worlds.options import check_options

_PAIRS = {
    "layers": "rolling_window=true",
    "latency": "scan_age_s=0.1",
    "odometry": "heading=1deg",
    "monitor": "time_before_collision=1.5",
}
"""An example of each option that takes pairs, for messages."""


@Parameter(name="*")
@dataclass(frozen=True, slots=True)
class ScenarioOptions:
    """Options of a mission, besides the settings of its costmap and its navigator.

    Attributes:
        time_limit: Simulated time limit of the run [s].
    """

    robot: Annotated[str | None, Parameter(help=options.ROBOT_HELP)] = None
    start: options.Start = None
    goal: options.Goals = None
    through: options.Through = False
    planner: Annotated[str | None, Parameter(help=options.PLANNER_HELP)] = None
    planner_options: options.PlannerOptions = None
    controller: Annotated[str | None, Parameter(help=options.CONTROLLER_HELP)] = None
    controller_options: options.ControllerOptions = None
    smoother: options.SmootherName = None
    smoother_options: options.SmootherOptions = None
    agent: options.AgentName = None
    agent_options: options.AgentOptions = None
    backend: Annotated[str | None, Parameter(help="The simulator: mujoco, kinematic, isaac or a plug-in's name.")] = (
        None
    )
    lidar: options.Lidar = None
    localizer: options.LocalizerName = None
    localizer_options: options.LocalizerOptions = None
    no_map: options.NoMap = False
    layers: options.LayersPairs = None
    latency: options.LatencyPairs = None
    odometry: options.OdometryPairs = None
    collision_monitor: options.CollisionMonitor = None
    monitor: options.MonitorPairs = None
    seed: Annotated[options.Integer | None, Parameter(help="Random seed: the same seed gives the same run.")] = None
    world_options: options.Settings = None
    exclude: options.Exclude = None
    floor_z: options.FloorZ = None
    paths: options.Paths = None
    compat: options.Compat = None
    max_cells: options.MaxCells = None
    keepout: options.Keepout = None
    speed_mask: options.SpeedMaskFile = None
    time_limit: float | None = None
    nav2_params: nav2.Nav2Params = None
    costmap: settings.CostmapOptions = None
    navigation: settings.RunOptions = None
    isaac_options: isaac.IsaacOptions | None = None

    def make(self, source: str, report: nav2.Nav2Report | None = None) -> Scenario:
        """Build the scenario from a map, a world by name or file, or another scenario.

        Args:
            source: The first argument.
            report: Where to put what became of --nav2-params; None prints it.

        Raises:
            InputError: If options are invalid; one line for each.
            UnknownNameError: If a name is unknown.
        """
        check_given(source, SCENARIO, MAP, WORLD)
        for text, kind in ((self.robot, ROBOT), (self.keepout, MAP), (self.speed_mask, MAP)):
            if text is not None:
                check_given(text, kind)
        given = {
            "robot": self.robot,
            "start": options.parse_pose("--start", self.start).as_tuple() if self.start else None,
            "backend": self.backend,
            "seed": self.seed,
            "compat": self.compat,
            "keepout": None if self.keepout is None else str(self.keepout),
            "speed_mask": None if self.speed_mask is None else str(self.speed_mask),
            "floor_z": self.floor_z,
            "time_limit_s": self.time_limit,
            "lidar": self.lidar,
            "through": True if self.through else None,
            "known_map": False if self.no_map else None,
            "collision_monitor": self.collision_monitor,
        }
        changes: dict[str, object] = {key: value for key, value in given.items() if value is not None}
        changes |= settings.given(self.costmap) | settings.given(self.navigation)
        if self.goal:
            goals = [options.parse_goal("--goal", text) for text in self.goal]
            changes |= {"goal": goals[0], "goals": None} if len(goals) == 1 else {"goal": None, "goals": goals}
        source = isaac.world_of(source, self.backend, self.isaac_options)
        world_options = sources.read_settings(source, self.world_options, self.exclude, self.paths)
        if self.max_cells is not None:
            if not (sources.looks_like_file(source) and sources.is_map(Path(source))):
                raise InputError("--max-cells is for maps; in a scenario, write map_options: {max_cells: …}")
            world_options["max_cells"] = self.max_cells
        base = self._with_nav2(_read(source, world_options, changes), changes, report)
        chosen = {
            "planner": settings.choose("planner", self.planner, self.planner_options, base.planner),
            "controller": settings.choose("controller", self.controller, self.controller_options, base.controller),
            "smoother": settings.choose("smoother", self.smoother, self.smoother_options, base.smoother),
            "localizer": settings.choose("localizer", self.localizer, self.localizer_options, base.localizer),
            "agent": settings.choose("agent", self.agent, self.agent_options, base.agent),
            **self._sensing(base),
        }
        return isaac.adapt(Scenario.make(**{**base.model_dump(), **chosen}), self.isaac_options)

    def _with_nav2(self, base: Scenario, changes: dict[str, object], report: nav2.Nav2Report | None) -> Scenario:
        """The scenario with Nav2's parameters, which come after the options and before what it says itself."""
        told = nav2.Nav2Report() if report is None else report
        found = nav2.translate(self.nav2_params, base, changes, told)
        if report is None:
            told.tell(quiet=False)
        return Scenario.make(**{**base.model_dump(), **found}) if found else base

    def _sensing(self, base: Scenario) -> dict[str, object]:
        """Settings of sensing that are given as pairs, added to those that the scenario has."""
        if self.monitor and self.collision_monitor is False:
            raise InputError("give --monitor or --no-collision-monitor, not both")
        chosen: dict[str, object] = {}
        for option, field, pairs in (
            ("layers", "layers", self.layers),
            ("latency", "latency", self.latency),
            ("odometry", "odometry", self.odometry),
            ("monitor", "collision_monitor", self.monitor),
        ):
            if pairs:
                before = getattr(base, field)
                kept = before.model_dump(exclude_unset=True) if isinstance(before, BaseModel) else {}
                given: dict[str, object] = {**options.parse_pairs(f"--{option}", pairs, _PAIRS[option])}
                chosen[field] = {**kept, **(_of_obstacles(given, kept) if field == "layers" else given)}
        return chosen


def _of_obstacles(given: dict[str, object], kept: dict[str, object]) -> dict[str, object]:
    """Settings of layers, of which those of the obstacle layer stand in its own part."""
    inner = {name: value for name, value in given.items() if name in ObstacleLayerSettings.model_fields}
    rest = {name: value for name, value in given.items() if name not in inner}
    before = kept.get("obstacle")
    known = cast("dict[str, object]", before) if isinstance(before, dict) else {}
    return {**rest, "obstacle": {**known, **inner}} if inner else rest


DEFAULTS = ScenarioOptions()
"""Default options."""


def _read(source: str, world_options: dict[str, bool | int | float | str], changes: dict[str, object]) -> Scenario:
    """Build a scenario from the first argument, with the changes of the options."""
    if source in world_names():
        return Scenario.make(world={"name": source, "options": world_options}, **changes)
    if not sources.looks_like_file(source):
        raise UnknownNameError("world", source, world_names())
    if not sources.is_yaml(source) and not source.lower().endswith(".map"):
        return Scenario.make(world={"name": source, "options": world_options}, **changes)
    if sources.is_map(Path(source)):
        if world_options:
            check_options(source, "a map", world_options, list(MapOptions.model_fields))
            changes = {"map_options": world_options, **changes}
        return Scenario.make(map=source, **changes)
    if world_options:
        raise InputError(f"--set and --exclude are for worlds, by name or file; {source} is a scenario")
    return Scenario.make(**{**Scenario.load(source).model_dump(), **changes})
