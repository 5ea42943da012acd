"""What grid planners share: search, shortcut, the check with the oriented footprint, and planning again on a hit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import FloatArray, Pose2D
from trundle.path import Path
from trundle.planning.ends import End, find_end
from trundle.planning.motions import Motion, fit_motions, poses_of
from trundle.planning.query import Query, no_path, still_hits

_SHORTCUT_STEP_CELLS = 8
"""The shortcut may turn where the grid path turns, and at every so many cells of it."""

_STEP_OFF_M = 0.3
"""Where a turn at the start or the goal is blocked, the way is closed this far from it, to leave it another way."""


@dataclass(frozen=True, slots=True)
class _Failure:
    """Why an attempt gave no path, and how often it was planned again until then."""

    error: PlanningError
    replans: int


class FootprintPlanner:
    """A* on the grid, the cheapest line-of-sight shortcut of it, and a check of every pose with the footprint.

    A cell costs `neutral_cost + cost_weight · cost` per length; cells of 253 and more are blocked: the inscribed radius
    is a hard limit. The way is then checked with the oriented footprint every 0.025 m and 2°, with the turns at its
    vertices and both ends, where the long way round is tried too. On a hit the cells of the colliding poses become
    lethal for this query, and it is planned again. Where that finds nothing and the robot cannot turn round at the
    start or the goal, it first drives straight on to where it can, and into the goal from such a place behind it.

    Args:
        name: Name of the planner, for `Path.planner`.
        neutral_cost: Weight of a free cell.
        cost_weight: Weight of one unit of cost.
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        max_replans: How often to plan again because the footprint hits something.
        spacing: Largest distance between two poses of the path [m].

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(
        self,
        name: str,
        *,
        neutral_cost: float,
        cost_weight: float,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
    ) -> None:
        for option, value in (
            ("start_tolerance", start_tolerance),
            ("goal_tolerance", goal_tolerance),
            ("max_replans", max_replans),
        ):
            if not (math.isfinite(value) and value >= 0):
                raise InputError(f"{option} must be a number of 0 or more, got {value}")
        if not (math.isfinite(spacing) and spacing > 0.0):
            raise InputError(f"spacing must be a positive number of metres, got {spacing}")
        self._name = name
        self._line_weights = cell_weights(neutral_cost, cost_weight)
        self._search_weights = np.floor(self._line_weights).astype(np.uint16)
        self._start_tolerance = float(start_tolerance)
        self._goal_tolerance = float(goal_tolerance)
        self._max_replans = int(max_replans)
        self._spacing = float(spacing)

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D, *, goal_yaw_free: bool = False) -> Path:
        """Plan from `start` to `goal`, poses in the map frame.

        Args:
            costmap: What to stay clear of.
            start: Where the robot stands.
            goal: Where it shall stand.
            goal_yaw_free: End with the yaw that the robot arrives with, not with the goal's.

        Raises:
            OutsideMapError: If the start or the goal lies outside the map.
            BlockedPoseError: If the robot does not fit at one of them, nor within its tolerance.
            NoPathError: If no way joins them.
            PlanningError: If the footprint still hits something after the last replan; it names the pose.
        """
        start_end = find_end(costmap, start, "start", self._start_tolerance)
        goal_end = find_end(costmap, goal, "goal", self._goal_tolerance, any_yaw=goal_yaw_free)
        query = Query(costmap, start_end, goal_end, start_end, goal_end, goal_yaw_free)
        outcome = self._attempt(query, 0)
        if isinstance(outcome, _Failure):
            straight = query.with_straight_ends()
            if straight != query:
                outcome = self._attempt(straight, outcome.replans + 1)
        if isinstance(outcome, _Failure):
            raise outcome.error
        return outcome

    def _attempt(self, query: Query, replans: int) -> Path | _Failure:
        """Plan, check, and plan again around what the footprint hits; `replans` is what came before."""
        costmap, costs = query.costmap, query.costmap.data
        last = replans + self._max_replans
        hit: FloatArray | None = None
        while True:
            way = self._find_way(costmap, costs, query.leave, query.enter)
            if way is None:
                return _Failure(no_path(query, hit), replans)
            vertices, cost = way
            motions, hits, owners = fit_motions(costmap, query.motions(vertices))
            if len(hits) == 0:
                return self._path(query, motions, cost, replans)
            hit = hits[0]
            places = _places_to_avoid(motions, hits, owners)
            blocked = _block(costmap, costs, places, (query.leave.cell, query.enter.cell))
            if replans == last or np.array_equal(blocked, costs):
                return _Failure(still_hits(query, hits[0], replans), replans)
            costs = blocked
            replans += 1

    def _find_way(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End
    ) -> tuple[FloatArray, float] | None:
        """Vertices (x, y) [m] of the cheapest way, and its cost; none where there is none."""
        # Searched from the lower cell to the higher, so that both directions give the same way.
        turned = (goal.cell, goal.pose.as_tuple()) < (start.cell, start.pose.as_tuple())
        first, last = (goal, start) if turned else (start, goal)
        cells = self._find_cells(costmap, costs, first.cell, last.cell)
        if len(cells) == 0:
            return None
        centres = cells[_turning_points(cells)][:, ::-1].astype(np.float64) + 0.5
        ends = to_grid(costmap, np.array([[end.pose.x, end.pose.y] for end in (first, last)]))
        points = np.concatenate([ends[:1], centres, ends[1:]])
        straightened, cost = self._straighten(costs, points)
        vertices = to_map(costmap, straightened)
        vertices[0], vertices[-1] = (first.pose.x, first.pose.y), (last.pose.x, last.pose.y)
        return vertices[::-1] if turned else vertices, cost * costmap.resolution

    def _find_cells(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> npt.NDArray[np.int32]:
        """Cells (row, col) of the best way from cell to cell over `costs`, shape (N, 2), N = 0 where there is none.

        `costs` are the costmap's own at first, and where the footprint hit something a copy of them with more blocked.
        """
        return _core.grid_search(costs, self._search_weights, start, goal)[0]

    def _straighten(self, costs: npt.NDArray[np.uint8], points: FloatArray) -> tuple[FloatArray, float]:
        """A cheaper line than the one through `points` (x, y) in grid units, with the same ends, and its cost."""
        chosen, cost = _core.shortcut(costs, self._line_weights, points)
        return points[chosen], cost

    def _path(self, query: Query, motions: list[Motion], cost: float, replans: int) -> Path:
        first = np.array(query.start.pose.as_tuple())
        last = np.array(query.goal.pose.as_tuple())
        if query.goal_yaw_free:
            last[2] = motions[-1].yaw + motions[-1].turn if motions else query.start.pose.yaw
        leads = query.start.pose.distance_to(query.leave.pose) + query.enter.pose.distance_to(query.goal.pose)
        return Path(
            poses_of(motions, first, last, self._spacing),
            cost=cost + leads * float(self._line_weights[0]),
            planner=self._name,
            replans=replans,
            start_snapped_m=query.start.snapped_m,
            goal_snapped_m=query.goal.snapped_m,
        )


def cell_weights(neutral_cost: float, cost_weight: float) -> FloatArray:
    """Weights per length of the costs 0 to 255: `neutral_cost + cost_weight · cost`, and 0 (blocked) from 253 on.

    Raises:
        InputError: If they do not lie between 1 and 10,000.
    """
    weights = neutral_cost + cost_weight * np.arange(256, dtype=np.float64)
    if not (np.isfinite(weights).all() and cost_weight >= 0.0 and weights[0] >= 1.0 and weights[252] <= 10_000.0):
        raise InputError(
            "neutral_cost must be 1 or more, cost_weight 0 or more, and neutral_cost + 252 · cost_weight at most "
            f"10000; got {neutral_cost} and {cost_weight}"
        )
    weights[INSCRIBED:] = 0.0
    return weights


def _turning_points(cells: npt.NDArray[np.int32]) -> npt.NDArray[np.bool_]:
    """Which cells of a grid path may become vertices."""
    keep = np.zeros(len(cells), dtype=np.bool_)
    keep[::_SHORTCUT_STEP_CELLS] = True
    keep[-1] = True
    steps = np.diff(cells, axis=0)
    keep[1:-1] |= (steps[1:] != steps[:-1]).any(axis=1)
    return keep


def to_grid(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Points [m] of the map frame in grid units."""
    return costmap.origin.inverse().transform_points(points) / costmap.resolution


def to_map(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Points in grid units in the map frame [m]."""
    return costmap.origin.transform_points(points * costmap.resolution)


def _places_to_avoid(motions: list[Motion], hits: FloatArray, owners: list[int]) -> FloatArray:
    """Places (x, y) [m] that the next way must not go through, shape (K, 2)."""
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


def _block(
    costmap: Costmap, costs: npt.NDArray[np.uint8], places: FloatArray, keep: tuple[tuple[int, int], ...]
) -> npt.NDArray[np.uint8]:
    """Copy the costs with the cells around `places` lethal; those of `keep` stay as they are."""
    blocked = costs.copy()
    rows, cols = costmap.world_to_cell(places[:, 0], places[:, 1])
    for row, col in zip(rows.tolist(), cols.tolist(), strict=True):
        blocked[max(0, row - 1) : row + 2, max(0, col - 1) : col + 2] = LETHAL
    for cell in keep:
        blocked[cell] = costs[cell]
    return blocked
