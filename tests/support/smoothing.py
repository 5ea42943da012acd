"""What a smoothed path must keep to, worked out from its poses alone."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from support.swept import along_legs, densely
from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray
from trundle.path import Path
from trundle.planning.constrained_smoother import Smoothing, SmoothingSettings

SMALL = ((0.2, 0.12), (-0.3, 0.12), (-0.3, -0.12), (0.2, -0.12))


def wrapped(angles: FloatArray) -> FloatArray:
    return np.remainder(angles + np.pi, 2 * np.pi) - np.pi


def leg_curvatures(poses: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Curvature [1/m] of each leg, of the arc that its chord and its turn give, and its length [m].

    A curve that bends by k at most and turns by a has a chord of at least 2 sin(a / 2) / k.
    """
    steps = np.diff(poses, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    turns = np.abs(wrapped(steps[:, 2]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(turns < 1e-7, 0.0, 2 * np.sin(turns / 2) / lengths), lengths


def point_curvatures(points: FloatArray) -> FloatArray:
    """Curvature [1/m] of the circle through each three neighbouring points, shape (N − 2,)."""
    a, b, c = points[:-2], points[1:-1], points[2:]
    twice_area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    sides = np.hypot(*(b - a).T) * np.hypot(*(c - b).T) * np.hypot(*(c - a).T)
    return 2 * np.abs(twice_area) / sides


def price(costmap: Costmap, path: Path, w_cost: float) -> float:
    """Integral of 1 + w_cost · cost / 252 along a path, clipped at cells' borders; on those the higher cost counts."""
    points = costmap.origin.inverse().transform_points(path.poses[:, :2]) / costmap.resolution
    drives = np.hypot(*np.diff(points, axis=0).T) > 0
    weights = 1 + w_cost * np.minimum(np.arange(256), 252) / 252
    starts, ends = (np.ascontiguousarray(each[drives]) for each in (points[:-1], points[1:]))
    return costmap.resolution * float(_core.line_costs(costmap.data, weights, starts, ends).sum())


def off_path(points: FloatArray, path: Path) -> FloatArray:
    """Distance [m] of each point to the polyline of a path."""
    a, b = path.poses[:-1, :2], path.poses[1:, :2]
    along = b - a
    squared = np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip(((points[:, None] - a) * along).sum(axis=2) / squared, 0, 1)
    return np.hypot(*np.moveaxis(points[:, None] - a - share[..., None] * along, 2, 0)).min(axis=1)


def stops(path: Path) -> tuple[int, int]:
    """How many turns in place, and changes of direction, a path has."""
    curvature, lengths = leg_curvatures(path.poses)
    drives = lengths > 1e-9
    return int(np.count_nonzero(~drives & (curvature > 0))), int(np.count_nonzero(np.diff(path.backward[drives])))


def assert_contract(
    costmap: Costmap, before: Path, done: Smoothing, settings: SmoothingSettings, *, depth: float = 0.0
) -> None:
    """The whole contract but for the sweep between poses 1 cm apart; see `swept_area_blocked` for that.

    `depth` [m] is by how much a footprint may touch between poses that were checked, where it has no padding.
    """
    path, new = done.path, ~done.kept
    assert (path.poses[0] == before.poses[0]).all()
    assert (path.poses[-1] == before.poses[-1]).all()
    assert done.kept.shape == path.backward.shape == (len(path) - 1,)
    # Curvature of what is new, and its directions.
    tightest = 1 / settings.minimum_turning_radius
    curvature, lengths = leg_curvatures(path.poses)
    assert (lengths[new] > 0).all()
    assert curvature[new].max(initial=0) <= tightest * (1 + 1e-4) + 1e-4
    steps, turns = np.diff(path.poses[:, :2], axis=0), wrapped(np.diff(path.poses[:, 2]))
    middle = path.poses[:-1, 2] + turns / 2 + np.where(path.backward, np.pi, 0)
    askew = np.abs(wrapped(np.arctan2(steps[:, 1], steps[:, 0]) - middle))
    assert askew[new & (lengths > 1e-3)].max(initial=0) < 0.02  # a leg may lead round the joint of two arcs
    runs = np.flatnonzero(np.diff(np.concatenate([[0], np.where(new, np.where(path.backward, 2, 1), 0), [0]])))
    for first, last in itertools.pairwise(runs):
        if new[first] and last - first >= 2:
            points = path.poses[first : last + 1, :2]
            apart = np.concatenate([[True], np.hypot(*np.diff(points, axis=0).T) > 1e-3])
            if apart.sum() >= 3:
                assert point_curvatures(points[apart]).max() <= tightest * (1 + 1e-3) + 1e-3
    # What is kept is the old path's.
    ends = np.concatenate([path.poses[:-1][done.kept], path.poses[1:][done.kept]])
    if len(ends):
        assert off_path(ends[:, :2], before).max() < 1e-9 * (1 + np.abs(ends).max())
    # Free where it is new.
    dense = along_legs(path.poses[:-1][new], path.poses[1:][new], 0.01)
    outline = costmap.footprint * (1 - min(0.5, depth / costmap.inscribed_radius))
    assert not costmap.footprint_collides(dense, outline=outline).any()
    # Its cost is no higher, and neither are the costs of its cells.
    was, now = (price(costmap, each, settings.w_cost) for each in (before, path))
    assert [done.cost_before, done.cost_after] == pytest.approx([was, now], rel=1e-6, abs=1e-6)
    assert done.cost_after <= (1 + settings.cost_tolerance) * done.cost_before * (1 + 1e-9)
    dearest = (int(np.minimum(costmap.cost_at(*densely(each)[:, :2].T), 252).max()) for each in (path, before))
    beside = math.exp(
        1.5 * costmap.resolution * costmap.cost_scaling_factor
    )  # how much dearer than a cell its neighbours
    rim = 252 * math.exp(-costmap.cost_scaling_factor * (costmap.inflation_radius - costmap.inscribed_radius))
    assert next(dearest) <= 1 + beside * max(next(dearest), rim)
    # No stop is added.
    assert all(after <= earlier for after, earlier in zip(stops(path), stops(before), strict=True))


def polyline(*corners, start_yaw=None, goal_yaw=None, backward=False):
    """A path along corners (x, y), with turns in place at each."""
    points = [np.array(corner, dtype=float) for corner in corners]
    headings = [math.atan2(*(b - a)[::-1]) + (math.pi if backward else 0) for a, b in itertools.pairwise(points)]
    poses = [] if start_yaw is None else [(*points[0], start_yaw)]
    for (a, b), heading in zip(itertools.pairwise(points), headings, strict=True):
        count = max(1, math.ceil(math.dist(a, b) / 0.1))
        poses += [(*(a + k / count * (b - a)), heading) for k in range(count + 1)]
    if goal_yaw is not None:
        poses.append((*points[-1], goal_yaw))
    return Path(np.array(poses), backward=np.full(len(poses) - 1, backward))


def turning(path):
    """Total change of yaw [rad]."""
    return np.abs(wrapped(np.diff(path.poses[:, 2]))).sum()


def tightest_bend(path):
    """Largest curvature [1/m]."""
    curvature, lengths = leg_curvatures(path.poses)
    return curvature[lengths > 1e-9].max()
