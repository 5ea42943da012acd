"""`OccupancyGrid`: a ROS occupancy map in memory."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps.frame import GridFrame

FREE = 0
OCCUPIED = 100
UNKNOWN = -1


@dataclass(frozen=True, slots=True)
class OccupancyGrid(GridFrame):
    """Cells that are free, occupied or unknown, and where they lie in the map frame.

    Attributes:
        data: int8, shape (rows, cols) = (y, x), row 0 at the bottom, read-only; −1 unknown, 0 free .. 100 occupied.
        resolution: Edge of a cell [m].
        origin: Pose of the lower-left corner of cell (0, 0) in the map frame; its yaw turns the whole grid.

    Raises:
        MapError: If the array has no cells or another shape, a value is outside −1..100, or the resolution is not a
            positive number.
    """

    data: npt.NDArray[np.int8]
    resolution: float
    origin: Pose2D = Pose2D(0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        source = np.asarray(self.data)
        if source.ndim != 2 or source.size == 0:
            raise MapError(f"an occupancy grid needs data of shape (rows, cols), got {source.shape}")
        if source.dtype.kind not in "iub" or source.min() < UNKNOWN or source.max() > OCCUPIED:
            raise MapError("an occupancy grid holds whole numbers from -1 (unknown) over 0 (free) to 100 (occupied)")
        resolution = float(self.resolution)
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise MapError(f"resolution must be a positive number of metres a cell, got {self.resolution}")
        data = np.array(source, dtype=np.int8, order="C", copy=True)
        data.flags.writeable = False
        object.__setattr__(self, "data", data)
        object.__setattr__(self, "resolution", resolution)
        object.__setattr__(self, "origin", Pose2D.of(self.origin))

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        rows, cols = self.data.shape
        return rows, cols
