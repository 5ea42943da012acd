"""What a bag holds of a run, and which of its topics hold it: by type, and by name where several have the same type."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trundle.bags.bag_reader import BagReader, BagTopic
from trundle.bags.topics import MOST_PARTICLES
from trundle.bags.transforms import TransformTree
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.messages import readers
from trundle.observation import Hypothesis, LocalizationState, Scan, pick_particles
from trundle.sim.state import MoverState

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
MAPS = ("nav_msgs/msg/OccupancyGrid",)
ODOMETRY = ("nav_msgs/msg/Odometry",)
PATHS = ("nav_msgs/msg/Path",)
SCANS = ("sensor_msgs/msg/LaserScan",)
COMMANDS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
GOALS = ("geometry_msgs/msg/PoseStamped",)
POSES = ("geometry_msgs/msg/PoseWithCovarianceStamped",)
CLOUDS = ("nav2_msgs/msg/ParticleCloud",)
DIAGNOSES = ("diagnostic_msgs/msg/DiagnosticArray",)
MARKERS = ("visualization_msgs/msg/MarkerArray",)

TRUTH = "/ground_truth/odom"
"""Topic of the true pose in trundle's recordings."""

ASKED = "/cmd_vel_nav"
"""Topic of what the controller asks for, before the collision monitor; Nav2's name."""

MOVERS = "/movers"
"""Topic of the movers in trundle's recordings."""


def of_types(topics: Sequence[BagTopic], types: Sequence[str]) -> list[BagTopic]:
    """Return the topics of these types that have messages."""
    return [topic for topic in topics if topic.type_name in types and topic.count]


def choose_topic(
    topics: Sequence[BagTopic],
    types: Sequence[str],
    names: Sequence[str],
    *,
    given: str | None = None,
    option: str = "",
    without: Sequence[str] = (),
) -> BagTopic | None:
    """Return the topic of these types whose name fits best, or None if there is none.

    Args:
        topics: All topics of a bag.
        types: Types of its messages.
        names: Its usual names, the most usual one first: the name itself, then the last part of a name (/robot1/map),
            then a part of it.
        given: The name that the user gave, which decides.
        option: The user's option, for messages.
        without: Parts of names that it does not have.

    Raises:
        InputError: If the bag has no topic of the given name and these types.
    """
    found = of_types(topics, types)
    if given is not None:
        chosen = next((topic for topic in found if topic.name == given), None)
        if chosen is None:
            there = ", ".join(topic.name for topic in found) or "none"
            raise InputError(f"{option} {given}: the bag has no such topic of type {types[0]}; there are: {there}")
        return chosen
    found = [topic for topic in found if not any(part in topic.name for part in without)]
    for fits in (
        lambda topic, name: topic.name == f"/{name}",
        lambda topic, name: topic.name.endswith(f"/{name}"),
        lambda topic, name: name in topic.name,
    ):
        for name in names:
            fitting = [topic for topic in found if fits(topic, name)]
            if fitting:
                return max(fitting, key=lambda topic: topic.count)
    return max(found, key=lambda topic: topic.count, default=None)


@dataclass(slots=True, eq=False)
class OdometrySamples:
    """The messages of one odometry topic.

    Attributes:
        frame, child: The frames, such as odom and base_link.
        times: [s].
        poses: (x, y, yaw).
        twists: (v, w) [m/s, rad/s].
    """

    frame: str = "odom"
    child: str = ""
    times: list[float] = field(default_factory=list[float])
    poses: list[tuple[float, float, float]] = field(default_factory=list[tuple[float, float, float]])
    twists: list[tuple[float, float]] = field(default_factory=list[tuple[float, float]])

    def add(self, message: Any) -> None:
        """Add a nav_msgs/Odometry."""
        if not self.times:
            self.frame = readers.read_frame(message.header.frame_id)
            self.child = readers.read_frame(message.child_frame_id)
        twist = readers.read_twist(message.twist.twist)
        self.times.append(readers.read_stamp(message.header.stamp))
        self.poses.append(readers.read_pose(message.pose.pose).as_tuple())
        self.twists.append((twist.v, twist.w))


@dataclass(slots=True, eq=False)
class BagContent:
    """What a bag holds of a run. Times are in seconds, as the messages' stamps have them.

    Attributes:
        tree: Its frames.
        grid: The last map; None without a map.
        map_frame: Frame of the map.
        odometry: The robot's odometry; None without odometry.
        truth: The true poses, in trundle's recordings.
        paths: Plans with their times and frames.
        commands: Commands that were sent to the robot, with the times at which they were received.
        asked: What the controller asked for, likewise, in trundle's recordings.
        goals: Goal poses with their times and frames.
        scans: Messages of scans.
        movers: The movers with their times, in trundle's recordings.
        covariances: Covariances of (x, y, yaw) of the estimated pose with their times, where they are known.
        particles: The particles of the localizer with their times, a choice of them.
        states: State and hypotheses of the localizer with their times, in trundle's recordings.
        topics: Names of the topics that were read.
        clock: Times at which stamped messages were received, with their stamps, to date those without one.
    """

    tree: TransformTree = field(default_factory=TransformTree)
    grid: OccupancyGrid | None = None
    map_frame: str = "map"
    odometry: OdometrySamples | None = None
    truth: OdometrySamples | None = None
    paths: list[tuple[float, str, FloatArray]] = field(default_factory=list[tuple[float, str, FloatArray]])
    commands: list[tuple[float, Twist2D]] = field(default_factory=list[tuple[float, Twist2D]])
    asked: list[tuple[float, Twist2D]] = field(default_factory=list[tuple[float, Twist2D]])
    goals: list[tuple[float, str, Pose2D]] = field(default_factory=list[tuple[float, str, Pose2D]])
    scans: list[tuple[str, Any]] = field(default_factory=list[tuple[str, Any]])
    movers: list[tuple[float, tuple[MoverState, ...]]] = field(
        default_factory=list[tuple[float, tuple[MoverState, ...]]]
    )
    covariances: list[tuple[float, FloatArray]] = field(default_factory=list[tuple[float, FloatArray]])
    particles: list[tuple[float, FloatArray]] = field(default_factory=list[tuple[float, FloatArray]])
    states: list[tuple[float, tuple[LocalizationState, tuple[Hypothesis, ...]]]] = field(
        default_factory=list[tuple[float, tuple[LocalizationState, tuple[Hypothesis, ...]]]]
    )
    topics: tuple[str, ...] = ()
    clock: list[tuple[float, float]] = field(default_factory=list[tuple[float, float]])

    def stamps_of(self, received: FloatArray) -> FloatArray:
        """Convert times of reception [s] to the clock of the stamps, since the bag may have another clock."""
        if not self.clock:
            return received
        pairs = np.array(sorted(self.clock))
        after = received - np.clip(received, pairs[0, 0], pairs[-1, 0])
        return np.interp(received, pairs[:, 0], pairs[:, 1]) + after


@dataclass(frozen=True, slots=True)
class TopicNames:
    """Names of topics that the user gave. Those that are None are found by type and name.

    Attributes:
        map: Topic of the map, or the YAML file of a ROS map.
        odom: Topic of the odometry.
        plan: Topic of the plans.
    """

    map: str | None = None
    odom: str | None = None
    plan: str | None = None


def read_content(bag: BagReader, names: TopicNames) -> BagContent:
    """Read what a bag holds of a run.

    Raises:
        InputError: If the bag has no map or no transforms, or is damaged.
    """
    topics = bag.topics
    content = BagContent()
    map_topic = None if _load_map(content, names.map) else _choose_map(bag, names.map)
    transforms = of_types(topics, TRANSFORMS)
    if not transforms:
        raise InputError(f"{bag.path}: the bag has no transforms (/tf), which say where the robot was; record /tf too")
    chosen = {
        "map": map_topic,
        "odometry": choose_topic(
            topics, ODOMETRY, ["odom", "odometry"], given=names.odom, option="--odom", without=["ground_truth"]
        ),
        "plan": choose_topic(
            topics, PATHS, ["plan", "path"], given=names.plan, option="--plan", without=["local", "smoothed"]
        ),
        "command": choose_topic(topics, COMMANDS, ["cmd_vel"], without=["cmd_vel_"]),
        "covariance": choose_topic(topics, POSES, ["amcl_pose"], without=["initialpose"]),
        "particles": choose_topic(topics, CLOUDS, ["particle_cloud"]),
        "state": choose_topic(topics, DIAGNOSES, ["diagnostics"]),
        "goal": choose_topic(topics, GOALS, ["goal_pose", "goal"], without=["pose_est", "tracked"]),
    }
    wanted = {topic: what for what, topic in chosen.items() if topic is not None}
    wanted |= dict.fromkeys(transforms, "transforms")
    wanted |= dict.fromkeys(of_types(topics, SCANS), "scan")
    wanted |= {topic: "truth" for topic in of_types(topics, ODOMETRY) if topic.name == TRUTH}
    wanted |= {topic: "asked" for topic in of_types(topics, COMMANDS) if topic.name == ASKED}
    wanted |= {topic: "movers" for topic in of_types(topics, MARKERS) if topic.name == MOVERS}
    content.topics = tuple(sorted(topic.name for topic in wanted))
    for topic, received, message in bag.messages(list(wanted)):
        try:
            _add(content, wanted[topic], topic, received, message)
        except InputError as error:
            raise InputError(f"{bag.path}: a message of {topic.name}, received at {received:.3f} s: {error}") from error
    return content


def _load_map(content: BagContent, given: str | None) -> bool:
    """Load the map where the user gave its file; whether that is so."""
    if given is None or not given.lower().endswith((".yaml", ".yml")):
        return False
    content.grid = OccupancyGrid.load(given)
    return True


def _choose_map(bag: BagReader, given: str | None) -> BagTopic:
    found = choose_topic(bag.topics, MAPS, ["map"], given=given, option="--map", without=["costmap"])
    if found is None:
        raise InputError(
            f"{bag.path}: the bag has no map (nav_msgs/OccupancyGrid); record /map too, or give its map's YAML with "
            "--map FILE.yaml"
        )
    return found


def _add(content: BagContent, what: str, topic: BagTopic, received: float, message: Any) -> None:
    """Add a message, of a topic that was chosen for what it holds."""
    match what:
        case "transforms":
            for one in message.transforms:
                parent, child = readers.read_frame(one.header.frame_id), readers.read_frame(one.child_frame_id)
                time, matrix = readers.read_stamp(one.header.stamp), readers.read_matrix(one.transform)
                content.tree.add(parent, child, time, matrix, is_static="static" in topic.name)
        case "map":
            content.grid = readers.read_grid(message)
            content.map_frame = readers.read_frame(message.header.frame_id)
        case "odometry":
            content.odometry = content.odometry or OdometrySamples()
            content.odometry.add(message)
            content.clock.append((received, content.odometry.times[-1]))
        case "truth":
            content.truth = content.truth or OdometrySamples()
            content.truth.add(message)
        case "plan":
            poses = readers.read_path(message)
            if len(poses) and not (content.paths and np.array_equal(content.paths[-1][2], poses)):
                frame = readers.read_frame(message.header.frame_id)
                content.paths.append((_time_of(message, received), frame, poses))
        case "command" | "asked":
            twist = readers.read_twist(message.twist if topic.type_name.endswith("Stamped") else message)
            (content.commands if what == "command" else content.asked).append((received, twist))
        case "goal":
            frame = readers.read_frame(message.header.frame_id)
            content.goals.append((_time_of(message, received), frame, readers.read_pose(message.pose)))
        case "scan":
            content.scans.append((topic.name, message))
        case "movers":
            content.movers.append((received, tuple(_read_mover(marker) for marker in message.markers)))
        case "covariance":
            covariance = readers.read_covariance(message.pose)
            if covariance is not None and np.isfinite(covariance).all():
                content.covariances.append((_time_of(message, received), covariance))
        case "particles":
            particles = pick_particles(readers.read_particles(message), MOST_PARTICLES)
            content.particles.append((_time_of(message, received), particles))
        case _:
            if (said := readers.read_diagnosis(message)) is not None:
                content.states.append((_time_of(message, received), said))


def _read_mover(marker: Any) -> MoverState:
    outline = tuple((point.x, point.y) for point in marker.points[:-1])
    return MoverState(marker.ns, readers.read_pose(marker.pose), outline=outline)


def _time_of(message: Any, received: float) -> float:
    """Return the time of a message [s]: its stamp, or where that is zero the time at which it was received."""
    stamp = readers.read_stamp(message.header.stamp)
    return stamp if stamp > 0.0 else received


def make_scan(message: Any, lidar: str, mount: FloatArray) -> Scan:
    """Return a scan from a message, and from where its lidar is on the robot: the pose in base_link, shape (4, 4).

    A lidar that is mounted upside down turns the other way round.
    """
    ranges = np.asarray(message.ranges, dtype=np.float64)
    angles = message.angle_min + message.angle_increment * np.arange(len(ranges))
    if mount[2, 2] < 0.0:
        angles = -angles
    ranges[np.isfinite(ranges) & (ranges < 0.0)] = np.nan
    return Scan(
        lidar,
        readers.read_stamp(message.header.stamp),
        Pose2D(float(mount[0, 3]), float(mount[1, 3]), float(np.arctan2(mount[1, 0], mount[0, 0]))),
        max(0.0, float(mount[2, 3])),
        angles,
        ranges,
        float(message.range_min),
        float(message.range_max),
        max(0.0, float(message.time_increment)),
    )
