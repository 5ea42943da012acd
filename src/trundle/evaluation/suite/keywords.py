"""`SuiteKeywords`: what `Suite(…)` and `Suite.make(…)` take, for type checkers; the fields hold what becomes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict, TypeVar

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
