"""Where the members of a crowd can be in a world."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from trundle._core import CrowdFloor, inflate, label_components
from trundle.geometry.solids import Solid
from trundle.maps.rasterise import HeightBand, SolidRaster

# Edge of a cell [m], as in the usual maps; it grows in larger worlds, which bounds the number of cells.
_RESOLUTION = 0.05
_MOST_CELLS = 1_000_000
_FLOOR_TOP = 0.05  # what is not higher is driven over [m]
_WALL = 255  # the cost of what is impassable
_BASE, _EXTRA, _DECAY_M = 10.0, 60.0, 0.4  # what a cell costs: paths keep off solids where there is room
_NEAR_M = 1.2  # solids that are farther than this from the disc are not felt [m]
_AHEAD_M = 0.3  # how far along its path somebody looks [m]


def make_floor(
    solids: Sequence[Solid], bounds: tuple[float, float, float, float], radius: float, top: float
) -> CrowdFloor | None:
    """Return where a disc is clear of a world's solids, as far as one can get from the largest such area.

    Args:
        solids: The world's solids.
        bounds: (x0, y0, x1, y1) [m], which the disc does not leave.
        radius: Radius of the disc [m].
        top: Solids that start above this height do not matter [m].

    Returns:
        The floor, or None where there is no such place.
    """
    x0, y0, x1, y1 = bounds
    edge = max(_RESOLUTION, math.sqrt((x1 - x0) * (y1 - y0) / _MOST_CELLS))
    rows, cols = math.ceil((y1 - y0) / edge) + 2, math.ceil((x1 - x0) / edge) + 2
    occupied = np.zeros((rows, cols), dtype=np.int8)
    band = HeightBand(_FLOOR_TOP, max(top, 2 * _FLOOR_TOP))
    SolidRaster(occupied, edge, (x0 - edge, y0 - edge), band).add(solids)
    occupied[[0, -1], :] = occupied[:, [0, -1]] = 100
    # Between the middles of two cells; points in them may be nearer by a diagonal.
    least = radius + math.sqrt(2.0) * edge
    reach = least + _NEAR_M
    distances = np.sqrt(np.arange(int((reach / edge) ** 2) + 1)) * edge
    costs = _BASE + _EXTRA * np.exp(-np.maximum(0.0, distances - least) / _DECAY_M)
    costs[distances <= least] = _WALL
    through = np.maximum(inflate(occupied, costs.astype(np.uint8)), np.uint8(_BASE))
    through[occupied != 0] = _WALL
    nearness = inflate(occupied, np.round(255.0 * (1.0 - distances / reach)).astype(np.uint8))
    labels, table = label_components((through != _WALL).view(np.uint8), False)
    if len(table) == 0:
        return None
    through[labels != int(np.argmax(table[:, 0])) + 1] = _WALL
    look = max(1, round(_AHEAD_M / edge))
    return CrowdFloor(through, nearness, x0 - edge, y0 - edge, edge, reach, look)
