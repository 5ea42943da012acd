"""Landmarks of a `GridSearch`: cells from which the ways to all others are measured beforehand."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.errors import InputError
from trundle.planning.fields import cost_field

_MOST = 16


def check_landmarks(landmarks: int, connectivity: int, method: str) -> int:
    """How many landmarks are asked for.

    Raises:
        InputError: If that is no whole number from 0 to 16, or the search is one that does not use them.
    """
    if isinstance(landmarks, bool) or not isinstance(landmarks, int | np.integer) or not 0 <= landmarks <= _MOST:
        raise InputError(f"landmarks is a whole number from 0 to {_MOST}, got {landmarks!r}")
    if landmarks > 0 and (connectivity == 4 or method == "astar"):
        search = "4-connected ways" if connectivity == 4 else "method 'astar'"
        raise InputError(f"landmarks guide jumps: they are of no use to {search}; leave them out")
    return int(landmarks)


def measure_landmarks(grid: _core.BinaryGrid, blocked: npt.NDArray[np.uint8], count: int) -> None:
    """Measure from as many cells at the edge of the largest part of the map, all round.

    Args:
        grid: The map.
        blocked: The same as bytes, not 0 where a cell is blocked, shape (rows, cols).
        count: How many; fewer on maps so small that cells would be measured twice.
    """
    costs = np.where(blocked, np.uint8(255), np.uint8(1))
    for row, col in grid.begin_landmarks(count).tolist():
        grid.add_landmark((row, col), cost_field(costs, (row, col)))
