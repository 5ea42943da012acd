"""The values of cells: how often each occurs, and which of two is the more careful one."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, Cells

Ranks: TypeAlias = npt.NDArray[np.uint8]

OCCUPIED_FROM = 65
"""From this value a cell is occupied, as map files have it (occupied_thresh 0.65)."""
FREE_UP_TO = 20
"""Up to this value a cell is free, as map files have it (free_thresh 0.196)."""

VALUES = np.arange(UNKNOWN, OCCUPIED + 1, dtype=np.int8)
VALUES.flags.writeable = False
UNKNOWN_RANK = OCCUPIED_FROM

_BLOCK_CELLS = 1 << 20


def count_values(cells: Cells) -> npt.NDArray[np.int64]:
    """How often each value of `VALUES` occurs, shape (102,)."""
    counts = np.zeros(len(VALUES), dtype=np.int64)
    step = max(1, _BLOCK_CELLS // cells.shape[1])
    for first in range(0, cells.shape[0], step):
        block = cells[first : first + step].ravel() - np.int8(UNKNOWN)
        counts += np.bincount(block, minlength=len(VALUES))
    return counts


def to_ranks(cells: Cells) -> Ranks:
    """Ranks of cells, where the higher is the more careful one: free, 1 to 64, unknown, 65 to 99, occupied."""
    ranks = cells.astype(np.uint8)
    ranks += cells >= OCCUPIED_FROM
    ranks[cells == UNKNOWN] = UNKNOWN_RANK
    return ranks


def from_ranks(ranks: Ranks) -> Cells:
    """Cells of ranks."""
    cells = ranks.astype(np.int8)
    cells -= ranks > UNKNOWN_RANK
    cells[ranks == UNKNOWN_RANK] = UNKNOWN
    return cells


def round_trinary(cells: Cells) -> Cells:
    """Cells as occupied, free or unknown, by the thresholds that map files are written with."""
    rounded = np.full_like(cells, UNKNOWN)
    rounded[cells >= OCCUPIED_FROM] = OCCUPIED
    rounded[(cells >= FREE) & (cells <= FREE_UP_TO)] = FREE
    return rounded
