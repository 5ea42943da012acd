"""The values of cells: how often each occurs, and their order from free to occupied."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, Cells

Ranks: TypeAlias = npt.NDArray[np.uint8]

OCCUPIED_FROM = 65
"""Cells of at least this value are occupied, as in map files (occupied_thresh 0.65)."""
FREE_UP_TO = 20
"""Cells of at most this value are free, as in map files (free_thresh 0.196)."""

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
    """Ranks of cells, in ascending order of caution: free, 1 to 64, unknown, 65 to 99, occupied."""
    ranks = cells.astype(np.uint8)
    ranks += cells >= OCCUPIED_FROM
    ranks[cells == UNKNOWN] = UNKNOWN_RANK
    return ranks


def from_ranks(ranks: Ranks) -> Cells:
    """Cells from their ranks; the inverse of the ranking."""
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
