import functools

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import NoPathError, PlanningStoppedError
from trundle.geometry import Goal, Pose2D
from trundle.path import Path
from trundle.planning import Cancellation, create_planner
from trundle.planning.grid_planners.least_cost import LeastCostPlanner
from trundle.testing import ConformanceError, check_planner


@pytest.mark.parametrize("name", ["least_cost", "astar", "any_angle", "manhattan_astar"])
def test_our_planners_conform(name):
    check_planner(functools.partial(create_planner, name))
    check_planner(create_planner(name))


class StraightPlanner:
    """Drives straight on whatever stands there."""

    def plan(self, costmap: Costmap, start: Pose2D, goal: Goal) -> Path:
        return Path(np.array([start.as_tuple(), goal.as_tuple()]))


class ForgetfulPlanner(LeastCostPlanner):
    """Leaves out the goal's yaw."""

    def plan(self, costmap, start, goal, **keywords):
        return super().plan(costmap, start, Pose2D(goal.x, goal.y, 0.123), **keywords)


class LooseErrorPlanner(LeastCostPlanner):
    """Says the same of everything that goes wrong."""

    def plan(self, costmap, start, goal, **keywords):
        try:
            return super().plan(costmap, start, goal, **keywords)
        except PlanningStoppedError:
            raise
        except Exception as error:
            raise NoPathError("no") from error


class MoodyPlanner(LeastCostPlanner):
    """Gives another path every time."""

    calls = 0

    def plan(self, costmap, start, goal, **keywords):
        path = super().plan(costmap, start, goal, **keywords)
        self.calls += 1
        return Path(np.repeat(path.poses, self.calls, axis=0))


class WritingPlanner(LeastCostPlanner):
    """Scribbles on the costmap."""

    def plan(self, costmap, start, goal, **keywords):
        path = super().plan(costmap, start, goal, **keywords)
        data = costmap.data
        data.flags.writeable = True
        data[30, 30] = 17
        data.flags.writeable = False
        return path


class UnstoppablePlanner(LeastCostPlanner):
    """Does not look whether it is cancelled."""

    def plan(self, costmap, start, goal, *, deadline_s=None, cancel=None):
        return super().plan(costmap, start, goal, deadline_s=deadline_s)


class StrayingPlanner(LeastCostPlanner):
    """Where the yaw is free, the place is as well."""

    def plan(self, costmap, start, goal, **keywords):
        return super().plan(costmap, start, start if goal.yaw_free else goal, **keywords)


class YawOnlyPlanner(LeastCostPlanner):
    """Plans only to goals with a yaw."""

    def plan(self, costmap, start, goal, **keywords):
        if goal.yaw_free:
            raise NoPathError("a goal needs a yaw")
        return super().plan(costmap, start, goal, **keywords)


class HastyPlanner(LeastCostPlanner):
    """Gives something else where it has little time."""

    def plan(self, costmap, start, goal, *, deadline_s=None, **keywords):
        path = super().plan(costmap, start, goal, **keywords)
        return path if deadline_s is None else Path(np.repeat(path.poses, 2, axis=0))


class WrongStatusPlanner(LeastCostPlanner):
    """Says that its time was up when it was cancelled."""

    def plan(self, costmap, start, goal, *, cancel=None, **keywords):
        if cancel is not None and cancel.cancelled:
            raise PlanningStoppedError("stopped")
        return super().plan(costmap, start, goal, cancel=cancel, **keywords)


class NothingCountedPlanner(LeastCostPlanner):
    """Counts that it expanded nothing."""

    def plan(self, costmap, start, goal, *, cancel=None, **keywords):
        path = super().plan(costmap, start, goal, cancel=None if cancel is None else Cancellation(), **keywords)
        if cancel is not None:
            if cancel.cancelled:
                raise PlanningStoppedError("stopped", status="cancelled")
            cancel.count(0)
        return path


class QuickToRefusePlanner(LeastCostPlanner):
    """Its quick planner says that there is no path."""

    def make_quick(self):
        return RefusingPlanner()


class RefusingPlanner(LeastCostPlanner):
    def plan(self, costmap, start, goal, **keywords):
        raise NoPathError("there is none")


class QuickThroughWallsPlanner(LeastCostPlanner):
    """Its quick planner drives straight on."""

    def make_quick(self):
        return StraightPlanner()


class QuickNumberPlanner(LeastCostPlanner):
    """Its quick planner is none."""

    def make_quick(self):
        return 3


class QuickPlanner(LeastCostPlanner):
    """Its quick planner is a function of the least arguments, which gives up."""

    def make_quick(self):
        def give_up(costmap, start, goal):
            raise PlanningStoppedError("it takes too long", status="exhausted")

        return give_up


def test_a_planner_may_make_a_quick_one():
    check_planner(QuickPlanner)


@pytest.mark.parametrize(
    ("planner", "message"),
    [
        (StraightPlanner, "goes through occupied"),
        (ForgetfulPlanner, "with a yaw of"),
        (LooseErrorPlanner, "must raise OutsideMapError"),
        (MoodyPlanner, "two different paths"),
        (WritingPlanner, "must not change the costmap"),
        (UnstoppablePlanner, "already cancelled query must raise"),
        (StrayingPlanner, "it must end at"),
        (YawOnlyPlanner, r"no path from .* to Goal\(x=8.0, y=1.0\)"),
        (HastyPlanner, "a deadline that is far off changes the path"),
        (WrongStatusPlanner, "status 'cancelled'"),
        (NothingCountedPlanner, "one or more in each plan; it counted 0"),
        (QuickToRefusePlanner, "make_quick may give up .* there is none"),
        (QuickThroughWallsPlanner, "goes through occupied"),
        (QuickNumberPlanner, "is no planner"),
    ],
)
def test_a_planner_that_breaks_a_promise_learns_which(planner, message):
    with pytest.raises(ConformanceError, match=message):
        check_planner(planner)
