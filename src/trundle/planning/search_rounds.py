"""Searches of poses in rounds of rising effort, until one finds a path, or an end is enclosed, so that none can."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import Query

_MOST_BOXES = (500_000, 100_000, 100_000, 100_000)
"""Boxes that one flood fills at most, by size of box: a small room of the largest, a tight place of the others."""

_MOST_CELLS, _MOST_HEADINGS = 1e12, 100_000
"""Limits on the numbers of boxes: cells of the map, and headings."""

BOXES_AN_EXPANSION = 20
"""Boxes that a flood fills in about the time in which a search of poses expands one node; for `Cancellation.count`."""

_CLOSED_OFF, _TIMEOUT, _CANCELLED = 0, 3, 4

_ROUNDING_M = 1e-8  # the outline shrinks by a little more, so that rounding makes no free pose a blocked one


@dataclass(frozen=True, slots=True)
class Enclosure:
    """Poses around an end that are closed off from the other end.

    Attributes:
        end: The start or the goal.
        is_start: Which of them.
        cell_m: Width of the boxes that proved it [m].
        yaw_rad: How much yaw each of them holds [rad].
    """

    end: End
    is_start: bool
    cell_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class _Boxes:
    """Boxes of poses, and the outline that is blocked at the middle of those that hold no free pose."""

    cell_m: float
    headings: int
    outline: FloatArray


def find_enclosure(query: Query, patience: Patience, most: int = max(_MOST_BOXES)) -> Enclosure | None:
    """Find an end whose free poses are closed off from the other one, by floods in up to four sizes of boxes.

    A flood fills boxes that hold a pose in which the footprint may be free, whatever the motions of the robot. So where
    it ends without the other end there is no path, for robots of any kind. Where neither flood does, or each fills
    more boxes than it may, there may be a path or none.

    Args:
        query: The ends.
        patience: When to stop.
        most: Boxes that one flood fills at most, whatever their size.

    Raises:
        PlanningStoppedError: If patience ends.
    """
    start, goal = query.start, query.goal
    for boxes, few in zip(_sizes(query.costmap), _MOST_BOXES, strict=False):
        limit = min(few, most)
        step = 2.0 * math.pi / boxes.headings
        if _is_closed_off(query.costmap, boxes, goal.pose, query.yaw_free, start.pose, False, limit, patience):
            return Enclosure(goal, False, boxes.cell_m, step)
        if _is_closed_off(query.costmap, boxes, start.pose, False, goal.pose, query.yaw_free, limit, patience):
            return Enclosure(start, True, boxes.cell_m, step)
    return None


def _sizes(costmap: Costmap) -> Iterator[_Boxes]:
    """Yield boxes from coarse to fine, from the first size on that leaves anything of the outline."""
    radius = costmap.circumscribed_radius
    cell, cells = 0.5 * costmap.resolution, 4.0 * math.prod(costmap.shape)
    while cells <= _MOST_CELLS:
        headings = min(max(16, math.ceil(2.0 * math.pi * radius / (math.sqrt(2.0) * cell))), _MOST_HEADINGS)
        # A point moves by half a diagonal of the cell at most, and by what half a step of yaw turns it.
        moves = math.sqrt(0.5) * cell + 2.0 * radius * math.sin(0.5 * math.pi / headings)
        outline = costmap.planar.shrink(moves + _ROUNDING_M)
        if outline is not None:
            yield _Boxes(cell, headings, outline)
        cell, cells = 0.5 * cell, 4.0 * cells


def _is_closed_off(
    costmap: Costmap,
    boxes: _Boxes,
    start: Pose2D,
    any_yaw: bool,
    goal: Pose2D,
    goal_any_yaw: bool,
    most: int,
    patience: Patience,
) -> bool:
    status, filled = _core.flood_poses(
        costmap.data,
        costmap.resolution,
        boxes.outline,
        on_grid(costmap, start),
        any_yaw,
        on_grid(costmap, goal),
        goal_any_yaw,
        boxes.cell_m,
        boxes.headings,
        most,
        patience.seconds,
        patience.flag,
    )
    patience.count(filled // BOXES_AN_EXPANSION)
    if status in (_TIMEOUT, _CANCELLED):
        raise patience.stopped("timeout" if status == _TIMEOUT else "cancelled")
    return status == _CLOSED_OFF


def on_grid(costmap: Costmap, pose: Pose2D) -> FloatArray:
    """Return a pose of the map frame in the frame of the grid's corner; rounding never puts it outside."""
    x, y, yaw = (costmap.origin.inverse() @ pose).as_tuple()
    rows, cols = costmap.shape
    edge = costmap.resolution * (1.0 - 1e-12)
    return np.array([min(max(x, 0.0), cols * edge), min(max(y, 0.0), rows * edge), yaw])


FOUND, UNREACHABLE, TIMEOUT, CANCELLED, SPENT, CLOSED_OFF, GOAL_CLOSED, START_CLOSED = range(8)
"""How a search ends, by the numbers of the kernel."""

ALL_TRIED = (UNREACHABLE, GOAL_CLOSED, START_CLOSED)


class Answer(NamedTuple):
    """The result of a search.

    Attributes:
        status: The kernel's.
        path: The path, if there is one; maybe a partial one.
        expansions: How many nodes were expanded.
        enclosure: Why no search can find a path, where that is known.
    """

    status: int
    path: Path | None
    expansions: int
    enclosure: Enclosure | None = None


class PoseSearch(Protocol):
    """A search of poses, which can be repeated in smaller cells and by shorter motions."""

    @property
    def max_expansions(self) -> int:
        """How many nodes one search expands at most."""
        ...

    def search(self, query: Query, patience: Patience) -> Answer:
        """Search in cells of the usual size."""
        ...

    def search_finely(self, query: Query, patience: Patience, most: int) -> Answer:
        """Search in smaller cells, with so many expansions at most."""
        ...


@dataclass(frozen=True, slots=True)
class _Round:
    """The effort of one round.

    Attributes:
        boxes: Boxes that one flood fills at most, to see whether an end is enclosed.
        expansions: Nodes that one search expands at most.
    """

    boxes: int
    expansions: int


_ROUNDS = (_Round(20_000, 20_000), _Round(500_000, 100_000))
"""The rounds of finer searches. In an office, a search with turns in place used up the planning deadline where the one
without them finds a path in 50 ms: so each gets 20,000 expansions before one of them gets 100,000."""


def search_in_rounds(searches: Sequence[PoseSearch], query: Query, patience: Patience) -> tuple[int, Answer]:
    """Run each search in turn, then finer ones in rounds of rising effort.

    A finer search that finds nothing takes long, while another search may find a path soon. So in each round every
    search has its turn before one of them goes on. A search whose first run is spent has no finer one. Where an end is
    enclosed, no search can find a path.

    Args:
        searches: One or more, with the preferred one first.
        query: The ends.
        patience: When to stop.

    Returns:
        Which search has the last word, and its answer.

    Raises:
        PlanningStoppedError: If patience ends.
    """
    answers: list[Answer] = []
    for search in searches:
        answers.append(search.search(query, patience))
        if _is_final(answers[-1]):
            return len(answers) - 1, answers[-1]
    most = BOXES_AN_EXPANSION * max(search.max_expansions for search in searches)
    open_ = [index for index, answer in enumerate(answers) if answer.status in ALL_TRIED]
    may_be_enclosed = len(open_) > 0
    for round_ in _ROUNDS:
        enclosure = find_enclosure(query, patience, min(most, round_.boxes)) if may_be_enclosed else None
        if enclosure is not None:
            return len(answers) - 1, answers[-1]._replace(enclosure=enclosure)
        for index in open_.copy():
            before, search = answers[index], searches[index]
            closer = search.search_finely(query, patience, min(round_.expansions, search.max_expansions))
            total = before.expansions + closer.expansions
            answers[index] = closer._replace(path=closer.path or before.path, expansions=total)
            if _is_final(closer):
                return index, answers[index]
            if closer.status in ALL_TRIED or search.max_expansions <= round_.expansions:
                open_.remove(index)
    return len(answers) - 1, answers[-1]


def _is_final(answer: Answer) -> bool:
    return answer.status in (FOUND, CLOSED_OFF)
