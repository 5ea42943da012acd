"""Planners of other packages behind the seam, as they are and through adapters."""

import copy
import functools
import pickle

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Navigator
from trundle.path import Path
from trundle.planning import Cancellation, create_planner, plan_many, planner_names
from trundle.planning.auto import AutoPlanner
from trundle.planning.grid_planners.least_cost import LeastCostPlanner
from trundle.planning.planner import PlannerAdapter
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
START, GOAL = Pose2D(2.0, 2.0), Pose2D(4.0, 2.0)
EVERY = {"deadline_s": 5.0, "cancel": Cancellation()}


def room():
    data = np.zeros((100, 140), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, 0.05)


def straight(start, goal):
    return Path(np.array([start.as_tuple(), goal.as_tuple()]))


class Plain:
    """As planners were before there were keywords."""

    def plan(self, costmap, start, goal):
        return straight(start, goal)


class Hurried:
    """With one of the keywords, given by place or by name."""

    def plan(self, costmap, start, goal, deadline_s=None):
        self.given = {"deadline_s": deadline_s}
        return straight(start, goal)


class Stoppable:
    def plan(self, costmap, start, goal, *, deadline_s=None, cancel=None):
        self.given = {"deadline_s": deadline_s, "cancel": cancel}
        return straight(start, goal)


class Wrapper:
    """Hands everything on to a planner of ours."""

    def __init__(self):
        self.inner, self.given = LeastCostPlanner(), {}

    def plan(self, *arguments, **kwargs):
        self.given = kwargs
        return self.inner.plan(*arguments, **kwargs)


def costmap():
    return Costmap.from_grid(room(), CARTER)


@pytest.mark.parametrize("name", planner_names())
def test_our_planners_take_every_keyword_and_need_no_adapter(name):
    planner = create_planner(name)
    assert not isinstance(planner, PlannerAdapter)
    path = planner.plan(costmap(), START, GOAL, **EVERY)
    assert path.goal.distance_to(GOAL) < 1e-6


@pytest.mark.parametrize("name", planner_names())
def test_our_planners_can_be_copied_and_pickled_after_they_have_planned(name):
    planner = create_planner(name, **({"max_expansions": 20_000} if name == "hybrid_astar" else {}))
    path = planner.plan(costmap(), START, GOAL)
    for other in (copy.deepcopy(planner), pickle.loads(pickle.dumps(planner))):
        assert other is not planner
        assert np.array_equal(other.plan(costmap(), START, GOAL).poses, path.poses)


def test_a_planner_derived_from_ours_is_never_copied_without_what_it_keeps():
    class Mine(LeastCostPlanner):
        pass

    with pytest.raises(TypeError, match="cannot pickle"):
        copy.deepcopy(Mine())


@pytest.mark.parametrize(
    ("make", "handed_on"), [(Plain, ()), (Hurried, ("deadline_s",)), (Stoppable, ("deadline_s", "cancel"))]
)
def test_an_older_planner_is_handed_the_keywords_that_it_takes(make, handed_on):
    older = make()
    planner = create_planner(older)
    assert isinstance(planner, PlannerAdapter)
    assert planner.planner is older
    assert planner.plan(costmap(), START, GOAL, **EVERY).goal == GOAL
    assert getattr(older, "given", {}) == {name: EVERY[name] for name in handed_on}


def test_a_wrapper_with_kwargs_is_handed_all_of_them():
    wrapper = Wrapper()
    assert create_planner(wrapper).planner is wrapper
    navigator = Navigator(room(), CARTER, planner=wrapper)
    navigator.set_goal(4.0, 3.5)
    path = navigator.plan((2.0, 2.0, 0.0))
    assert wrapper.given["deadline_s"] == 2.0
    # It ends as it arrives: with a yaw it would have turned to it.
    assert path.goal.yaw == pytest.approx(np.arctan2(1.5, 2.0))


def test_a_planner_makes_no_quick_one_unless_it_says_so():
    class Careful(Plain):
        def make_quick(self):
            return Plain

    assert create_planner(Plain()).make_quick() is None
    assert create_planner("least_cost").make_quick() is None
    quick = create_planner(Careful()).make_quick()
    assert isinstance(quick.planner, Plain)
    assert quick.plan(costmap(), START, GOAL, **EVERY).goal == GOAL


def test_auto_makes_a_quick_one_with_its_options_unless_its_effort_was_chosen():
    quick = create_planner("auto", goal_tolerance=0.0).make_quick()
    assert quick._goal_tolerance == 0.0
    assert [search.max_expansions for search in quick._searches] == [5_000, 5_000]
    assert quick.make_quick() is None
    assert create_planner("auto", max_expansions=100).make_quick() is None

    class Mine(AutoPlanner):
        def __init__(self, colour="red"):
            super().__init__()

    assert create_planner(Mine, colour="blue").make_quick() is None


def test_a_wrapper_made_by_a_decorator_shows_what_it_wraps():
    class Decorated:
        @functools.wraps(Plain.plan)
        def plan(self, *arguments, **keywords):
            return Plain.plan(self, *arguments, **keywords)

    assert create_planner(Decorated()).plan(costmap(), START, GOAL, **EVERY).goal == GOAL


@pytest.mark.parametrize("older", [Plain(), Hurried(), Stoppable()])
def test_an_older_planner_plans_for_a_navigator_and_for_many(older):
    navigator = Navigator(room(), CARTER, planner=older)
    navigator.set_goal(4.0, 2.0)
    assert navigator.plan(START).goal == GOAL
    assert navigator.planner_name == type(older).__name__
    assert [path.goal for path in plan_many(older, costmap(), [START], [GOAL], deadline_s=60.0)] == [GOAL]


def test_an_older_planner_is_not_begun_when_it_is_cancelled_already():
    cancel = Cancellation()
    cancel.cancel()
    with pytest.raises(PlanningStoppedError, match="cancelled") as raised:
        create_planner(Plain()).plan(costmap(), START, GOAL, cancel=cancel)
    assert raised.value.status == "cancelled"
    with pytest.raises(InputError, match="deadline_s"):
        create_planner(Plain()).plan(costmap(), START, GOAL, deadline_s=-1.0)


def test_a_planner_without_a_readable_signature_is_called_by_the_protocol():
    class Compiled:
        given = None

        def call(self, costmap, start, goal, **given):
            Compiled.given = given
            return straight(start, goal)

        plan = type("Opaque", (), {"__call__": call, "__signature__": "none"})()

    assert create_planner(Compiled()).plan(None, START, GOAL, **EVERY).goal == GOAL
    assert Compiled.given == EVERY
