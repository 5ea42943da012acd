"""`Nodes`: a pose graph while it grows, and the beams of its scans."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import find_normals, pick_beams
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.pose_graph import FARTHEST_M, FOLLOWS, LOOP, Lidar, PoseGraph
from trundle.observation import Scan
from trundle.robots import Robot

_BODY_PADDING_M = 0.03  # hits so near to the outline are on the robot: ranges have noise
_GAP, _LEAST_GAP_M = 0.07, 0.15  # two beams of 1 degree on a wall at 15 degrees are 0.07 of the range apart
MOST_POINTS = 720  # of a scan: two in each degree of a turn, which is more than is matched


@dataclass(frozen=True, slots=True)
class ScanRecord:
    """One scan of a node.

    Attributes:
        node: The node.
        lidar: Index of the lidar.
        poses: Base_link at the first and at the last beam, seen from the node, shape (2, 3).
        ranges: [m], float32.
    """

    node: int
    lidar: int
    poses: FloatArray
    ranges: npt.NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Surface:
    """Points with their normals, and where their beams began, seen from one pose [m], each shape (N, 2)."""

    points: FloatArray
    normals: FloatArray
    sensors: FloatArray


@dataclass(frozen=True, slots=True)
class Floating:
    """The last node, in a place that is known: the next one there replaces it.

    Attributes:
        before: The node before it, and its pose in the frame of the window.
        covariance: Covariance of the edge between them.
        anchor: An old node that it was recognised from, or None.
    """

    before: tuple[int, Pose2D]
    covariance: FloatArray
    anchor: int | None

    @property
    def stays(self) -> int:
        """A node that it is seen from, and that is not replaced."""
        return self.before[0] if self.anchor is None else self.anchor


def make_surface(points: FloatArray, sensors: FloatArray) -> Surface:
    """Find the normals of points in the order of their beams."""
    return Surface(points, find_normals(points, sensors, _GAP, _LEAST_GAP_M), sensors)


class Nodes:
    """Nodes, scans and edges, in lists that grow.

    Attributes:
        times, parts, poses, odometry: As in `PoseGraph`; the poses are arrays of shape (3,).
        travelled: How far the robot had driven at each node [m]; turns count as well.
        lidars: The lidars.
        scans: All scans.
        first_scan: Index of the first scan of each node; the scans of a node come one after the other.
        edges, transforms, covariances: As in `PoseGraph`.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        outline = robot.planar.padded(_BODY_PADDING_M).outline
        sides = np.roll(outline, -1, axis=0) - outline
        normals = np.stack([sides[:, 1], -sides[:, 0]], axis=1) / np.hypot(sides[:, 0], sides[:, 1])[:, np.newaxis]
        self.body = np.column_stack([normals, (normals * outline).sum(axis=1)])
        self.times: list[float] = []
        self.parts: list[int] = []
        self.poses: list[FloatArray] = []
        self.odometry: list[Pose2D] = []
        self.travelled: list[float] = []
        self.lidars: list[Lidar] = []
        self.scans: list[ScanRecord] = []
        self.first_scan: list[int] = []
        self.edges: list[tuple[int, int, int]] = []
        self.transforms: list[FloatArray] = []
        self.covariances: list[FloatArray] = []

    def __len__(self) -> int:
        return len(self.times)

    def pose(self, node: int) -> Pose2D:
        """Return the pose of a node in the map frame."""
        return Pose2D(*self.poses[node].tolist())

    def add_node(self, time: float, part: int, pose: Pose2D, odometry: Pose2D, travelled: float) -> int:
        """Add a node; return its index."""
        self.times.append(time)
        self.parts.append(part)
        self.poses.append(np.array(pose.as_tuple()))
        self.odometry.append(odometry)
        self.travelled.append(travelled)
        self.first_scan.append(len(self.scans))
        return len(self.times) - 1

    def add_scan(self, scan: Scan, first: Pose2D, last: Pose2D) -> None:
        """Add a scan to the last node, with base_link at its first and last beam seen from the node."""
        poses = np.array((first.as_tuple(), last.as_tuple()))
        ranges = scan.ranges.astype(np.float32)
        self.scans.append(ScanRecord(len(self) - 1, self._lidar(scan), poses, ranges))

    def add_edge(self, a: int, b: int, kind: int, transform: Pose2D, covariance: FloatArray) -> None:
        """Add an edge: the pose of node b seen from a."""
        self.edges.append((a, b, kind))
        self.transforms.append(np.array(transform.as_tuple()))
        self.covariances.append(covariance)

    def remove_last(self) -> None:
        """Remove the last node, with its scans and edges."""
        node = len(self) - 1
        del self.scans[self.first_scan[node] :]
        kept = [i for i, (a, b, _) in enumerate(self.edges) if node not in (a, b)]
        self.edges = [self.edges[i] for i in kept]
        self.transforms = [self.transforms[i] for i in kept]
        self.covariances = [self.covariances[i] for i in kept]
        for column in (self.times, self.parts, self.poses, self.odometry, self.travelled, self.first_scan):
            column.pop()

    def scans_of(self, node: int) -> list[ScanRecord]:
        """Return the scans of a node."""
        end = self.first_scan[node + 1] if node + 1 < len(self) else len(self.scans)
        return self.scans[self.first_scan[node] : end]

    def key_surface(self, node: int) -> Surface:
        """Return what the scans at the node itself saw, one of each lidar, seen from the node."""
        return make_surface(*self.key_points(node))

    def key_points(self, node: int) -> tuple[FloatArray, FloatArray]:
        """Return the points of `key_surface`, and where their beams began, each (N, 2)."""
        seen: set[int] = set()
        points, sensors = [np.empty((0, 2))], [np.empty((0, 2))]
        for scan in self.scans_of(node):
            if scan.lidar in seen:
                break
            seen.add(scan.lidar)
            ends, starts = self.beams(scan)
            points.append(ends)
            sensors.append(starts)
        return np.concatenate(points), np.concatenate(sensors)

    def beams(self, scan: ScanRecord) -> tuple[FloatArray, FloatArray]:
        """Return where the beams of a scan with a return ended and began, seen from its node, each (N, 2)."""
        lidar = self.lidars[scan.lidar]
        mount = np.array(lidar.mount.as_tuple())
        ranges = scan.ranges.astype(np.float64)
        far = min(lidar.range_max, FARTHEST_M)
        ends, starts = pick_beams(
            ranges, lidar.angles, mount, scan.poses, self.body, lidar.range_min, far, MOST_POINTS, 0.0
        )
        return ends, starts

    def _lidar(self, scan: Scan) -> int:
        for index, lidar in enumerate(self.lidars):
            same = lidar.name == scan.lidar and len(lidar.angles) == len(scan.angles)
            if same and lidar.mount == scan.mount and (lidar.angles == scan.angles).all():
                return index
        if len(self.lidars) >= 64:
            raise InputError(
                f"the lidar {scan.lidar!r} has changed its mount or its beams 64 times; scans of one lidar must have "
                "the same angles"
            )
        self.lidars.append(
            Lidar(
                scan.lidar,
                scan.mount,
                scan.height,
                scan.angles,
                scan.range_min,
                scan.range_max,
                scan.time_increment,
            )
        )
        return len(self.lidars) - 1

    def track(self) -> tuple[FloatArray, npt.NDArray[np.int32]]:
        """Return the poses (N, 3), and the pairs of nodes that a loop joins (M, 2)."""
        loops = [(a, b) for a, b, kind in self.edges if kind == LOOP]
        return np.array(self.poses, np.float64).reshape(-1, 3), np.array(loops, np.int32).reshape(-1, 2)

    def to_graph(self) -> PoseGraph:
        """Return all of it as a `PoseGraph`."""
        ranges = [scan.ranges for scan in self.scans]
        return PoseGraph(
            times=np.array(self.times, dtype=np.float64),
            parts=np.array(self.parts, dtype=np.int32),
            poses=np.array(self.poses, dtype=np.float64).reshape(-1, 3),
            odometry=np.array([pose.as_tuple() for pose in self.odometry], dtype=np.float64).reshape(-1, 3),
            lidars=tuple(self.lidars),
            scan_nodes=np.array([scan.node for scan in self.scans], dtype=np.int32),
            scan_lidars=np.array([scan.lidar for scan in self.scans], dtype=np.int32),
            scan_poses=np.array([scan.poses for scan in self.scans], dtype=np.float64).reshape(-1, 2, 3),
            ranges=np.concatenate(ranges) if ranges else np.empty(0, dtype=np.float32),
            edges=np.array(self.edges, dtype=np.int32).reshape(-1, 3),
            transforms=np.array(self.transforms, dtype=np.float64).reshape(-1, 3),
            covariances=np.array(self.covariances, dtype=np.float64).reshape(-1, 3, 3),
            robot=self.robot.name,
        )

    @classmethod
    def from_graph(cls, graph: PoseGraph, robot: Robot) -> Nodes:
        """Read the nodes of a graph, to continue it."""
        nodes = cls(robot)
        nodes.lidars = list(graph.lidars)
        nodes.times = graph.times.tolist()
        nodes.parts = graph.parts.tolist()
        nodes.poses = [np.array(pose) for pose in graph.poses]
        nodes.odometry = [Pose2D(*pose) for pose in graph.odometry.tolist()]
        nodes.edges = [(a, b, kind) for a, b, kind in graph.edges.tolist()]
        nodes.transforms = [np.array(transform) for transform in graph.transforms]
        nodes.covariances = [np.array(covariance) for covariance in graph.covariances]
        counts = [len(graph.lidars[lidar].angles) for lidar in graph.scan_lidars.tolist()]
        ends = np.cumsum(counts, dtype=np.int64).tolist()
        for i, end in enumerate(ends):
            ranges = np.array(graph.ranges[end - counts[i] : end])
            node, lidar = int(graph.scan_nodes[i]), int(graph.scan_lidars[i])
            nodes.scans.append(ScanRecord(node, lidar, np.array(graph.scan_poses[i]), ranges))
        nodes.first_scan = np.searchsorted(graph.scan_nodes, np.arange(len(nodes))).tolist()
        nodes.travelled = _travelled(nodes)
        return nodes


def _travelled(nodes: Nodes) -> list[float]:
    """Return how far the robot had driven at each node, by the edges from one node to the next."""
    far = [0.0] * len(nodes)
    for (a, b, kind), transform in zip(nodes.edges, nodes.transforms, strict=True):
        if kind == FOLLOWS and b > a:
            far[b] = far[a] + step_length(transform)
    for i in range(1, len(far)):
        far[i] = max(far[i], far[i - 1])
    return far


def step_length(step: FloatArray) -> float:
    """Return how long a motion is [m]: a turn by a radian counts as 0.3 m."""
    return math.hypot(step[0], step[1]) + 0.3 * abs(float(step[2]))
