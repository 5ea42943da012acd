"""How much a navigator searches when it plans again and again, and how a drive ends that used that up."""

from dataclasses import replace

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, grid_of, room
from support.walled_rooms import walled_room
from trundle.errors import PlanningStoppedError
from trundle.geometry import Pose2D, Twist2D
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation import replanner as module
from trundle.navigation.state import FINAL
from trundle.planning import Cancellation, create_planner
from trundle.planning.cancellation import nominal_expansions
from trundle.planning.grid_planners.least_cost import LeastCostPlanner
from trundle.sim import simulate

CLOSED = room(block("closed", 5.0, 0.1, 5.4, 5.9))
EVERYTHING = (slice(0, 100), slice(0, 240))


class Planner:
    """Plans by `least_cost`; each search after the first takes so many expansions. It notes when it is called."""

    def __init__(self, expansions, first=1, *, counts=True):
        self.expansions, self.first, self.counts = expansions, first, counts
        self.starts, self.found = [], []
        self.inner = LeastCostPlanner()

    def plan(self, costmap, start, goal, *, deadline_s=None, cancel=None):
        self.starts.append(start)
        if self.counts and cancel is not None:
            cancel.count(self.first if len(self.starts) == 1 else self.expansions)
        return self.inner.plan(costmap, start, goal)


def drive(navigator, world, *, seconds=120.0):
    """Drive until it ends; when the planner was called [s], and where the robot was in each period."""
    planner, plans, poses = getattr(navigator.planner, "planner", navigator.planner), [], []
    navigator.set_goal(GOAL)
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(round(seconds / navigator.dt)):
            before = len(getattr(planner, "starts", ()))
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            plans += [state.time] * (len(getattr(planner, "starts", ())) - before)
            poses.append((*state.pose.as_tuple(), command.v, command.w))
            if navigator.status in FINAL:
                break
            state = sim.step(command, navigator.dt)
    return plans, poses


def settings(**given):
    return NavigatorSettings(planning_deadline_s=None, **given)


@pytest.mark.slow
def test_a_drive_in_a_closed_place_ends_when_its_expansions_are_used_up():
    planner = Planner(100_000)
    limits = settings(patience_s=60.0, replan_expansions=300_000, replan_rate=None)
    navigator = Navigator(grid_of(room()), ROBOT, planner=planner, settings=limits)
    drive(navigator, CLOSED, seconds=200.0)
    assert len(planner.starts) == 4  # the first, and three more
    assert navigator.planning_expansions == 300_001
    assert navigator.status is NavigationStatus.NO_PATH
    assert isinstance(navigator.error, PlanningStoppedError)
    assert navigator.error.status == "exhausted"
    assert "after 300,000 expansions in 3 plans beyond the first (replan_expansions)" in str(navigator.error)
    assert "the last one: no path from" in str(navigator.error)


@pytest.mark.slow
def test_large_plans_wait_until_the_ones_before_are_paid_for():
    planner = Planner(100_000)
    limits = settings(patience_s=30.0, replan_expansions=None, replan_rate=10_000)
    navigator = Navigator(grid_of(room()), ROBOT, planner=planner, settings=limits)
    plans, _ = drive(navigator, CLOSED)
    assert len(plans) >= 3
    assert np.diff(plans[1:]).min() >= 9.0 - 1e-6
    assert navigator.status is NavigationStatus.NO_PATH


def test_the_first_plan_does_not_count():
    planner = Planner(1_000, first=10**9)
    navigator = Navigator(grid_of(room()), ROBOT, planner=planner, settings=settings(replan_expansions=10_000))
    drive(navigator, room(block("box", 4.6, 2.5, 5.4, 3.5)))
    assert navigator.status is NavigationStatus.ARRIVED
    assert len(planner.starts) > 1


def test_each_stop_of_a_route_has_a_first_plan_of_its_own():
    planner = Planner(10**9, first=10**9)
    navigator = Navigator(walled_room(), "nova_carter", planner=planner, settings=settings(replan_expansions=1))
    navigator.set_goals([(2.0, 4.0), (3.0, 4.0), (4.0, 4.0)])
    for time, x in enumerate((2.0, 2.0, 3.0, 3.0, 4.0, 4.0)):
        navigator.update((x, 4.0, 0.0), Twist2D(), time=0.1 * time)
    assert navigator.status is NavigationStatus.ARRIVED


def closed_ahead():
    values = walled_room().data.copy()
    values[:, 120:124] = 100
    return values


def stand(navigator, time, x=2.0):
    return navigator.update((x, 4.0, 0.0), Twist2D(), time=time)


def make_closed(planner, **given):
    """A robot that stands, and whose way has just been closed."""
    navigator = Navigator(walled_room(), "nova_carter", planner=planner, settings=settings(**given))
    navigator.set_goal(10.5, 4.0)
    stand(navigator, 0.0)
    navigator.static_costmap = navigator.costmap.update(slice(0, 160), slice(0, 240), closed_ahead())
    return navigator


def test_a_search_that_failed_is_not_made_again_while_nothing_has_changed():
    planner = Planner(1)
    navigator = make_closed(planner, recovery=["replan"])
    for time in np.arange(0.05, 60.0, 0.05).tolist():
        stand(navigator, time)
    assert len(planner.starts) == 2
    assert navigator.status is NavigationStatus.NO_PATH


@pytest.mark.slow
def test_noise_of_the_lidar_is_no_reason_to_search_again():
    planner = Planner(1)
    navigator = Navigator(grid_of(room()), ROBOT, planner=planner, recovery=(), settings=settings(patience_s=40.0))
    plans, _ = drive(navigator, CLOSED)
    assert navigator.status is NavigationStatus.NO_PATH
    assert sum(plan > 25.0 for plan in plans) <= 2  # after what was seen is forgotten


@pytest.mark.parametrize("change", ["freed", "moved", "other goal", "other planner"])
def test_a_search_that_failed_is_made_again_when_something_has_changed(change):
    planner = Planner(1)
    navigator = make_closed(planner, recovery=["replan"])
    for time in np.arange(0.05, 3.0, 0.05).tolist():
        stand(navigator, time)
    assert len(planner.starts) == 2
    assert navigator.status not in FINAL
    x, asked = 2.0, planner
    if change == "freed":
        navigator.static_costmap = navigator.costmap.update(slice(10, 11), slice(120, 121), 0)
    elif change == "moved":
        x = 2.2
    elif change == "other goal":
        navigator.set_goal(10.5, 4.5)
    else:
        asked = navigator.planner = Planner(1)
    before = len(asked.starts)
    for time in np.arange(3.0, 6.0, 0.05).tolist():
        stand(navigator, time, x)
    assert len(asked.starts) > before


def test_a_wall_that_grows_is_not_searched_again():
    planner = Planner(1)
    navigator = make_closed(planner, recovery=["replan"])
    values = closed_ahead()
    for step, time in enumerate(np.arange(0.05, 20.0, 0.05).tolist()):
        values[20:140, 124 + step // 40] = 100
        navigator.static_costmap = navigator.costmap.update(slice(0, 160), slice(0, 240), values)
        stand(navigator, time)
    assert len(planner.starts) == 2


def test_plans_of_a_planner_that_counts_nothing_count_by_the_cells_of_the_map():
    planner = Planner(1, counts=False)
    navigator = make_closed(planner, recovery=["replan"])
    first = navigator.planning_expansions
    assert 0 < first < walled_room().data.size // 500
    stand(navigator, 0.05)
    assert navigator.planning_expansions == first + 1 + walled_room().data.size // 500


def test_a_search_over_a_large_map_counts_as_a_short_search_of_poses():
    assert nominal_expansions((10_000, 10_000)) == 5_000
    assert nominal_expansions((10_000, 10_000), np.array([(0.0, 0.0), (99.0, 49.0)])) == 11


@pytest.mark.parametrize("name", ["auto", "hybrid_astar", "least_cost", "astar", "any_angle"])
def test_planners_say_how_much_they_searched(name):
    grid = walled_room()
    navigator = Navigator(grid, "nova_carter")
    count = Cancellation()
    assert count.expansions is None
    create_planner(name).plan(navigator.costmap, Pose2D(2.0, 4.0), Pose2D(10.5, 4.0), cancel=count)
    found = count.expansions or 0
    assert found > 0
    closed = navigator.costmap.update(slice(0, 160), slice(0, 240), closed_ahead())
    with pytest.raises(Exception, match="no path"):
        create_planner(name).plan(closed, Pose2D(2.0, 4.0), Pose2D(10.5, 4.0), cancel=count)
    assert (count.expansions or 0) > found


class SlowClock:
    """Every look at it takes a minute."""

    now = 0.0

    def perf_counter(self):
        self.now += 60.0
        return self.now


@pytest.mark.slow
def test_a_run_that_uses_its_expansions_up_is_the_same_on_a_slow_machine(monkeypatch):
    runs = []
    for clock in (None, SlowClock()):
        if clock is not None:
            monkeypatch.setattr(module, "clock", clock)
        limits = settings(patience_s=30.0, replan_expansions=60_000, replan_rate=20_000)
        navigator = Navigator(grid_of(room()), ROBOT, settings=limits)
        _, poses = drive(navigator, room(block("one", 5.0, 0.1, 5.4, 2.75), block("other", 5.0, 3.15, 5.4, 5.9)))
        runs.append((poses, navigator.planning_expansions, navigator.replans, str(navigator.error), navigator.status))
    assert runs[0] == runs[1]
    assert "replan_expansions" in runs[0][3]


def test_with_its_expansions_used_up_it_still_finds_a_path_where_what_blocked_it_leaves():
    navigator = Navigator(grid_of(room()), ROBOT, settings=settings(patience_s=60.0, replan_expansions=1))
    shut, opened = (room(block("closed", 5.0, 0.1, 5.4, top)) for top in (5.9, 4.0))
    navigator.set_goal(GOAL)
    with simulate(shut, ROBOT, backend="kinematic", lidar=True) as before:
        state = before.reset(START)
        while state.time < 10.0:
            state = before.step(command_of(navigator, state, 0.0), navigator.dt)
    assert navigator.planning_expansions > 1
    with simulate(opened, ROBOT, backend="kinematic", lidar=True) as after:
        state = after.reset(state.pose)
        while navigator.status not in FINAL and state.time < 60.0:
            state = after.step(command_of(navigator, state, 10.0), navigator.dt)
    assert navigator.status is NavigationStatus.ARRIVED


def command_of(navigator, state, since):
    scans = [replace(scan, time=scan.time + since) for scan in state.scans]
    return navigator.update(state.pose, state.twist, time=state.time + since, scans=scans)
