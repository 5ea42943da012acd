"""What a navigator does while planning takes long."""

import math

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.costmap import Costmap
from trundle.errors import InputError, NoPathError, PlanningStoppedError
from trundle.geometry import Pose2D, Twist2D
from trundle.mission import Outcome, run
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation import replanner as module
from trundle.planning import create_planner
from trundle.planning.grid_planners.least_cost import LeastCostPlanner
from trundle.planning.grid_planners.manhattan_astar import ManhattanAstarPlanner
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
STANDS, DRIVES = Twist2D(), Twist2D(0.5, 0.0)
EVERYTHING = (slice(0, 100), slice(0, 240))


def hall():
    return walled_room(depth=5.0)


def blocked_ahead():
    values = hall().data.copy()
    values[:60, 120:124] = 100
    return values


class Clock:
    """Replaces the computer's clock: only planning takes time, a given one."""

    now = 0.0

    def perf_counter(self):
        return self.now


class Planner:
    """Takes so long for each plan [s], in turn, and gives up at its deadline."""

    def __init__(self, clock, *seconds):
        self.clock, self.seconds, self.inner = clock, list(seconds), LeastCostPlanner()
        self.deadlines = []

    def plan(self, costmap, start, goal, *, deadline_s=None, cancel=None):
        self.deadlines.append(deadline_s)
        takes = self.seconds.pop(0) if self.seconds else 0.0
        if deadline_s is not None and takes > deadline_s:
            self.clock.now += deadline_s
            raise PlanningStoppedError("no path found yet when the deadline passed", status="timeout")
        self.clock.now += takes
        return self.inner.plan(costmap, start, goal)


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(module, "clock", clock)
    return clock


def make(clock, *seconds, **settings):
    planner = Planner(clock, *seconds)
    navigator = Navigator(hall(), CARTER, planner=planner, settings=NavigatorSettings(**settings))
    navigator.set_goal(10.5, 2.5)
    return navigator, planner


def update(navigator, time, twist=STANDS, x=2.0):
    return navigator.update((x, 2.5, 0.0), twist, time=time)


def test_three_tries_with_pauses_between_them_then_an_outcome_of_its_own(clock):
    navigator, planner = make(clock, 9.0, 9.0, 9.0, 0.0)
    tried = []
    for time in np.arange(0.0, 5.0, 0.05).tolist():
        before = len(planner.deadlines)
        assert update(navigator, time) == STANDS
        if len(planner.deadlines) > before:
            tried.append(time)
            assert navigator.status is (
                NavigationStatus.PLANNING_TIMED_OUT if len(tried) == 3 else NavigationStatus.BLOCKED
            )
    assert tried == pytest.approx([0.0, 1.0, 2.0], abs=0.06)
    assert planner.deadlines == [2.0, 4.0, 8.0]
    assert navigator.status is NavigationStatus.PLANNING_TIMED_OUT
    assert isinstance(navigator.error, PlanningStoppedError)
    navigator.set_goal(10.5, 2.5)
    assert update(navigator, 6.0).v > 0.0
    assert navigator.status is NavigationStatus.DRIVING


def test_a_search_that_takes_twice_the_deadline_is_given_the_time_in_the_third_try(clock):
    navigator, planner = make(clock, *[4.5] * 3)
    for time in (0.0, 1.0):
        assert update(navigator, time) == STANDS
    assert update(navigator, 2.0).v > 0.0
    assert planner.deadlines == [2.0, 4.0, 8.0]
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    update(navigator, 3.0)
    assert planner.deadlines[-1] == 2.0


def test_a_try_that_succeeds_drives_on_and_resets_the_count(clock):
    navigator, planner = make(clock, 9.0, 9.0, 0.1, 9.0, 9.0, 0.1)
    for time in (0.0, 1.0):
        assert update(navigator, time) == STANDS
        assert navigator.waits_to_plan
    assert update(navigator, 2.0).v > 0.0
    assert not navigator.waits_to_plan
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    for time in (3.0, 4.0):
        assert update(navigator, time) == STANDS
    assert update(navigator, 5.0).w != 0.0
    assert navigator.status is NavigationStatus.DRIVING
    assert len(planner.deadlines) == 6


def test_a_moving_robot_plans_for_a_quarter_and_stops_where_that_is_not_enough(clock):
    navigator, planner = make(clock, 0.1, 0.7, 0.7)
    update(navigator, 0.0)
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    assert update(navigator, 0.05, DRIVES) == STANDS
    assert planner.deadlines == [2.0, 0.5]
    assert update(navigator, 0.10, DRIVES) == STANDS  # it still moves
    assert update(navigator, 0.15, Twist2D(0.1, 0.1)) == STANDS
    assert len(planner.deadlines) == 2
    assert navigator.status is NavigationStatus.BLOCKED
    assert update(navigator, 0.20, STANDS) != STANDS
    assert planner.deadlines == [2.0, 0.5, 2.0]
    assert navigator.replans == 1


def test_after_a_plan_that_took_long_the_robot_stops_before_the_next(clock):
    navigator, planner = make(clock, 0.6, 0.6, 0.1)
    update(navigator, 0.0)
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    assert update(navigator, 0.05, DRIVES) == STANDS
    assert len(planner.deadlines) == 1
    assert update(navigator, 0.10, STANDS) != STANDS
    assert planner.deadlines == [2.0, 2.0]


def test_odometry_that_never_says_0_does_not_keep_it_from_planning(clock):
    navigator, planner = make(clock, 0.6, 0.6)
    update(navigator, 0.0)
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    planned = [time for time in np.arange(0.05, 4.0, 0.05).tolist() if update(navigator, time, DRIVES) != STANDS]
    assert planned[0] == pytest.approx(3.05)
    assert len(planner.deadlines) == 2


def test_a_better_path_is_looked_for_only_while_that_is_quick(clock):
    navigator, planner = make(clock, 0.1, 0.7, 0.7, replan_interval_s=1.0)
    update(navigator, 0.0)
    path = navigator.path
    assert update(navigator, 1.0, DRIVES).v > 0.0  # not done within a quarter: the path is still good
    assert planner.deadlines == [2.0, 0.5]
    assert update(navigator, 2.0, DRIVES).v > 0.0
    assert len(planner.deadlines) == 2
    assert navigator.path is path
    assert navigator.status is NavigationStatus.DRIVING


def test_without_a_deadline_nothing_depends_on_the_clock(clock):
    navigator, planner = make(clock, 60.0, 60.0, planning_deadline_s=None)
    assert update(navigator, 0.0).v > 0.0
    navigator.static_costmap = navigator.static_costmap.update(*EVERYTHING, blocked_ahead())
    assert update(navigator, 0.05, DRIVES) != STANDS
    assert planner.deadlines == [None, None]


def test_no_path_is_no_time_out(clock):
    navigator, planner = make(clock)
    planner.inner = type("Nowhere", (), {"plan": lambda *_, **__: (_ for _ in ()).throw(NoPathError("none"))})()
    update(navigator, 0.0)
    assert navigator.status is NavigationStatus.NO_PATH


@pytest.mark.parametrize("wrong", [0.0, -1.0, math.nan, "soon"])
def test_a_deadline_is_a_positive_number(wrong):
    with pytest.raises(InputError, match="deadline_s"):
        NavigatorSettings(planning_deadline_s=wrong)


@pytest.mark.parametrize("goals", [[(10.5, 2.5)], [(6.0, 2.5), (10.5, 2.5)]])
def test_a_mission_ends_with_the_same_outcome(clock, goals):
    navigator, planner = make(clock, *[9.0] * 9)
    with simulate(World.from_map(hall()), CARTER, backend="kinematic") as sim:
        episode = run(sim, navigator, (2.0, 2.5, 0.0), goals)
    assert episode.outcome is Outcome.PLANNING_TIMED_OUT
    assert not episode.arrived
    assert "deadline" in episode.message
    assert len(planner.deadlines) <= 3 + len(goals)
    assert episode.trajectory.time[-1] < 4.0


def test_a_mission_whose_first_plan_comes_late_is_driven(clock):
    navigator, _ = make(clock, 9.0)
    with simulate(World.from_map(hall()), CARTER, backend="kinematic") as sim:
        episode = run(sim, navigator, (2.0, 2.5, 0.0), (4.0, 2.5))
    assert episode.outcome is Outcome.ARRIVED


@pytest.mark.parametrize("kind", [LeastCostPlanner, ManhattanAstarPlanner])
def test_the_shorter_of_two_deadlines_holds(kind):
    costmap = Costmap.from_grid(hall(), CARTER)
    for own, given in ((1e-9, 60.0), (60.0, 1e-9), (1e-9, None)):
        with pytest.raises(PlanningStoppedError):
            create_planner(kind(deadline_s=own)).plan(costmap, Pose2D(2, 2.5), Pose2D(10, 2.5), deadline_s=given)
