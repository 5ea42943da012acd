"""How every planner of trundle is called: `QueryPlanner`, and `PosePlanner` for those that know the footprint."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, TypeVar

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError
from trundle.geometry import Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience, check_limits, sooner
from trundle.planning.queries.ends import End, find_end
from trundle.planning.queries.query import Query
from trundle.registry import CopiedAsNew
from trundle.values import check_flag, check_kind, check_number

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
