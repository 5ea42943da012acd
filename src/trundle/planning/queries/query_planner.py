"""`QueryPlanner`: how every planner of trundle is called."""

from __future__ import annotations

from abc import ABC, abstractmethod

from trundle.costmap import Costmap
from trundle.geometry import Goal, Pose2D
from trundle.path import Path
from trundle.planning.cancellation import Cancellation, Patience, check_limits, sooner
from trundle.planning.queries.question import check_question


class QueryPlanner(ABC):
    """Checks what it is asked, and plans within the sooner of two deadlines: its caller's and its own.

    Args:
        deadline_s: Give up after this time [s]; none means as long as it takes.

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
        """The path of a query whose arguments are checked."""
