"""The outline of a robot on the floor."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.robots import Robot


def as_outline(footprint: Robot | npt.ArrayLike) -> FloatArray:
    """Take a robot, or the corners of its outline in base_link [m], shape (N, 2), either way round.

    Returns:
        The corners counter-clockwise, shape (N, 2), read-only.

    Raises:
        InputError: If they do not go once round a convex outline with base_link (0, 0) inside.
    """
    if isinstance(footprint, Robot):
        return footprint.outline
    try:
        points = np.array(footprint, dtype=np.float64, order="C", copy=True)
    except (TypeError, ValueError) as error:
        raise InputError(f"a footprint must be a robot or corners of shape (N, 2) [m]; {error}") from None
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3 or not np.isfinite(points).all():
        raise InputError(f"a footprint needs at least 3 finite corners of shape (N, 2) [m], got shape {points.shape}")
    edges = np.roll(points, -1, axis=0) - points
    following = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    total = np.arctan2(turns, (edges * following).sum(axis=1)).sum()
    if not ((turns > 0).all() or (turns < 0).all()) or abs(abs(total) - 2.0 * np.pi) > 1e-6:
        raise InputError(
            "a footprint must be convex, with its corners in order and none of them repeated or on a straight edge; "
            f"got {points.tolist()}"
        )
    if turns[0] < 0:
        points = points[::-1].copy()
    if not (_edge_distances(points) > 0.0).all():
        raise InputError(f"base_link (0, 0) must lie inside the footprint {points.tolist()}")
    points.flags.writeable = False
    return points


def inscribed_radius(outline: FloatArray) -> float:
    """Distance [m] from base_link to the nearest edge of a counter-clockwise outline."""
    return float(_edge_distances(outline).min())


def circumscribed_radius(outline: FloatArray) -> float:
    """Distance [m] from base_link to the farthest corner of an outline."""
    return float(np.hypot(outline[:, 0], outline[:, 1]).max())


def _edge_distances(outline: FloatArray) -> FloatArray:
    """Distance [m] of base_link to the left of each edge of a counter-clockwise outline."""
    edges = np.roll(outline, -1, axis=0) - outline
    return (outline[:, 0] * edges[:, 1] - outline[:, 1] * edges[:, 0]) / np.hypot(edges[:, 0], edges[:, 1])
