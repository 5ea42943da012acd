"""`Footprint`: the outline of a robot on the floor, checked in one place."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, pad_outline


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
        distances = _edge_distances(outline)
        if not (distances > 0.0).all():
            raise InputError(f"base_link (0, 0) must lie inside the footprint {outline.tolist()}")
        outline.flags.writeable = False
        object.__setattr__(self, "outline", outline)
        object.__setattr__(self, "inscribed_radius", float(distances.min()))
        object.__setattr__(self, "circumscribed_radius", float(np.hypot(outline[:, 0], outline[:, 1]).max()))

    def padded(self, padding: float) -> Footprint:
        """The footprint with every edge moved outwards by `padding` [m]."""
        return Footprint(pad_outline(self.outline, padding))


def _read_corners(corners: npt.ArrayLike) -> FloatArray:
    """A copy of the corners, shape (N, 2)."""
    try:
        points = np.array(corners, dtype=np.float64, order="C", copy=True)
    except (TypeError, ValueError) as error:
        raise InputError(f"a footprint must be a robot or corners of shape (N, 2) [m]; {error}") from None
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3 or not np.isfinite(points).all():
        raise InputError(f"a footprint needs at least 3 finite corners of shape (N, 2) [m], got shape {points.shape}")
    return points


def _edge_distances(outline: FloatArray) -> FloatArray:
    """Distance [m] of base_link to the left of each edge of a counter-clockwise outline."""
    edges = np.roll(outline, -1, axis=0) - outline
    return (outline[:, 0] * edges[:, 1] - outline[:, 1] * edges[:, 0]) / np.hypot(edges[:, 0], edges[:, 1])
