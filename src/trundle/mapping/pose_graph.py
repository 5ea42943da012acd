"""`PoseGraph`: all that a mapper knows, as arrays: where the robot was, what it saw, and what ties poses together.

The idea: the map is drawn from the graph and can always be drawn again. So only the graph is saved, continued, moved
and merged; what a correction changes are the nodes' poses alone. What is drawn from a graph, and what continues it,
relies on `check_pose_graph`: indices are in bounds, poses are finite, and covariances can be inverted.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D

FOLLOWS, LOOP = 0, 1
"""Kinds of edges: from one node to the next by odometry and scan matching, and back to a place seen before."""

FARTHEST_M = 500.0
"""Longer ranges are no measurements of a lidar that looks around a robot [m]; beams of this length met nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Lidar:
    """How one of the lidars measured.

    Attributes:
        name: Its name.
        mount: Pose of the sensor in base_link.
        height: Height of its beams above the floor [m].
        angles: Directions of the beams in the sensor's frame [rad], shape (B,).
        range_min, range_max: Shortest and longest range that it measures [m].
        time_increment: Time from one beam to the next [s].
    """

    name: str
    mount: Pose2D
    height: float
    angles: FloatArray
    range_min: float
    range_max: float
    time_increment: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class PoseGraph:
    """Poses, the scans seen from them, and edges between them. N nodes, S scans, E edges.

    Within a part the odometry is continuous. The parts of a robot that was carried away, or of several runs, are tied
    to each other by loop edges alone, or not yet: then their poses are not in one frame.

    Attributes:
        times: Times of the nodes [s], on the clock of their part, shape (N,).
        parts: Which part a node belongs to, int32, shape (N,).
        poses: Poses of base_link in the map frame, corrected [m, rad], shape (N, 3).
        odometry: Odometry of base_link in the odom frame of the part [m, rad], shape (N, 3).
        lidars: The lidars.
        scan_nodes: Which node a scan belongs to, int32, shape (S,), ascending.
        scan_lidars: Which lidar measured it, int32, shape (S,).
        scan_poses: Base_link at the first and at the last beam, seen from the node [m, rad], shape (S, 2, 3).
        ranges: Of all scans, one after the other [m], float32, as REP-117 has them; a scan has as many as its lidar.
        edges: First node, second node and kind (`FOLLOWS` or `LOOP`), int32, shape (E, 3).
        transforms: Pose of the second node seen from the first [m, rad], shape (E, 3).
        covariances: Covariances of the transforms (x, y, yaw) [m², rad²], shape (E, 3, 3).
        robot: Name of the robot; empty where it is not known.
    """

    times: FloatArray
    parts: npt.NDArray[np.int32]
    poses: FloatArray
    odometry: FloatArray
    lidars: tuple[Lidar, ...]
    scan_nodes: npt.NDArray[np.int32]
    scan_lidars: npt.NDArray[np.int32]
    scan_poses: FloatArray
    ranges: npt.NDArray[np.float32]
    edges: npt.NDArray[np.int32]
    transforms: FloatArray
    covariances: npt.NDArray[np.float64]
    robot: str = ""


MOST_LIDARS = 64
MOST_BEAMS = 100_000
"""Limits of one robot: a catalogue of lidars has none with more."""

_FARTHEST_M = 1e6
_LATEST_S = 1e11
_LONGEST_NAME = 200


def check_pose_graph(graph: PoseGraph) -> None:
    """Check every array of a pose graph.

    Raises:
        InputError: If an array has another shape or type, or a value is out of range; the message names the array and
            the index.
    """
    nodes, scans, edges = _length(graph.times), _length(graph.scan_nodes), _length(graph.edges)
    kinds = (
        ("times", graph.times, np.float64, (nodes,)),
        ("parts", graph.parts, np.int32, (nodes,)),
        ("poses", graph.poses, np.float64, (nodes, 3)),
        ("odometry", graph.odometry, np.float64, (nodes, 3)),
        ("scan_nodes", graph.scan_nodes, np.int32, (scans,)),
        ("scan_lidars", graph.scan_lidars, np.int32, (scans,)),
        ("scan_poses", graph.scan_poses, np.float64, (scans, 2, 3)),
        ("ranges", graph.ranges, np.float32, (_length(graph.ranges),)),
        ("edges", graph.edges, np.int32, (edges, 3)),
        ("transforms", graph.transforms, np.float64, (edges, 3)),
        ("covariances", graph.covariances, np.float64, (edges, 3, 3)),
    )
    for name, values, kind, shape in kinds:
        if values.dtype != kind or values.shape != shape:
            raise InputError(
                f"{name}: an array of {values.dtype} and shape {values.shape}; it must be {np.dtype(kind)} and "
                f"{shape} like the others"
            )
    _check_lidars(graph.lidars)
    if len(graph.robot) > _LONGEST_NAME or not graph.robot.isprintable():
        raise InputError(f"robot: a name has at most {_LONGEST_NAME} printable characters")
    _check_within("times", graph.times, -_LATEST_S, _LATEST_S)
    for name in ("poses", "odometry", "scan_poses", "transforms"):
        _check_within(name, getattr(graph, name), -_FARTHEST_M, _FARTHEST_M)
    _check_within("parts", graph.parts, 0, max(0, nodes - 1))
    _check_scans(graph, nodes)
    _check_edges(graph, nodes)


def count_ranges(beams: npt.NDArray[np.int64], scan_lidars: npt.NDArray[np.int32]) -> int:
    """Return how many ranges scans have in all, of lidars with so many beams."""
    return int(beams[scan_lidars].sum()) if len(scan_lidars) else 0


def _length(values: npt.NDArray[np.generic]) -> int:
    return len(values) if values.ndim else 0


def _check_within(name: str, values: npt.NDArray[Any], low: float, high: float) -> None:
    """Refuse values out of a range; NaN is out of any."""
    with np.errstate(invalid="ignore"):
        good = (values >= low) & (values <= high)
    if not good.all():
        index = np.argwhere(~good)[0].tolist()
        place = ", ".join(map(str, index))
        raise InputError(f"{name}[{place}] is {values[tuple(index)]}; it must be from {low:g} to {high:g}")


def _check_lidars(lidars: tuple[Lidar, ...]) -> None:
    if len(lidars) > MOST_LIDARS:
        raise InputError(f"lidars: {len(lidars)} of them; a robot has at most {MOST_LIDARS}")
    for number, lidar in enumerate(lidars):
        what = f"lidar {number} ({lidar.name!r})"
        if len(lidar.name) > _LONGEST_NAME or not lidar.name.isprintable():
            raise InputError(f"lidar {number}: its name must have at most {_LONGEST_NAME} printable characters")
        if lidar.angles.ndim != 1 or not 1 <= len(lidar.angles) <= MOST_BEAMS:
            raise InputError(f"{what}: it must have 1 to {MOST_BEAMS} beams, got angles of shape {lidar.angles.shape}")
        if not np.isfinite(lidar.angles).all():
            raise InputError(f"{what}: the angle of a beam is not finite")
        for name in ("height", "range_min", "range_max", "time_increment"):
            number_ = getattr(lidar, name)
            if not (math.isfinite(number_) and 0.0 <= number_ <= _FARTHEST_M):
                raise InputError(f"{what}: {name} must be a finite number of 0 or more, got {number_}")
        if not lidar.range_min < lidar.range_max:
            raise InputError(f"{what}: range_min {lidar.range_min:g} m is not below range_max {lidar.range_max:g} m")


def _check_scans(graph: PoseGraph, nodes: int) -> None:
    if len(graph.scan_nodes):
        _check_within("scan_nodes", graph.scan_nodes, 0, nodes - 1)
        _check_within("scan_lidars", graph.scan_lidars, 0, len(graph.lidars) - 1)
    if (np.diff(graph.scan_nodes) < 0).any():
        raise InputError("scan_nodes: they must be ascending: the scans of one node follow each other")
    beams = np.array([len(lidar.angles) for lidar in graph.lidars], dtype=np.int64)
    wanted = count_ranges(beams, graph.scan_lidars)
    if len(graph.ranges) != wanted:
        raise InputError(f"ranges: {len(graph.ranges)} of them, and the beams of all scans are {wanted}")
    bad = np.isfinite(graph.ranges) & (graph.ranges < 0.0)
    if bad.any():
        raise InputError(f"ranges[{int(np.argmax(bad))}] is negative; minus infinity is a beam that met something near")


def _check_edges(graph: PoseGraph, nodes: int) -> None:
    if not len(graph.edges):
        return
    _check_within("edges", graph.edges[:, :2], 0, nodes - 1)
    if (graph.edges[:, 0] == graph.edges[:, 1]).any():
        edge = int(np.argmax(graph.edges[:, 0] == graph.edges[:, 1]))
        raise InputError(f"edges[{edge}] ties node {graph.edges[edge, 0]} to itself")
    if not np.isin(graph.edges[:, 2], (FOLLOWS, LOOP)).all():
        edge = int(np.argmin(np.isin(graph.edges[:, 2], (FOLLOWS, LOOP))))
        raise InputError(
            f"edges[{edge}] is of kind {graph.edges[edge, 2]}; there are {FOLLOWS} (follows) and {LOOP} (loop)"
        )
    _check_within("covariances", graph.covariances, -_FARTHEST_M, _FARTHEST_M)
    symmetric = np.abs(graph.covariances - graph.covariances.transpose(0, 2, 1)).max(axis=(1, 2))
    bad = (symmetric > 1e-9) | (np.linalg.eigvalsh(graph.covariances)[:, 0] <= 0.0)
    if bad.any():
        raise InputError(f"covariances[{int(np.argmax(bad))}] is no covariance: it must be symmetric and positive")
