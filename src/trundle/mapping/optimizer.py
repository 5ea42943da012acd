"""Corrected poses of a graph: least squares over its edges, robust where loops may be wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle._core import solve_graph
from trundle.geometry import FloatArray, wrap_angle
from trundle.mapping.loops import Loop
from trundle.mapping.nodes import Nodes
from trundle.mapping.parts import first_of_components
from trundle.mapping.pose_graph import LOOP

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
