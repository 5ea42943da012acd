"""Visible shapes without a collider nearby: walls that somebody forgot to make colliders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Tf, UsdGeom

from trundle.geometry import FloatArray
from trundle.geometry.solids import Solid, solids_bounds
from trundle.worlds.usd.walk import TIME, Place

LOW, HIGH = 0.01, 2.0
"""Shapes that end below or start above these heights over the ground [m] are floor or ceiling, and ignored."""

_NEAR = 0.01
_AT_ONCE = 1 << 22


def seen_without_collider(places: Sequence[Place], solids: Sequence[Solid], ground: float) -> list[Place]:
    """The shapes between floor and ceiling whose bounds overlap no solid above the floor.

    Args:
        places: Visible shapes that do not collide.
        solids: Solids made from colliders.
        ground: Its height [m].
    """
    bounds = [(place, _bounds(place)) for place in places]
    found = [
        (place, box)
        for place, box in bounds
        if box is not None and box[1][2] - ground > LOW and box[0][2] - ground < HIGH
    ]
    if not found:
        return []
    lows, highs = solids_bounds(solids)
    standing = highs[:, 2] - ground > LOW
    lows, highs = lows[standing] - _NEAR, highs[standing] + _NEAR
    step = max(1, _AT_ONCE // max(1, len(lows)))
    alone: list[Place] = []
    for start in range(0, len(found), step):
        boxes = np.array([box for _, box in found[start : start + step]])
        meets = ((boxes[:, None, 0] <= highs) & (boxes[:, None, 1] >= lows)).all(axis=-1).any(axis=-1)
        alone += [found[start + int(index)][0] for index in np.flatnonzero(~meets)]
    return alone


def _bounds(place: Place) -> FloatArray | None:
    """Lowest and highest corner [m] of a prim's extent in the map frame, shape (2, 3); None if it has no extent."""
    try:
        extent = UsdGeom.Boundable(place.prim).ComputeExtent(TIME)
    except Tf.ErrorException:
        return None
    box = np.array(extent or (), dtype=np.float64)
    if box.shape != (2, 3) or not np.isfinite(box).all() or (box[0] > box[1]).any():
        return None
    corners = np.array(np.meshgrid(*box.T)).reshape(3, -1)
    placed = (place.matrix[:3, :3] @ corners).T + place.matrix[:3, 3]
    return np.array([placed.min(axis=0), placed.max(axis=0)])
