"""The fields of a scenario: its world, its map, what ends a run, and what the software takes the robot for."""

from __future__ import annotations

import math
import zlib
from typing import Annotated, Literal, Self, TypeAlias

import numpy as np
from pydantic import BeforeValidator, Field, field_validator, model_validator

from trundle.control import MonitorSettings
from trundle.control.latency import Latency
from trundle.costmap import CostmapSettings, LayersSettings
from trundle.files.choice import Choice, takes_name, takes_plugin
from trundle.files.yaml_config import Angle, Config, NotNegative, PoseNumbers, Positive
from trundle.geometry import FloatArray, Footprint, Pose2D, wrap_angle
from trundle.maps.cells import MOST_CELLS
from trundle.mission.goal_fields import GoalFields
from trundle.mission.obstacles import MapErrors, MoverChoice, Unmapped
from trundle.navigation import NavigatorSettings
from trundle.robots import Limits, Robot
from trundle.robots.parts import Acceleration, Coordinate, ReverseSpeed, Speed, TurningAcceleration, TurningSpeed
from trundle.sim.actuation import Actuation
from trundle.sim.lidar_errors import LidarErrors
from trundle.sim.odometry_errors import OdometryErrors
from trundle.worlds.load import is_world_file


class Rules(Config):
    """What ends a run besides the usual: `{arrival_radius: 1.0, every_contact: true}`, as in BARN.

    Attributes:
        arrival_radius: The run ends as arrived when the robot truly is this close to its last goal [m], at any speed
            and yaw, whatever it believes. If None, when the robot says that it has arrived.
        every_contact: A moving obstacle that runs into the robot while it stands is a collision, too.
    """

    arrival_radius: Positive | None = None
    every_contact: bool = False


_START_STREAM = zlib.crc32(b"start error")
_LEAST_START_M, _LEAST_START_RAD = 1e-3, 1e-3
"""The least standard deviations that are told: with one of 0 the covariance would not be positive definite."""


class StartError(Config):
    """How far the pose that the localizer is told is from the true start: `{distance: 0.5, heading: 10deg}`.

    The seed of the run decides in which direction. `unknown` alone says that it is told no pose, and has to find out.

    Attributes:
        distance: From the true position [m].
        heading: From the true yaw [rad], 0 to π; text may be degrees.
        covariance: Whether it is told how uncertain the pose is; if not, it has to take it for exact.
        unknown: Whether it is told no pose at all.
    """

    distance: NotNegative = 0.0
    heading: Annotated[Angle, Field(ge=0.0, le=math.pi)] = 0.0
    covariance: bool = True
    unknown: bool = False

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.unknown and (self.distance > 0.0 or self.heading > 0.0 or not self.covariance):
            raise ValueError("a start that is unknown has no distance, heading or covariance: give either")
        return self

    def draw(self, start: Pose2D, seed: int) -> tuple[Pose2D | None, FloatArray | None]:
        """Draw what the localizer is told.

        Args:
            start: Where the robot is, map frame.
            seed: The same seed gives the same pose.

        Returns:
            The pose, or None for no pose; and its covariance of (x, y, yaw) [m², rad²], shape (3, 3), or None for a
            pose that is told as exact.
        """
        if self.unknown:
            return None, None
        rng = np.random.default_rng([seed, _START_STREAM])
        direction, sign = float(rng.uniform(-math.pi, math.pi)), float(rng.choice((-1.0, 1.0)))
        told = Pose2D(
            start.x + self.distance * math.cos(direction),
            start.y + self.distance * math.sin(direction),
            wrap_angle(start.yaw + sign * self.heading),
        )
        if not self.covariance or self.distance == self.heading == 0.0:
            return told, None
        # A distance d in any direction is a variance of d²/2 along each axis.
        along = max(self.distance / math.sqrt(2.0), _LEAST_START_M)
        return told, np.diag(np.square([along, along, max(self.heading, _LEAST_START_RAD)]))


def read_unknown(value: object) -> object:
    """Take `unknown` alone as a start that is not told."""
    return {"unknown": True} if value == "unknown" else value


class AssumedLimits(Config):
    """Limits that the robot's software keeps to; the robot's own hold where they are lower.

    Attributes:
        linear_speed: Maximum forward speed [m/s]. If None, the robot's.
        reverse_speed: Maximum reverse speed [m/s], as a positive number. If None, the robot's.
        angular_speed: Maximum turning speed in both directions [rad/s]. If None, the robot's.
        linear_acceleration: Maximum acceleration and deceleration [m/s²]. If None, the robot's.
        angular_acceleration: Maximum angular acceleration and deceleration [rad/s²]. If None, the robot's.
    """

    linear_speed: Speed | None = None
    reverse_speed: ReverseSpeed | None = None
    angular_speed: TurningSpeed | None = None
    linear_acceleration: Acceleration | None = None
    angular_acceleration: TurningAcceleration | None = None

    def within(self, own: Limits) -> Limits:
        """Return the lower of these limits and a robot's own."""
        back = own.linear_speed if own.reverse_speed is None else own.reverse_speed
        given = {name: value for name, value in self.model_dump().items() if value is not None}
        kept = {**own.model_dump(), "reverse_speed": back}
        return Limits(**{name: min(value, given.get(name, value)) for name, value in kept.items()})


class Assumed(Config):
    """What the robot's software takes the robot for: `{footprint: [[0.3, 0.2], …], limits: {linear_speed: 0.5}}`.

    The simulated robot keeps its own outline and its own limits.

    Attributes:
        footprint: Corners of the convex outline that it plans and drives with, base_link [m], clockwise or
            counter-clockwise. If None, the robot's.
        limits: Speeds and accelerations that it keeps to. If None, the robot's.
    """

    footprint: Annotated[tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=64)] | None = None
    limits: AssumedLimits | None = None

    @field_validator("footprint")
    @classmethod
    def _check_footprint(
        cls, corners: tuple[tuple[float, float], ...] | None
    ) -> tuple[tuple[float, float], ...] | None:
        if corners is None:
            return None
        return tuple((float(x), float(y)) for x, y in Footprint(np.asarray(corners)).outline)

    def of(self, robot: Robot) -> Robot:
        """Return the robot as its software takes it."""
        changes: dict[str, object] = {}
        if self.footprint is not None:
            changes["footprint"] = self.footprint
        if self.limits is not None:
            changes["limits"] = self.limits.within(robot.limits)
        # Made from its fields: a copy would keep the outline that the robot has computed.
        return type(robot)(**{**{name: getattr(robot, name) for name in type(robot).model_fields}, **changes})


_READING = ("trusted", "time_limit_s", "memory_limit_gb")
"""Options of `World.load` that say how far a file is trusted."""


class WorldChoice(Choice):
    """A world: `warehouse`, `{name: warehouse, seed: 7, options: {aisle_width: 1.4}}`, or a file, `hall.sdf`.

    Attributes:
        name: Name of a generated world, or the path of a world's file; a path in a file is relative to that file.
        options: Options of the generator, or of the file's loader.
        seed: Seed of a generated world. If None, the scenario's.
    """

    seed: int | None = None

    @property
    def is_file(self) -> bool:
        """Whether it is loaded from a file."""
        return is_world_file(self.name)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.is_file and self.seed is not None:
            raise ValueError("seed is for generated worlds; this one is a file")
        for option in _READING:
            if self.is_file and option in self.options:
                raise ValueError(
                    f"{option} is no option of a scenario, which others may have written: set TRUNDLE_TRUSTED, "
                    "TRUNDLE_READ_SECONDS or TRUNDLE_READ_GIGABYTES instead"
                )
        return self


class MapOptions(Config):
    """How a map becomes a world: `{height: 0.5, unknown: free}`.

    Attributes:
        height: Height of the walls [m].
        unknown: What unknown cells are in the simulated world; in the map they stay unknown. None means solid where
            the scenario's `unknown` is blocked, and free otherwise.
        max_cells: Largest number of cells that the map may have. If None, 20 million.
    """

    height: Positive = 1.0
    unknown: Literal["solid", "free"] | None = None
    max_cells: Annotated[int, Field(ge=1, le=MOST_CELLS)] | None = None


class RecordChoice(Config):
    """How a run is recorded besides its folder: `mcap`, or `{name: mcap, distro: kilted}`.

    Attributes:
        name: The format: "mcap" is rosbag2's.
        distro: The distribution of ROS 2 whose message types, hashes and QoS the recording has. If None, jazzy.
    """

    name: Literal["mcap"] = "mcap"
    distro: Literal["humble", "jazzy", "kilted", "lyrical"] | None = None


LidarNames: TypeAlias = Annotated[
    bool | tuple[str, ...],
    BeforeValidator(
        lambda given: (given,) if isinstance(given, str) else given, json_schema_input_type=bool | str | list[str]
    ),
]
"""All of a robot's lidars, none, or some by name; one name alone is a list of one."""


BY_SCANS = ("amcl", "slam")
"""Localizers that find the robot by the scans of its lidars."""


class RunSettings(NavigatorSettings):
    """Those of a navigator; without a planning deadline, so that a run is the same however busy the computer is.

    Attributes:
        planning_deadline_s: Wall time [s] after which a plan is stopped; it is tried three times at most. If None,
            no limit.
    """

    planning_deadline_s: Positive | None = None


class ScenarioFields(CostmapSettings, RunSettings):
    """The fields of a scenario; see `Scenario`.

    Beside its own fields it has those of `CostmapSettings` and `RunSettings`.

    Attributes:
        name: Name of the run. If None, robot and place.
        world: A world, generated or from a file; its map is made as the robot needs it. Either this or `map`.
        map: Path of a ROS map's YAML, extruded into a world. In a file, it is relative to that file.
        map_options: How the map is extruded. If None, walls of 1 m.
        floor_z: Height [m] of the floor in the world's file. If None, the one under the start, or where none is
            given, under most of the world (0 with backend isaac, and with physx in a USD file, which they take as it
            is).
        compat: "humble" reads the map and the masks as ROS 2 Humble does.
        keepout: Path of a keep-out mask's YAML, a ROS map; in a file, relative to that file.
        speed_mask: Path of a speed mask's YAML; in a file, relative to that file.
        robot: Catalogue name or path of a robot's YAML; a path in a file is relative to that file.
        assumed: What its software takes the robot for, where that differs: outline, speeds and accelerations. None
            means the robot as it is.
        start: (x, y) or (x, y, yaw) [m, m, rad], map frame. If None, picked from the free space by seed.
        goal: (x, y), to be reached with any yaw, or (x, y, yaw); none, and no `goals`, means picked by seed.
        goals: Several of these, to be reached in order; or waypoints with tasks, `{pose: [5, 3], wait: 2.0}`.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.
        planner: Planner by name, by `module:name`, or `{name: …, options: {…}}`; in Python also a class, a function or
            an object.
        controller: Controller, likewise.
        smoother: Smoother of the planned paths, likewise; none drives them as they are planned.
        agent: What drives instead of planner, controller and smoother, likewise. If None, that these drive.
        unmapped: Boxes in the world that are not on the robot's map, drawn by seed. If None, no such boxes.
        movers: What moves in the world besides the robot and the world's movers: on a path, or crowds of people and
            forklifts.
        backend: Simulator, likewise.
        actuation: How the robot's motion differs from what its software believes. If None, not at all.
        latency: How late scans and commands arrive. If None, not at all.
        odometry: How far its odometry is from its motion. If None, not at all.
        lidar: Which of the robot's lidars are simulated: all (true), none (false), or a list of names. With them it
            senses obstacles that are not on its map.
        lidar_errors: What its lidars measure wrongly. If None, only what their own noise does.
        known_map: Whether the robot starts with the map of its surroundings. Without it, it drives by its lidars alone;
            unknown space can then be driven, at a cost, also where `unknown` is blocked.
        map_errors: What is missing from its map, and what is on it and not in the world. If None, nothing.
        localizer: What estimates the robot's pose, likewise; none gives it the true pose. `amcl` and `slam` need
            lidars.
        start_error: How far the start that the localizer is told is from the true one, or `unknown` if it is told none.
            If None, it is told the true one.
        layers: How scans are put into the costmap. If None, the defaults.
        collision_monitor: Whether every command passes a collision monitor (true or its settings), or none (false). Not
            given means one where there are scans.
        rules: What ends the run besides the usual. If None, nothing.
        directives: Path of the directives that steer the run, as a steered run has recorded them; in a file, relative
            to that file. None means that nothing steers it.
        record: What `trundle run` writes besides the run's other files: "mcap" is run.mcap, a rosbag2. If None,
            nothing.
        seed: For everything random: the world, the picked poses and the simulator.
        resolution: Edge of a cell [m] of the map that is made of a world.
        time_limit_s: Simulated time [s] at which the run is stopped. If None, `trundle.run`'s default.
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
    lidar_errors: LidarErrors | None = None
    known_map: bool = True
    map_errors: MapErrors | None = None
    localizer: Annotated[Choice | None, takes_plugin(Choice)] = None
    start_error: Annotated[
        StartError | None, BeforeValidator(read_unknown, json_schema_input_type=Literal["unknown"] | StartError | None)
    ] = None
    layers: LayersSettings | None = None
    collision_monitor: bool | MonitorSettings | None = None
    rules: Rules | None = None
    directives: str | None = None
    record: Annotated[RecordChoice | None, takes_name(RecordChoice)] = None
    seed: Annotated[int, Field(ge=0)] = 0
    resolution: Positive = 0.05
    time_limit_s: Positive | None = None

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
        has_lidars = bool(self.lidar or self.backend.options.get("lidar"))
        if not self.known_map and not has_lidars:
            raise ValueError("a robot that does not know the map needs lidars: give lidar: true, or --lidar")
        if not self.known_map and (self.keepout is not None or self.speed_mask is not None):
            raise ValueError("keepout and speed_mask are areas of a map: they need known_map: true")
        if not self.known_map and self.map_errors is not None:
            raise ValueError("map_errors are errors of the robot's map: they need known_map: true")
        if self.lidar_errors is not None and not has_lidars:
            raise ValueError("lidar_errors are errors of simulated lidars: give lidar: true, or --lidar")
        if self.start_error is not None and self.localizer is None:
            raise ValueError(
                "start_error is what a localizer is told of the start: give a localizer, such as localizer: amcl"
            )
        if self.localizer is not None and self.localizer.name in BY_SCANS and not has_lidars:
            raise ValueError(
                f"the localizer {self.localizer.name} finds the robot by the scans of its lidars: give lidar: true, or "
                "--lidar"
            )
        return self
