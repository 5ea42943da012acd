"""Planners that take the former keyword `goal_yaw_free` are refused with the new signature."""

import functools

import pytest

import trundle
from trundle.errors import InputError
from trundle.navigation import Navigator
from trundle.planning import create_planner
from trundle.testing import ConformanceError, check_planner


class Older:
    def plan(self, costmap, start, goal, *, goal_yaw_free=False, deadline_s=None, cancel=None):
        return [start.as_tuple(), goal.as_tuple()]


class OlderByPlace:
    def plan(self, costmap, start, goal, goal_yaw_free):
        return [start.as_tuple(), goal.as_tuple()]


class Decorated:
    @functools.wraps(Older.plan)
    def plan(self, *arguments, **keywords):
        return Older.plan(self, *arguments, **keywords)


def older(costmap, start, goal, *, goal_yaw_free=False):
    return [start.as_tuple(), goal.as_tuple()]


def older_by_place(costmap, start, goal, goal_yaw_free):
    return [start.as_tuple(), goal.as_tuple()]


SIGNATURE = r"plan\(costmap, start, goal, \*, deadline_s=None, cancel=None\)"
FORMER = rf"test_older_planners\.py:\d+\) takes 'goal_yaw_free'.*{SIGNATURE}"


@pytest.mark.parametrize(
    "planner",
    [
        Older,
        Older(),
        lambda: Older(),
        OlderByPlace,
        Decorated,
        older,
        older_by_place,
        f"{__name__}:Older",
        f"{__file__}:older",
    ],
)
def test_a_planner_that_takes_the_former_keyword_is_refused_with_the_new_signature(planner):
    with pytest.raises(InputError, match=FORMER):
        create_planner(planner)
    with pytest.raises(InputError, match=FORMER):
        Navigator(None, "jackal", planner=planner)
    with pytest.raises(ConformanceError, match=FORMER):
        check_planner(planner)


def test_a_planner_that_hands_on_whatever_it_gets_is_not_taken_for_an_older_one():
    def mine(costmap, start, goal, **keywords):
        return create_planner("least_cost").plan(costmap, start, goal, **keywords)

    check_planner(mine)


def test_an_evaluation_refuses_an_older_planner_before_it_begins(tmp_path):
    with pytest.raises(InputError, match=FORMER):
        trundle.evaluate({"worlds": "warehouse", "planners": Older, "seeds": 1}, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()
