"""A small pose graph, for tests of what is done with one."""

from __future__ import annotations

import numpy as np

from trundle.geometry import Pose2D
from trundle.mapping import Lidar, PoseGraph


def make_graph(nodes: int = 5) -> PoseGraph:
    """A drive along x with two lidars, each node with a scan of both."""
    rng = np.random.default_rng(3)
    lidars = (
        Lidar("front", Pose2D(0.2, 0.0), 0.3, np.linspace(-1.5, 1.5, 7), 0.1, 12.0, 1e-4),
        Lidar("back", Pose2D(-0.2, 0.0, 3.0), 0.3, np.linspace(-1.5, 1.5, 5), 0.1, 12.0),
    )
    odometry = np.column_stack([0.5 * np.arange(nodes), np.zeros(nodes), np.zeros(nodes)])
    poses = odometry + rng.normal(0.0, 0.01, odometry.shape)
    scans = np.repeat(np.arange(nodes, dtype=np.int32), 2)
    ranges = rng.uniform(0.5, 9.0, 12 * nodes).astype(np.float32)
    ranges[::5], ranges[1::7], ranges[2::9] = np.inf, np.nan, -np.inf
    follows = np.column_stack([np.arange(nodes - 1), np.arange(1, nodes), np.zeros(nodes - 1)])
    edges = np.vstack([follows, (0, nodes - 1, 1)]).astype(np.int32)
    return PoseGraph(
        times=100.0 + np.arange(nodes),
        parts=np.zeros(nodes, dtype=np.int32),
        poses=poses,
        odometry=odometry,
        lidars=lidars,
        scan_nodes=scans,
        scan_lidars=np.tile(np.arange(2, dtype=np.int32), nodes),
        scan_poses=np.zeros((2 * nodes, 2, 3)),
        ranges=ranges,
        edges=edges,
        transforms=poses[edges[:, 1]] - poses[edges[:, 0]],
        covariances=np.tile(np.diag([1e-4, 1e-4, 1e-5]), (len(edges), 1, 1)),
        robot="nova_carter",
    )
