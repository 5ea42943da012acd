"""What of a graph hangs together, and how a part that is recognised is moved to the others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.loops import Loop
from trundle.mapping.nodes import Nodes


def join_parts(nodes: Nodes, loop: Loop) -> list[FloatArray]:
    """Return the poses with the part of a key frame moved to where a loop says, if nothing joins it to the other yet.

    The same list comes back where nothing moves. What holds the first node stays.
    """
    if nodes.parts[loop.a] == nodes.parts[loop.b]:
        return nodes.poses
    roots = component_of(len(nodes), nodes.edges)
    if roots[loop.a] == roots[loop.b]:
        return nodes.poses
    stays, moves = (loop.a, loop.b) if roots[loop.a] < roots[loop.b] else (loop.b, loop.a)
    T_a_b = loop.transform if stays == loop.a else loop.transform.inverse()
    shift = nodes.pose(stays) @ T_a_b @ nodes.pose(moves).inverse()
    moved = [np.array((shift @ nodes.pose(i)).as_tuple()) for i in range(len(nodes))]
    return [moved[i] if root == roots[moves] else nodes.poses[i] for i, root in enumerate(roots)]


def nearest_joined(nodes: Nodes, pose: Pose2D) -> int:
    """Return the node that is nearest to a pose, of those that hang together with the first one."""
    roots = np.array(component_of(len(nodes), nodes.edges))
    off = np.hypot(*(np.array(nodes.poses)[:, :2] - (pose.x, pose.y)).T)
    return int(np.where(roots == roots[0], off, np.inf).argmin())


def component_of(count: int, edges: Sequence[tuple[int, int, int]] | np.ndarray) -> list[int]:
    """Return the first node of what each node hangs together with."""
    root = list(range(count))

    def find(node: int) -> int:
        while root[node] != node:
            root[node] = root[root[node]]
            node = root[node]
        return node

    pairs = edges.tolist() if isinstance(edges, np.ndarray) else edges
    for a, b, _ in pairs:
        first, second = find(a), find(b)
        if first != second:
            root[max(first, second)] = min(first, second)
    return [find(node) for node in range(count)]


def first_of_components(count: int, edges: np.ndarray) -> list[int]:
    """Return the first node of each component."""
    return sorted(set(component_of(count, edges)))
