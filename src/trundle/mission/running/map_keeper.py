"""`MapKeeper`: takes the map that a localizer makes, while it drives and at the end of the run."""

from __future__ import annotations

import heapq
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, wrap_angle
from trundle.localization import Localizer
from trundle.mapping import PoseGraph
from trundle.maps import OccupancyGrid
from trundle.mission.own_map import LEAST_CORRECTION_M, Correction, MapTrack, OwnMap
from trundle.observation import Estimate

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
        """Take that the localizer was told where the robot is: that moves the estimate, and corrects no map."""
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
