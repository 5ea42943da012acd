"""`without_unseen`: the costmap of a map without the small things on it that no scan has hit."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.costmap.costmap import Costmap
from trundle.costmap.costs import LETHAL
from trundle.maps import FREE, OCCUPIED
from trundle.maps.cells import UNKNOWN

_LARGEST_M = 2.0  # walls are longer: a path never leads through one that was not seen yet
_BESIDE_M = 0.1  # so far from a thing on the map a hit may lie that is one of it


def without_unseen(static: Costmap, hit: npt.NDArray[np.bool_]) -> Costmap | None:
    """Take the things off a map that are at most 2 m long and wide, and that no scan has hit.

    A thing is what hangs together of occupied cells, with the unknown ones that it encloses.

    Args:
        static: The costmap of the map. What its keep-out mask forbids stays, and counts as a part of what it touches.
        hit: Cells in which scans have marked obstacles, shape (rows, cols).

    Returns:
        The costmap without them, or None if there is no such thing.
    """
    occupied, unknown = static.data == LETHAL, static.unknown_cells
    labels, table = label_components((occupied | unknown).view(np.uint8), True)
    long = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * static.resolution
    is_solid = np.bincount(labels[occupied], minlength=len(table) + 1)[1:] > 0
    unseen = np.append(False, is_solid & (long <= _LARGEST_M + 1e-9))
    reach = math.ceil(_BESIDE_M / static.resolution - 1e-9)
    row, col = np.nonzero(hit)
    for up in range(-reach, reach + 1):
        for right in range(-reach, reach + 1):
            inside = static.contains(row + up, col + right)
            unseen[labels[row[inside] + up, col[inside] + right]] = False
    gone = unseen[labels]
    if static.keepout is not None:
        gone &= static.keepout != LETHAL
    rows, cols = np.flatnonzero(gone.any(axis=1)), np.flatnonzero(gone.any(axis=0))
    if len(rows) == 0:
        return None
    part = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
    cells = np.where(occupied[part], OCCUPIED, np.where(unknown[part], UNKNOWN, FREE))
    cells[gone[part]] = FREE
    return static.update(*part, cells.astype(np.int8))
