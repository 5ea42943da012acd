"""The parts of a graph: what hangs together, how a part is moved, and the poses that fit all edges best."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import solve_graph
from trundle.geometry import FloatArray, Pose2D, wrap_angle
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
        time: Time at which it was recognised [s], on the clock of the part.
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


_TRUE_M, _TRUE_RAD = 0.03, math.radians(0.3)  # less than a cell of the map
_WIDTH = 3.0  # standard deviations, from which on a loop counts less
_WRONG = 25.0  # squared error of new loops that do not fit: about 4 standard deviations


def optimize(nodes: Nodes, *, iterations: int = 10, free: Sequence[int] = ()) -> tuple[FloatArray, FloatArray]:
    """Return corrected poses (N, 3), and the squared error of each edge (E,).

    Args:
        nodes: The graph; it is not changed.
        iterations: The most.
        free: Edges that count in full, whatever their error: loops that are new.
    """
    poses = np.array(nodes.poses)
    edges = np.array(nodes.edges, dtype=np.int32).reshape(-1, 3)
    if not len(edges):
        return poses, np.empty(0)
    transforms = np.array(nodes.transforms)
    information = np.linalg.inv(np.array(nodes.covariances))
    information = np.ascontiguousarray(0.5 * (information + information.transpose(0, 2, 1)))
    fixed = np.zeros(len(poses), dtype=np.uint8)
    fixed[first_of_components(len(poses), edges)] = 1
    widths = np.where(edges[:, 2] == LOOP, _WIDTH, 0.0)
    ends = np.ascontiguousarray(edges[:, :2])
    if len(free):
        first = widths.copy()
        first[list(free)] = 0.0
        poses, _, _ = solve_graph(poses, ends, transforms, information, first, fixed, iterations)
    poses, errors, _ = solve_graph(poses, ends, transforms, information, widths, fixed, iterations)
    return poses, errors


def fits(errors: FloatArray) -> bool:
    """Return whether the squared errors of new loops say that these are right."""
    return float(np.median(errors)) <= _WRONG


def is_true(nodes: Nodes, loop: Loop) -> bool:
    """Return whether a loop says what the poses say already: then the graph need not be solved again."""
    seen = nodes.pose(loop.a).inverse() @ nodes.pose(loop.b)
    turn = abs(wrap_angle(seen.yaw - loop.transform.yaw))
    return seen.distance_to(loop.transform) < _TRUE_M and turn < _TRUE_RAD


def contradicts(nodes: Nodes, loop: Loop, part: int, covariance: FloatArray) -> bool:
    """Return whether a loop moves a part by more than is likely, for where that lies by this covariance."""
    if nodes.parts[loop.b] != part:
        return False
    first = nodes.parts.index(part)
    at = nodes.pose(first)
    moved = nodes.pose(loop.a) @ loop.transform @ nodes.pose(loop.b).inverse() @ at
    off = np.array((moved.x - at.x, moved.y - at.y, wrap_angle(moved.yaw - at.yaw)))
    return bool(off @ np.linalg.solve(covariance, off) > _WRONG)
