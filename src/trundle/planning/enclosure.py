"""Whether an end of a query is enclosed, so that no path leads there however the robot moves."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trundle import _core
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D
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
