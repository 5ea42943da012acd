"""Corrected poses of a graph: least squares over its edges, robust where loops may be wrong."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle._core import solve_graph
from trundle.geometry import FloatArray
from trundle.mapping.nodes import Nodes
from trundle.mapping.pose_graph import LOOP

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
    """Whether the squared errors of new loops say that these are right."""
    return float(np.median(errors)) <= _WRONG


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
