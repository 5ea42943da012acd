"""Moving a pose graph: the same drive in another map frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.pose_graph import PoseGraph
from trundle.values import check_number


def move_pose_graph(graph: PoseGraph, origin: Pose2D) -> PoseGraph:
    """Return a pose graph in another map frame. Scans, odometry and edges stay as they are: they are relative.

    Args:
        graph: The graph.
        origin: Pose of its present map frame in the new one: for a drive that began at the origin, where it began.

    Raises:
        InputError: If the origin is farther away than 1,000 km.
    """
    for name, value in (("x", origin.x), ("y", origin.y)):
        check_number(f"{name} of the pose graph's origin", value, -1e6, 1e6, "m")
    return replace(graph, poses=compose_poses(origin, graph.poses))


def compose_poses(outer: Pose2D, poses: FloatArray) -> FloatArray:
    """Return `outer @ pose` of poses [m, m, rad], shape (N, 3); yaws are not wrapped."""
    moved = np.array(poses, dtype=np.float64)
    cos, sin = np.cos(outer.yaw), np.sin(outer.yaw)
    moved[:, 0] = outer.x + cos * poses[:, 0] - sin * poses[:, 1]
    moved[:, 1] = outer.y + sin * poses[:, 0] + cos * poses[:, 1]
    moved[:, 2] = poses[:, 2] + outer.yaw
    return moved
