"""`PoseGraph`: all that a mapper knows, as arrays: where the robot was, what it saw, and what ties poses together.

The idea: the map is drawn from the graph and can always be drawn again. So only the graph is saved, continued, moved
and merged; what a correction changes are the nodes' poses alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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
        times: Of the nodes [s], on the clock of their part, shape (N,).
        parts: Which part a node belongs to, int32, shape (N,).
        poses: Of base_link in the map frame, corrected [m, rad], shape (N, 3).
        odometry: Of base_link in the odom frame of the part [m, rad], shape (N, 3).
        lidars: The lidars.
        scan_nodes: Which node a scan belongs to, int32, shape (S,), ascending.
        scan_lidars: Which lidar measured it, int32, shape (S,).
        scan_poses: Base_link at the first and at the last beam, seen from the node [m, rad], shape (S, 2, 3).
        ranges: Of all scans, one after the other [m], float32, as REP-117 has them; a scan has as many as its lidar.
        edges: First node, second node and kind (`FOLLOWS` or `LOOP`), int32, shape (E, 3).
        transforms: Pose of the second node seen from the first [m, rad], shape (E, 3).
        covariances: Of the transforms (x, y, yaw) [m², rad²], shape (E, 3, 3).
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
