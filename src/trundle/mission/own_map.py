"""`OwnMap`: the map that a robot makes in a run, how `MapKeeper` takes it, and the largest corrections of it."""

from __future__ import annotations

import heapq
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, wrap_angle
from trundle.localization import Localizer
from trundle.mapping.pose_graph import LOOP, PoseGraph
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate

LEAST_CORRECTION_M = 0.05
"""Corrections of the pose that are smaller than this are not worth a name [m]."""


class Correction(NamedTuple):
    """A jump of the estimate that put a drift right, such as by a loop that was closed.

    Attributes:
        moved_m: How far the estimated position jumped [m].
        turned_rad: How far the estimated yaw jumped [rad].
        time: Time of the correction [s].
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
        poses: Poses of base_link, map frame [m, rad], shape (N, 3).
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


PERIOD_S = 1.0
"""How often the map is drawn again [s]: often enough to plan on, as the scans show what is new since then."""

_MOST_NAMED = 5


@runtime_checkable
class _HasGraph(Protocol):
    """A localizer that says what its map is drawn from, as `slam` does."""

    def graph(self) -> PoseGraph: ...

    def track(self) -> tuple[FloatArray, npt.NDArray[np.int32]]: ...


class MapKeeper:
    """Takes the map of a localizer that makes one, once a second and when what was mapped before has moved.

    Args:
        localizer: The localizer.

    Attributes:
        grid: The map as it was taken last; None before the first one, and where the localizer makes none.
        track: Poses and loops of that map; None where the localizer does not say.
    """

    def __init__(self, localizer: Localizer) -> None:
        self._localizer = localizer
        self.reset()

    def reset(self) -> None:
        """Begin a run."""
        self.grid: OccupancyGrid | None = None
        self.track: MapTrack | None = None
        self._due: float | None = None
        self._revision = self._localizer.corrections
        self._last: Estimate | None = None
        self._corrections: list[Correction] = []

    def follow(self, estimate: Estimate) -> bool | None:
        """Take a new map if one is due; return whether what was mapped before has moved, and None without a new map."""
        revision = self._localizer.corrections
        corrected = revision != self._revision
        self._note(estimate)
        if not corrected and self._due is not None and estimate.time < self._due - 1e-9:
            return None
        self._due = estimate.time + PERIOD_S
        grid = self._localizer.map()
        if grid is None:
            return None
        self._revision, self.grid = revision, grid
        if isinstance(self._localizer, _HasGraph):
            self.track = MapTrack(*self._localizer.track(), self._largest)
        return corrected

    @property
    def _largest(self) -> tuple[Correction, ...]:
        return tuple(sorted(self._corrections, reverse=True))

    def finish(self) -> OwnMap | None:
        """Let the localizer finish its map, and return it; None where it has made none."""
        localizer = self._localizer
        localizer.finish()
        grid = localizer.map()
        if grid is None:
            return None
        self.grid = grid
        graph = localizer.graph() if isinstance(localizer, _HasGraph) else None
        return OwnMap(grid, graph, self._largest)

    def take_told(self, estimate: Estimate) -> None:
        """Note that the localizer was told where the robot is: that moves the estimate, and corrects no map."""
        self._last = estimate

    def _note(self, estimate: Estimate) -> None:
        """Keep a jump of the estimate if it is among the largest."""
        last, self._last = self._last, estimate
        if last is None or last.T_map_odom == estimate.T_map_odom:
            return
        believed = last.T_map_odom @ estimate.odom_pose
        moved = believed.distance_to(estimate.pose)
        if moved < LEAST_CORRECTION_M:
            return
        turned = abs(wrap_angle(estimate.pose.yaw - believed.yaw))
        found = Correction(moved, turned, estimate.time, estimate.pose.x, estimate.pose.y)
        if len(self._corrections) < _MOST_NAMED:
            heapq.heappush(self._corrections, found)
        else:
            heapq.heappushpop(self._corrections, found)
