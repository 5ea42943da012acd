"""What grid planners share: search, shortcut, the check with the oriented footprint, and planning again on a hit."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, TypedDict

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import FloatArray, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.detours import Detours
from trundle.planning.ends import End, place_to_turn, place_with_room
from trundle.planning.grid_search import GridSearch
from trundle.planning.motions import Motion, fit_motions, motions_before, poses_of
from trundle.planning.pose_planner import PosePlanner
from trundle.planning.query import Query, no_path, none_found
from trundle.planning.tight_places import TightPlaces
from trundle.values import check_count, check_number


def cell_weights(neutral_cost: float, cost_weight: float) -> FloatArray:
    """Weights per length of the costs 0 to 255: `neutral_cost + cost_weight · cost`, and 0 (blocked) from 253 on.

    Raises:
        InputError: If they do not lie between 1 and 10,000.
    """
    neutral, factor = (
        check_number("neutral_cost", neutral_cost, 1.0, 1e4),
        check_number("cost_weight", cost_weight, 0.0, 1e4),
    )
    weights = neutral + factor * np.arange(256, dtype=np.float64)
    if weights[252] > 10_000.0:
        raise InputError(
            f"neutral_cost + 252 · cost_weight must be at most 10000; got {neutral_cost} and {cost_weight}"
        )
    weights[INSCRIBED:] = 0.0
    return weights


class FootprintOptions(TypedDict, total=False):
    """The options that every `FootprintPlanner` takes, for the signatures of those that take more."""

    start_tolerance: float
    goal_tolerance: float
    max_replans: int
    spacing: float
    allow_partial: bool
    deadline_s: float | None


@dataclass(frozen=True, slots=True)
class _Failure:
    """Why an attempt gave no path, and how often it was planned again until then."""

    error: PlanningError
    replans: int


@dataclass(frozen=True, slots=True)
class _Fit:
    """The motions along a path, where they hit something as of `fit_motions`, and what it took."""

    motions: list[Motion]
    hits: FloatArray
    owners: list[int]
    cost: float
    replans: int


class FootprintPlanner(PosePlanner):
    """A way for a point, and a check of every pose with the footprint.

    A cell costs its weight per length; cells of 253 and more are blocked: the inscribed radius is a hard limit. The
    path is checked with all that the oriented footprint sweeps over, with the turns at its vertices and both ends,
    where the long way round is tried too. On a hit, planners of shortest paths first take stretches with more room
    there; what is hit all the same is closed for this query, and it is planned again. Where that finds nothing and the
    robot cannot turn round at the start or the goal, it first drives straight on to where it can, and into the goal
    from such a place behind it.

    A planner may be used by several threads at once.

    Args:
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        max_replans: How often to close what is too narrow and search again; 0 means one search alone.
        spacing: Largest distance between two poses of the path [m].
        allow_partial: Where the goal cannot be reached, or the robot does not fit there, plan to near it: to the place
            nearest to it that the inscribed circle can get to, or as far towards that as the footprint fits. It ends
            with the yaw with which the robot arrives. `Path.status` is "partial" then.
        deadline_s: Give up after this time [s]; none means as long as it takes.

    Raises:
        InputError: If an option is out of range.
    """

    name: ClassVar[str]
    """Of the planner, for `Path.planner`."""

    _tight_places: TightPlaces | None = None
    """Other stretches where the footprint hits something, for planners whose cost is the length."""

    _line_weights: FloatArray = cell_weights(1.0, 0.0)
    """What a length costs in a cell, by its cost, shape (256,)."""

    def __init__(
        self,
        *,
        start_tolerance: float = 0.05,
        goal_tolerance: float = 0.25,
        max_replans: int = 20,
        spacing: float = 0.1,
        allow_partial: bool = False,
        deadline_s: float | None = None,
    ) -> None:
        super().__init__(
            start_tolerance=start_tolerance,
            goal_tolerance=goal_tolerance,
            allow_partial=allow_partial,
            deadline_s=deadline_s,
        )
        self._max_replans = check_count("max_replans", max_replans, 0, 10**6)
        self._spacing = check_number("spacing", spacing, 1e-3, 1e6, "metres")

    def _plan_to(self, query: Query, goal: Pose2D, patience: Patience) -> Path:
        failure, replans = None, 0
        for variant in self._variants(query, goal, patience):
            outcome = self._attempt(variant, replans, patience)
            if isinstance(outcome, Path):
                return outcome
            if failure is None or variant.goal == query.goal:
                failure = outcome
            replans = outcome.replans + 1
        if failure is not None and not self._allow_partial:
            raise failure.error
        return self._plan_near(query.costmap, query.start, goal, patience, replans)

    def _variants(self, query: Query, goal: Pose2D, patience: Patience) -> Iterator[Query]:
        """What to try one after the other: the query, and with a goal where there is more room.

        Each is tried as it is, and then straight out of a start and into a goal where the robot cannot turn.
        """
        yield from query.both_ways_out()
        roomy = self._move_goal(query, goal, patience)
        if roomy is not None:
            yield from roomy.both_ways_out()

    def _move_goal(self, query: Query, goal: Pose2D, patience: Patience) -> Query | None:
        """The query with its goal moved, within its tolerance, from where the footprint cannot arrive to more room."""
        costs, cell = query.costmap.data, query.goal.cell
        if self._goal_tolerance == 0.0 or self._nearest_reachable(query.costmap, costs, query.start.cell, cell) != cell:
            return None
        place = place_with_room(query.costmap, goal, self._goal_tolerance, query.start, patience)
        return None if place is None or place.cell == cell else replace(query, goal=place, enter=place)

    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience, replans: int = 0) -> Path:
        near = self._approach(costmap, start, start, goal, replans, patience)
        ahead = place_to_turn(costmap, start, 1.0)
        if ahead != start:
            other = self._approach(costmap, start, ahead, goal, near.replans + 1, patience)
            near = min(near, other, key=lambda path: path.remaining_m)
        return near

    def is_near_enough(self, path: Path, costmap: Costmap, start: End, goal: Pose2D) -> bool:
        """Whether a partial path ends about as near to a goal as the inscribed circle can get."""
        least = self._place_near(costmap, costmap.data, start, goal).pose.distance_to(goal)
        return path.remaining_m <= least + _overhang(costmap)

    def _attempt(self, query: Query, replans: int, patience: Patience) -> Path | _Failure:
        """Search a path for a point and fit the footprint to it; close what it does not fit through, and search again.

        1. `_find_way` gives the best path for a point past what is closed.
        2. `_fit` makes motions of it, with other stretches where the footprint hits something, if the planner has some.
        3. What is hit all the same is too narrow: `Detours` closes it for the next search.

        `replans` is what came before.
        """
        keep = (query.leave.cell, query.enter.cell)
        detours = Detours(query.costmap, keep, self._max_replans, wide=self._tight_places is not None)
        hit: FloatArray | None = None
        while True:
            patience.check()
            way = self._find_way(query.costmap, detours.costs, query.leave, query.enter, patience)
            if way is None:
                goes_on = detours.give_back()
            else:
                fit = self._fit(query, detours, way, patience)
                replans += fit.replans
                if len(fit.hits) == 0:
                    return self._path(query, fit.motions, fit.cost, replans)
                hit = fit.hits[0]
                goes_on = detours.avoid(fit.motions, fit.hits, fit.owners)
            if not goes_on:
                error = no_path(query, patience) if hit is None else none_found(query, hit, replans)
                return _Failure(error, replans)
            replans += 1

    def _fit(self, query: Query, detours: Detours, way: tuple[FloatArray, float], patience: Patience) -> _Fit:
        """The motions along a path for a point, led past what the footprint hits where there is more room nearby."""
        vertices, cost = way
        replans = 0
        while True:
            patience.check()
            motions, hits, owners = fit_motions(query.costmap, query.motions(vertices))
            places = self._tight_places if detours.wide and self._max_replans > 0 else None
            if len(hits) == 0 or places is None or replans == places.tries:
                return _Fit(motions, hits, owners, cost, replans)
            vertices = places.lead_past(query.costmap, detours.costs, vertices, hits, replans, patience)
            cost = float(np.hypot(*np.diff(vertices, axis=0).T).sum())
            replans += 1

    def _approach(
        self, costmap: Costmap, start: End, leave: End, goal: Pose2D, replans: int, patience: Patience
    ) -> Path:
        """A way that leads as near to a goal as it can; `replans` is what came before.

        Each attempt is cut off where the footprint hits something. The next one avoids that place, and is only made if
        it may end nearer by more than the footprint reaches past its inscribed circle.
        """
        detours = Detours(costmap, (leave.cell,), self._max_replans)
        overhang = _overhang(costmap)
        best: Path | None = None
        while True:
            patience.check()
            target = self._place_near(costmap, detours.costs, leave, goal)
            least = target.pose.distance_to(goal)
            if best is not None and best.remaining_m <= least:
                return best
            way = self._find_way(costmap, detours.costs, leave, target, patience)
            vertices = np.array([[leave.pose.x, leave.pose.y]]) if way is None else way[0]
            query = Query(costmap, start, target, leave, target, goal_yaw_free=True)
            motions, hits, owners = fit_motions(costmap, query.motions(vertices))
            path = self._partial_path(query, motions_before(costmap, motions), goal, replans)
            if best is None or path.remaining_m < best.remaining_m:
                best = path
            if best.remaining_m <= least + overhang or len(hits) == 0:
                return best
            if not detours.avoid(motions, hits, owners):
                return best
            replans += 1

    def _place_near(self, costmap: Costmap, costs: npt.NDArray[np.uint8], leave: End, goal: Pose2D) -> End:
        """The place nearest to a goal that the inscribed circle can get to."""
        row, col = (int(index) for index in costmap.world_to_cell(goal.x, goal.y))
        cell = self._nearest_reachable(costmap, costs, leave.cell, (row, col))
        x, y = (goal.x, goal.y) if cell == (row, col) else costmap.cell_to_world(*cell)
        place = End(Pose2D(float(x), float(y)), cell)
        return leave if leave.pose.distance_to(goal) <= place.pose.distance_to(goal) else place

    def _nearest_reachable(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> tuple[int, int]:
        return GridSearch(costs >= INSCRIBED, method="astar").nearest_reachable(start, goal)

    @abstractmethod
    def _find_way(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        """Vertices (x, y) [m] of the best way, and its cost; none where there is none.

        `costs` are the costmap's own at first, and where the footprint hit something a copy of them with more blocked.
        """

    def _path(self, query: Query, motions: list[Motion], cost: float, replans: int) -> Path:
        first = np.array(query.start.pose.as_tuple())
        last = np.array(query.goal.pose.as_tuple())
        if query.goal_yaw_free:
            last[2] = motions[-1].yaw + motions[-1].turn if motions else query.start.pose.yaw
        leads = query.start.pose.distance_to(query.leave.pose) + query.enter.pose.distance_to(query.goal.pose)
        return Path(
            poses_of(motions, first, last, self._spacing),
            cost=cost + leads * float(self._line_weights[0]),
            planner=self.name,
            replans=replans,
            start_snapped_m=query.start.snapped_m,
            goal_snapped_m=query.goal.snapped_m,
        )

    def _partial_path(self, query: Query, motions: list[Motion], goal: Pose2D, replans: int) -> Path:
        costmap = query.costmap
        first = last = np.array(query.start.pose.as_tuple())
        cost = 0.0
        if motions:
            last = np.array([*motions[-1].end, motions[-1].yaw + motions[-1].turn])
            lines = np.array([(*motion.start, *motion.end) for motion in motions])
            starts, ends = (np.ascontiguousarray(to_grid(costmap, part)) for part in (lines[:, :2], lines[:, 2:]))
            # Out of a start where it cannot turn the robot may drive through cells of 253.
            costs = _core.line_costs(costmap.data, self._line_weights, starts, ends)
            lengths = np.hypot(*(ends - starts).T)
            cost = float(np.where(np.isfinite(costs), costs, lengths * self._line_weights[0]).sum())
        return Path(
            poses_of(motions, first, last, self._spacing),
            cost=cost * costmap.resolution,
            planner=self.name,
            replans=replans,
            start_snapped_m=query.start.snapped_m,
            status="partial",
            remaining_m=math.dist(last[:2], (goal.x, goal.y)),
        )


def _overhang(costmap: Costmap) -> float:
    """How far [m] the footprint reaches past its inscribed circle, and a cell."""
    return costmap.circumscribed_radius - costmap.inscribed_radius + costmap.resolution


def to_grid(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Points [m] of the map frame in grid units."""
    return costmap.origin.inverse().transform_points(points) / costmap.resolution


def to_map(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Points in grid units in the map frame [m]."""
    return costmap.origin.transform_points(points * costmap.resolution)
