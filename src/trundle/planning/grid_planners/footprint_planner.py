"""`FootprintPlanner`: a grid search for a point, and what is done so that the footprint fits along its path.

A plan is a short list of attempts, made in order until one finds a path (`FootprintPlanner._plan_to`):

1. as asked: between the start and the goal;
2. straight ends: straight out of a start and into a goal where the robot cannot turn;
3. roomier goal: the goal moved, within its tolerance, to where there is more room;
4. roomier goal and straight ends.

With `allow_partial`, a path to near the goal is planned after these (`_plan_near`).

An attempt searches, fits the footprint, and has three remedies for a collision, also in order (`_search_and_fit`):

1. reroute: replace the stretches that collide by ones with more room nearby (`TightPlaces`), without a new search;
2. close: close what is too narrow (`Detours.close`), and search again;
3. reopen: where closing left no path, open it again and close only the cells of collisions (`Detours.reopen`).
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, TypedDict

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import FloatArray, Pose2D, path_length
from trundle.path import Path
from trundle.planning.cancellation import Patience, nominal_expansions
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.grid_planners.detours import Detours, TightPlaces
from trundle.planning.motions import Motion, fit_motions, motions_before, poses_of
from trundle.planning.queries.ends import End, place_to_turn, place_with_room
from trundle.planning.queries.query import PosePlanner, Query, no_path, none_found
from trundle.values import check_count, check_number


def cell_weights(neutral_cost: float, cost_weight: float) -> FloatArray:
    """Return the weights per length of the costs 0 to 255: `neutral_cost + cost_weight · cost`, and 0 from 253 on.

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
    """Why an attempt found no path, and how many replans there had been by then."""

    error: PlanningError
    replans: int


@dataclass(frozen=True, slots=True)
class _Fit:
    """The motions along a path, where they collide as of `fit_motions`, its cost, and how often it was rerouted."""

    motions: list[Motion]
    hits: FloatArray
    owners: list[int]
    cost: float
    reroutes: int


@dataclass(slots=True)
class _Plan:
    """One plan in progress.

    Attributes:
        query: The query.
        goal: The goal as it was given, before it was moved to where the footprint fits.
        patience: When to give up.
        roomier: The query of attempt 3, for attempt 4.
    """

    query: Query
    goal: Pose2D
    patience: Patience
    roomier: Query | None = None


class FootprintPlanner(PosePlanner):
    """A path for a point, checked with everything that the oriented footprint sweeps.

    A cell costs its weight per length; cells of 253 and more are blocked: the inscribed radius is a hard limit. Turns
    at the vertices and at both ends are checked too, in both directions of rotation at the ends. Where the footprint
    collides, planners of shortest paths first reroute through more room nearby; what still collides is closed for this
    query, and it is planned again. Where that finds no path and the robot cannot turn at the start or the goal, it
    drives straight out of the start, and straight into the goal.

    A planner may be used by several threads at once.

    Args:
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        max_replans: How often to close what is too narrow and search again; 0 means one search alone.
        spacing: Largest distance between two poses of the path [m].
        allow_partial: Where the goal cannot be reached, or the robot does not fit there, plan to near it: to the place
            nearest to it that the inscribed circle can reach, or as far towards that as the footprint fits. Such a path
            ends with the yaw of arrival. `Path.status` is "partial" then.
        deadline_s: Give up after this time [s]. If None, plan as long as it takes.

    Raises:
        InputError: If an option is out of range.
    """

    name: ClassVar[str]
    """The planner's name, for `Path.planner`."""

    _tight_places: TightPlaces | None = None
    """Reroutes stretches where the footprint collides, for planners whose cost is the length."""

    _line_weights: FloatArray = cell_weights(1.0, 0.0)
    """Weight per length of each cost, shape (256,)."""

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
        plan = _Plan(query, goal, patience)
        error: PlanningError | None = None
        replans = 0
        for attempt in (self._as_asked, self._straight_ends, self._roomier_goal, self._roomier_goal_and_straight_ends):
            tried = attempt(plan)
            if tried is None:
                continue
            outcome = self._search_and_fit(tried, replans, patience)
            if isinstance(outcome, Path):
                return outcome
            if tried.goal == query.goal:
                error = outcome.error
            replans = outcome.replans + 1
        if error is not None and not self._allow_partial:
            raise error
        return self._plan_near(query.costmap, query.start, goal, patience, replans)

    # The attempts. Each returns the query to search, or None where that would be one that was searched before.

    def _as_asked(self, plan: _Plan) -> Query | None:
        return plan.query

    def _straight_ends(self, plan: _Plan) -> Query | None:
        """Return a query that leads straight out of a start and into a goal where the robot cannot turn."""
        return plan.query.with_straight_ends()

    def _roomier_goal(self, plan: _Plan) -> Query | None:
        """Return a query whose goal is moved, within its tolerance, from where the footprint cannot arrive."""
        query, costmap = plan.query, plan.query.costmap
        if self._goal_tolerance == 0.0:
            return None
        if self._nearest_reachable(costmap, costmap.data, query.start.cell, query.goal.cell) != query.goal.cell:
            return None  # the inscribed circle cannot get there: room at the goal does not help
        place = place_with_room(costmap, plan.goal, self._goal_tolerance, query.start, plan.patience)
        if place is not None and place.cell != query.goal.cell:
            plan.roomier = replace(query, goal=place, enter=place)
        return plan.roomier

    def _roomier_goal_and_straight_ends(self, plan: _Plan) -> Query | None:
        """Return a query with the goal of attempt 3 and the straight ends of attempt 2."""
        return None if plan.roomier is None else plan.roomier.with_straight_ends()

    def _search_and_fit(self, query: Query, replans: int, patience: Patience) -> Path | _Failure:
        """Search for a point and fit the footprint; where it collides, close what is too narrow and search again.

        `replans` is how many there were in earlier attempts.
        """
        keep = (query.leave.cell, query.enter.cell)
        detours = Detours(query.costmap, keep, self._max_replans, wide=self._tight_places is not None)
        collision: FloatArray | None = None
        while True:
            patience.check()
            found = self._find_counted(query.costmap, detours.costs, query.leave, query.enter, patience)
            if found is None:
                changed = detours.reopen()
            else:
                fit = self._fit(query, detours, *found, patience)
                replans += fit.reroutes
                if len(fit.hits) == 0:
                    return self._path(query, fit.motions, fit.cost, replans)
                collision = fit.hits[0]
                changed = detours.close(fit.motions, fit.hits, fit.owners)
            if not changed:
                error = no_path(query, patience) if collision is None else none_found(query, collision, replans)
                return _Failure(error, replans)
            replans += 1

    def _fit(self, query: Query, detours: Detours, vertices: FloatArray, cost: float, patience: Patience) -> _Fit:
        """Return the motions along a path for a point, rerouted where the footprint collides and has room nearby."""
        places = self._tight_places if detours.wide and self._max_replans > 0 else None
        reroutes = 0
        while True:
            patience.check()
            motions, hits, owners = fit_motions(query.costmap, query.motions(vertices))
            if len(hits) == 0 or places is None or reroutes == places.tries:
                return _Fit(motions, hits, owners, cost, reroutes)
            vertices = places.reroute(query.costmap, detours.costs, vertices, hits, reroutes, patience)
            cost = path_length(vertices)
            reroutes += 1

    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience, replans: int = 0) -> Path:
        near = self._approach(costmap, start, start, goal, replans, patience)
        ahead = place_to_turn(costmap, start, 1.0)
        if ahead != start:
            other = self._approach(costmap, start, ahead, goal, near.replans + 1, patience)
            near = min(near, other, key=lambda path: path.remaining_m)
        return near

    def is_near_enough(self, path: Path, costmap: Costmap, start: End, goal: Pose2D) -> bool:
        """Return whether a partial path ends about as near to a goal as the inscribed circle can."""
        least = self._place_near(costmap, costmap.data, start, goal).pose.distance_to(goal)
        return path.remaining_m <= least + _overhang(costmap)

    def _approach(
        self, costmap: Costmap, start: End, leave: End, goal: Pose2D, replans: int, patience: Patience
    ) -> Path:
        """Return the path that ends nearest to a goal; `replans` is how many there were in earlier attempts.

        Each path is cut off where the footprint collides. The next one avoids that place, and is only searched if it
        may end nearer by more than the footprint reaches past its inscribed circle.
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
            found = self._find_counted(costmap, detours.costs, leave, target, patience)
            vertices = np.array([[leave.pose.x, leave.pose.y]]) if found is None else found[0]
            query = Query(costmap, start, target, leave, target, yaw_free=True)
            motions, hits, owners = fit_motions(costmap, query.motions(vertices))
            path = self._partial_path(query, motions_before(costmap, motions), goal, replans)
            if best is None or path.remaining_m < best.remaining_m:
                best = path
            if best.remaining_m <= least + overhang or len(hits) == 0:
                return best
            if not detours.close(motions, hits, owners):
                return best
            replans += 1

    def _place_near(self, costmap: Costmap, costs: npt.NDArray[np.uint8], leave: End, goal: Pose2D) -> End:
        """Return the place nearest to a goal that the inscribed circle can reach."""
        row, col = (int(index) for index in costmap.world_to_cell(goal.x, goal.y))
        cell = self._nearest_reachable(costmap, costs, leave.cell, (row, col))
        x, y = (goal.x, goal.y) if cell == (row, col) else costmap.cell_to_world(*cell)
        place = End(Pose2D(float(x), float(y)), cell)
        return leave if leave.pose.distance_to(goal) <= place.pose.distance_to(goal) else place

    def _nearest_reachable(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: tuple[int, int], goal: tuple[int, int]
    ) -> tuple[int, int]:
        return GridSearch(costs >= INSCRIBED, method="astar").nearest_reachable(start, goal)

    def _find_counted(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        """Find a path as `_find_path` does, and count the expansions."""
        found = self._find_path(costmap, costs, start, goal, patience)
        points = None if found is None else to_grid(costmap, found[0])
        patience.count(nominal_expansions(costmap.shape, points))
        return found

    @abstractmethod
    def _find_path(
        self, costmap: Costmap, costs: npt.NDArray[np.uint8], start: End, goal: End, patience: Patience
    ) -> tuple[FloatArray, float] | None:
        """Return the vertices (x, y) [m] of the best path for a point, and its cost; None if there is no path.

        `costs` are the costmap's own at first, and after a collision a copy of them with more cells blocked.
        """

    def _path(self, query: Query, motions: list[Motion], cost: float, replans: int) -> Path:
        first = np.array(query.start.pose.as_tuple())
        last = np.array(query.goal.pose.as_tuple())
        if query.yaw_free:
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
            # Out of a start where it cannot turn, the robot may drive through cells of 253.
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
    """Return how far the footprint reaches past its inscribed circle, and a cell [m]."""
    return costmap.circumscribed_radius - costmap.inscribed_radius + costmap.resolution


def to_grid(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Return points [m] of the map frame in grid units."""
    return costmap.origin.inverse().transform_points(points) / costmap.resolution


def to_map(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Return points in grid units in the map frame [m]."""
    return costmap.origin.transform_points(points * costmap.resolution)
