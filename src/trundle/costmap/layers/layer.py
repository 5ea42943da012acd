"""The protocol of layers, and what they exchange with a layered costmap."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Estimate, Scan


class MapWindow(NamedTuple):
    """A rectangle in the map frame [m] that holds everything that changed."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


EVERYWHERE = MapWindow(-math.inf, -math.inf, math.inf, math.inf)
"""The window of a layer that changed everywhere, for example because it was cleared."""


@dataclass(frozen=True, slots=True, eq=False)
class MapPart:
    """A rectangle of a map for a layer to write into.

    Attributes:
        cells: int8, shape (rows, cols), writable: −1 unknown, 0 free, 100 occupied. It starts as the static map.
        kept: uint8, shape (rows, cols): not 0 where nothing may be marked, near obstacles of the static map.
        resolution: Edge of a cell [m].
        pose: Pose of the lower left corner of cell (0, 0) in the map frame.
    """

    cells: npt.NDArray[np.int8]
    kept: npt.NDArray[np.uint8]
    resolution: float
    pose: Pose2D


@runtime_checkable
class Layer(Protocol):
    """Gathers in the map frame what sensors report, and writes it into parts of a map.

    What was seen stays where the estimate of its time put it. The odometry between two times, and `T_map_odom` of the
    newest estimate, place a scan; how a layer deals with an estimate that jumps is its own choice.
    """

    def reset(self) -> None:
        """Forget everything, for a new run."""
        ...

    def update(self, scans: Sequence[Scan], estimate: Estimate) -> MapWindow | None:
        """Take the scans that arrived since the last call, and where the robot is now.

        Scans that cannot be used are left out with a `SensorWarning`.

        Returns:
            What changed, in the map frame, or None if nothing changed.

        Raises:
            InputError: If the estimate's time is not after the last one.
        """
        ...

    def paint(self, part: MapPart) -> None:
        """Write free space and obstacles into `part.cells`."""
        ...

    def obstacles(self) -> FloatArray:
        """Return points at which the layer holds something occupied [m], map frame, shape (N, 2)."""
        ...
