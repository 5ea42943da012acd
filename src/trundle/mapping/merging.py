"""Pose graphs of pose graphs: `merge_pose_graphs`, and `move_pose_graph` into another map frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.mapper import Mapper
from trundle.mapping.pose_graph import MOST_LIDARS, Lidar, PoseGraph
from trundle.robots import Robot
from trundle.values import check_number


def merge_pose_graphs(first: PoseGraph, second: PoseGraph, robot: Robot) -> PoseGraph:
    """Join two pose graphs by the mapper's search for loops; the map frame is that of the first one.

    Parts of the second one that are not recognised stay as they are, and out of the map until something ties them.

    Args:
        first: The graph whose map frame stays.
        second: The other graph.
        robot: The robot, whose outline is left out of the scans.

    Raises:
        InputError: If both have more lidars together than a graph may have.
    """
    mapper = Mapper.from_graph(put_together(first, second), robot)
    mapper.seek_loops(len(first.times))
    mapper.finish()
    return replace(mapper.graph(), robot=first.robot or second.robot)


def put_together(first: PoseGraph, second: PoseGraph) -> PoseGraph:
    """Return both graphs as one, with nothing between them: the second one's parts are new ones."""
    lidars = list(first.lidars)
    numbers = [_find_or_add(lidars, lidar) for lidar in second.lidars]
    if len(lidars) > MOST_LIDARS:
        raise InputError(f"both pose graphs together have {len(lidars)} lidars; the limit is {MOST_LIDARS}")
    nodes = len(first.times)
    parts = int(first.parts.max()) + 1 if nodes else 0
    own = np.unique(second.parts, return_inverse=True)[1].astype(np.int32).reshape(-1)
    edges = second.edges + np.array((nodes, nodes, 0), dtype=np.int32)
    lidar_of = np.array(numbers, dtype=np.int32)[second.scan_lidars] if numbers else second.scan_lidars
    return PoseGraph(
        times=np.concatenate([first.times, second.times]),
        parts=np.concatenate([first.parts, own + np.int32(parts)]),
        poses=np.concatenate([first.poses, second.poses]),
        odometry=np.concatenate([first.odometry, second.odometry]),
        lidars=tuple(lidars),
        scan_nodes=np.concatenate([first.scan_nodes, second.scan_nodes + np.int32(nodes)]),
        scan_lidars=np.concatenate([first.scan_lidars, lidar_of]),
        scan_poses=np.concatenate([first.scan_poses, second.scan_poses]),
        ranges=np.concatenate([first.ranges, second.ranges]),
        edges=np.concatenate([first.edges, edges]),
        transforms=np.concatenate([first.transforms, second.transforms]),
        covariances=np.concatenate([first.covariances, second.covariances]),
        robot=first.robot or second.robot,
    )


def _find_or_add(lidars: list[Lidar], lidar: Lidar) -> int:
    for number, one in enumerate(lidars):
        same = (one.name, one.mount, one.range_min, one.range_max) == (
            lidar.name,
            lidar.mount,
            lidar.range_min,
            lidar.range_max,
        )
        if same and np.array_equal(one.angles, lidar.angles):
            return number
    lidars.append(lidar)
    return len(lidars) - 1


def move_pose_graph(graph: PoseGraph, origin: Pose2D) -> PoseGraph:
    """Return a pose graph in another map frame. Scans, odometry and edges stay as they are: they are relative.

    Args:
        graph: The graph.
        origin: Pose of its present map frame in the new one: for a drive that began at the origin, where it began.

    Raises:
        InputError: If the origin is farther away than 1,000 km.
    """
    check_origin(origin)
    return replace(graph, poses=compose_poses(origin, graph.poses))


def check_origin(origin: Pose2D) -> None:
    """Check that a pose graph can be moved there.

    Raises:
        InputError: If that is farther away than 1,000 km.
    """
    for name, value in (("x", origin.x), ("y", origin.y)):
        check_number(f"{name} of the pose graph's origin", value, -1e6, 1e6, "m")


def compose_poses(outer: Pose2D, poses: FloatArray) -> FloatArray:
    """Return `outer @ pose` of poses [m, m, rad], shape (N, 3); yaws are not wrapped."""
    moved = np.array(poses, dtype=np.float64)
    cos, sin = np.cos(outer.yaw), np.sin(outer.yaw)
    moved[:, 0] = outer.x + cos * poses[:, 0] - sin * poses[:, 1]
    moved[:, 1] = outer.y + sin * poses[:, 0] + cos * poses[:, 1]
    moved[:, 2] = poses[:, 2] + outer.yaw
    return moved
