"""`find_frontiers`: where free space borders on unknown space (Yamauchi, CIRA 1997); `Targets`: which is next."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt
from pydantic import Field

from trundle._core import cast_grid_rays, inflate, label_components, mark_gaps
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.files.yaml_config import Config, NotNegative, Positive
from trundle.geometry import FloatArray, Pose2D
from trundle.maps.cells import OCCUPIED
from trundle.planning import cost_field

_AROUND_M = 0.3
"""The robot stands there: so far beside its outline [m] it can drive, whatever the costmap says."""
_LOOK_M = 3.0
"""A place from which a frontier is looked at lies within this of it [m]."""
_PLACES = 9
"""So many places of a frontier are tried before it counts as out of sight."""
_RAYS = 180
_UNSEEN_M = 3.0
"""Along a ray, not more than this of unknown space counts [m]: what is behind is anybody's guess."""
_STEP, _WALL = 20, 255
"""Costs of a cell's length: free, and where the robot cannot be. In between, a place near obstacles counts as farther
away, up to three times."""

_Mask = npt.NDArray[np.bool_]
_Cells = npt.NDArray[np.intp]


class ExplorerSettings(Config):
    """When an explorer drives where.

    Attributes:
        least_frontier: Frontiers shorter than this are left out [m]: the robot does not fit through.
        least_gain: Frontiers that would show less than this are left out [m²]. With 1 instead of 0.15 an office takes
            a fifth less time, and over 99 % of its floor is still seen.
        least_opening: A frontier counts all the same if what is unknown behind it keeps the robot's centre from so much
            floor [m²], as an area amid an aisle does.
        speck_area: Unknown areas smaller than this count as seen [m²], such as what lies between two beams.
        view_range: How far what a frontier would show is counted [m].
        gain_exponent: Weight of what a frontier would show: frontiers are rated by area ** exponent / distance. With 0
            the nearest is the best.
        period: How often the explorer looks for frontiers [s].
        tries: How often it tries to get to a frontier before it gives that up.
        patience: Time without getting nearer to a frontier after which a try has failed [s].

    Raises:
        InputError: If a value is out of range.
    """

    least_frontier: NotNegative = 0.3
    least_gain: NotNegative = 1.0
    least_opening: NotNegative = 0.5
    speck_area: NotNegative = 0.02
    view_range: Annotated[float, Field(gt=0.1, le=100.0)] = 6.0
    gain_exponent: Annotated[float, Field(ge=0.0, le=4.0)] = 0.5
    period: Annotated[float, Field(ge=0.05, le=60.0)] = 1.0
    tries: Annotated[int, Field(ge=1, le=20)] = 2
    patience: Positive = 40.0


@dataclass(frozen=True, slots=True)
class Frontier:
    """A stretch of free space that borders on unknown space.

    Attributes:
        x, y: Its middle, map frame [m]; of one longer than four times the view range, where it is nearest to the robot.
        length: Its length [m].
        view: Where the robot can look at it from, map frame [m].
        distance: How far the robot drives there [m]; near obstacles a metre counts up to three times.
        gain: How much unknown space it would see from there [m²].
    """

    x: float
    y: float
    length: float
    view: tuple[float, float]
    distance: float
    gain: float


def find_frontiers(
    costmap: Costmap, pose: Pose2D, settings: ExplorerSettings | None = None, *, in_pieces: bool = False
) -> list[Frontier]:
    """Return the frontiers that a robot can look at from places that it can reach through known free space.

    Whether its footprint fits through is judged by its inscribed circle; a planner has the last word.

    Args:
        costmap: What is free, blocked and unknown; unknown cells must not block in it.
        pose: Where the robot is, map frame.
        settings: Which frontiers count.
        in_pieces: Whether those longer than four times the view range come in pieces.
    """
    settings = ExplorerSettings() if settings is None else settings
    edge = costmap.resolution
    unseen = _without_specks(costmap.unknown_cells, settings.speck_area / edge**2 - 1e-9)
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if not costmap.contains(row, col) or not unseen.any():
        return []
    reached = _reach(costmap, unseen, row, col)
    roomy = np.where(costmap.data <= _cost_of_turning(costmap), reached, np.float32(np.inf))
    blocked = (costmap.data == LETHAL).view(np.uint8)
    # Walls have gaps where beams graze them. Where the robot does not fit through, there is nothing for it to see.
    blocked |= mark_gaps(blocked, costmap.planar.least_width / edge)
    solid = blocked.view(np.bool_)
    border = ~unseen & ~solid & _beside(unseen & ~solid)
    reach = _LOOK_M / edge
    found: list[Frontier] = []
    x, y = (float(value) / edge for value in costmap.cell_to_world(0, 0))
    square = 2.0 * settings.view_range / edge
    for rows, cols in _stretches(border, (y, x), settings.least_frontier / edge, square if in_pieces else math.inf):
        found_place = None
        # A part may lie behind a wall. The middle of a long one moves from end to end of a hall with all that is seen.
        middle = (row, col) if len(rows) > 2.0 * square else (rows.mean(), cols.mean())
        order = np.argsort((rows - middle[0]) ** 2 + (cols - middle[1]) ** 2, kind="stable")
        for index in order[np.linspace(0, len(order) - 1, min(len(order), _PLACES)).astype(np.intp)].tolist():
            at = int(rows[index]), int(cols[index])
            view = _place_to_look(blocked, roomy, at, reach) or _place_to_look(blocked, reached, at, reach)
            if view is not None:
                found_place = at, view
                break
        if found_place is None:
            continue
        at, view = found_place
        gain = _gain(blocked, unseen, view, settings.view_range / edge, _UNSEEN_M / edge) * edge**2
        if gain < settings.least_gain and _opening(costmap, rows, cols) < settings.least_opening:
            continue
        x, y = (float(value) for value in costmap.cell_to_world(*at))
        view_x, view_y = (float(value) for value in costmap.cell_to_world(*view))
        distance = float(reached[view]) / _STEP * edge
        found.append(Frontier(x, y, len(rows) * edge, (view_x, view_y), distance, gain))
    return found


def shows_floor(costmap: Costmap, pose: Pose2D) -> bool:
    """Return whether a costmap shows free space that the robot can drive on from a pose, map frame."""
    unseen = costmap.unknown_cells
    row, col = (int(index) for index in costmap.world_to_cell(pose.x, pose.y))
    if not costmap.contains(row, col) or unseen.all():
        return False
    return bool((np.isfinite(_reach(costmap, unseen, row, col)) & ~unseen).any())


def _opening(costmap: Costmap, rows: _Cells, cols: _Cells) -> float:
    """Return how much floor the robot's centre is kept from by what is unknown beside a stretch of the border [m²].

    It counts the cells within the footprint's inscribed radius of the border, seen or not, that no obstacle keeps it
    from.
    """
    radius = math.ceil(costmap.inscribed_radius / costmap.resolution)
    top, left = max(0, int(rows.min()) - radius), max(0, int(cols.min()) - radius)
    drivable = costmap.data[top : int(rows.max()) + radius + 1, left : int(cols.max()) + radius + 1] < INSCRIBED
    marked = np.zeros(drivable.shape, np.int8)
    marked[rows - top, cols - left] = OCCUPIED
    near = inflate(marked, np.ones(radius**2 + 1, np.uint8)) > 0
    return float((near & drivable).sum()) * costmap.resolution**2


def _stretches(
    border: _Mask, corner: tuple[float, float], least: float, side: float
) -> Iterator[tuple[_Cells, _Cells]]:
    """Yield rows and columns of each stretch of the border, without those of fewer than `least` cells.

    One longer than twice the side of a square [cells] comes in pieces, one for each square. As the map may grow on all
    sides, `corner`, the place of its first cell [cells], says where squares begin.
    """
    labels, table = label_components(border.view(np.uint8), True)
    for number in np.flatnonzero(table[:, 0] >= least).tolist():
        count, first, end, left, right = table[number].tolist()
        rows, cols = np.nonzero(labels[first:end, left:right] == number + 1)
        rows, cols = rows + first, cols + left
        if count <= 2.0 * side:
            yield rows, cols
            continue
        down, across = (np.floor((a + b) / side).astype(np.int64) for a, b in zip((rows, cols), corner, strict=True))
        square = (down - down.min()) * (across.max() - across.min() + 1) + across - across.min()
        for one in np.unique(square).tolist():
            inside = square == one
            if inside.sum() >= least:
                yield rows[inside], cols[inside]


def _without_specks(unseen: _Mask, least: float) -> _Mask:
    """Return unknown cells without areas of fewer than `least` cells."""
    labels, table = label_components(np.ascontiguousarray(unseen).view(np.uint8), False)
    kept = np.concatenate([[False], table[:, 0] >= least])
    return kept[labels]


def _reach(costmap: Costmap, unseen: _Mask, row: int, col: int) -> npt.NDArray[np.float32]:
    """Return what it costs to drive to each cell through known free space; infinite where the robot does not get."""
    costs = np.where(costmap.data < INSCRIBED, _STEP + costmap.data // 6, _WALL).astype(np.uint8)
    costs[unseen] = _WALL
    reach = math.ceil((costmap.circumscribed_radius + _AROUND_M) / costmap.resolution)
    rows, cols = slice(max(0, row - reach), row + reach + 1), slice(max(0, col - reach), col + reach + 1)
    near_row, near_col = np.ogrid[rows.start - row : rows.stop - row, cols.start - col : cols.stop - col]
    near_row, near_col = near_row[: costs[rows].shape[0]], near_col[:, : costs[:, cols].shape[1]]
    here = (near_row**2 + near_col**2 <= reach**2) & (costmap.data[rows, cols] != LETHAL)
    costs[rows, cols][here] = np.minimum(costs[rows, cols][here], 3 * _STEP)
    costs[row, col] = _STEP
    return cost_field(costs, (row, col), threads=1)


def _cost_of_turning(costmap: Costmap) -> int:
    """Return the highest cost of a cell at which the robot fits at every yaw."""
    off = costmap.circumscribed_radius - costmap.inscribed_radius
    return int((INSCRIBED - 1) * math.exp(-costmap.cost_scaling_factor * off))


def _beside(mask: _Mask) -> _Mask:
    """Return the cells that have a set cell beside them, above or below."""
    beside = np.zeros_like(mask)
    beside[1:] |= mask[:-1]
    beside[:-1] |= mask[1:]
    beside[:, 1:] |= mask[:, :-1]
    beside[:, :-1] |= mask[:, 1:]
    return beside


def _place_to_look(
    blocked: npt.NDArray[np.uint8], reached: npt.NDArray[np.float32], at: tuple[int, int], reach: float
) -> tuple[int, int] | None:
    """Return the cell nearest to `at` that the robot can reach and from which it sees that cell; None without one."""
    half = math.ceil(reach)
    rows, cols = slice(max(0, at[0] - half), at[0] + half + 1), slice(max(0, at[1] - half), at[1] + half + 1)
    places = np.argwhere(np.isfinite(reached[rows, cols]))
    if not len(places):
        return None
    off = places + np.array((rows.start - at[0], cols.start - at[1]))
    distance = np.hypot(off[:, 0], off[:, 1])
    order = np.argsort(distance, kind="stable")[:512]
    bearing: FloatArray = np.arctan2(off[order, 0], off[order, 1]).astype(np.float64)
    free = cast_grid_rays(blocked, at[1] + 0.5, at[0] + 0.5, bearing, reach)
    seen = order[(distance[order] <= reach) & (distance[order] <= free)]
    if not len(seen):
        return None
    row, col = places[seen[0]].tolist()
    return rows.start + row, cols.start + col


def _gain(blocked: npt.NDArray[np.uint8], unseen: _Mask, view: tuple[int, int], reach: float, deepest: float) -> float:
    """Return how many unknown cells can be seen from a cell: of each ray, up to `deepest` [cells] of unknown space."""
    angles: FloatArray = np.arange(_RAYS, dtype=np.float64) * (2.0 * math.pi / _RAYS)
    free: FloatArray = cast_grid_rays(blocked, view[1] + 0.5, view[0] + 0.5, angles, reach)
    step = 2.0
    along = np.arange(step, reach, step)
    rows = np.floor(view[0] + 0.5 + np.outer(np.sin(angles), along)).astype(np.intp)
    cols = np.floor(view[1] + 0.5 + np.outer(np.cos(angles), along)).astype(np.intp)
    inside = (rows >= 0) & (rows < unseen.shape[0]) & (cols >= 0) & (cols < unseen.shape[1])
    inside &= along < np.minimum(free, reach)[:, None]
    new = np.zeros(rows.shape, np.bool_)
    new[inside] = unseen[rows[inside], cols[inside]]
    counted = new & (np.cumsum(new, axis=1) * step <= deepest)
    return float((counted * along).sum() * step * 2.0 * math.pi / _RAYS)


_SAME_M = 1.0
"""Frontiers that are nearer to each other than this are one and the same [m]: they move as more is seen."""
_STAYS = 1.5
"""So much better must another frontier be before the robot turns away from the one that it drives to."""
_LOOKS = 3
"""So often a frontier may come back after it was looked at."""
_TURN_M = 1.5
"""Added to the distance of every frontier [m], so that a close one does not count without limit."""


@dataclass(frozen=True, slots=True)
class GivenUp:
    """A frontier that the robot could not look at.

    Attributes:
        x, y: Where it is, map frame [m], as of a `Frontier`.
        reason: Why.
        gain: How much unknown space it would have shown [m²].
    """

    x: float
    y: float
    reason: str
    gain: float


@dataclass(slots=True)
class _Refused:
    """Tries to get to a frontier that have failed.

    Attributes:
        frontier: The frontier.
        reason: Why the last one failed.
        tries: How many.
        waits: Whether others come first.
        is_forgiven: Whether one of them was taken back, or none may be: it was refused for good.
    """

    frontier: Frontier
    reason: str
    tries: int = 0
    waits: bool = True
    is_forgiven: bool = False


class Targets:
    """Chooses among frontiers, and remembers those that could not be reached.

    A frontier at which a try has failed is tried again once no other is left: what was in the way may have moved.

    Args:
        settings: How frontiers are rated, and how often each is tried.
    """

    def __init__(self, settings: ExplorerSettings) -> None:
        self._settings = settings
        self._refused: list[_Refused] = []
        self._visited: list[tuple[float, float]] = []

    def choose(self, frontiers: Sequence[Frontier], current: Frontier | None) -> Frontier | None:
        """Return the frontier to drive to; None where none is left to be tried.

        Args:
            frontiers: All that there are now.
            current: The one that the robot drives to.
        """
        open_ones = [one for one in frontiers if not self._waits(one)]
        if not open_ones:
            for refused in self._refused:
                refused.waits = refused.tries >= self._settings.tries
            open_ones = [one for one in frontiers if not self._waits(one)]
        if not open_ones:
            return None

        def worth(frontier: Frontier) -> float:
            rated = frontier.gain**self._settings.gain_exponent / (frontier.distance + _TURN_M)
            return rated * _STAYS if current is not None and is_same(frontier, current) else rated

        return max(open_ones, key=worth)

    def refuse(self, frontier: Frontier, reason: str, *, for_good: bool = False) -> None:
        """Note that a try to look at a frontier has failed."""
        refused = next((one for one in self._refused if is_same(one.frontier, frontier)), None)
        if refused is None:
            refused = _Refused(frontier, reason)
            self._refused.append(refused)
        refused.reason, refused.waits = reason, True
        refused.tries = self._settings.tries if for_good else refused.tries + 1
        refused.is_forgiven = refused.is_forgiven or for_good

    def forgive(self, frontiers: Sequence[Frontier]) -> None:
        """Take back a failed try at each of these frontiers, once, unless it was refused for good."""
        for one in self._refused:
            if not one.is_forgiven and any(is_same(one.frontier, frontier) for frontier in frontiers):
                one.tries, one.waits, one.is_forgiven = one.tries - 1, False, True

    def note_vanished(self, frontier: Frontier) -> None:
        """Note that a frontier was looked at and has vanished.

        One that comes back again and again, as where beams graze a wall, is given up.
        """
        places = [*self._visited, (frontier.x, frontier.y)]
        self._visited = places
        if sum(math.dist(place, places[-1]) < _SAME_M for place in places) > _LOOKS:
            self.refuse(frontier, f"looked at {_LOOKS + 1} times, and unknown again", for_good=True)

    def given_up(self, frontiers: Sequence[Frontier]) -> tuple[GivenUp, ...]:
        """Return those of the frontiers that there are now that were given up."""
        return tuple(
            GivenUp(one.x, one.y, refused.reason, one.gain)
            for one in frontiers
            for refused in self._refused
            if refused.waits and is_same(refused.frontier, one)
        )

    def _waits(self, frontier: Frontier) -> bool:
        return any(one.waits and is_same(one.frontier, frontier) for one in self._refused)


def is_same(one: Frontier, other: Frontier) -> bool:
    """Return whether two frontiers, of one time or of two, are one and the same."""
    return math.hypot(one.x - other.x, one.y - other.y) < _SAME_M
