"""What a bag holds, found before its scans are read: odometry, restarts, and where its lidars are on the robot."""

from __future__ import annotations

import collections
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trundle.bags.bag_content import ODOMETRY, SCANS, TRANSFORMS, OdometrySamples, of_types
from trundle.bags.bag_reader import BagReader, BagTopic
from trundle.bags.transforms import TransformTree
from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.messages import readers
from trundle.recordings.drive import Remarks
from trundle.recordings.own_hits import OwnHits
from trundle.robots import Robot

Shape = tuple[int, float, float]
"""Number of beams, angle of the first one and from one to the next [rad]."""

_MOST_BEAMS = 100_000
_JUMPED_BACK_S = 1.0  # the clock began again, or the recording is joined of several


@dataclass(slots=True, eq=False)
class LidarSurvey:
    """What the scans of one frame on one topic are like.

    Attributes:
        topic: The topic.
        frame: The frame.
        received, stamps: Of its scans [s].
        shapes: How often its scans have which beams.
        increments: Times from beam to beam [s], as the messages have them.
        own_hits: Looks for beams that meet the robot.
    """

    topic: str
    frame: str
    received: list[float] = field(default_factory=list[float])
    stamps: list[float] = field(default_factory=list[float])
    shapes: collections.Counter[Shape] = field(default_factory=collections.Counter[Shape])
    increments: collections.Counter[float] = field(default_factory=collections.Counter[float])
    own_hits: OwnHits = field(default_factory=OwnHits)

    @property
    def shape(self) -> Shape:
        """The beams that most of its scans have."""
        return self.shapes.most_common(1)[0][0]

    @property
    def period(self) -> float:
        """Time from scan to scan [s], as it usually is."""
        steps = np.diff(np.array(self.stamps))
        steps = steps[steps > 0.0]
        return float(np.median(steps)) if len(steps) else 0.0


@dataclass(slots=True, eq=False)
class Survey:
    """What a bag holds of a drive.

    Attributes:
        tree: Its frames.
        odometry: The messages of its odometry; None without such a topic.
        odometry_topic: Its name.
        odometry_received: When its messages were received [s].
        lidars: The lidars, by topic and frame.
    """

    tree: TransformTree
    odometry: OdometrySamples | None
    odometry_topic: str | None
    odometry_received: list[float]
    lidars: dict[tuple[str, str], LidarSurvey]


def survey_bag(bag: BagReader, remarks: Remarks, *, scan_topics: Sequence[str], odometry: BagTopic | None) -> Survey:
    """Read a bag once.

    Args:
        bag: The bag, open.
        remarks: What is found on the way.
        scan_topics: Topics of scans that the user chose; all if empty.
        odometry: Topic of the odometry.

    Raises:
        InputError: If the bag is damaged.
    """
    scans = [topic for topic in of_types(bag.topics, SCANS) if not scan_topics or topic.name in scan_topics]
    edges = _Edges()
    samples = OdometrySamples()
    received_at: list[float] = []
    lidars: dict[tuple[str, str], LidarSurvey] = {}
    wanted = [*of_types(bag.topics, TRANSFORMS), *scans, *([odometry] if odometry is not None else [])]
    for topic, received, message in bag.messages(wanted):
        if topic in scans:
            _add_scan(lidars, topic, received, message, remarks)
        elif topic == odometry:
            count = len(samples.times)
            _add_odometry(samples, message, remarks)
            received_at += [received] * (len(samples.times) - count)
        else:
            edges.add(topic, message, remarks)
    found = samples if len(samples.times) > 1 else None
    name = odometry.name if odometry is not None and found is not None else None
    return Survey(edges.make_tree(remarks), found, name, received_at, lidars)


def find_odometry_topic(bag: BagReader, given: str | None) -> BagTopic | None:
    """Return the topic of the odometry: the given one, else by its usual names.

    Raises:
        InputError: If the bag does not have the given one.
    """
    from trundle.bags.bag_content import choose_topic

    if given in ("tf", "none"):
        return None
    return choose_topic(
        bag.topics,
        ODOMETRY,
        ["odom", "odometry"],
        given=given,
        option="--odom",
        without=["truth", "gps", "gnss", "global", "amcl"],
    )


class _Edges:
    """Transforms on their way to a tree: a frame that is sent with several parents keeps the most frequent one."""

    def __init__(self) -> None:
        self._edges: dict[str, dict[str, list[tuple[float, FloatArray, bool]]]] = {}

    def add(self, topic: BagTopic, message: Any, remarks: Remarks) -> None:
        """Add a message."""
        is_static = "static" in topic.name
        for one in message.transforms:
            try:
                matrix = readers.read_matrix(one.transform)
            except InputError:
                matrix = None
            if matrix is None or not np.isfinite(matrix).all():
                remarks.count("transforms have no finite rotation, and are left out")
                continue
            parent, child = readers.read_frame(one.header.frame_id), readers.read_frame(one.child_frame_id)
            rows = self._edges.setdefault(child, {}).setdefault(parent, [])
            rows.append((readers.read_stamp(one.header.stamp), matrix, is_static))
            if is_static:
                del rows[:-1]

    def make_tree(self, remarks: Remarks) -> TransformTree:
        """Return the tree."""
        tree = TransformTree()
        for child, by_parent in self._edges.items():
            parent = max(by_parent, key=lambda name: len(by_parent[name]))
            if len(by_parent) > 1:
                others = ", ".join(sorted(name for name in by_parent if name != parent))
                remarks.note(f"frame {child!r} jumps between parents: {parent!r} is used, and {others} not")
            for time, matrix, is_static in by_parent[parent]:
                tree.add(parent, child, time, matrix, is_static=is_static)
        return tree


def _add_odometry(samples: OdometrySamples, message: Any, remarks: Remarks) -> None:
    values = message.pose.pose
    place, turn = values.position, values.orientation
    if not all(np.isfinite(value) for value in (place.x, place.y, turn.x, turn.y, turn.z, turn.w)):
        remarks.count("messages of the odometry are not finite, and are left out")
        return
    try:
        samples.add(message)
    except InputError:  # of its twist, which is not used
        remarks.count("messages of the odometry are not finite, and are left out")


def _add_scan(
    lidars: dict[tuple[str, str], LidarSurvey], topic: BagTopic, received: float, message: Any, remarks: Remarks
) -> None:
    frame = readers.read_frame(message.header.frame_id)
    shape = read_shape(message)
    if shape is None:
        remarks.count(f"scans of {topic.name} have no beams, or no finite angles, and are left out")
        return
    lidar = lidars.setdefault((topic.name, frame), LidarSurvey(topic.name, frame))
    lidar.received.append(received)
    lidar.stamps.append(readers.read_stamp(message.header.stamp))
    lidar.shapes[shape] += 1
    lidar.increments[round(float(message.time_increment), 9)] += 1
    lidar.own_hits.add(received, np.asarray(message.ranges, dtype=np.float64))
    count, first, step = shape
    if abs(first + step * (count - 1) - message.angle_max) > 1.5 * abs(step):
        remarks.count(
            f"scans of {topic.name} end at another angle than their angle_max; their number of beams and "
            "angle_increment count"
        )


def read_shape(message: Any) -> Shape | None:
    """Return the beams of a scan; None where it has none, or where no angle can be told."""
    count, first, step, last = (
        len(message.ranges),
        float(message.angle_min),
        float(message.angle_increment),
        float(message.angle_max),
    )
    if not 1 <= count <= _MOST_BEAMS or not np.isfinite(first) or abs(first) > 20.0:
        return None
    is_useless = not np.isfinite(step) or step == 0.0 or abs(step) * (count - 1) > 2.02 * np.pi
    if is_useless and count > 1:
        if not np.isfinite(last) or abs(last - first) > 2.02 * np.pi or last == first:
            return None
        step = (last - first) / (count - 1)
    return count, round(first, 6), round(step, 9)


def find_restarts(received: FloatArray, stamps: FloatArray) -> FloatArray:
    """Return when [s], by reception, the stamps jumped back: where each new stretch begins."""
    order = np.argsort(received, kind="stable")
    stamps, received = stamps[order], received[order]
    found: list[float] = []
    latest = -np.inf
    for time, stamp in zip(received.tolist(), stamps.tolist(), strict=True):
        if stamp < latest - _JUMPED_BACK_S:
            found.append(time)
            latest = stamp
        latest = max(latest, stamp)
    return np.array(found)


_BASES = ("base_link", "base_footprint")
_MOST_TILT = math.cos(math.radians(15.0))


def find_base(survey: Survey) -> str:
    """Return the frame of the robot's base: the odometry's child, else by its usual names."""
    frames = survey.tree.frames
    if survey.odometry is not None and survey.odometry.child:
        return survey.odometry.child
    for name in _BASES:
        fitting = [frame for frame in frames if frame.rsplit("/", 1)[-1] == name]
        if fitting:
            return min(fitting, key=len)
    for lidar in survey.lidars.values():  # the last frame above a lidar that is fixed to it
        chain = survey.tree.chain_to_root(lidar.frame)
        fixed = [frame for frame in chain if survey.tree.static(lidar.frame, frame) is not None]
        if fixed:
            return fixed[-1]
    return _BASES[0]


def find_odometry_frame(survey: Survey, base: str) -> str | None:
    """Return the frame in which transforms say continuously where the base is; None where there is none."""
    above = survey.tree.chain_to_root(base)[1:]
    moving = [frame for frame in above if survey.tree.static(base, frame) is None]
    named = [frame for frame in moving if "odom" in frame.rsplit("/", 1)[-1]]
    return (named or moving or [None])[0]


def find_mount(
    survey: Survey, lidar: LidarSurvey, base: str, robot: Robot | None, remarks: Remarks
) -> FloatArray | None:
    """Return the pose of a lidar in the base, shape (4, 4): by the transforms, else by the robot's file.

    None where it cannot be told, or the lidar does not look along the floor; a remark says so.
    """
    found = _fixed_pose(survey.tree, lidar.frame, base)
    if found is None and robot is not None:
        by_name = [one for name, one in robot.lidars.items() if name in (lidar.frame, lidar.topic.strip("/"))]
        own = by_name or [one for name, one in robot.lidars.items() if name in f"{lidar.topic}/{lidar.frame}"]
        own = own or (list(robot.lidars.values()) if len(robot.lidars) == len(survey.lidars) == 1 else [])
        if own:
            x, y, yaw = own[0].x, own[0].y, own[0].yaw
            found = np.eye(4)
            found[:2, :2] = ((math.cos(yaw), -math.sin(yaw)), (math.sin(yaw), math.cos(yaw)))
            found[:3, 3] = x, y, own[0].z
            remarks.note(f"no transform says where {lidar.frame!r} is on the robot: the robot's own file does")
    if found is None and len(survey.lidars) == 1:
        remarks.note(
            f"no transform says where {lidar.frame!r} is on the robot: taken to be in its middle and to look forward; "
            "record /tf_static too, or give the robot with --robot"
        )
        return np.eye(4)
    if found is None:
        remarks.note(
            f"scans of {lidar.topic} are left out: no transform says where {lidar.frame!r} is on the robot "
            f"({base!r}); record /tf_static too"
        )
    elif abs(found[2, 2]) < _MOST_TILT:
        degrees = math.degrees(math.acos(min(1.0, abs(float(found[2, 2])))))
        remarks.note(f"scans of {lidar.topic} are left out: {lidar.frame!r} is tilted by {degrees:.0f}°")
        return None
    elif found[2, 2] < 0.0:
        remarks.note(f"{lidar.frame!r} is mounted upside down: its beams turn the other way round")
    return found


def _fixed_pose(tree: TransformTree, frame: str, base: str) -> FloatArray | None:
    """Return the pose of a frame in another one to which it is fixed, by way of any frame above both."""
    if frame == base:
        return np.eye(4)
    above = tree.chain_to_root(base)
    for ancestor in tree.chain_to_root(frame):
        if ancestor in above:
            mine, other = tree.static(frame, ancestor), tree.static(base, ancestor)
            return None if mine is None or other is None else np.linalg.inv(other) @ mine
    return None
