"""`MapDoubts`: when a navigator that finds no path takes things off its map."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.errors import PlanningError
from trundle.geometry import Goal, Pose2D
from trundle.navigation.planning_limits import FailedPlan, PlanningBudget, timed_out
from trundle.navigation.route_planner import RoutePlanner, is_of_goal
from trundle.navigation.sensing import SensedMap
from trundle.navigation.state import Snapshot
from trundle.planning import Planner

_STANDS_S = 3.0
"""A robot that stands so long doubts by a short search: a long one among what seems to move is put off for 20 s."""


class MapDoubts:
    """Takes off the map what beams pass through, or else, where the map alone is closed, what no scan has hit.

    Nothing is taken off unless the settings of the obstacle layer say so (`doubt_static`), and there was a scan; nor
    for a goal that is occupied.

    Args:
        sensed: The map.
        routes: Plans on the map alone.
    """

    def __init__(self, sensed: SensedMap, routes: RoutePlanner) -> None:
        self._sensed, self._routes = sensed, routes

    def see_more(self, failed: FailedPlan | None, now: Snapshot, goals: Sequence[Goal]) -> bool:
        """Whether beams pass through more of the map since the last long search failed, or the robot stands in it."""
        static = self._sensed.static
        if not self._sensed.may_doubt or static is None:
            return False
        searched = failed is not None and not is_of_goal(failed.error, goals)
        if not searched and not static.footprint_collides(now.pose.as_tuple())[0]:
            return False
        return self._sensed.doubt_passed(now.pose)

    def help_short(self, error: PlanningError, pose: Pose2D, goals: Sequence[Goal], standing_s: float) -> bool:
        """Whether to plan again after a short search in vain, of a robot that has stood at a pose for so long [s]."""
        return standing_s >= _STANDS_S and not is_of_goal(error, goals) and self._sensed.doubt_passed(pose)

    def help_long(
        self,
        error: PlanningError,
        now: Snapshot,
        goals: Sequence[Goal],
        planner: Planner,
        deadline_s: float | None,
        budget: PlanningBudget,
    ) -> bool:
        """Whether to plan again after a long search in vain; `budget` pays for a search of the map alone."""
        if timed_out(error) or is_of_goal(error, goals) or not self._sensed.may_doubt:
            return False
        if self._sensed.doubt_passed(now.pose):
            return True
        is_closed = self._routes.is_closed(now.pose, goals, planner, deadline_s)
        budget.spend(self._routes.expansions, now.time, needed=True)
        return is_closed and self._sensed.doubt_static()
