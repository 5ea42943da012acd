import functools

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import NoPathError
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning import create_planner
from trundle.planning.least_cost import LeastCostPlanner
from trundle.testing import ConformanceError, check_planner


@pytest.mark.parametrize("name", ["least_cost", "astar", "jps", "jps_plus", "any_angle", "theta_star", "blog"])
def test_our_planners_conform(name):
    check_planner(functools.partial(create_planner, name))
    check_planner(create_planner(name))


class StraightPlanner:
    """Drives straight on whatever stands there."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> Path:
        return Path(np.array([start.as_tuple(), goal.as_tuple()]))


class ForgetfulPlanner(LeastCostPlanner):
    """Leaves out the goal's yaw."""

    def plan(self, costmap, start, goal, *, goal_yaw_free=False):
        return super().plan(costmap, start, Pose2D(goal.x, goal.y, 0.123))


class LooseErrorPlanner(LeastCostPlanner):
    """Says the same of everything that goes wrong."""

    def plan(self, costmap, start, goal, *, goal_yaw_free=False):
        try:
            return super().plan(costmap, start, goal)
        except Exception as error:
            raise NoPathError("no") from error


class MoodyPlanner(LeastCostPlanner):
    """Gives another path every time."""

    calls = 0

    def plan(self, costmap, start, goal, *, goal_yaw_free=False):
        path = super().plan(costmap, start, goal)
        self.calls += 1
        return Path(np.repeat(path.poses, self.calls, axis=0))


class WritingPlanner(LeastCostPlanner):
    """Scribbles on the costmap."""

    def plan(self, costmap, start, goal, *, goal_yaw_free=False):
        path = super().plan(costmap, start, goal)
        data = costmap.data
        data.flags.writeable = True
        data[30, 30] = 17
        data.flags.writeable = False
        return path


@pytest.mark.parametrize(
    ("planner", "message"),
    [
        (StraightPlanner, "goes through occupied"),
        (ForgetfulPlanner, "with a yaw of"),
        (LooseErrorPlanner, "must raise OutsideMapError"),
        (MoodyPlanner, "two different paths"),
        (WritingPlanner, "must not change the costmap"),
    ],
)
def test_a_planner_that_breaks_a_promise_is_told_which(planner, message):
    with pytest.raises(ConformanceError, match=message):
        check_planner(planner)
