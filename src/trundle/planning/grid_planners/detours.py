"""The cells that are closed for the next search after a collision."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.costmap.inflation import cost_table
from trundle.geometry import FloatArray
from trundle.maps import FREE, OCCUPIED
from trundle.planning.motions import Motion

_STEP_OFF_M = 0.3
"""Where a turn at the start or the goal is blocked, the path is closed this far from it: another exit stays open."""

_WIDE_ROUNDS = 6
"""Rounds that may close more than the cells around collisions; from the third on there is room for any turn."""

Costs = npt.NDArray[np.uint8]


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
        costs: For the next search, shape (rows, cols); they are not changed later.
        wide: Whether more than the cells around the collisions is being closed.
    """

    def __init__(self, costmap: Costmap, keep: tuple[tuple[int, int], ...], most: int, *, wide: bool = False) -> None:
        self._costmap, self._keep, self._most, self.wide = costmap, keep, most, wide
        self._round = 0
        self.costs: Costs = costmap.data

    def close(self, motions: list[Motion], hits: FloatArray, owners: list[int]) -> bool:
        """Close where motions collide, as of `fit_motions`; false where no round is left or nothing to close."""
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
    """Those cells that are not near one taken before."""
    kept: list[tuple[int, int]] = []
    for row, col in zip(rows, cols, strict=True):
        if all(max(abs(row - r), abs(col - c)) > apart for r, c in kept):
            kept.append((row, col))
    return kept


def places_to_avoid(motions: list[Motion], hits: FloatArray, owners: list[int]) -> FloatArray:
    """Places (x, y) [m] that the next path must not go through, shape (K, 2)."""
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
