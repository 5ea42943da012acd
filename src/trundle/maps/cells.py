"""The cells of a map: their values, how many there may be, and where they lie."""

from __future__ import annotations

from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.geometry import Pose2D

Cells: TypeAlias = npt.NDArray[np.int8]

FREE = 0
"""A cell that is certainly free."""
OCCUPIED = 100
"""A cell that is certainly occupied."""
UNKNOWN = -1
"""A cell of which nothing is known."""
MAX_CELLS = 400_000_000
"""More cells than this are taken for a mistake; 1 km² at 0.05 m has as many."""

MAX_EXTENT = 1e5
"""Largest width of a map [m]; paths are checked every few centimetres."""
MAX_ORIGIN = 1e9
"""Farthest origin of a map [m]; coordinates of surveyors (UTM) are below 1e7."""


class PlacedCells(NamedTuple):
    """Cells and where they lie: what an `OccupancyGrid` is made of, as files and worlds give it.

    Attributes:
        data: Shape (rows, cols), row 0 at the bottom; −1 unknown, 0 free .. 100 occupied.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame.
    """

    data: Cells
    resolution: float
    origin: Pose2D


class CellGrid(Protocol):
    """What is written to a file; `OccupancyGrid` is one."""

    @property
    def data(self) -> Cells:
        """Shape (rows, cols), row 0 at the bottom; −1 unknown, 0 free .. 100 occupied."""
        ...

    @property
    def resolution(self) -> float:
        """Edge of a cell [m]."""
        ...

    @property
    def origin(self) -> Pose2D:
        """Pose of the lower-left corner of cell (0, 0) in the map frame."""
        ...
