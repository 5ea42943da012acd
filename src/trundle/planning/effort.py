"""What a plan counts as, in expansions of a search of poses: `nominal_expansions` of a search over cells."""

from __future__ import annotations

import math

from trundle.geometry import FloatArray

_CELLS_AN_EXPANSION = 500
"""Cells that a wavefront settles while a search of poses expands one node: 30 to 40 million a second against 50,000 to
80,000 (benchmarks/planning/RESULTS.md)."""

_MOST = 5_000
"""So a drive over a map of 10,000² cells may plan again as often as one through a hall: once a second."""


def nominal_expansions(shape: tuple[int, ...], points: FloatArray | None = None) -> int:
    """What a search over cells counts as: by the rectangle around its path, or by the map where it found none.

    It is 5,000 at most: how long such a search takes depends on the map, and is no reason to give up a drive.

    Args:
        shape: Of the map, in cells.
        points: Of the path, in cells, shape (N, 2); None without a path.
    """
    cells = math.prod(shape)
    if points is not None:
        cells = min(cells, math.ceil(math.prod((points.max(axis=0) - points.min(axis=0) + 1.0).tolist())))
    return min(1 + cells // _CELLS_AN_EXPANSION, _MOST)
