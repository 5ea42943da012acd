"""The query of a planner, how every planner is called, and the errors that say why there is no path."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from trundle import _core
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import BlockedPoseError, InputError, NoPathError, PlanningStoppedError
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience, check_limits, sooner
from trundle.planning.motions import Motion, motions_along
from trundle.planning.queries.ends import End, find_end, place_to_turn
from trundle.registry import CopiedAsNew
from trundle.values import check_flag, check_kind, check_number


@dataclass(frozen=True, slots=True)
class Query:
    """The query of a plan.

    Attributes:
        costmap: What to stay clear of.
        start: Where the robot stands.
        goal: Where it is to stand.
        leave: Where the search begins: the start, or a place straight ahead of it.
        enter: Where the search ends: the goal, or a place straight behind it.
        yaw_free: Whether it may end with any yaw.
    """

    costmap: Costmap
    start: End
    goal: End
    leave: End
    enter: End
    yaw_free: bool

    def motions(self, vertices: FloatArray) -> list[Motion]:
        """Return motions from the start along the vertices from `leave` to `enter`, and on to the goal."""
        start, goal = self.start.pose, self.goal.pose
        corners = np.concatenate([[[start.x, start.y]], vertices, [[goal.x, goal.y]]])
        return motions_along(corners, start.yaw, None if self.yaw_free else goal.yaw)

    @property
    def ends(self) -> str:
        """Both ends in words, for messages."""
        start, goal = self.start.pose, self.goal.pose
        return f"from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f})"

    def with_straight_ends(self) -> Query | None:
        """Return the query straight out of a start and into a goal where the robot cannot turn; None where it can."""
        leave = place_to_turn(self.costmap, self.start, 1.0)
        enter = self.goal if self.yaw_free else place_to_turn(self.costmap, self.goal, -1.0)
        straight = replace(self, leave=leave, enter=enter)
        return None if straight == self else straight


def cell_at(costmap: Costmap, x: float, y: float) -> tuple[int, int]:
    """Return the (row, col) that holds a point [m] of the map frame."""
    row, col = costmap.world_to_cell(x, y)
    return int(row), int(col)


def none_found(query: Query, hit: FloatArray, replans: int) -> PlanningStoppedError:
    """Make the error for a footprint that collides on every path tried, on the last one at a pose (x, y, yaw).

    There may be another path: only some were tried, all of them driven forwards.
    """
    x, y, yaw = hit.tolist()
    return PlanningStoppedError(
        f"no path {query.ends}: none found within {replans + 1} plan{'s' if replans else ''}; the footprint hits "
        f"something on each, on the last at ({x:.2f}, {y:.2f}, {math.degrees(yaw):.0f}°); planner auto or hybrid_astar "
        "also searches paths that are driven backwards",
        pose=(x, y, yaw),
        cell=cell_at(query.costmap, x, y),
        status="exhausted",
    )


def no_path(query: Query, patience: Patience) -> NoPathError:
    """Make the error for ends that no path of the inscribed circle connects.

    Raises:
        PlanningStoppedError: If patience ends before the reason is known.
    """
    costmap, start, goal = query.costmap, query.leave, query.enter
    # For a point, with as few steps as possible through what is too narrow for the robot.
    weights = np.ones(256, dtype=np.uint16)
    weights[INSCRIBED], weights[LETHAL:] = 10_000, 0
    cells, cost = _core.grid_search(costmap.data, weights, start.cell, goal.cell, 4, patience.seconds, patience.flag)
    if len(cells) == 0:
        if math.isnan(cost):
            patience.check()
        return NoPathError(
            f"no path {query.ends}: they are separated by occupied or unknown space, and no robot could get there",
            pose=goal.pose.as_tuple(),
            cell=goal.cell,
        )
    narrow = np.flatnonzero(costmap.data[cells[:, 0], cells[:, 1]] == INSCRIBED)
    first_gap = narrow[: int(np.argmax(np.diff(narrow, append=len(cells) + 2) > 1)) + 1]
    row, col = (int(index) for index in cells[first_gap[len(first_gap) // 2]])
    x, y = costmap.cell_to_world(row, col)
    return NoPathError(
        f"no path {query.ends}: a path exists for a point, but this robot is too wide for it at ({x:.2f}, {y:.2f}); "
        f"its inscribed circle alone needs {2.0 * costmap.inscribed_radius:.2f} m",
        pose=(float(x), float(y), 0.0),
        cell=(row, col),
    )


_Read = TypeVar("_Read")


class QueryPlanner(ABC):
    """Checks what it is asked, and plans within the sooner of two deadlines: its caller's and its own.

    Args:
        deadline_s: Give up after this time [s]. If None, plan as long as it takes.

    Raises:
        InputError: If that is no positive number.
    """

    def __init__(self, deadline_s: float | None) -> None:
        check_limits(deadline_s, None)
        self._deadline_s = deadline_s

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Goal,
        *,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`, in the map frame.

        Args:
            costmap: What to stay clear of.
            start: Where the robot stands.
            goal: Where it is to stand. Where any yaw will do, the path ends with the yaw that the robot arrives with
                (with `hybrid_astar` one of 16).
            deadline_s: Give up after this time [s]; the planner's own deadline holds as well.
            cancel: Give up once this is cancelled.

        Raises:
            OutsideMapError: If the start or the goal lies outside the map.
            BlockedPoseError: If the robot does not fit at one of them, nor within its tolerance; of `manhattan_astar`,
                if one of them lies in an occupied or unknown cell.
            NoPathError: If no path connects them; of `hybrid_astar`, no path of its arcs and lines.
            PlanningError: If the footprint still hits something after the last replan; it names the pose.
            PlanningStoppedError: If planning ended first: out of time, cancelled, or out of expansions.
            InputError: If an argument is invalid.
        """
        check_limits(deadline_s, cancel)
        start, goal = check_question(costmap, start, goal)
        row, col = costmap.world_to_cell(goal.x, goal.y)
        patience = Patience(
            sooner(deadline_s, self._deadline_s),
            cancel,
            f"no path from ({start.x:.2f}, {start.y:.2f}) to ({goal.x:.2f}, {goal.y:.2f}) found yet",
            pose=goal.as_tuple(),
            cell=(int(row), int(col)),
        )
        patience.check()
        return self._plan(costmap, start, goal, patience)

    def make_quick(self) -> QueryPlanner | None:
        """Return None: there is no planner like this one that gives up sooner; see `Planner`."""
        return None

    @abstractmethod
    def _plan(self, costmap: Costmap, start: Pose2D, goal: Goal, patience: Patience) -> Path:
        """Plan a query whose arguments are checked."""


class PosePlanner(CopiedAsNew, QueryPlanner):
    """Plans between two poses where the footprint fits, or near to them.

    Args:
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        allow_partial: Where the goal cannot be reached, or the robot does not fit there, plan to near it.
        deadline_s: Give up after this time [s]. If None, plan as long as it takes.

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(
        self, *, start_tolerance: float, goal_tolerance: float, allow_partial: bool, deadline_s: float | None
    ) -> None:
        super().__init__(deadline_s)
        self._start_tolerance = check_number("start_tolerance", start_tolerance, 0.0, 1e6, "metres")
        self._goal_tolerance = check_number("goal_tolerance", goal_tolerance, 0.0, 1e6, "metres")
        self._allow_partial = check_flag("allow_partial", allow_partial)

    def _plan(self, costmap: Costmap, start: Pose2D, goal: Goal, patience: Patience) -> Path:
        first = find_end(costmap, start, "start", self._start_tolerance, patience=patience)
        pose = goal.pose
        try:
            last = find_end(
                costmap, pose, "goal", self._goal_tolerance, any_yaw=goal.yaw_free, beside=first, patience=patience
            )
        except BlockedPoseError:
            if not self._allow_partial:
                raise
            return self._plan_near(costmap, first, pose, patience)
        return self._plan_to(Query(costmap, first, last, first, last, goal.yaw_free), pose, patience)

    @abstractmethod
    def _plan_to(self, query: Query, goal: Pose2D, patience: Patience) -> Path:
        """Plan a query, or with `allow_partial` a path to near the `goal` that was asked for."""

    @abstractmethod
    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience) -> Path:
        """Plan a partial path, to as near to a goal as can be."""


def check_question(costmap: object, start: object, goal: object) -> tuple[Pose2D, Goal]:
    """Check the costmap, and read the start and the goal of a plan; see `read_ends`.

    Raises:
        InputError: If they are none, or `costmap` is not a `Costmap`.
    """
    check_kind(costmap, Costmap, "a planner's costmap", "Costmap.from_grid(grid, robot) makes one")
    return read_ends(start, goal)


def read_ends(start: object, goal: object) -> tuple[Pose2D, Goal]:
    """Read the start and the goal of a plan, each as it is, or of (x, y) or (x, y, yaw) [m, m, rad], map frame.

    A goal (x, y) is one with any yaw. A goal may also be a pose, whose yaw is wanted then.

    Raises:
        InputError: If they are none of these.
    """
    return (
        _read(Pose2D.of, start, "the start must be a pose: Pose2D, (x, y) or (x, y, yaw)"),
        _read(Goal.of, goal, "the goal must be a pose: Goal, Pose2D, (x, y) for any yaw, or (x, y, yaw)"),
    )


def _read(of: Callable[[Any], _Read], value: object, requirement: str) -> _Read:
    try:
        return of(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"{requirement}; got {value!r}: {error}") from error
