"""The cells of a map: their values, the order from free to occupied, limits and position."""

from __future__ import annotations

from typing import Literal, NamedTuple, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.geometry import Pose2D
from trundle.values import check_count

Cells: TypeAlias = npt.NDArray[np.int8]

FREE = 0
"""A cell that is certainly free."""

OCCUPIED = 100
"""A cell that is certainly occupied."""

UNKNOWN = -1
"""A cell whose state is unknown."""

MAX_CELLS = 400_000_000
"""The most cells of a map; 1 km² at 0.05 m has as many. More are probably a mistake."""

MAX_LOADED_CELLS = 20_000_000
"""The most cells of a map that is loaded without another limit, 223 m square at 0.05 m: `trundle map check` takes up to
1.5 GB for them, whatever the image's format (measured with noise and a checkerboard)."""

MOST_CELLS = 2**31 - 1
"""What a limit on cells may be: the kernels count them with 32 bits."""

MAX_EXTENT = 1e5
"""Largest width of a map [m]; paths are checked every few centimetres."""

MAX_ORIGIN = 1e9
"""Farthest origin of a map [m]; survey coordinates (UTM) are below 1e7."""

Ranks: TypeAlias = npt.NDArray[np.uint8]

OCCUPIED_FROM = 65
"""Cells of at least this value are occupied, as in map files (occupied_thresh 0.65)."""

FREE_UP_TO = 20
"""Cells of at most this value are free, as in map files (free_thresh 0.196)."""

VALUES = np.arange(UNKNOWN, OCCUPIED + 1, dtype=np.int8)
VALUES.flags.writeable = False
UNKNOWN_RANK = OCCUPIED_FROM  # the rank between 64 and 65, which moves up by one

_BLOCK_CELLS = 1 << 20  # cells counted at once, which bounds the memory


def cell_limit(given: int | None) -> int:
    """Return the most cells of a map that is loaded.

    Raises:
        InputError: If the limit that is given is none.
    """
    return MAX_LOADED_CELLS if given is None else check_count("max_cells", given, 1, MOST_CELLS)


Surface = Literal["border", "overlap", "centre"]
"""Where the surface of what a map shows lies in the occupied cells at the rim; see `OccupancyGrid`."""

SURFACES: tuple[Surface, ...] = ("border", "overlap", "centre")


class PlacedCells(NamedTuple):
    """Cells with their resolution and origin: the contents of an `OccupancyGrid`, as read from files and worlds.

    Attributes:
        data: Shape (rows, cols), row 0 at the bottom; −1 unknown, 0 free .. 100 occupied.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame.
        surface: Where surfaces lie in the occupied cells at the rim.
    """

    data: Cells
    resolution: float
    origin: Pose2D
    surface: Surface = "border"


class CellGrid(Protocol):
    """A grid that can be written to a file, such as `OccupancyGrid`."""

    @property
    def data(self) -> Cells:
        """Shape (rows, cols), row 0 at the bottom; −1 unknown, 0 free .. 100 occupied."""
        ...

    @property
    def resolution(self) -> float:
        """Edge of a cell [m]."""
        ...

    @property
    def surface(self) -> Surface:
        """Where surfaces lie in the occupied cells at the rim."""
        ...

    @property
    def origin(self) -> Pose2D:
        """Pose of the lower-left corner of cell (0, 0) in the map frame."""
        ...


def count_values(cells: Cells) -> npt.NDArray[np.int64]:
    """Return how often each value of `VALUES` occurs, shape (102,)."""
    counts = np.zeros(len(VALUES), dtype=np.int64)
    step = max(1, _BLOCK_CELLS // cells.shape[1])
    for first in range(0, cells.shape[0], step):
        block = cells[first : first + step].ravel() - np.int8(UNKNOWN)
        counts += np.bincount(block, minlength=len(VALUES))
    return counts


def to_ranks(cells: Cells) -> Ranks:
    """Return ranks of cells, in ascending order of caution: free, 1 to 64, unknown, 65 to 99, occupied."""
    ranks = cells.astype(np.uint8)
    ranks += cells >= OCCUPIED_FROM
    ranks[cells == UNKNOWN] = UNKNOWN_RANK
    return ranks


def from_ranks(ranks: Ranks) -> Cells:
    """Return cells from their ranks; the inverse of the ranking."""
    cells = ranks.astype(np.int8)
    cells -= ranks > UNKNOWN_RANK
    cells[ranks == UNKNOWN_RANK] = UNKNOWN
    return cells


def round_trinary(cells: Cells) -> Cells:
    """Return cells as occupied, free or unknown, by the thresholds that map files are written with."""
    rounded = np.full_like(cells, UNKNOWN)
    rounded[cells >= OCCUPIED_FROM] = OCCUPIED
    rounded[(cells >= FREE) & (cells <= FREE_UP_TO)] = FREE
    return rounded
