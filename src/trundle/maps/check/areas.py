"""Connected areas of a map, and the map as its checks see it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.check.finding import MOST_A_KIND, Finding, Kind, Severity
from trundle.maps.grid import OccupancyGrid

SPECK_CELLS = 4
"""An area of at most this many cells is probably noise."""

Mask = npt.NDArray[np.bool_]
Cells = npt.NDArray[np.int8]

# Each cell and its neighbour below, above, left and right.
NEIGHBOURS = (
    (np.s_[1:, :], np.s_[:-1, :]),
    (np.s_[:-1, :], np.s_[1:, :]),
    (np.s_[:, 1:], np.s_[:, :-1]),
    (np.s_[:, :-1], np.s_[:, 1:]),
)


class Area(NamedTuple):
    """A connected area: its label, number of cells, and bounding box of rows and columns (ends excluded)."""

    label: int
    cells: int
    row: int
    row_end: int
    col: int
    col_end: int


class Areas:
    """The connected areas of some cells of a map.

    Args:
        mask: Which cells.
        diagonal: Whether cells that touch at a corner are connected.
    """

    def __init__(self, mask: Mask, *, diagonal: bool) -> None:
        self.labels, self.table = label_components(np.ascontiguousarray(mask).view(np.uint8), diagonal)

    def __len__(self) -> int:
        return len(self.table)

    @property
    def sizes(self) -> npt.NDArray[np.int64]:
        """Number of cells of each area, shape (len,)."""
        return self.table[:, 0]

    @property
    def lengths(self) -> npt.NDArray[np.int64]:
        """The longer side of each area's bounding box in cells, shape (len,)."""
        return np.maximum(self.table[:, 2] - self.table[:, 1], self.table[:, 4] - self.table[:, 3])

    def area(self, index: int) -> Area:
        """Return the area at a row of the table; its label is one more."""
        return Area(index + 1, *self.table[index].tolist())

    def mask(self, area: Area) -> Mask:
        """Return the area's cells within its bounding box."""
        return self.labels[area.row : area.row_end, area.col : area.col_end] == area.label

    def select(self, chosen: Mask) -> Mask:
        """Return the cells of some of the areas, `chosen` of shape (len,), as a mask of the map."""
        return np.concatenate([[False], chosen])[self.labels]

    def on_edge(self) -> Mask:
        """Return which areas touch the edge of the map, shape (len,)."""
        rows, cols = self.labels.shape
        table = self.table
        return (table[:, 1] == 0) | (table[:, 2] == rows) | (table[:, 3] == 0) | (table[:, 4] == cols)

    def beside(self, other: Mask) -> npt.NDArray[np.int64]:
        """Return how often a cell of each area has one of `other` above, below, left or right of it, shape (len,)."""
        counts = np.zeros(len(self) + 1, dtype=np.int64)
        for here, there in NEIGHBOURS:
            meets = other[there] & (self.labels[here] > 0)
            counts += np.bincount(self.labels[here][meets], minlength=len(counts))
        return counts[1:]

    def middle(self, area: Area) -> tuple[int, int]:
        """Return the area's own cell (row, col) that is nearest to the mean of its cells."""
        rows, cols = np.nonzero(self.mask(area))
        nearest = int(np.argmin((rows - rows.mean()) ** 2 + (cols - cols.mean()) ** 2))
        return area.row + int(rows[nearest]), area.col + int(cols[nearest])


class Chart:
    """A map, the true state of its cells in the world, and its cells with every certain correction.

    Args:
        grid: The map.
        truth: The state of the same cells in the world: occupied, free where it can be reached, else unknown. None
            without a world, or where its place is not certain.
    """

    def __init__(self, grid: OccupancyGrid, truth: Cells | None = None) -> None:
        self.grid = grid
        self.truth = truth
        self.cells = grid.data.copy()
        self.corrected: set[Kind] = set()
        # As in a costmap, every known cell below 100 is free.
        self.free = (grid.data >= FREE) & (grid.data < OCCUPIED)
        self.unknown = grid.data == UNKNOWN
        self.occupied = grid.data == OCCUPIED
        self.free_count = int(np.count_nonzero(self.free))
        self.holes = np.zeros(grid.shape, dtype=np.bool_)
        """Unknown cells in the middle of free space, as the check of unknown space finds them."""

    def place(self, row: float, col: float) -> tuple[float, float]:
        """Return the centre (x, y) [m] of a cell in the map frame."""
        x, y = self.grid.cell_to_world(row, col)
        return float(x), float(y)

    def area(self, cells: int) -> float:
        """Return the area of a number of cells [m²]."""
        return round(cells * self.grid.resolution**2, 9)

    def square_metres(self, cells: int) -> str:
        """Return an area as text."""
        area = self.area(cells)
        return f"{area:.0f} m²" if area >= 10.0 else f"{area:.2g} m²"

    def take_from_world(self, kind: Kind, mask: Mask) -> bool:
        """Correct some cells from the world, where it knows them; return whether it knows any."""
        if self.truth is None:
            return False
        known = mask & (self.truth != UNKNOWN)
        if not known.any():
            return False
        self.cells[known] = self.truth[known]
        self.corrected.add(kind)
        return True

    def list_areas(
        self, areas: Areas, chosen: Mask, kind: Kind, severity: Severity, words: tuple[str, str], fix: str
    ) -> list[Finding]:
        """List one finding for each of the chosen areas, the largest first, and one for the rest if there are too many.

        `words` are the message for one area, with {area}, {cells} and {size} (along x and y) to fill in, and the
        plural for the rest.
        """
        indices = np.flatnonzero(chosen)
        indices = indices[np.argsort(-areas.sizes[indices], kind="stable")]
        findings: list[Finding] = []
        for index in indices[: MOST_A_KIND + 1].tolist():
            area = areas.area(index)
            width, height = (
                count * self.grid.resolution for count in (area.col_end - area.col, area.row_end - area.row)
            )
            square_metres = self.square_metres(area.cells)
            size = f"{width:.2g} x {height:.2g} m ({square_metres})"
            message = words[0].format(area=square_metres, cells=area.cells, size=size)
            where = self.place(*areas.middle(area))
            findings.append(Finding(kind, severity, message, where, fix, self.area(area.cells)))
        return shorten(findings, len(indices), words[1])


def grow(mask: Mask, radius: int) -> Mask:
    """Return the cells of a mask and all within a distance [cells] of them."""
    rows, cols = mask.shape
    wide = np.pad(mask, radius)
    grown = np.zeros_like(mask)
    for down in range(-radius, radius + 1):
        for right in range(-radius, radius + 1):
            if down * down + right * right <= radius * radius:
                top, left = radius + down, radius + right
                grown |= wide[top : top + rows, left : left + cols]
    return grown


def shorten(findings: list[Finding], total: int, what: str) -> list[Finding]:
    """Keep the largest findings of one kind, up to the limit, and sum up the rest in one."""
    if total <= MOST_A_KIND:
        return findings
    next_one = findings[MOST_A_KIND]
    message = f"{total - MOST_A_KIND} more {what}, none of them larger"
    rest = Finding(next_one.kind, next_one.severity, message, next_one.where, next_one.fix)
    return [*findings[:MOST_A_KIND], rest]
