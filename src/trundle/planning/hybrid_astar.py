"""`HybridAStarPlanner`: paths for robots that are long or cannot turn in place, by name `hybrid_astar`."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from trundle import _core
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, NoPathError, PlanningError, PlanningStoppedError
from trundle.geometry import FloatArray, Pose2D, wrap_angles
from trundle.path import Path
from trundle.planning.cancellation import Patience, nominal_expansions
from trundle.planning.constrained_smoother import (
    LEAST_PADDING_M,
    PADDING_SHARE,
    CheckedOutline,
    ConstrainedSmoother,
    pose_spacing,
)
from trundle.planning.grid.grid_search import GridSearch
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import PosePlanner, Query, no_path
from trundle.planning.search_rounds import (
    ALL_TRIED,
    CANCELLED,
    CLOSED_OFF,
    FOUND,
    GOAL_CLOSED,
    START_CLOSED,
    TIMEOUT,
    Answer,
    Enclosure,
    on_grid,
    search_in_rounds,
)
from trundle.values import check_flag

MOTION_MODELS = ("dubins", "reeds_shepp")

MAX_EXPANSIONS = 200_000
"""Nodes that one search expands at most by default, which takes it 0.4 to 0.7 s where there is no path
(benchmarks/planning/RESULTS.md, "Dead ends")."""

PADDING_M = 0.02
"""Distance [m] that the footprint keeps from obstacles along the path, by default."""

_LONGEST_CURVE = 5
"""Pieces of the longest Reeds-Shepp curve (Reeds and Shepp 1990)."""

_LESS_PADDING = 0.25
"""Share of the padding that is kept where there is no path with all of it: ends of 3 in 1,000 pairs are enclosed with
0.02 m, and planned with a quarter of it (benchmarks/planning/RESULTS.md, "Pairs without a path")."""


@dataclass(frozen=True, slots=True)
class HybridAStarSettings:
    """Settings of `HybridAStarPlanner`, under the names of Nav2's Smac planner where it has them.

    Attributes:
        motion_model: "dubins" drives forwards only, "reeds_shepp" forwards and backwards.
        minimum_turning_radius: Radius of the tightest arc [m]; 0 with `in_place` for lines and turns in place alone.
        in_place: Whether the robot also turns in place, as differential robots can.
        reverse_penalty: Cost of a metre backwards, in that of one forwards; at least 1.
        change_penalty: Cost of a change between forward and backward [m].
        turn_penalty: Cost of turning in place [m/rad].
        cost_weight: A cell of cost c has 1 + cost_weight · c / 252 times the cost of a free one.
        heuristic_weight: At least 1; a larger one ends the search sooner, and the path may cost more by that factor.
        cell_size: Edge of a cell of states, and of the field that guides the search [m]; a multiple of the map's. Where
            no path is found, states of a half, a quarter and a sixteenth of it and shorter motions are tried, as far as
            100,000 expansions go, so that gaps hardly wider than the robot are not missed.
        smooth: Whether the path is then smoothed, by `ConstrainedSmoother` with these settings.
        padding: The footprint keeps at least this distance from obstacles along the path, if there is room at both ends
            [m], and a quarter of it where no such path is found. Poses are checked so closely that nothing can
            pass between two of them.
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        spacing: Largest distance between two poses of the path [m].
        max_expansions: How many nodes to expand at most.
        deadline_s: How long to search before it gives up [s]. If None, as long as it takes.
        allow_partial: Where the goal cannot be reached, the robot does not fit there, or `max_expansions` is spent,
            give the path to the nearest pose to it that was reached; `Path.status` is "partial" then.
    """

    motion_model: str = "reeds_shepp"
    minimum_turning_radius: float = 0.4
    in_place: bool = False
    reverse_penalty: float = 2.0
    change_penalty: float = 0.3
    turn_penalty: float = 0.5
    cost_weight: float = 2.0
    heuristic_weight: float = 1.2
    cell_size: float = 0.1
    smooth: bool = True
    padding: float = PADDING_M
    start_tolerance: float = 0.05
    goal_tolerance: float = 0.25
    spacing: float = 0.05
    max_expansions: int = MAX_EXPANSIONS
    deadline_s: float | None = None
    allow_partial: bool = False

    def __post_init__(self) -> None:
        if self.motion_model not in MOTION_MODELS:
            raise InputError(f"motion_model is one of {', '.join(MOTION_MODELS)}; got {self.motion_model!r}")
        for name in ("in_place", "smooth"):
            if getattr(self, name) not in (True, False):
                raise InputError(f"{name} is true or false, got {getattr(self, name)!r}")
        tightest = 0.0 if self.in_place else 0.01
        self._check("minimum_turning_radius", tightest, 1e4, "; 0 is for in_place alone" if not self.in_place else "")
        if 0.0 < self.minimum_turning_radius < 0.01:
            raise InputError(f"minimum_turning_radius must be 0, or 0.01 or more, got {self.minimum_turning_radius!r}")
        self._check("reverse_penalty", 1.0, 1e3)
        self._check("heuristic_weight", 1.0, 1e2)
        for name in ("change_penalty", "turn_penalty", "cost_weight"):
            self._check(name, 0.0, 1e3)
        for name in ("padding", "start_tolerance", "goal_tolerance"):
            self._check(name, 0.0, 1e4)
        for name in ("cell_size", "spacing"):
            self._check(name, 1e-3, 1e4)
        if not (isinstance(self.max_expansions, int) and 1 <= self.max_expansions <= 10**8):
            raise InputError(f"max_expansions must be an integer from 1 to 1e8, got {self.max_expansions!r}")
        if self.deadline_s is not None:
            self._check("deadline_s", 1e-9, 1e9)
        check_flag("allow_partial", self.allow_partial)

    def _check(self, name: str, least: float, most: float, hint: str = "") -> None:
        value = getattr(self, name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
            raise InputError(f"{name} must be a number from {least:g} to {most:g}{hint}, got {value!r}")


class HybridAStarPlanner(PosePlanner):
    """Searches poses, not cells: every path is made of arcs and lines that the robot can drive as it is.

    Hybrid A* with 72 headings (Dolgov et al. 2008), Dubins or Reeds-Shepp curves to the goal, and the oriented
    footprint at every pose. `Path.cost` is the length [m] with the settings' penalties and weights in it;
    `Path.backward` says which legs are driven backwards. Lookup tables are filled while it searches,
    and its memory is kept for the next plan; several threads may use one planner.

    Args:
        settings: Any field of `HybridAStarSettings`.

    Raises:
        InputError: If a setting is out of range.
    """

    def __init__(self, **settings: Any) -> None:
        self.settings = HybridAStarSettings(**settings)
        super().__init__(
            start_tolerance=self.settings.start_tolerance,
            goal_tolerance=self.settings.goal_tolerance,
            allow_partial=self.settings.allow_partial,
            deadline_s=self.settings.deadline_s,
        )
        self._smoother = self._make_smoother()
        self._search = _core.HybridAStar(
            radius=float(self.settings.minimum_turning_radius),
            reverse=self.settings.motion_model == "reeds_shepp",
            in_place=bool(self.settings.in_place),
            reverse_penalty=float(self.settings.reverse_penalty),
            change_cost=float(self.settings.change_penalty),
            turn_cost=float(self.settings.turn_penalty),
            cost_weight=float(self.settings.cost_weight),
            heuristic_weight=float(self.settings.heuristic_weight),
            cell_size=float(self.settings.cell_size),
        )

    @property
    def nbytes(self) -> int:
        """Memory that is kept for the next plan."""
        return self._search.bytes

    def _plan_to(self, query: Query, goal: Pose2D, patience: Patience) -> Path:
        return self._conclude(query, goal, self._find(query, patience), patience)

    def _conclude(self, query: Query, goal: Pose2D, answer: Answer, patience: Patience) -> Path:
        """Return the path of an answer, or raise its error."""
        path = answer.path
        if path is not None and answer.status != CLOSED_OFF:
            return path if answer.status == FOUND else replace(path, remaining_m=path.goal.distance_to(goal))
        if self._allow_partial:
            return self._plan_near(query.costmap, query.start, goal, patience)
        raise self._failure(query, answer, patience)

    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience) -> Path:
        # Towards the nearest place that the inscribed circle gets to.
        row, col = (int(index) for index in costmap.world_to_cell(goal.x, goal.y))
        search = GridSearch(costmap.data >= INSCRIBED, method="astar")
        cell = search.nearest_reachable(start.cell, (row, col))
        x, y = (goal.x, goal.y) if cell == (row, col) else costmap.cell_to_world(*cell)
        place = End(Pose2D(float(x), float(y)), cell)
        if start.pose.distance_to(goal) > place.pose.distance_to(goal):
            path = self._find(Query(costmap, start, place, start, place, yaw_free=True), patience).path
            if path is not None:
                return replace(path, status="partial", remaining_m=path.goal.distance_to(goal))
        here = np.array([start.pose.as_tuple()])
        left = start.pose.distance_to(goal)
        return Path(
            here,
            cost=0.0,
            planner="hybrid_astar",
            start_snapped_m=start.snapped_m,
            status="partial",
            remaining_m=left,
        )

    @property
    def max_expansions(self) -> int:
        """How many nodes one search expands at most."""
        return self.settings.max_expansions

    def search(self, query: Query, patience: Patience) -> Answer:
        """Search in cells of the usual size, with the padding and then with less of it."""
        padding, less = self._paddings(query)
        answer = self._find_padded(query, patience, padding)
        if answer.status in ALL_TRIED and less < padding:
            answer = self._find_padded(query, patience, less)
        return answer

    def search_finely(self, query: Query, patience: Patience, most: int) -> Answer:
        """Search in smaller cells and by shorter motions, with so many expansions at most."""
        return self._find_padded(query, patience, self._paddings(query)[1], thorough=True, most=most)

    def _find(self, query: Query, patience: Patience) -> Answer:
        return search_in_rounds([self], query, patience)[1]

    def _paddings(self, query: Query) -> tuple[float, float]:
        padding = self._padding_at_ends(query)
        return padding, min(max(_LESS_PADDING * padding, LEAST_PADDING_M), padding)

    def _find_padded(
        self, query: Query, patience: Patience, padding: float, *, thorough: bool = False, most: int | None = None
    ) -> Answer:
        costmap, settings = query.costmap, self.settings
        checked = CheckedOutline.of(costmap.planar, padding)
        status, poses, backward, parts, cost, effort = self._search.plan(
            costmap.data,
            costmap.resolution,
            checked.outline,
            on_grid(costmap, query.start.pose),
            on_grid(costmap, query.goal.pose),
            query.yaw_free,
            checked.step_m,
            self._spacing(padding),
            settings.max_expansions if most is None else most,
            patience.seconds,
            patience.flag,
            settings.allow_partial,
            checked.inner,
            thorough,
        )
        patience.count(effort[0] + nominal_expansions((effort[1],)))  # poses, and cells of the field that guides it
        if status in (TIMEOUT, CANCELLED):
            raise patience.stopped("timeout" if status == TIMEOUT else "cancelled")
        if len(poses) == 0:
            return Answer(status, None, effort[0])
        path = Path(
            _in_map(query, poses, ends_at_goal=status == FOUND),
            cost=cost,
            planner="hybrid_astar",
            start_snapped_m=query.start.snapped_m,
            goal_snapped_m=query.goal.snapped_m if status == FOUND else 0.0,
            backward=backward.view(np.bool_),
            status="found" if status == FOUND else "partial",
        )
        # One curve from the start to the goal is as short as can be.
        if status == FOUND and self._smoother is not None and len(parts) > _LONGEST_CURVE:
            smoothing = self._smoother.smooth_free(path, costmap)
            path = replace(smoothing.path, cost=smoothing.price_after or path.cost)
        return Answer(status, path, effort[0])

    def _make_smoother(self) -> ConstrainedSmoother | None:
        settings = self.settings
        if not settings.smooth or settings.minimum_turning_radius == 0.0:
            return None
        return ConstrainedSmoother(
            minimum_turning_radius=settings.minimum_turning_radius,
            w_cost=settings.cost_weight,
            reverse_penalty=settings.reverse_penalty,
            change_penalty=settings.change_penalty,
            turn_penalty=settings.turn_penalty,
            padding=settings.padding,
            spacing=settings.spacing,
        )

    def _padding_at_ends(self, query: Query) -> float:
        """Return the padding, or as much of it as there is room for at the start and the goal."""
        padding = float(self.settings.padding)
        if padding == 0.0:
            return 0.0
        ends = [query.start.pose] if query.yaw_free else [query.start.pose, query.goal.pose]
        room = query.costmap.clearance([end.as_tuple() for end in ends], cap=2.0 * padding).min()
        return min(padding, PADDING_SHARE * float(room))

    def _spacing(self, padding: float) -> float:
        radius = self.settings.minimum_turning_radius
        return float(self.settings.spacing) if radius == 0.0 else pose_spacing(self.settings.spacing, radius, padding)

    def _failure(self, query: Query, answer: Answer, patience: Patience) -> PlanningError:
        """Make the error for a query without a path.

        A robot that drives forwards and backwards can follow any free path as closely as it likes (Laumond, Jacobs,
        Taix and Murray 1994): there is none only where an end is enclosed. One that drives forwards only has tried all
        states, in the smallest cells.
        """
        if answer.status == CLOSED_OFF:
            return no_path(query, patience)
        if answer.enclosure is not None:
            return self._enclosed(query, answer.enclosure)
        end = query.start if answer.status == START_CLOSED else query.goal
        where = {"pose": end.pose.as_tuple(), "cell": end.cell}
        if answer.status in ALL_TRIED and self.settings.motion_model == "dubins":
            return NoPathError(f"no path {query.ends}: {self._why_not(answer)}", **where)
        most = self.settings.max_expansions
        limit = f"{most} expansions (max_expansions)" if answer.expansions > most else f"{answer.expansions} expansions"
        return PlanningStoppedError(f"no path {query.ends}: none found within {limit}", **where, status="exhausted")

    def _enclosed(self, query: Query, enclosure: Enclosure) -> NoPathError:
        end = enclosure.end
        what = "cannot get away from the start" if enclosure.is_start else "gets to the goal from nowhere but close by"
        return NoPathError(
            f"no path {query.ends}: the footprint {what}, however the robot moves (all poses tried, in steps of "
            f"{1e3 * enclosure.cell_m:.1f} mm and {math.degrees(enclosure.yaw_rad):.1f}°)",
            pose=end.pose.as_tuple(),
            cell=end.cell,
        )

    def _why_not(self, answer: Answer) -> str:
        """Return why no path that is driven forward only leads there."""
        settings = self.settings
        how = "" if settings.minimum_turning_radius == 0.0 else f"arcs of {settings.minimum_turning_radius:g} m, "
        also = "turning in place, " if settings.in_place else ""
        moving = f"with {how}{also}driving forward only, the footprint"
        if answer.status == START_CLOSED:
            return f"{moving} cannot get away from the start"
        if answer.status == GOAL_CLOSED:
            return f"{moving} gets to the goal from nowhere but close by"
        tried = f"{moving} gets there by none of {answer.expansions} poses that were tried"
        return f"there is room for the inscribed circle, but {tried}"


def _in_map(query: Query, poses: FloatArray, *, ends_at_goal: bool) -> FloatArray:
    """Return poses of the frame of the grid's corner in the map frame, with the ends exactly as they were asked for."""
    origin = query.costmap.origin
    out = np.column_stack([origin.transform_points(poses[:, :2]), wrap_angles(poses[:, 2] + origin.yaw)])
    out[0] = query.start.pose.as_tuple()
    if not ends_at_goal:
        return out
    goal = query.goal.pose
    out[-1] = (goal.x, goal.y, out[-1, 2] if query.yaw_free else goal.yaw)
    return out
