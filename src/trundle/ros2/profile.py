"""`Profile`: names of topics, frames and sensors on the network, as a tutorial or a launch file expects them."""

from __future__ import annotations

import math
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Annotated, TypeAlias

from pydantic import Field

from trundle.errors import UnknownNameError
from trundle.files.yaml_config import Config, PoseNumbers, Positive, load_config
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.robots.parts import Lidar

OptionalName: TypeAlias = str | None
"""Name of a topic. If None, it is not published."""


class Frames(Config):
    """Names of frames.

    Attributes:
        map: Frame of the map.
        odom: Frame of the odometry.
        base: Frame of the robot, on the floor between its drive wheels: trundle's base_link.
        body: Frame that sensors and wheels are fixed to; `static_frames` says where it is in the base. If None, it is
            the base.
        also_base: Other frames that a command may be stamped with, besides the base.
    """

    map: str = "map"
    odom: str = "odom"
    base: str = "base_link"
    body: str | None = None
    also_base: tuple[str, ...] = ()


class Topics(Config):
    """Names of topics; a relative one gets the namespace. If it is None, the topic is not published.

    Attributes:
        clock: The simulated time.
        tf, tf_static: The transforms.
        odom: The odometry.
        cmd_vel: The commands.
        joint_states: The drive wheels' joints.
        robot_description: The robot as URDF.
        contacts: What the robot touches.
        imu: The turn rate and the acceleration of the base, without noise.
        battery_state: The battery, of which nothing is simulated: its numbers are not measured (NaN).
    """

    clock: OptionalName = "/clock"
    tf: str = "/tf"
    tf_static: OptionalName = "/tf_static"
    odom: OptionalName = "odom"
    cmd_vel: str = "cmd_vel"
    joint_states: OptionalName = "joint_states"
    robot_description: OptionalName = "robot_description"
    contacts: OptionalName = "contacts"
    imu: OptionalName = None
    battery_state: OptionalName = None


class Sensor(Config):
    """How a lidar is published.

    Attributes:
        frame: Its frame. If None, it has its name, as in the exported URDF.
        scan: Topic of its scans. If None, they are not published.
        points: Topic of its points. If None, they are not published.
        rings: Elevation of each ring of the points [deg], the lowest first. If empty, there is the level ring of the
            scans. Each ring has the beams of the lidar, and costs 3 µs for each of them.
        first_beam: Direction of the first beam of a scan [rad], for a lidar that sees all around: 0 for one whose beams
            go from 0 (forward) to 2π. If None, they go from −π to π.
    """

    frame: str | None = None
    scan: OptionalName = None
    points: OptionalName = None
    rings: tuple[Annotated[float, Field(ge=-85.0, le=85.0)], ...] = ()
    first_beam: Annotated[float, Field(ge=-math.pi, le=math.pi)] | None = None


class StaticFrame(Config):
    """A frame that is fixed to another one.

    Attributes:
        parent: The other one.
        child: Its name.
        pose: Where it is in the other one: (x, y, z, yaw) [m, m, m, rad].
    """

    parent: str
    child: str
    pose: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


class Profile(Config):
    """What is published and heard, and under which names.

    Attributes:
        robot: The robot that it is for, by its catalogue name. If None, it is for any.
        start: Where launch files expect the robot to start; used where the scenario says nothing, and it fits there.
        frames: Names of frames.
        topics: Names of topics.
        lidars: Lidars that the robot gets, where it has none of that name.
        sensors: How each lidar is published; those that are not listed as `scan` and `lidar_points`, or
            `<name>/scan` and `<name>/lidar_points` where the robot has several. Not listed, if `only_listed`.
        only_listed: Whether lidars that are not listed are not published.
        static_frames: Frames besides those of the sensors.
        publishes_static: Whether /tf_static has the sensors and those frames from the start; else
            robot_state_publisher is expected to do that, and waited for.
        imu_frame: Frame of the IMU.
        wheel_frames: Frames of the drive wheels by their joints, which are published where robot_state_publisher does
            not do that.
        services_prefix: Before the names of the services of simulation_interfaces.
        control_period_s: Length of a control period [s]: /tf and /odom come once in each.
        joint_state_rate: How often joint states are published [Hz of simulated time]; above the control rate they come
            from the physics steps.
        clock_rate: How often /clock is published [Hz of simulated time], as far as the physics steps are that short.
        command_holds_s: How long a command drives the robot [s of simulated time]. If None, until the next one.
    """

    robot: str | None = None
    start: PoseNumbers | None = None
    frames: Frames = Field(default_factory=Frames)
    topics: Topics = Field(default_factory=Topics)
    lidars: dict[str, Lidar] = Field(default_factory=dict)
    sensors: dict[str, Sensor] = Field(default_factory=dict)
    only_listed: bool = False
    static_frames: tuple[StaticFrame, ...] = ()
    publishes_static: bool = True
    imu_frame: str = "imu_link"
    wheel_frames: dict[str, str] = Field(default_factory=dict)
    services_prefix: str = ""
    control_period_s: Positive = 0.02
    joint_state_rate: Positive = 50.0
    clock_rate: Positive = 200.0
    command_holds_s: Positive | None = 0.5

    @classmethod
    def load(cls, name: str) -> Profile:
        """Load a profile by its name, or from a YAML file.

        Raises:
            UnknownNameError: If there is none of that name.
            InputError: If the file cannot be used; every mistake is listed as file:line:column.
        """
        found = _files()
        if Path(name).suffix in (".yaml", ".yml"):
            return load_config(name, cls)
        if name not in found:
            raise UnknownNameError("profile", name, found)
        return load_config(found[name], cls)

    @property
    def body_pose(self) -> tuple[Pose2D, float]:
        """Where the body is in the base, and its height above the floor [m]."""
        for fixed in self.static_frames:
            if fixed.child == self.frames.body and fixed.parent == self.frames.base:
                x, y, z, yaw = fixed.pose
                return Pose2D(x, y, yaw), z
        return Pose2D(0.0, 0.0), 0.0

    def fit(self, robot: Robot) -> Robot:
        """Return the robot with the lidars of the profile."""
        missing = {name: lidar for name, lidar in self.lidars.items() if name not in robot.lidars}
        return robot.model_copy(update={"lidars": {**robot.lidars, **missing}}) if missing else robot

    def sensors_of(self, robot: Robot) -> dict[str, Sensor]:
        """Return how each lidar of a robot is published, with all names filled in."""
        listed = self.sensors
        others = [name for name in robot.lidars if name not in listed and not self.only_listed]
        found: dict[str, Sensor] = {}
        for name in robot.lidars:
            if name in listed:
                frame = listed[name].frame or link_of(name)
                found[name] = listed[name].model_copy(update={"frame": frame})
            elif name in others:
                folder = "" if len(others) == 1 else f"{name}/"
                found[name] = Sensor(frame=link_of(name), scan=f"{folder}scan", points=f"{folder}lidar_points")
        return found


def link_of(lidar: str) -> str:
    """Return the name of a lidar's link in the exported URDF."""
    return lidar if "lidar" in lidar else f"lidar_{lidar}"


@cache
def _files() -> dict[str, Path]:
    folder = Path(str(resources.files("trundle.ros2") / "profiles"))
    return {path.stem: path for path in folder.glob("*.yaml")}
