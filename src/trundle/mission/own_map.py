"""`OwnMap`: the map that a robot has made in a run, and the largest corrections that it took."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from trundle.mapping.pose_graph import LOOP, PoseGraph
from trundle.maps import OccupancyGrid

LEAST_CORRECTION_M = 0.05
"""Corrections of the pose that are smaller than this are not worth a name [m]."""


class Correction(NamedTuple):
    """A jump of the estimate that put a drift right, such as by a loop that was closed.

    Attributes:
        moved_m: How far the estimated position jumped [m].
        turned_rad: How far the estimated yaw jumped [rad].
        time: When [s].
        x, y: Where the robot was then, map frame [m].
    """

    moved_m: float
    turned_rad: float
    time: float
    x: float
    y: float


@dataclass(frozen=True, slots=True, eq=False)
class OwnMap:
    """The map that a robot's localizer has made, and how.

    Attributes:
        grid: The map at the end.
        graph: Poses, scans and loops that it was drawn from; None where the localizer does not say.
        corrections: The largest corrections of the estimate, the largest first, at most five.
    """

    grid: OccupancyGrid
    graph: PoseGraph | None = None
    corrections: Sequence[Correction] = ()

    def as_dict(self) -> dict[str, object]:
        """Size, poses, loops and corrections as plain values, for JSON."""
        rows, cols = self.grid.shape
        graph = self.graph
        return {
            "rows": rows,
            "cols": cols,
            "resolution_m": self.grid.resolution,
            "poses": None if graph is None else len(graph.poses),
            "loops": None if graph is None else int((graph.edges[:, 2] == LOOP).sum()),
            "corrections": [one._asdict() for one in self.corrections],
        }


def describe_corrections(corrections: Sequence[Correction]) -> str:
    """Return the largest corrections in words: "0.42 m and 3° at 83 s, at (3.1, 4.2)"."""
    parts = (
        f"{one.moved_m:.2f} m and {math.degrees(one.turned_rad):.1f}° at {one.time:.0f} s, "
        f"at ({one.x:.1f}, {one.y:.1f})"
        for one in corrections
    )
    return "; ".join(parts) or f"none of {LEAST_CORRECTION_M:g} m or more"
