"""The parts of a graph: what hangs together, how a part that is recognised is moved, and what loops have changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.loops import Loop
from trundle.mapping.nodes import Nodes
from trundle.mapping.pose_graph import FOLLOWS, LOOP, PoseGraph


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


@dataclass(frozen=True, slots=True)
class Correction:
    """A loop, and by how much the robot had lost its way when it closed.

    Attributes:
        first, second: The nodes: the old place, and the one that recognised it.
        time: When it was recognised [s], on the clock of the part.
        metres, radians: How far the second node was off, by odometry and scan matching from the first one on; None for
            a loop between two parts, which had nothing to be off from.
    """

    first: int
    second: int
    time: float
    metres: float | None
    radians: float | None


def find_corrections(graph: PoseGraph) -> tuple[Correction, ...]:
    """Return the loops of a graph: those that join parts first, then the largest correction first."""
    chained = _chain(graph)
    found: list[Correction] = []
    for one, other, kind in graph.edges.tolist():
        first, second = min(one, other), max(one, other)
        if kind != LOOP:
            continue
        metres = radians = None
        if graph.parts[first] == graph.parts[second]:
            predicted = chained[first].inverse() @ chained[second]
            real = _pose(graph, first).inverse() @ _pose(graph, second)
            off = predicted.inverse() @ real
            metres, radians = float(np.hypot(off.x, off.y)), abs(off.yaw)
        found.append(Correction(first, second, float(graph.times[second]), metres, radians))
    found.sort(key=lambda one: (one.metres is not None, -(one.metres or 0.0), one.second))
    return tuple(found)


def joined_nodes(graph: PoseGraph) -> npt.NDArray[np.bool_]:
    """Return which nodes hang together with the first one, shape (N,): the others are in no map yet."""
    if not len(graph.times):
        return np.zeros(0, dtype=bool)
    roots = np.array(component_of(len(graph.times), graph.edges))
    return roots == roots[0]


def _chain(graph: PoseGraph) -> list[Pose2D]:
    """Return the nodes' poses by the edges from one to the next alone; each part begins where it lies now."""
    before: dict[int, tuple[int, Pose2D]] = {}
    for (first, second, kind), transform in zip(graph.edges.tolist(), graph.transforms.tolist(), strict=True):
        if kind == FOLLOWS and first < second:
            before[second] = first, Pose2D(*transform)
    poses: list[Pose2D] = []
    for node in range(len(graph.times)):
        known = before.get(node)
        poses.append(_pose(graph, node) if known is None else poses[known[0]] @ known[1])
    return poses


def _pose(graph: PoseGraph, node: int) -> Pose2D:
    return Pose2D(*graph.poses[node].tolist())
