"""Blocked cells of a map as few boxes."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle.geometry.solids import OccupancyCells

MOST_BOXES = 40_000


def boxes_of(cells: OccupancyCells) -> npt.NDArray[np.float64]:
    """Boxes (x, y, width, depth) [m] in the frame of the cells, (x, y) the middle, that cover the blocked cells.

    Of a map that needs more than 40,000 boxes, cells are joined to larger ones until it does not.
    """
    blocked, edge = cells.blocked, cells.resolution
    while len(boxes := _rectangles(blocked)) > MOST_BOXES:
        blocked, edge = _halved(blocked), 2.0 * edge
    rows, cols, row_ends, col_ends = boxes.T * edge
    return np.c_[(cols + col_ends) / 2.0, (rows + row_ends) / 2.0, col_ends - cols, row_ends - rows]


def _rectangles(blocked: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Disjoint rectangles (row, col, end of rows, end of columns) of the blocked cells: equal runs of rows joined."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    order = np.lexsort((rows, ends, starts))
    rows, starts, ends = rows[order], starts[order], ends[order]
    joined = np.zeros(len(rows), dtype=np.bool_)
    joined[1:] = (starts[1:] == starts[:-1]) & (ends[1:] == ends[:-1]) & (rows[1:] == rows[:-1] + 1)
    first = np.flatnonzero(~joined)
    last = np.append(first[1:], len(rows)) - 1 if len(first) else first
    return np.c_[rows[first], starts[first], rows[last] + 1, ends[first]]


def _halved(blocked: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Cells of twice the size, blocked where one of the four is."""
    rows, cols = (math.ceil(count / 2) * 2 for count in blocked.shape)
    padded = np.zeros((rows, cols), dtype=np.bool_)
    padded[: blocked.shape[0], : blocked.shape[1]] = blocked
    return padded[::2, ::2] | padded[1::2, ::2] | padded[::2, 1::2] | padded[1::2, 1::2]
