"""Information that a map loses in a conversion, in plain words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from trundle.geometry import Pose2D
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.grid import OccupancyGrid
from trundle.maps.occupancy import Mode
from trundle.maps.ros_writer import read_back
from trundle.maps.values import VALUES, count_values, round_trinary

LossKind: TypeAlias = Literal[
    "resampled", "moved", "cropped", "disagreement", "values", "unknown", "origin", "resolution"
]
Format: TypeAlias = Literal["ros", "movingai"]

_MOVINGAI_RESOLUTION = 1.0  # Assumed by readers, the format has none.


@dataclass(frozen=True, slots=True)
class Loss:
    """Information that a converted map has lost.

    Attributes:
        kind: Kind of the loss.
        message: Description for the user.
        cells: Number of cells concerned, None for the whole map.
    """

    kind: LossKind
    message: str
    cells: int | None = None


def find_file_losses(grid: OccupancyGrid, form: Format, mode: Mode = "trinary") -> tuple[Loss, ...]:
    """The information that a map loses when it is written to a file.

    Args:
        grid: The map.
        form: The format of the file.
        mode: The mode of a ROS map.
    """
    if form == "ros":
        return _find_changed_values(grid, read_back(mode), f"mode {mode}", "; mode raw keeps them")
    table = round_trinary(VALUES)
    table[table == UNKNOWN] = OCCUPIED
    losses = [*_find_changed_values(grid, table, "a MovingAI map", "")]
    if grid.resolution != _MOVINGAI_RESOLUTION:
        text = f"a MovingAI map has no resolution: cells of {grid.resolution:g} m are read as 1 m"
        losses.append(Loss("resolution", text))
    if grid.origin != Pose2D(0.0, 0.0, 0.0):
        x, y, yaw = grid.origin.as_tuple()
        text = f"a MovingAI map has no origin: ({x:g}, {y:g}, {yaw:g}) is read as (0, 0, 0)"
        losses.append(Loss("origin", text))
    return tuple(losses)


def _find_changed_values(
    grid: OccupancyGrid, table: np.ndarray[tuple[int], np.dtype[np.int8]], where: str, advice: str
) -> tuple[Loss, ...]:
    counts = np.where(table != VALUES, count_values(grid.data), 0)
    losses: list[Loss] = []
    if counts[0]:
        text = f"{where} has no unknown cells: {counts[0]} of them become occupied"
        losses.append(Loss("unknown", text, int(counts[0])))
        counts[0] = 0
    if counts.any():
        ends = {"free": table == FREE, "occupied": table == OCCUPIED, "unknown": table == UNKNOWN}
        parts = [f"{counts[hit].sum()} become {name}" for name, hit in ends.items() if counts[hit].any()]
        other = counts[(table > FREE) & (table < OCCUPIED)].sum()
        parts += [f"{other} another value"] if other else []
        text = f"{where} does not keep {counts.sum()} cells between free and occupied: {', '.join(parts)}{advice}"
        losses.append(Loss("values", text, int(counts.sum())))
    return tuple(losses)
