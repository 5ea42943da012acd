"""Distances in the plane between footprints and the sections of solids, for many at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.sim.sections import Disc

_LEAST_AREA = 1e-12
"""Twice the area [m²] below which it is rounding noise."""

_CHUNK = 2_000_000
"""Pairs of edges per batch."""


def polygon_distances(outlines: FloatArray, polygons: FloatArray) -> FloatArray:
    """Distances [m] from convex outlines to the nearest of several convex polygons; 0 if they overlap.

    Args:
        outlines: Corners, counter-clockwise, shape (P, N, 2).
        polygons: Corners in either sense, also repeated or on one line, shape (Q, M, 2), Q ≥ 1.

    Returns:
        Shape (P,).
    """
    corners = polygons.shape[0] * polygons.shape[1]
    rows = max(1, _CHUNK // (corners * outlines.shape[1]))
    parts = [_polygon_distances(outlines[first : first + rows], polygons) for first in range(0, len(outlines), rows)]
    return np.concatenate(parts)


def disc_distances(outlines: FloatArray, disc: Disc) -> FloatArray:
    """Distances [m] from convex outlines, counter-clockwise, shape (P, N, 2), to a disc; 0 if they overlap."""
    centre = np.array([[[disc.x, disc.y]]])
    return np.maximum(polygon_distances(outlines, centre) - disc.radius, 0.0)


def _polygon_distances(outlines: FloatArray, polygons: FloatArray) -> FloatArray:
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
    # A polygon without area is on both sides of its own line.
    x, y = polygons[..., 0], polygons[..., 1]
    area = (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    return (within & (np.abs(area) > _LEAST_AREA)).any(axis=1)
