"""What is done where the footprint collides on a path: it is rerouted through more room, or cells are closed."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.costmap.costs import cost_table
from trundle.geometry import FloatArray, arc_lengths
from trundle.maps import FREE, OCCUPIED
from trundle.planning.cancellation import Patience
from trundle.planning.motions import Motion

_TRIES = ((2.0, 0.001), (3.0, 0.0025), (4.0, 0.006), (6.0, 0.016))
"""The tries in order: length that is replaced on both sides of a collision [circumscribed radii], and the weight of one
unit of cost. Each replaces more and keeps farther away than the one before: a path stays short where that fits."""

_STEP_OFF_M = 0.3
"""Where a turn at the start or the goal is blocked, the path is closed this far from it: another exit stays open."""

_WIDE_ROUNDS = 6
"""Rounds that may close more than the cells around collisions; from the third on there is room for any turn."""

Costs = npt.NDArray[np.uint8]

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
        """Return the vertices (x, y) [m] of the path with the sections around the collisions replaced.

        Args:
            costmap: Where it is planned.
            costs: What is blocked for this search, shape (rows, cols).
            vertices: Vertices of the path [m], shape (N, 2).
            hits: Poses at which the footprint collides, shape (K, 3).
            number: Number of the try, from 0.
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
    """Return from where to where [m] along a path it is near its collisions; overlapping intervals are merged."""
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


class Detours:
    """The costs of a query's replans: the costmap's own, with cells closed where the footprint collided.

    A round closes the cells around the collisions. With `wide`, a path planned around them that collides again shows
    that the place is too narrow, and from the second round on all cells nearby are closed that are closer to an
    obstacle than a distance: halfway from the inscribed to the circumscribed radius, then the circumscribed radius,
    with which the footprint fits at every yaw. That may close a passage that the robot fits through at some yaw, so a
    search that then finds no path proves nothing: `reopen` opens all of it again, and from there on only the cells
    around the collisions are closed.

    Args:
        costmap: Where it is planned.
        keep: Cells that stay as they are, e.g. those of the start and the goal. Near them nothing is widened.
        most: How many rounds there may be; those before a `reopen` do not count.
        wide: Whether to close more than the cells around the collisions.

    Attributes:
        costs: Costs for the next search, shape (rows, cols); they are not changed later.
        wide: Whether more than the cells around the collisions is being closed.
    """

    def __init__(self, costmap: Costmap, keep: tuple[tuple[int, int], ...], most: int, *, wide: bool = False) -> None:
        self._costmap, self._keep, self._most, self.wide = costmap, keep, most, wide
        self._round = 0
        self.costs: Costs = costmap.data

    def close(self, motions: list[Motion], hits: FloatArray, owners: list[int]) -> bool:
        """Close cells where motions collide, as `fit_motions` says; False if no round is left, or nothing to close."""
        if self._round == (min(self._most, _WIDE_ROUNDS) if self.wide else self._most):
            return self.reopen()
        places = places_to_avoid(motions, hits, owners)
        costs = self.costs.copy()
        rows, cols = self._costmap.world_to_cell(places[:, 0], places[:, 1])
        for row, col in zip(rows.tolist(), cols.tolist(), strict=True):
            costs[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2] = LETHAL
        if self.wide and self._round > 0:
            for row, col in _thinned(rows.tolist(), cols.tolist(), self._reach // 2):
                self._widen(costs, row, col)
        for cell in self._keep:
            costs[cell] = self._costmap.data[cell]
        self._round += 1
        if np.array_equal(costs, self.costs):
            return self.reopen()
        self.costs = costs
        return True

    def reopen(self) -> bool:
        """Open what was closed while `wide`; from then on close only cells around collisions. False if done before."""
        if not self.wide or self._round == 0:
            return False
        self.wide, self._round = False, 0
        self.costs = self._costmap.data
        return True

    @property
    def _reach(self) -> int:
        """How far around a collision cells are closed [cells]."""
        return math.ceil(2.0 * self._costmap.circumscribed_radius / self._costmap.resolution)

    def _widen(self, costs: Costs, row: int, col: int) -> None:
        """Close what is too close to an obstacle around a cell, in place."""
        costmap, reach = self._costmap, self._reach
        all_round = costmap.circumscribed_radius + costmap.resolution
        room = 0.5 * (costmap.inscribed_radius + all_round) if self._round == 1 else all_round
        margin = math.ceil(room / costmap.resolution)
        # Distances are right as far in as the margin reaches; what is within `reach` of the cell is closed.
        bottom, left = max(0, row - reach - margin), max(0, col - reach - margin)
        window = slice(bottom, row + reach + margin + 1), slice(left, col + reach + margin + 1)
        occupied = np.where(costmap.data[window] >= LETHAL, np.int8(OCCUPIED), np.int8(FREE))
        tight = _core.inflate(occupied, cost_table(room, room, 1.0, costmap.resolution)) >= INSCRIBED
        rows, cols = np.ogrid[bottom : bottom + tight.shape[0], left : left + tight.shape[1]]
        tight &= (abs(rows - row) <= reach) & (abs(cols - col) <= reach)
        for end_row, end_col in self._keep:
            tight &= np.hypot(rows - end_row, cols - end_col) > margin
        costs[window][tight] = LETHAL


def _thinned(rows: list[int], cols: list[int], apart: int) -> list[tuple[int, int]]:
    """Return those cells that are not near one taken before."""
    kept: list[tuple[int, int]] = []
    for row, col in zip(rows, cols, strict=True):
        if all(max(abs(row - r), abs(col - c)) > apart for r, c in kept):
            kept.append((row, col))
    return kept


def places_to_avoid(motions: list[Motion], hits: FloatArray, owners: list[int]) -> FloatArray:
    """Return places (x, y) [m] that the next path must not go through, shape (K, 2)."""
    places: dict[tuple[float, float], None] = {}
    last = len(motions) - 1
    for pose, owner in zip(hits.tolist(), owners, strict=True):
        motion = motions[owner]
        if motion.turn != 0.0 and owner == 0 and last > 0:
            place = _point_along(motions[1].start, motions[1].end)
        elif motion.turn != 0.0 and owner == last and last > 0:
            place = _point_along(motions[last - 1].end, motions[last - 1].start)
        else:
            place = (pose[0], pose[1])
        places[place] = None
    return np.array(list(places))


def _point_along(start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    t = min(1.0, _STEP_OFF_M / length)
    return start[0] + t * (end[0] - start[0]), start[1] + t * (end[1] - start[1])
