"""`RunTopics`: the topics of a recorded run, and the messages of its steps; `BeliefTopics`: those of a localizer."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from trundle.bags.bag_writer import BagWriter, Topic
from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.messages.codec import Codec, Distro
from trundle.messages.makers import (
    DIAGNOSTICS,
    PARTICLE_CLOUD,
    POSE,
    MessageMaker,
    encode_particles,
    learn_particle_cloud,
    scan_topic,
)
from trundle.messages.qos import CLOCK, LATCHED, SENSOR, TRANSFORMS, Qos
from trundle.mission import Step
from trundle.observation import FloatArray, Scan, describe_state, pick_particles
from trundle.robots import Robot

MAP, ODOM, BASE = "map", "odom", "base_link"
"""Frames of REP-105."""

COSTMAP_PERIOD_S = 1.0
"""Changes of the costmap are written at most this often: Nav2's publish_frequency of 1 Hz."""

WHOLE_COSTMAP_S = 10.0
"""A whole costmap follows after at most so long, for programs that do not read updates."""

RANGE_STEP_M = 2.0**-12
"""Ranges of scans are rounded to this, a quarter of a millimetre: less than a lidar resolves, and half the size."""

_COMMAND = Qos(1)
_ODOMETRY = Qos(10)


class RunTopics:
    """The bag of a run, whose messages are made from its steps.

    Args:
        path: The file.
        robot: The robot that is driven.
        distro: Distribution of ROS 2.

    Attributes:
        bag: What they are written to.
    """

    def __init__(self, path: Path, robot: Robot, distro: Distro) -> None:
        self.bag = BagWriter(path, distro)
        self._codec = Codec(distro)
        self._make = MessageMaker(self._codec)
        self._robot = robot
        self._topics: dict[str, Topic] = {}
        self._path: object = None
        self._goal: int | None = None
        self._goals: tuple[Goal, ...] = ()
        self._costmap: object = None
        self._costmap_at = self._whole_at = -WHOLE_COSTMAP_S
        self._costmap_frame: object = None
        self._belief = BeliefTopics(self._make, self._write_bytes, MAP)
        self._open_topics()

    def _open_topics(self) -> None:
        self._clock = self._add("/clock", "rosgraph_msgs/msg/Clock", CLOCK)
        self._tf = self._add("/tf", "tf2_msgs/msg/TFMessage", TRANSFORMS)
        self._tf_static = self._add("/tf_static", "tf2_msgs/msg/TFMessage", LATCHED)
        self._odom = self._add("/odom", "nav_msgs/msg/Odometry", _ODOMETRY)
        self._truth = self._add("/ground_truth/odom", "nav_msgs/msg/Odometry", _ODOMETRY)
        self._commanded = self._add("/cmd_vel_nav", self._make.command_type, _COMMAND)
        self._sent = self._add("/cmd_vel", self._make.command_type, _COMMAND)

    def _add(self, name: str, type_name: str, qos: Qos) -> Topic:
        """Return a topic; it is added when it is first needed, and only once."""
        topic = self._topics.get(name)
        if topic is None:
            codec = self._codec
            definition, type_hash = codec.definition(type_name), codec.type_hash(type_name)
            topic = self._topics[name] = self.bag.add_topic(name, type_name, definition, type_hash, qos)
        return topic

    def _write(self, topic: Topic, time: float, message: Any) -> None:
        self.bag.write(topic, round(time * 1e9), self._codec.encode(message))

    def _write_bytes(self, name: str, type_name: str, qos: Qos, time: float, data: bytes) -> None:
        self.bag.write(self._add(name, type_name, qos), round(time * 1e9), data)

    def start(self, grid: OccupancyGrid | None, goals: Sequence[Goal]) -> None:
        """Write what does not change: the map, and where the sensors are on the robot."""
        make = self._make
        self._goals = tuple(goals)
        mounts = [
            make.transform(0.0, BASE, name, Pose2D(lidar.x, lidar.y, lidar.yaw), lidar.z)
            for name, lidar in self._robot.lidars.items()
        ]
        self._write(self._tf_static, 0.0, make.transforms(mounts))
        if grid is not None:
            self._write(self._add("/map", "nav_msgs/msg/OccupancyGrid", LATCHED), 0.0, make.grid(0.0, grid, MAP))

    def add(self, step: Step) -> None:
        """Write the messages of a control period."""
        make, state, time = self._make, step.state, step.state.time
        observed = step.observation if step.observation is not None else state.observation
        odometry = observed.odometry
        pose = state.pose if step.estimate is None else step.estimate.pose
        self._write(self._clock, time, make.clock(time))
        transforms = [
            make.transform(time, MAP, ODOM, pose @ odometry.inverse()),
            make.transform(time, ODOM, BASE, odometry),
        ]
        self._write(self._tf, time, make.transforms(transforms))
        self._write(self._odom, time, make.odometry(time, ODOM, BASE, odometry, observed.twist))
        self._write(self._truth, time, make.odometry(time, MAP, BASE, state.pose, state.twist))
        self._write(self._commanded, time, make.command(time, step.command, BASE))
        self._write(self._sent, time, make.command(time, step.sent, BASE))
        for scan in observed.scans:
            self._write_scan(time, scan)
        if state.movers:
            topic = self._add("/movers", "visualization_msgs/msg/MarkerArray", _ODOMETRY)
            self._write(topic, time, make.movers(time, state.movers, MAP))
        self._belief.add(step)
        self._write_goal(step)
        if step.path is not None and step.path is not self._path:
            self._path = step.path
            topic = self._add("/plan", "nav_msgs/msg/Path", _COMMAND)
            self._write(topic, time, make.path(time, step.path.poses, MAP))
        if step.costmap is not None:
            self._write_costmap(time, step.costmap)

    def _write_scan(self, time: float, scan: Scan) -> None:
        topic = self._add(scan_topic(scan.lidar, self._robot), "sensor_msgs/msg/LaserScan", SENSOR)
        self._write(topic, time, self._make.scan(scan, scan.lidar, range_step=RANGE_STEP_M))

    def _write_goal(self, step: Step) -> None:
        if step.goal == self._goal or not step.goal < len(self._goals):
            return
        self._goal = step.goal
        topic = self._add("/goal_pose", "geometry_msgs/msg/PoseStamped", _COMMAND)
        goal = self._goals[step.goal].pose
        self._write(topic, step.state.time, self._make.goal(step.state.time, goal, MAP))

    def _write_costmap(self, time: float, costmap: Costmap) -> None:
        """Write the costmap where it has changed: the rectangles that did, or all of it."""
        if costmap.version is self._costmap or time - self._costmap_at < COSTMAP_PERIOD_S - 1e-9:
            return
        frame = (costmap.shape, costmap.resolution, costmap.origin)
        windows = costmap.changes_since(self._costmap) if frame == self._costmap_frame else None
        make = self._make
        if windows is None or time - self._whole_at >= WHOLE_COSTMAP_S:
            topic = self._add("/global_costmap/costmap", "nav_msgs/msg/OccupancyGrid", LATCHED)
            self._write(topic, time, make.costmap(time, costmap, MAP))
            self._whole_at = time
        else:
            topic = self._add("/global_costmap/costmap_updates", "map_msgs/msg/OccupancyGridUpdate", _ODOMETRY)
            for rows, cols in windows:
                self._write(topic, time, make.costmap_update(time, costmap, rows, cols, MAP))
        self._costmap, self._costmap_at, self._costmap_frame = costmap.version, time, frame


AMCL_POSE, PARTICLES, STATE = "/amcl_pose", "/particle_cloud", "/diagnostics"

MOST_PARTICLES = 200
"""So many particles are written of a cloud: 2,000 would take more than everything else of a run."""

POSE_PERIOD_S = 0.1
PARTICLES_PERIOD_S = 1.0
"""The pose is written at most so often, and the particles and the state; they are also where the state changes."""

_SAME_S = 1e-9

Write = Callable[[str, str, Qos, float, bytes], None]
"""Writes the bytes of a message of a topic, by name, type, QoS and time [s]."""


class BeliefTopics:
    """Writes what a localizer believes; nothing where the robot knows its true pose.

    Args:
        make: Makes the messages.
        write: Writes them.
        frame: The map frame.
    """

    def __init__(self, make: MessageMaker, write: Write, frame: str) -> None:
        self._make, self._write, self._frame = make, write, frame
        self._posed_s = self._clouded_s = -math.inf
        self._said = ""
        self._shown: FloatArray | None = None

    def add(self, step: Step) -> None:
        """Write what is due at the end of a control period."""
        estimate, time = step.estimate, step.state.time
        if estimate is None or estimate.pose is step.state.pose:
            return
        said = describe_state(estimate)
        changes, self._said = said != self._said, said
        make, encode = self._make, self._make.codec.encode
        if changes or time - self._posed_s >= POSE_PERIOD_S - _SAME_S:
            self._posed_s = time
            pose = make.pose_estimate(time, estimate.pose, estimate.covariance, self._frame)
            self._write(AMCL_POSE, POSE, LATCHED, time, encode(pose))
        if not changes and time - self._clouded_s < PARTICLES_PERIOD_S - _SAME_S:
            return
        self._clouded_s = time
        self._write(STATE, DIAGNOSTICS, Qos(10), time, encode(make.diagnosis(time, estimate)))
        if estimate.particles is not None and estimate.particles is not self._shown:
            self._shown = estimate.particles
            learn_particle_cloud(make.codec)
            cloud = pick_particles(estimate.particles, MOST_PARTICLES)
            self._write(PARTICLES, PARTICLE_CLOUD, SENSOR, time, encode_particles(make, time, cloud, self._frame))
