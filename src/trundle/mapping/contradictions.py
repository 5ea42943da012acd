"""`seen_through`: whether what two key frames saw can be true at the same time, where a match says that both are.

Rooms that look alike fit each other, but not to the last thing in them: beams of one pass through what the other saw.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.mapping.nodes import Nodes, Surface
from trundle.mapping.submaps import Submaps

_TOLERANCE_M, _TOLERANCE_SHARE = 0.3, 0.03  # so far behind a point a beam has to end
_ASIDE_RAD = math.radians(1.5)  # between a point and the beams beside it
_LIDARS_APART_M = 0.2
_POINTS, _FRAMES = 360, 4  # of a key frame, and of a submap: at least so many are compared, where there are as many
_FEWEST = 100  # of what is compared, so many points are where the other place's beams reach


@dataclass(frozen=True, slots=True)
class _Beams:
    """Beams of one lidar: where they began (2,), and directions [rad] and lengths [m] in the order of directions."""

    origin: FloatArray
    bearings: FloatArray
    lengths: FloatArray


def seen_through(nodes: Nodes, submaps: Submaps, a: int, b: int, transform: Pose2D) -> float:
    """Return the share of points that the other place's beams pass through, of those that they reach; 1 without any.

    In an office with six people, it was at most 0.11 for 9 right matches, and at least 0.10 for 52 wrong ones, of which
    48 were above 0.13.

    Args:
        nodes: The graph.
        submaps: Its submaps.
        a: The middle node of a submap.
        b: A key frame.
        transform: Pose of the key frame seen from the middle node.
    """
    submap, seen = submaps.all[submaps.of_node[a]], nodes.key_surface(b)
    reached = through = 0
    for node in range(submap.first, submap.last + 1, max(1, (submap.last + 1 - submap.first) // _FRAMES)):
        known = nodes.key_surface(node)
        T_node_b = submaps.seen_from_middle(submap, node).inverse() @ transform
        for viewer, other, pose in ((known, seen, T_node_b), (seen, known, T_node_b.inverse())):
            points = pose.transform_points(other.points[:: max(1, len(other.points) // _POINTS)])
            for beams in _lidars(viewer):
                counts = _count(beams, points)
                reached, through = reached + counts[0], through + counts[1]
    return through / reached if reached >= _FEWEST else 1.0


def _lidars(surface: Surface) -> Iterator[_Beams]:
    """The beams of each lidar; in a surface they come one lidar after the other."""
    if not len(surface.points):
        return
    apart = np.hypot(*np.diff(surface.sensors, axis=0).T)
    for part in np.split(np.arange(len(surface.points)), np.flatnonzero(apart > _LIDARS_APART_M) + 1):
        origin = surface.sensors[part].mean(axis=0)
        bearings, lengths = _polar(surface.points[part] - origin)
        order = np.argsort(bearings, kind="stable")
        yield _Beams(origin, bearings[order], lengths[order])


def _count(beams: _Beams, points: FloatArray) -> tuple[int, int]:
    """How many points the beams beside them reach, and through how many of these they pass."""
    bearings, lengths = _polar(points - beams.origin)
    index, count = np.searchsorted(beams.bearings, bearings), len(beams.bearings)
    sides = np.stack([(index - 1) % count, index % count])
    aside = np.abs(np.remainder(bearings - beams.bearings[sides] + math.pi, 2.0 * math.pi) - math.pi).min(axis=0)
    ends = beams.lengths[sides]
    reached = (aside < _ASIDE_RAD) & (lengths <= ends.max(axis=0) + _TOLERANCE_M)
    through = reached & (lengths < ends.min(axis=0) - _TOLERANCE_M - _TOLERANCE_SHARE * lengths)
    return int(reached.sum()), int(through.sum())


def _polar(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
