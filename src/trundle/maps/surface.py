"""Where the surfaces of solids lie in the cells that they occupy: at the cells' borders, or somewhere inside."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry.solids import Box, Solid, solids_bounds
from trundle.maps.cells import Surface
from trundle.maps.rasterise import HeightBand

_LEAST_DEPTH = 0.25
"""Share of a cell, on average over the faces: halfway between walls on cell borders (0) and walls anywhere (a half)."""

_SQUARE = 1e-9


def find_surface(solids: Sequence[Solid], resolution: float, corner: tuple[float, float], band: HeightBand) -> Surface:
    """Return where surfaces lie in the cells that solids reach into.

    The faces of a box that is aligned with the cells lie at a known depth below the rim of what is marked; those of any
    other shape lie half a cell below it on average.

    Args:
        solids: What the map shows.
        resolution: Edge of a cell [m].
        corner: Lower-left corner of the map [m].
        band: The heights that are marked.
    """
    if not solids:
        return "border"
    lows, highs = solids_bounds(solids)
    inside = (highs[:, 2] > band.low) & (lows[:, 2] < band.high)
    aligned = np.array([_is_aligned(solid) for solid in solids], dtype=np.bool_)
    low, high = ((bounds[inside][:, :2] - corner) / resolution for bounds in (lows, highs))
    # How far the rim of the marked cells is outside of each face, in cells; a micrometre of rounding is none.
    slack = 1e-6 / resolution
    depths = np.stack([low - np.floor(low + slack), np.ceil(high - slack) - high], axis=1).clip(0.0, 1.0)
    depths[~aligned[inside]] = 0.5
    lengths = np.stack([(high - low)[:, ::-1]] * 2, axis=1)  # a face across x is as long as the solid is in y
    total = float(lengths.sum())
    return "overlap" if total > 0.0 and float((depths * lengths).sum()) / total > _LEAST_DEPTH else "border"


def _is_aligned(solid: Solid) -> bool:
    """Whether a solid is a box whose sides are parallel to the axes."""
    if not isinstance(solid.shape, Box):
        return False
    rotation = np.abs(solid.pose.rotation())
    return bool((np.minimum(rotation, np.abs(1.0 - rotation)) < _SQUARE).all())
