"""`PosePlanner`: the query of every planner that knows the robot's footprint, and where its paths begin and end."""

from __future__ import annotations

from abc import abstractmethod

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError
from trundle.geometry import Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.queries.ends import End, find_end
from trundle.planning.queries.query import Query
from trundle.planning.queries.query_planner import QueryPlanner
from trundle.registry import CopiedAsNew
from trundle.values import check_flag, check_number


class PosePlanner(CopiedAsNew, QueryPlanner):
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
        """The path of a query, or with `allow_partial` one to near the `goal` that was asked for."""

    @abstractmethod
    def _plan_near(self, costmap: Costmap, start: End, goal: Pose2D, patience: Patience) -> Path:
        """A partial path, to as near to a goal as can be."""
