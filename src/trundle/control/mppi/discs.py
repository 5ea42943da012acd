"""Discs that cover a footprint, along the axis of the robot."""

from __future__ import annotations

import itertools
import math

import numpy as np

from trundle.geometry import FloatArray, Footprint

MOST_DISCS = 8
_WIDER = 0.17
"""Share of the half width by which a disc may reach past the sides; more discs reach less far."""


def cover_with_discs(footprint: Footprint, padding: float = 0.0) -> FloatArray:
    """The fewest discs on base_link's x axis that cover a footprint and reach little past its sides.

    The outline is cut across its axis into slices of equal length. A disc lies on the axis in the middle of each slice
    and just covers it.

    Args:
        footprint: A convex outline around base_link.
        padding: What it is widened by first [m].

    Returns:
        (x, radius) [m] of each disc, base_link, from the rear to the front, shape (K, 2) with K from 1 to 8.
    """
    outline = footprint.padded(padding).outline if padding > 0.0 else footprint.outline
    half_width = float(np.abs(outline[:, 1]).max())
    discs = _cover(outline, 1)
    for count in range(2, MOST_DISCS + 1):
        if float(discs[:, 1].max()) <= (1.0 + _WIDER) * half_width:
            break
        discs = _cover(outline, count)
    return discs


def _cover(outline: FloatArray, count: int) -> FloatArray:
    rear, front = float(outline[:, 0].min()), float(outline[:, 0].max())
    edges: list[float] = np.linspace(rear, front, count + 1).tolist()
    points: list[tuple[float, float]] = [(x, y) for x, y in outline.tolist()]
    discs: list[tuple[float, float]] = []
    for low, high in itertools.pairwise(edges):
        middle = 0.5 * (low + high)
        reach = max(math.hypot(x - middle, y) for x, y in _slice(points, low, high))
        discs.append((middle, reach))
    return np.array(discs)


def _slice(points: list[tuple[float, float]], low: float, high: float) -> list[tuple[float, float]]:
    """Corners of the part of a convex outline between two values of x."""
    kept = [(x, y) for x, y in points if low <= x <= high]
    for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[0]], strict=True):
        kept += [
            (cut, y0 + (y1 - y0) * (cut - x0) / (x1 - x0)) for cut in (low, high) if min(x0, x1) < cut < max(x0, x1)
        ]
    return kept
