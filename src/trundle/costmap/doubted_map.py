"""The costmap of a map without the small things on it that no scan has hit, or that beams pass through."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.costmap.costmap import Costmap
from trundle.costmap.costs import LETHAL
from trundle.geometry import FloatArray
from trundle.maps import FREE, OCCUPIED
from trundle.maps.cells import UNKNOWN

_LARGEST_M = 2.0  # walls are longer: a path never leads through one that was not seen yet
_BESIDE_M = 0.1  # so far from a thing on the map a hit may lie that is one of it
_BETWEEN_M = 0.1  # cells between beams count as passed where these are at most twice as far apart
_AT_WALL_M = 0.5
"""So far from a hit a wall may be drawn that was hit there: one that is seen at a low angle is hit here and there."""


def without_unseen(static: Costmap, hit: npt.NDArray[np.bool_]) -> Costmap | None:
    """Take the things off a map that are at most 2 m long and wide, and that no scan has hit.

    A thing is what hangs together of occupied cells, with the unknown ones that it encloses.

    Args:
        static: The costmap of the map. What its keep-out mask forbids stays, and counts as a part of what it touches.
        hit: Cells in which scans have marked obstacles, shape (rows, cols).

    Returns:
        The costmap without them, or None if there is no such thing.
    """
    occupied = static.data == LETHAL
    labels, small = _small_things(static, occupied | static.unknown_cells)
    unseen = small & (np.bincount(labels[occupied], minlength=len(small)) > 0)
    unseen[labels[_beside(static, hit, _BESIDE_M)]] = False
    return _without(static, unseen[labels])


def without_passed(
    static: Costmap,
    hit: npt.NDArray[np.bool_],
    passes: Callable[[FloatArray, FloatArray], npt.NDArray[np.bool_]],
    outline: FloatArray | None,
) -> Costmap | None:
    """Take cells off a map that beams pass through, of things that scans have not hit.

    What lies within 0.1 m of a hit belongs to what was hit there. A thing is what hangs together of the other occupied
    cells; of those of at most 2 m the cells go that beams pass. A thing also counts by itself where it touches a wall
    that was hit within 0.5 m of there; then all that is not passed of it has to lie there. What is longer stays: beams
    pass over a kerb.

    Args:
        static: The costmap of the map. What its keep-out mask forbids stays.
        hit: Cells in which scans have marked obstacles, shape (rows, cols).
        passes: Whether scans agree that beams pass through points, given their x and y [m], map frame.
        outline: Corners of a robot that stands in something on the map [m], map frame, counter-clockwise, shape
            (N, 2): nothing is there. None where it does not.

    Returns:
        The costmap without them, or None if there are no such cells.
    """
    occupied = static.data == LETHAL
    apart = occupied & ~_beside(static, hit, _BESIDE_M)
    row, col = np.nonzero(_beside(static, apart, _BETWEEN_M))
    passed = np.zeros(static.shape, np.bool_)
    passed[row, col] = passes(*static.cell_to_world(row, col))
    stood_in = np.zeros(static.shape, np.bool_) if outline is None else occupied & _within(static, outline)
    if not passed.any():  # the rest takes a while on a large map
        return _without(static, stood_in)
    passed = apart & ~_beside(static, ~_beside(static, passed, _BETWEEN_M), _BETWEEN_M)
    things, small = _small_things(static, apart | static.unknown_cells)
    parts, small_part = _small_things(static, passed)
    left = apart & ~passed & ~_beside(static, hit, _AT_WALL_M)
    small_part[parts[_beside(static, left, static.resolution)]] = False
    return _without(static, passed & (small[things] | small_part[parts]) | stood_in)


def _within(static: Costmap, outline: FloatArray) -> npt.NDArray[np.bool_]:
    """Say which cells have their centres in a convex outline."""
    inside = np.zeros(static.shape, np.bool_)
    corners = static.world_to_cell(outline[:, 0], outline[:, 1])
    rows, cols = (slice(max(0, int(cell.min())), max(0, int(cell.max()) + 1)) for cell in corners)
    row, col = np.indices(inside[rows, cols].shape)
    x, y = static.cell_to_world(row + rows.start, col + cols.start)
    found = np.ones(x.shape, np.bool_)
    for (ax, ay), (bx, by) in zip(outline.tolist(), np.roll(outline, -1, axis=0).tolist(), strict=True):
        found &= (bx - ax) * (y - ay) - (by - ay) * (x - ax) >= 0.0
    inside[rows, cols] = found
    return inside


def _small_things(static: Costmap, cells: npt.NDArray[np.bool_]) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.bool_]]:
    """Number what hangs together of cells from 1 on, and say by number what is at most 2 m long and wide."""
    labels, table = label_components(cells.view(np.uint8), True)
    long = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * static.resolution
    return labels, np.append(False, long <= _LARGEST_M + 1e-9)


def _beside(static: Costmap, cells: npt.NDArray[np.bool_], within_m: float) -> npt.NDArray[np.bool_]:
    """Say which cells are these or lie beside them, in a square around each that reaches so far [m]."""
    reach = math.ceil(within_m / static.resolution - 1e-9)
    for across in (False, True):  # along the columns, and then along the rows
        grown = cells.copy()
        to, by = (grown.T, cells.T) if across else (grown, cells)  # a copy of what is turned costs ten times as much
        for step in range(1, reach + 1):
            to[step:] |= by[:-step]
            to[:-step] |= by[step:]
        cells = grown
    return cells


def _without(static: Costmap, gone: npt.NDArray[np.bool_]) -> Costmap | None:
    """Return the costmap with these cells free, apart from what its mask forbids; None if there are none."""
    if static.keepout is not None:
        gone &= static.keepout != LETHAL
    rows, cols = np.flatnonzero(gone.any(axis=1)), np.flatnonzero(gone.any(axis=0))
    if len(rows) == 0:
        return None
    part = slice(int(rows[0]), int(rows[-1]) + 1), slice(int(cols[0]), int(cols[-1]) + 1)
    occupied, unknown = static.data[part] == LETHAL, static.unknown_cells[part]
    cells = np.where(occupied, OCCUPIED, np.where(unknown, UNKNOWN, FREE))
    cells[gone[part]] = FREE
    return static.update(*part, cells.astype(np.int8))
