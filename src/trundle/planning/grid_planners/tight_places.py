"""`TightPlaces`: reroutes a path that is short but too tight through more room where the footprint collides."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.geometry import FloatArray, arc_lengths
from trundle.planning.cancellation import Patience

_TRIES = ((2.0, 0.001), (3.0, 0.0025), (4.0, 0.006), (6.0, 0.016))
"""Length that is replaced on both sides of a collision [circumscribed radii], and the weight of one unit of cost."""

_COSTS = np.arange(256.0)

_FOUND = 0


class TightPlaces:
    """Replaces sections of a path by minimum-cost ones over the costs nearby, which keep to the middle of a passage.

    A shortest path touches the corners that it goes around, so the footprint of a robot that is longer than wide
    collides at most bends. That does not mean that the passage is too narrow.

    Each try replaces more of the path on both sides of a collision, and keeps farther from obstacles.
    """

    def __init__(self) -> None:
        self._kernels = [
            _core.LeastCost(np.where(_COSTS < INSCRIBED, 1.0 + weight * _COSTS, 0.0)) for _, weight in _TRIES
        ]

    @property
    def tries(self) -> int:
        """How many tries there are."""
        return len(_TRIES)

    def reroute(
        self,
        costmap: Costmap,
        costs: npt.NDArray[np.uint8],
        vertices: FloatArray,
        hits: FloatArray,
        number: int,
        patience: Patience,
    ) -> FloatArray:
        """Vertices (x, y) [m] of the path with the sections around the collisions replaced.

        Args:
            costmap: Where it is planned.
            costs: What is blocked for this search, shape (rows, cols).
            vertices: Of the path [m], shape (N, 2).
            hits: Poses at which the footprint collides, shape (K, 3).
            number: Of the try, from 0.
            patience: When to stop.

        Returns:
            Shape (M, 2). A section for which there is no replacement stays as it was.

        Raises:
            PlanningStoppedError: If patience ends.
        """
        if len(vertices) < 2:
            return vertices
        reach_m = _TRIES[number][0] * costmap.circumscribed_radius
        along = arc_lengths(vertices)
        parts: list[FloatArray] = []
        done = 0.0
        for begin, end in _stretches(vertices, along, hits, reach_m):
            patience.check()
            ends = np.column_stack([np.interp((begin, end), along, vertices[:, k]) for k in range(2)])
            inside = vertices[(along > begin) & (along < end)]
            stretch = _cheapest(self._kernels[number], costmap, costs, ends, inside, reach_m, patience)
            parts += [vertices[(along >= done) & (along < begin)], stretch]
            done = end
        rest = vertices[along > done]
        return np.concatenate([*parts, rest])


def _cheapest(
    kernel: _core.LeastCost,
    costmap: Costmap,
    costs: npt.NDArray[np.uint8],
    ends: FloatArray,
    inside: FloatArray,
    reach_m: float,
    patience: Patience,
) -> FloatArray:
    old = np.concatenate([ends[:1], inside, ends[1:]])
    grid = costmap.origin.inverse().transform_points(old) / costmap.resolution
    reach = reach_m / costmap.resolution
    low = np.maximum(np.floor(grid.min(axis=0) - reach), 0.0).astype(int)
    high = np.ceil(grid.max(axis=0) + reach).astype(int)
    window = np.ascontiguousarray(costs[low[1] : high[1], low[0] : high[0]])
    local = grid[[0, -1]] - low
    first, last = ((int(row), int(col)) for col, row in np.floor(local))
    if first == last or window[first] >= INSCRIBED or window[last] >= INSCRIBED:
        return old
    status, points, _ = kernel.find(window, first, last, local, patience.seconds, patience.flag)
    if status != _FOUND:
        return old
    found = costmap.origin.transform_points((points + low) * costmap.resolution)
    found[0], found[-1] = ends
    return found


def _stretches(vertices: FloatArray, along: FloatArray, hits: FloatArray, reach_m: float) -> list[tuple[float, float]]:
    """From where to where [m] a path is near its collisions; overlapping intervals are merged."""
    starts, change = vertices[:-1], np.diff(vertices, axis=0)
    squared = np.maximum((change**2).sum(axis=1), 1e-18)
    offsets = hits[:, np.newaxis, :2] - starts
    shares = np.clip((offsets * change).sum(axis=2) / squared, 0.0, 1.0)
    apart = ((offsets - shares[:, :, np.newaxis] * change) ** 2).sum(axis=2)
    nearest = np.argmin(apart, axis=1)
    share = shares[np.arange(len(hits)), nearest]
    places = along[nearest] + share * (along[nearest + 1] - along[nearest])
    stretches: list[tuple[float, float]] = []
    for place in np.sort(places).tolist():
        begin, end = max(0.0, place - reach_m), min(float(along[-1]), place + reach_m)
        if stretches and begin <= stretches[-1][1]:
            stretches[-1] = stretches[-1][0], end
        else:
            stretches.append((begin, end))
    return stretches
