"""Distances of outlines from polygons and of points from a polyline, in NumPy."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

_LEAST_AREA = 1e-12
"""Twice the area [m²] below which it is rounding noise."""


def polygon_distances(outlines: FloatArray, polygons: FloatArray) -> FloatArray:
    points = polygons.reshape(-1, 2)
    starts, ends = points, np.roll(polygons, -1, axis=1).reshape(-1, 2)
    own_ends = np.roll(outlines, -1, axis=1)
    # If two segments do not cross, the shortest distance is at an end of one of them.
    to_outline = _point_to_segments(points[None, :, None], outlines[:, None], own_ends[:, None])
    to_polygon = _point_to_segments(outlines[:, :, None], starts, ends)
    nearest = np.minimum(to_outline.min(axis=(1, 2)), to_polygon.min(axis=(1, 2)))
    within = _side(outlines[:, None], own_ends[:, None], points[None, :, None]) >= 0.0
    inside = np.any(within.all(axis=2), axis=1)
    crossing = _cross(outlines[:, :, None], own_ends[:, :, None], starts, ends).any(axis=(1, 2))
    around = _is_inside(outlines[:, 0], polygons)
    return np.where(inside | crossing | around, 0.0, nearest)


def _point_to_segments(points: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    along = ends - starts
    squared = (along * along).sum(axis=-1)
    offset = points - starts
    share = np.clip((offset * along).sum(axis=-1) / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
    rest = offset - share[..., None] * along
    return np.hypot(rest[..., 0], rest[..., 1])


def _side(starts: FloatArray, ends: FloatArray, points: FloatArray) -> FloatArray:
    """Positive if a point is on the left of a line."""
    along, offset = ends - starts, points - starts
    return along[..., 0] * offset[..., 1] - along[..., 1] * offset[..., 0]


def _cross(a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether segments a to b and c to d cross."""
    return (_side(a, b, c) * _side(a, b, d) < 0.0) & (_side(c, d, a) * _side(c, d, b) < 0.0)


def _is_inside(points: FloatArray, polygons: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether each of some points (P, 2) is inside one of some convex polygons (Q, M, 2), of either sense."""
    sides = _side(polygons, np.roll(polygons, -1, axis=1), points[:, None, None])
    within = (sides >= 0.0).all(axis=2) | (sides <= 0.0).all(axis=2)
    # A polygon without area is on both sides of its line.
    x, y = polygons[..., 0], polygons[..., 1]
    area = (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    return (within & (np.abs(area) > _LEAST_AREA)).any(axis=1)


def distances_to_polyline(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Distance [m] of each of `points` (N, 2) to the nearest place on a polyline with `corners` (M, 2), M ≥ 1."""
    starts = corners[:-1] if len(corners) > 1 else corners
    along = np.diff(corners, axis=0) if len(corners) > 1 else np.zeros_like(corners)
    squared = (along * along).sum(axis=1)
    nearest = np.empty(len(points))
    for first in range(len(points)):
        offsets = points[first : first + 1, None, :] - starts[None, :, :]
        projected = (offsets * along).sum(axis=2)
        fraction = np.clip(projected / np.where(squared > 0.0, squared, 1.0), 0.0, 1.0)
        gaps = offsets - fraction[:, :, None] * along
        nearest[first : first + 1] = np.sqrt((gaps * gaps).sum(axis=2).min(axis=1))
    return nearest
