"""What the next way must not go through where the footprint hit something on the last one."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.costmap import LETHAL, Costmap
from trundle.geometry import FloatArray
from trundle.planning.motions import Motion

_STEP_OFF_M = 0.3
"""Where a turn at the start or the goal is blocked, the way is closed this far from it, to leave it another way."""


def places_to_avoid(motions: list[Motion], hits: FloatArray, owners: list[int]) -> FloatArray:
    """Places (x, y) [m] that the next way must not go through, shape (K, 2)."""
    places: dict[tuple[float, float], None] = {}
    last = len(motions) - 1
    for pose, owner in zip(hits.tolist(), owners, strict=True):
        motion = motions[owner]
        if motion.turn != 0.0 and owner == 0 and last > 0:
            place = _point_along(motions[1].start, motions[1].end)
        elif motion.turn != 0.0 and owner == last and last > 0:
            place = _point_along(motions[last - 1].end, motions[last - 1].start)
        else:
            place = (pose[0], pose[1])
        places[place] = None
    return np.array(list(places))


def _point_along(start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    t = min(1.0, _STEP_OFF_M / length)
    return start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])


def block(
    costmap: Costmap, costs: npt.NDArray[np.uint8], places: FloatArray, keep: tuple[tuple[int, int], ...]
) -> npt.NDArray[np.uint8]:
    """Copy the costs with the cells around `places` lethal; those of `keep` stay as they are."""
    blocked = costs.copy()
    rows, cols = costmap.world_to_cell(places[:, 0], places[:, 1])
    for row, col in zip(rows.tolist(), cols.tolist(), strict=True):
        blocked[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2] = LETHAL
    for cell in keep:
        blocked[cell] = costs[cell]
    return blocked
