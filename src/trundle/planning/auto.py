"""`AutoPlanner`: least cost, and hybrid A* where that finds no path; by name `auto`, the default everywhere."""

from __future__ import annotations

import math
from typing import Any, Unpack

import numpy as np

from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import NoPathError, PlanningError, PlanningStoppedError
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.grid_planners.footprint_planner import FootprintOptions
from trundle.planning.grid_planners.least_cost import COST_WEIGHT, NEUTRAL_COST, LeastCostPlanner
from trundle.planning.hybrid_astar import MAX_EXPANSIONS, PADDING_M, HybridAStarPlanner
from trundle.planning.path_check import PathCheck
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import PosePlanner, Query
from trundle.planning.search_rounds import search_in_rounds
from trundle.values import check_flag

_QUICK_EXPANSIONS = 5_000
"""Expansions of hybrid A* in a quick planner: a tenth of a second. Where there is no path, all take it seconds."""


class AutoPlanner(PosePlanner):
    """Plans by `least_cost`, and where that finds no path by `hybrid_astar` with turns in place.

    `least_cost` plans for a point and checks the footprint afterwards, so it fails where the robot has to reverse out
    of its start or into its goal. `hybrid_astar` searches poses, and drives backwards where it must. `Path.planner` and
    `Path.cost` are those of the planner that found the path. A goal is moved, within its tolerance, only where no
    planner reaches it as it is. Where the path of `least_cost` turns in place closer to something than `hybrid_astar`
    does where it can, one of `hybrid_astar` that keeps a larger distance is taken instead.

    Where the search with turns in place finds nothing, one without them follows; then both search more finely, by turns
    and with rising effort, so that neither uses up the time before the other one has had any. Where all fail, the error
    is a `NoPathError` if the inscribed circle cannot get there, or if one of the ends is enclosed; otherwise a
    `PlanningStoppedError`. With `allow_partial` the path is given that ends nearest to the goal; where a deadline ends
    hybrid A*, that of `least_cost`.

    Args:
        neutral_cost: Weight of a free cell, as of `LeastCostPlanner`.
        cost_weight: Weight of one unit of cost, as of `LeastCostPlanner`.
        max_expansions: Nodes that each search of `HybridAStarPlanner` expands at most.
        options: Options of `FootprintPlanner`. Tolerances, `spacing` and `allow_partial` hold for each planner, and
            `deadline_s` for all together.

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(
        self,
        *,
        neutral_cost: float = NEUTRAL_COST,
        cost_weight: float = COST_WEIGHT,
        max_expansions: int = MAX_EXPANSIONS,
        **options: Unpack[FootprintOptions],
    ) -> None:
        strict = options.copy()
        allow_partial = check_flag("allow_partial", strict.pop("allow_partial", False))
        self._least_cost = LeastCostPlanner(neutral_cost=neutral_cost, cost_weight=cost_weight, **strict)
        super().__init__(
            start_tolerance=self._least_cost._start_tolerance,
            goal_tolerance=self._least_cost._goal_tolerance,
            allow_partial=allow_partial,
            deadline_s=self._least_cost._deadline_s,
        )
        self._padded: tuple[Footprint, FloatArray] | None = None
        given: dict[str, Any] = {"spacing": options["spacing"]} if "spacing" in options else {}
        given["max_expansions"] = max_expansions
        self._searches = [HybridAStarPlanner(in_place=in_place, **given) for in_place in (True, False)]
        self._nearing = HybridAStarPlanner(in_place=True, allow_partial=True, **given) if allow_partial else None

    def make_quick(self) -> AutoPlanner | None:
        """Make one with the same options whose hybrid A* expands 5,000 nodes at most.

        It is None where `max_expansions` was chosen, and for derived classes, which may take other options.
        """
        _, options = self._made_with
        if type(self) is not AutoPlanner or "max_expansions" in options:
            return None
        return AutoPlanner(**options, max_expansions=_QUICK_EXPANSIONS)

    def _plan_to(self, query: Query, goal: Pose2D, patience: Patience) -> Path:
        refusal: NoPathError | None = None
        try:
            path = self._least_cost._plan_to(query, goal, patience)
        except NoPathError as error:
            refusal = error  # the inscribed circle cannot get there either
        except PlanningStoppedError as error:
            if error.status != "exhausted":
                raise
        else:
            return self._improve(query, goal, path, patience)
        if self._nearing is None:
            return self._search(query, goal, patience, refusal)
        # Done before the searches of poses, which may use up the time.
        near = self._least_cost._plan_near(query.costmap, query.start, goal, patience)
        try:
            return self._search(query, goal, patience, refusal)
        except PlanningError as error:
            if isinstance(error, PlanningStoppedError) and error.status == "cancelled":
                raise
            return self._nearer(self._nearing, near, query.costmap, query.start, goal, patience)

    def _search(self, query: Query, goal: Pose2D, patience: Patience, refusal: NoPathError | None) -> Path:
        """Return the path of the first search of poses that finds one, or raise the error if none does."""
        if refusal is not None:
            raise refusal
        index, answer = search_in_rounds(self._searches, query, patience)
        return self._searches[index]._conclude(query, goal, answer, patience)

    def _improve(self, query: Query, goal: Pose2D, path: Path, patience: Patience) -> Path:
        """Return a path of `least_cost`, or a better one where that has its goal moved or turns close to something."""
        is_exact = path.goal_snapped_m == query.goal.snapped_m
        if is_exact and not _turns_tightly(query.costmap, path, self._pad(query.costmap.planar)):
            return path
        try:
            other = self._searches[0]._plan_to(query, goal, patience)
        except PlanningError as error:
            if isinstance(error, PlanningStoppedError) and error.status == "cancelled":
                raise
            return path
        return other if not is_exact or _keeps_more(query.costmap, other, path) else path

    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience) -> Path:
        path = self._least_cost._plan_near(costmap, start, goal, patience)
        return path if self._nearing is None else self._nearer(self._nearing, path, costmap, start, goal, patience)

    def _nearer(
        self, nearing: HybridAStarPlanner, path: Path, costmap: Costmap, start: End, goal: Pose2D, patience: Patience
    ) -> Path:
        """Return a partial path of `least_cost`, or one of a search of poses that ends nearer to the goal."""
        if self._least_cost.is_near_enough(path, costmap, start, goal):
            return path
        try:
            other = nearing._plan_near(costmap, start, goal, patience)
        except PlanningStoppedError as error:
            if error.status == "cancelled":
                raise
            return path
        return other if other.remaining_m < path.remaining_m - costmap.resolution else path

    def _pad(self, footprint: Footprint) -> FloatArray:
        """Return the outline with the distance that `hybrid_astar` keeps where it can; it is kept for the next plan."""
        kept = self._padded
        if kept is None or kept[0] is not footprint:
            kept = self._padded = (footprint, footprint.padded(PADDING_M).outline)
        return kept[1]


def _turns_tightly(costmap: Costmap, path: Path, padded: FloatArray) -> bool:
    """Return whether the padded outline touches something where a path turns in place."""
    poses = path.poses
    turns = (poses[1:, 0] == poses[:-1, 0]).nonzero()[0]
    first, last = poses[turns], poses[turns + 1]
    if not (first[:, 1] == last[:, 1]).all():  # lines along y
        in_place = first[:, 1] == last[:, 1]
        first, last = first[in_place], last[in_place]
    change = last[:, 2] - first[:, 2]
    last[:, 2] -= 2.0 * math.pi * np.rint(change / (2.0 * math.pi))
    # `Costmap.footprint_sweeps` without its checks of the arguments: this is part of every plan.
    origin = costmap.origin
    shares = _core.footprint_sweep(
        costmap.data, costmap.resolution, origin.x, origin.y, origin.yaw, padded, first, last
    )
    return bool((shares < math.inf).any())


def _keeps_more(costmap: Costmap, path: Path, other: Path) -> bool:
    """Return whether a path keeps a larger distance from everything than another one."""
    clearances = [costmap.clearance(PathCheck(each).poses, cap=2.0 * PADDING_M).min() for each in (path, other)]
    return bool(clearances[0] > clearances[1])
