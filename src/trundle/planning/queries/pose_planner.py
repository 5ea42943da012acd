"""`PosePlanner`: the query of every planner that knows the robot's footprint, and where its paths begin and end."""

from __future__ import annotations

from abc import ABC, abstractmethod

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience, check_limits
from trundle.planning.queries.ends import End, begin_plan, find_end
from trundle.planning.queries.query import Query
from trundle.registry import CopiedAsNew
from trundle.values import check_flag, check_number


class PosePlanner(CopiedAsNew, ABC):
    """Plans between two poses where the footprint fits, or near to them.

    Args:
        start_tolerance: How far a start where the robot does not fit may be moved [m].
        goal_tolerance: How far a goal where the robot does not fit may be moved [m].
        allow_partial: Where the goal cannot be reached, or the robot does not fit there, plan to near it.
        deadline_s: Give up after this time [s]; none means as long as it takes.

    Raises:
        InputError: If an option is out of range.
    """

    def __init__(
        self, *, start_tolerance: float, goal_tolerance: float, allow_partial: bool, deadline_s: float | None
    ) -> None:
        self._start_tolerance = check_number("start_tolerance", start_tolerance, 0.0, 1e6, "metres")
        self._goal_tolerance = check_number("goal_tolerance", goal_tolerance, 0.0, 1e6, "metres")
        self._allow_partial = check_flag("allow_partial", allow_partial)
        check_limits(deadline_s, None)
        self._deadline_s = deadline_s

    def plan(
        self,
        costmap: Costmap,
        start: Pose2D,
        goal: Pose2D,
        *,
        goal_yaw_free: bool = False,
        deadline_s: float | None = None,
        cancel: Cancellation | None = None,
    ) -> Path:
        """Plan from `start` to `goal`, poses in the map frame.

        Args:
            costmap: What to stay clear of.
            start: Where the robot stands.
            goal: Where it is to stand.
            goal_yaw_free: End with the yaw that the robot arrives with (of `hybrid_astar` one of 16), not with the
                goal's.
            deadline_s: Give up after this time [s]; the planner's own deadline holds as well.
            cancel: Give up once this is cancelled.

        Raises:
            OutsideMapError: If the start or the goal lies outside the map.
            BlockedPoseError: If the robot does not fit at one of them, nor within its tolerance.
            NoPathError: If no path connects them; of `hybrid_astar`, no path of its arcs and lines.
            PlanningError: If the footprint still hits something after the last replan; it names the pose.
            PlanningStoppedError: If planning ended first: out of time, cancelled, or out of expansions.
            InputError: If an argument is invalid.
        """
        start, goal, patience = begin_plan(
            costmap, start, goal, deadline_s, cancel, planner_deadline_s=self._deadline_s
        )
        first = find_end(costmap, start, "start", self._start_tolerance, patience=patience)
        try:
            last = find_end(
                costmap, goal, "goal", self._goal_tolerance, any_yaw=goal_yaw_free, beside=first, patience=patience
            )
        except BlockedPoseError:
            if not self._allow_partial:
                raise
            return self._plan_near(costmap, first, goal, patience)
        return self._plan_to(Query(costmap, first, last, first, last, goal_yaw_free), goal, patience)

    @abstractmethod
    def _plan_to(self, query: Query, goal: Pose2D, patience: Patience) -> Path:
        """The path of a query, or with `allow_partial` one to near the `goal` that was asked for."""

    @abstractmethod
    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience) -> Path:
        """A partial path, to as near to a goal as can be."""
