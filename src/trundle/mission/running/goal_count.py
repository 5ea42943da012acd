"""`GoalCount`: which goals of a run the robot has reached."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.control import GoalChecker
from trundle.geometry import Goal, Pose2D
from trundle.navigation.waypoint import tasks_of


class GoalCount:
    """Counts the goals at which an agent says that it has arrived, and checks that it truly is there.

    Args:
        goals: The goals, in order.
        checker: Says whether a pose is at a goal.
        through: Whether the robot drives through the goals without stopping, but for waypoints with tasks and the last.

    Attributes:
        goals: The same; `replace` changes them.
        reached: The number of goals reached.
        reached_by_estimate: Whether one of them was reached only by the localizer's estimate.
    """

    def __init__(self, goals: Sequence[Goal], checker: GoalChecker, *, through: bool) -> None:
        self.goals = tuple(goals)
        self._checker = checker
        self._through = through
        self.reached = 0
        self._before = 0
        self.reached_by_estimate = False

    @property
    def current(self) -> int:
        """Index of the goal that the robot drives to; of the last one at the end, whose tasks may still run."""
        return min(self.reached, max(0, len(self.goals) - 1))

    @property
    def next(self) -> Goal:
        """The goal that comes after those reached."""
        return self.goals[self.reached]

    @property
    def are_reached(self) -> bool:
        """Whether all goals are reached."""
        return self.reached >= len(self.goals)

    def replace(self, goals: Sequence[Goal], *, through: bool) -> None:
        """Change the goals that are not reached, and how they are driven; the first ones stay those that are."""
        self.goals, self._through = tuple(goals), through

    def begin_again(self) -> None:
        """Expect that the agent gets the goals that are left, and counts them from none."""
        self._before = self.reached

    def count(self, pose: Pose2D, believed: Pose2D | None) -> bool:
        """Count the next goal; False where neither the true nor the believed pose is at it."""
        if not self._is_at(self.next, pose, believed):
            return False
        self.reached += 1
        return True

    def count_passed(self, reached: int, pose: Pose2D, believed: Pose2D | None) -> bool:
        """Count the goals of a list that the agent has reached or passed; False where it is not at one of them.

        Goals that it drives through are not checked.
        """
        while self.reached < min(self._before + reached, len(self.goals)):
            goal = self.next
            is_stop = not self._through or bool(tasks_of(goal)) or self.reached == len(self.goals) - 1
            if is_stop and not self._is_at(goal, pose, believed):
                return False
            self.reached += 1
        return True

    def is_near_last(self, pose: Pose2D, radius: float | None) -> bool:
        """Whether only the last goal is left, and the pose is within a radius [m] of it; never without a radius."""
        if radius is None or self.reached + 1 != len(self.goals):
            return False
        return pose.distance_to(self.goals[-1].pose) <= radius

    def is_at_last(self, pose: Pose2D, believed: Pose2D | None) -> bool:
        """Whether the true or the believed pose is at the last goal."""
        last, within = self.goals[-1], self._checker.is_within
        return any(within(at, last.pose, any_yaw=last.yaw_free) for at in (pose, believed) if at is not None)

    def _is_at(self, goal: Goal, pose: Pose2D, believed: Pose2D | None) -> bool:
        if self._checker.is_within(pose, goal.pose, any_yaw=goal.yaw_free):
            return True
        if believed is not None and self._checker.is_within(believed, goal.pose, any_yaw=goal.yaw_free):
            self.reached_by_estimate = True
            return True
        return False
