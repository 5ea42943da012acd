"""`ScenarioFields`: what a scenario's YAML says."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, TypeAlias, cast

from pydantic import BeforeValidator, Field, model_validator

from trundle.control import MonitorSettings
from trundle.control.latency import Latency
from trundle.costmap import CostmapSettings, LayersSettings
from trundle.files.choice import Choice, takes_name, takes_plugin
from trundle.files.config_fields import PoseNumbers, Positive
from trundle.mission.assumed import Assumed
from trundle.mission.choices import MapOptions, RecordChoice, WorldChoice
from trundle.mission.goal_fields import GoalFields
from trundle.mission.movers import MoverChoice
from trundle.mission.rules import Rules
from trundle.mission.unmapped import Unmapped
from trundle.navigation import NavigatorSettings
from trundle.sim.actuation import Actuation
from trundle.sim.odometry_errors import OdometryErrors

LidarNames: TypeAlias = Annotated[
    bool | tuple[str, ...],
    BeforeValidator(
        lambda given: (given,) if isinstance(given, str) else given, json_schema_input_type=bool | str | list[str]
    ),
]
"""All of a robot's lidars, none, or some by name; one name alone is a list of one."""


class RunSettings(NavigatorSettings):
    """Those of a navigator; without a planning deadline, so that a run is the same however busy the computer is.

    Attributes:
        planning_deadline_s: How long a plan may take [s] of the computer's time, three times at most; none means as
            long as it takes.
    """

    planning_deadline_s: Positive | None = None


class ScenarioFields(CostmapSettings, RunSettings):
    """The fields of a scenario; see `Scenario`.

    Beside its own fields it has those of `CostmapSettings` and `RunSettings`.

    Attributes:
        name: Name of the run; none means robot and place.
        world: A world, generated or from a file; its map is made as the robot needs it. Either this or `map`.
        map: Path of a ROS map's YAML, extruded into a world. In a file, it is relative to that file.
        map_options: How the map is extruded; none means walls of 1 m.
        floor_z: Height [m] of the floor in the world's file; none means the one under the start, or where none is
            given, under most of the world (with backend isaac 0, as Isaac Sim takes the file as it is).
        compat: "humble" reads the map and the masks as ROS 2 Humble does.
        keepout: Path of a keep-out mask's YAML, a ROS map; in a file, relative to that file.
        speed_mask: Path of a speed mask's YAML; in a file, relative to that file.
        robot: Catalogue name or path of a robot's YAML; a path in a file is relative to that file.
        assumed: What its software takes the robot for, where that differs: outline, speeds and accelerations. None
            means the robot as it is.
        start: (x, y) or (x, y, yaw) [m, m, rad], map frame; none means picked from the free space by seed.
        goal: (x, y), to be reached with any yaw, or (x, y, yaw); none, and no `goals`, means picked by seed.
        goals: Several of these, to be reached in order; or waypoints with tasks, `{pose: [5, 3], wait: 2.0}`.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.
        planner: Planner by name, by `module:name`, or `{name: …, options: {…}}`; in Python also a class, a function or
            an object.
        controller: Controller, likewise.
        smoother: Smoother of the planned paths, likewise; none drives them as they are planned.
        agent: What drives instead of planner, controller and smoother, likewise; none means that these drive.
        unmapped: Boxes in the world that are not on the robot's map, drawn by seed; none means no such boxes.
        movers: What moves in the world besides the robot and the world's movers: on a path, or crowds of people and
            forklifts.
        backend: Simulator, likewise.
        actuation: How the robot's motion differs from what its software believes; none means not at all.
        latency: How late scans and commands arrive; none means not at all.
        odometry: How far its odometry is from its motion; none means not at all.
        lidar: Which of the robot's lidars are simulated: all (true), none (false), or a list of names. With them it
            senses obstacles that are not on its map.
        known_map: Whether the robot starts with the map of its surroundings. Without it, it drives by its lidars alone;
            unknown space can then be driven, at a cost, also where `unknown` is blocked.
        localizer: What estimates the robot's pose, likewise; none gives it the true pose.
        layers: How scans are put into the costmap; none means the defaults.
        collision_monitor: Whether every command passes a collision monitor (true or its settings), or none (false). Not
            given means one where there are scans.
        rules: What ends the run besides the usual; none means nothing.
        directives: Path of the directives that steer the run, as a steered run has recorded them; in a file, relative
            to that file. None means that nothing steers it.
        record: What `trundle run` writes besides the run's other files: "mcap" is run.mcap, a rosbag2; none means
            nothing.
        seed: For everything random: the world, the picked poses and the simulator.
        resolution: Edge of a cell [m] of the map that is made of a world.
        time_limit_s: Simulated time [s] at which the run is stopped; none means `trundle.run`'s default.
    """

    name: str | None = None
    world: Annotated[WorldChoice | None, takes_name(WorldChoice)] = None
    map: str | None = None
    map_options: MapOptions | None = None
    floor_z: float | None = None
    compat: Literal["humble"] | None = None
    keepout: str | None = None
    speed_mask: str | None = None
    robot: str = "nova_carter"
    assumed: Assumed | None = None
    start: PoseNumbers | None = None
    goal: PoseNumbers | None = None
    goals: Annotated[tuple[GoalFields, ...], Field(min_length=1)] | None = None
    through: bool = False
    planner: Annotated[Choice, takes_plugin(Choice)] = Choice(name="auto")
    controller: Annotated[Choice, takes_plugin(Choice)] = Choice(name="regulated_pure_pursuit")
    smoother: Annotated[Choice | None, takes_plugin(Choice)] = None
    agent: Annotated[Choice | None, takes_plugin(Choice)] = None
    unmapped: Unmapped | None = None
    movers: tuple[MoverChoice, ...] = ()
    backend: Annotated[Choice, takes_name(Choice)] = Choice(name="mujoco")
    actuation: Actuation | None = None
    latency: Latency | None = None
    odometry: OdometryErrors | None = None
    lidar: LidarNames = False
    known_map: bool = True
    localizer: Annotated[Choice | None, takes_plugin(Choice)] = None
    layers: LayersSettings | None = None
    collision_monitor: bool | MonitorSettings | None = None
    rules: Rules | None = None
    directives: str | None = None
    record: Annotated[RecordChoice | None, takes_name(RecordChoice)] = None
    seed: Annotated[int, Field(ge=0)] = 0
    resolution: Positive = 0.05
    time_limit_s: Positive | None = None

    @model_validator(mode="before")
    @classmethod
    def _move_latency(cls, given: Any) -> Any:
        """Take `actuation: {latency_s: …}` of older versions as `latency: {command_delay_s: …}`."""
        if not isinstance(given, dict):
            return given
        values = cast("dict[str, Any]", given)
        actuation = values.get("actuation")
        if not isinstance(actuation, dict) or "latency_s" not in actuation or values.get("latency") is not None:
            return values
        actuation = dict(cast("dict[str, Any]", actuation))
        latency = {"command_delay_s": actuation.pop("latency_s")}
        return {**values, "latency": latency, "actuation": actuation or None}

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.world is None) == (self.map is None):
            raise ValueError("give either world or map")
        if self.goal is not None and self.goals is not None:
            raise ValueError("give either goal or goals")
        if self.map_options is not None and self.map is None:
            raise ValueError("map_options say how a map becomes a world: they need map")
        if self.floor_z is not None and self.world is None:
            raise ValueError("floor_z is the height of the floor in a world: it needs world")
        if self.compat is not None and self.map is None:
            raise ValueError("compat says how a map is read: it needs map")
        if self.lidar and "lidar" in self.backend.options:
            raise ValueError("lidar is given twice: take it out of the backend's options")
        if not self.known_map and not self.lidar and "lidar" not in self.backend.options:
            raise ValueError("a robot that does not know the map needs lidars: give lidar: true")
        if not self.known_map and (self.keepout is not None or self.speed_mask is not None):
            raise ValueError("keepout and speed_mask are areas of a map: they need known_map: true")
        return self
