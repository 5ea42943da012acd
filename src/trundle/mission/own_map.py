"""`OwnMap`: the map that a robot has made in a run, and the largest corrections that it took."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
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
class MapTrack:
    """Where the map of a localizer comes from: the poses that it has scans of, as they are now.

    Attributes:
        poses: Of base_link, map frame [m, rad], shape (N, 3).
        loops: Pairs of poses that a loop joins, shape (M, 2).
        corrections: The largest corrections of the estimate so far, the largest first, at most five.
    """

    poses: FloatArray
    loops: npt.NDArray[np.int32]
    corrections: tuple[Correction, ...] = ()


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

    @property
    def track(self) -> MapTrack | None:
        """The graph's poses and loops, and the corrections; None without a graph."""
        graph = self.graph
        if graph is None:
            return None
        return MapTrack(graph.poses, graph.edges[graph.edges[:, 2] == LOOP, :2], tuple(self.corrections))

    def as_dict(self) -> dict[str, object]:
        """Size, poses, loops and corrections as plain values, for JSON."""
        rows, cols = self.grid.shape
        track = self.track
        return {
            "rows": rows,
            "cols": cols,
            "resolution_m": self.grid.resolution,
            "poses": None if track is None else len(track.poses),
            "loops": None if track is None else len(track.loops),
            "corrections": [one._asdict() for one in self.corrections],
        }


def describe_correction(correction: Correction) -> str:
    """Return a correction in words, without its time: "0.42 m and 3.0° at (3.1, 4.2)"."""
    one = correction
    return f"{one.moved_m:.2f} m and {math.degrees(one.turned_rad):.1f}° at ({one.x:.1f}, {one.y:.1f})"


def describe_corrections(corrections: Sequence[Correction]) -> str:
    """Return the largest corrections in words: "0.42 m and 3° at 83 s, at (3.1, 4.2)"."""
    parts = (
        f"{one.moved_m:.2f} m and {math.degrees(one.turned_rad):.1f}° at {one.time:.0f} s, "
        f"at ({one.x:.1f}, {one.y:.1f})"
        for one in corrections
    )
    return "; ".join(parts) or f"none of {LEAST_CORRECTION_M:g} m or more"
