"""Obstacles erased from good maps, and obstacles drawn into them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.maps import FREE, OCCUPIED, OccupancyGrid
from trundle.maps.check import Finding

LEAST_AREA = 0.1
BEYOND = 2

Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Fault:
    """A map with one fault: its kind, and its cells."""

    grid: OccupancyGrid
    kind: str
    cells: Mask

    @property
    def area(self) -> float:
        return float(self.cells.sum()) * self.grid.resolution**2

    def is_named(self, findings: tuple[Finding, ...]) -> bool:
        """Whether the findings about obstacles are one, of this kind, at this place."""
        named = [finding for finding in findings if finding.kind in ("missing_obstacle", "phantom_obstacle")]
        if [finding.kind for finding in named] != [self.kind] or named[0].where is None:
            return False
        row, col = self.grid.world_to_cell(*named[0].where)
        return bool(self.cells[row, col])


def plant(grid: OccupancyGrid, kind: str, random: np.random.Generator) -> Fault:
    """Erase or draw a piece of at least 0.1 m² that reaches beyond two cells from what stands there."""
    occupied, free = grid.data == OCCUPIED, grid.data == FREE
    erase = kind == "missing_obstacle"
    places = np.argwhere(occupied if erase else free)
    for _ in range(10_000):
        row, col = places[random.integers(len(places))]
        height, width = np.ceil(random.uniform(0.15, 2.0, 2) / grid.resolution).astype(int)
        box = np.zeros(grid.shape, dtype=np.bool_)
        box[max(0, row - height // 2) : row + height - height // 2, max(0, col - width // 2) : col + width // 2 + 1] = (
            True
        )
        cells = _piece_of(box & occupied, row, col) if erase else box
        if not erase and not free[box].all():
            continue
        around = occupied & ~cells
        if cells.sum() * grid.resolution**2 < LEAST_AREA or not (cells & ~grown(around, BEYOND)).any():
            continue
        if erase and not free[grown(cells, 1) & ~cells].any():
            continue  # in the middle of a thing, where nobody sees it
        data = grid.data.copy()
        data[cells] = FREE if erase else OCCUPIED
        return Fault(OccupancyGrid(data, grid.resolution, grid.origin), kind, cells)
    raise AssertionError(f"found no place for a {kind}")


def _piece_of(mask: Mask, row: int, col: int) -> Mask:
    """The connected part of a mask that a cell belongs to."""
    piece = np.zeros_like(mask)
    piece[row, col] = True
    while True:
        more = grown(piece, 1, square=True) & mask
        if (more == piece).all():
            return piece
        piece = more


def grown(mask: Mask, radius: int, *, square: bool = False) -> Mask:
    """The cells within so many cells of a mask."""
    rows, cols = np.nonzero(mask)
    result = np.zeros_like(mask)
    for down in range(-radius, radius + 1):
        for right in range(-radius, radius + 1):
            if square or down * down + right * right <= radius * radius:
                at_row, at_col = rows + down, cols + right
                inside = (at_row >= 0) & (at_row < mask.shape[0]) & (at_col >= 0) & (at_col < mask.shape[1])
                result[at_row[inside], at_col[inside]] = True
    return result
