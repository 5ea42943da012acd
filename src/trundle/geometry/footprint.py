"""`Footprint`, the outline of a robot on the floor, checked in one place; and what is computed of outlines."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry.poses import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Footprint:
    """The convex outline of a robot on the floor, with base_link inside.

    Attributes:
        outline: Corners in base_link [m], shape (N, 2). They may be given clockwise or counter-clockwise; the array
            is counter-clockwise and read-only.
        inscribed_radius: Distance [m] from base_link to the nearest edge.
        circumscribed_radius: Distance [m] from base_link to the farthest corner: the radius of a turn in place.

    Raises:
        InputError: If the corners do not go once round a convex outline with base_link (0, 0) inside.
    """

    outline: FloatArray
    inscribed_radius: float = field(init=False)
    circumscribed_radius: float = field(init=False)

    def __post_init__(self) -> None:
        outline = _read_corners(self.outline)
        edges = np.roll(outline, -1, axis=0) - outline
        following = np.roll(edges, -1, axis=0)
        turns = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
        total = np.arctan2(turns, (edges * following).sum(axis=1)).sum()
        if not ((turns > 0).all() or (turns < 0).all()) or abs(abs(total) - 2.0 * np.pi) > 1e-6:
            raise InputError(
                "the corners of a footprint must go once round a convex outline, none repeated or on a straight "
                f"edge; got {outline.tolist()}"
            )
        if turns[0] < 0:
            outline = outline[::-1].copy()
        self._take(outline)
        if not self.inscribed_radius > 0.0:
            raise InputError(f"base_link (0, 0) must lie inside the footprint {outline.tolist()}")

    @classmethod
    def of(cls, footprint: Footprint | npt.ArrayLike) -> Footprint:
        """Return a footprint itself, or one of corners in base_link [m], shape (N, 2)."""
        return footprint if isinstance(footprint, Footprint) else cls(footprint)  # type: ignore[arg-type]

    @property
    def size(self) -> tuple[float, float]:
        """Length along x and width along y [m]."""
        length, width = np.ptp(self.outline, axis=0).tolist()
        return length, width

    @property
    def least_width(self) -> float:
        """Width of the narrowest gap that it fits through [m]: the least distance between two parallel lines around it.

        The lines of least distance touch an edge (Houle and Toussaint 1988, "Computing the width of a set").
        """
        edges = np.roll(self.outline, -1, axis=0) - self.outline
        inwards = np.stack([-edges[:, 1], edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])
        return float(np.ptp(self.outline @ inwards, axis=0).min())

    def padded(self, padding: float) -> Footprint:
        """Return the footprint with every edge moved outwards by `padding` [m], 0 or more."""
        if not padding >= 0.0:
            raise InputError(f"the padding of a footprint must be 0 m or more, got {padding!r}")
        wider = object.__new__(Footprint)  # convex around base_link as this one is: nothing to check
        wider._take(pad_outline(self.outline, padding))
        return wider

    def shrink(self, margin: float) -> FloatArray | None:
        """Return the outline with every edge moved inwards by `margin` [m], shape (M, 2), or None if nothing is left.

        base_link may lie outside of it.
        """
        return shrink_outline(self.outline, margin)

    def at_poses(self, poses: FloatArray) -> FloatArray:
        """Return its corners [m] at poses (x, y, yaw) of shape (P, 3), in their frame; shape (P, N, 2)."""
        cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
        x = poses[:, 0, None] + cos * self.outline[:, 0] - sin * self.outline[:, 1]
        y = poses[:, 1, None] + sin * self.outline[:, 0] + cos * self.outline[:, 1]
        return np.stack([x, y], axis=-1)

    def _take(self, outline: FloatArray) -> None:
        """Keep a convex, counter-clockwise outline, and what follows from it."""
        outline.flags.writeable = False
        object.__setattr__(self, "outline", outline)
        object.__setattr__(self, "inscribed_radius", float(_edge_distances(outline).min()))
        object.__setattr__(self, "circumscribed_radius", float(np.hypot(outline[:, 0], outline[:, 1]).max()))


def _read_corners(corners: npt.ArrayLike) -> FloatArray:
    """Return a copy of the corners, shape (N, 2)."""
    try:
        points = np.array(corners, dtype=np.float64, order="C", copy=True)
    except (TypeError, ValueError) as error:
        raise InputError(f"a footprint must be a robot or corners of shape (N, 2) [m]; {error}") from None
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3 or not np.isfinite(points).all():
        raise InputError(f"a footprint needs at least 3 finite corners of shape (N, 2) [m], got shape {points.shape}")
    return points


def _edge_distances(outline: FloatArray) -> FloatArray:
    """Return the distance [m] of base_link to the left of each edge of a counter-clockwise outline."""
    edges = np.roll(outline, -1, axis=0) - outline
    return (outline[:, 0] * edges[:, 1] - outline[:, 1] * edges[:, 0]) / np.hypot(edges[:, 0], edges[:, 1])


def pad_outline(outline: npt.ArrayLike, padding: float) -> FloatArray:
    """Move every edge of a convex, counter-clockwise outline outwards by `padding` [m]; shape (N, 2) stays (N, 2)."""
    points = np.asarray(outline, dtype=np.float64)
    edges = np.roll(points, -1, axis=0) - points
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    before = np.roll(normals, 1, axis=0)
    # A corner moves along the sum of its two edges' normals, scaled to move both edges by the padding.
    shift = (before + normals) / (1.0 + (before * normals).sum(axis=1))[:, None]
    return points + padding * shift


def shrink_outline(outline: npt.ArrayLike, margin: float) -> FloatArray | None:
    """Inset a convex, counter-clockwise outline by `margin` [m]; None if nothing is left."""
    points = np.asarray(outline, dtype=np.float64)
    kept = points
    for first, second in zip(points, np.roll(points, -1, axis=0), strict=True):
        along = (second - first) / math.hypot(*(second - first))
        inside = along[0] * (kept[:, 1] - first[1]) - along[1] * (kept[:, 0] - first[0]) - margin
        # Sutherland and Hodgman 1974, against one edge.
        clipped: list[FloatArray] = []
        for i in range(len(kept)):
            before, here = inside[i - 1], inside[i]
            if (before > 0.0) != (here > 0.0):
                clipped.append(kept[i - 1] + before / (before - here) * (kept[i] - kept[i - 1]))
            if here > 0.0:
                clipped.append(kept[i])
        if len(clipped) < 3:
            return None
        kept = np.array(clipped)
    return kept


def convex_hull(points: FloatArray, *, least_turn: float = 0.0) -> FloatArray:
    """Return the convex hull of points, shape (N, 2), counter-clockwise (Andrew's monotone chain).

    Args:
        points: The points [m], shape (N, 2).
        least_turn: Corners stay that turn by more: the cross product of their edges [m²].
    """
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)

    def half(sequence: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for point in sequence:
            while len(chain) >= 2 and _turn(chain[-2], chain[-1], point) <= least_turn:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
