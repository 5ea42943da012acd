"""What a robot does while its localizer does not know where it is."""

import math

import pytest

import trundle
from support.sensed_rooms import ROBOT, grid_of, room
from trundle.geometry import Pose2D, Twist2D
from trundle.localization.odometry import OdometryLocalizer
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.relocalization import GIVES_UP_S, NOT_LOCALIZED, Relocalization
from trundle.observation import Estimate, Hypothesis, Observation
from trundle.robots import Robot


class Doubting(OdometryLocalizer):
    """Says that it does not know where the robot is between two times [s]."""

    def __init__(self, grid, robot, *, state="lost", first=1.0, last=8.0):
        super().__init__(grid, robot)
        self._state, self._first, self._last = state, first, last

    def update(self, observation):
        found = super().update(observation)
        if not self._first <= found.time < self._last:
            return found
        places = tuple(Hypothesis(Pose2D(float(k), 1.0), 0.5) for k in range(2)) if self._state == "ambiguous" else ()
        return Estimate(found.time, found.pose, None, found.T_map_odom, self._state, places)


@pytest.fixture(scope="module")
def world():
    return trundle.World.generate("office", seed=3)


def _ends(grid):
    return trundle.sample_mission(trundle.Costmap.from_grid(grid, Robot.load("nova_carter")), seed=1)


def _session(world, localizer, *, lidar=True, **options):
    grid = trundle.OccupancyGrid.from_world(world, resolution=0.05)
    start, goal = _ends(grid)
    sim = trundle.simulate(world, "nova_carter", backend="kinematic", lidar=lidar)
    navigator = Navigator(grid, "nova_carter")
    return trundle.Session(sim, navigator, start, goal, localizer=localizer, **options), navigator


@pytest.mark.parametrize("state", ["lost", "ambiguous"])
def test_it_looks_around_says_so_and_goes_on_by_itself(world, state):
    session, navigator = _session(world, Doubting(None, Robot.load("nova_carter"), state=state))
    turned, moved, messages = 0.0, 0.0, set()
    with session:
        while (step := session.step()) is not None:
            if step.estimate.state != "localized":
                messages.add(navigator.message)
            if 1.5 < step.state.time < 8.0:
                turned += abs(step.sent.w) * session.dt
                moved += abs(step.sent.v) * session.dt
    assert session.outcome is trundle.Outcome.ARRIVED
    assert turned > 1.0
    assert moved < 1.0  # it drives slowly
    assert navigator.standing_reasons[NOT_LOCALIZED] == pytest.approx(7.0 / session.dt, abs=2)
    assert all("looking around" in message for message in messages if message)
    assert any(("2 places" if state == "ambiguous" else "does not know where it is") in one for one in messages)


def test_it_touches_nothing_while_it_looks_for_its_place(world):
    never = Doubting(None, Robot.load("nova_carter"), first=0.0, last=math.inf)
    session, navigator = _session(world, never, monitor=False, time_limit_s=90.0)
    driven = 0.0
    with session:
        while (step := session.step()) is not None:
            driven += abs(step.sent.v) * session.dt
    assert session.outcome is trundle.Outcome.TIMED_OUT, session.message
    assert driven > 3.0  # it also drives, and not only turns
    assert navigator.status is NavigationStatus.DRIVING


def test_without_scans_it_stands_and_gives_up_in_the_end(world):
    session, _ = _session(
        world, Doubting(None, Robot.load("nova_carter"), first=0.0, last=math.inf), lidar=False, time_limit_s=200.0
    )
    episode = session.run()
    assert episode.outcome is trundle.Outcome.STUCK
    assert "has not found out in 120 s where it is" in episode.message
    assert episode.metrics.time_s == pytest.approx(GIVES_UP_S, abs=0.2)
    assert episode.metrics.distance_m < 0.01


def test_a_robot_that_is_somewhere_else_forgets_what_it_sensed_and_plans_again(world):
    grid = trundle.OccupancyGrid.from_world(world, resolution=0.05)
    here, goal = _ends(grid)
    navigator = Navigator(grid, "nova_carter")
    navigator.set_goal(goal)

    def update(time, pose, state):
        return navigator.update(Observation(time, Twist2D(), Pose2D(0.0, 0.0)), Estimate(time, pose, None, pose, state))

    update(0.0, here, "localized")
    first = navigator.path
    assert update(0.05, here, "lost") == Twist2D()
    assert navigator.path is first
    update(0.10, here, "localized")
    assert navigator.path is first
    update(0.15, here, "lost")
    update(0.20, Pose2D(here.x + 0.4, here.y, here.yaw), "localized")
    assert navigator.path is not first
    assert navigator.path.start.distance_to(here) == pytest.approx(0.4, abs=0.05)


def test_a_robot_that_is_not_localized_has_not_arrived(world):
    grid = trundle.OccupancyGrid.from_world(world, resolution=0.05)
    _, at = _ends(grid)
    navigator = Navigator(grid, "nova_carter")
    navigator.set_goal(at)
    for k, state in enumerate(["lost", "ambiguous", "localized"]):
        time = 0.05 * k
        navigator.update(Observation(time, Twist2D(), Pose2D(0.0, 0.0)), Estimate(time, at, None, at, state))
        assert (navigator.status is NavigationStatus.ARRIVED) == (state == "localized")


class DoubtingAt(OdometryLocalizer):
    """Does not know where the robot is, whenever it looks into some direction."""

    def update(self, observation):
        found = super().update(observation)
        state = "ambiguous" if 0.6 < found.pose.yaw < 1.2 else "localized"
        return Estimate(found.time, found.pose, None, found.T_map_odom, state)


def test_it_drives_on_where_doubts_have_ended_in_vain_at_one_place():
    """Whoever turns to the path doubts, turns back to look, and turns to the path again."""
    navigator = Navigator(grid_of(room()), ROBOT)
    start, goal = Pose2D(4.0, 1.5), (6.0, 4.02)  # it has to drive at a yaw of 0.9
    with trundle.simulate(room(), ROBOT, backend="kinematic", lidar=True) as sim:
        localizer = DoubtingAt(None, ROBOT)
        with trundle.Session(sim, navigator, start, goal, localizer=localizer, time_limit_s=90.0) as session:
            while session.step() is not None:
                pass
    assert session.outcome is trundle.Outcome.ARRIVED, session.message


def test_doubts_that_ended_elsewhere_do_not_count():
    search = Relocalization(ROBOT)
    for k in range(5):
        place = Pose2D(1.0 * k, 0.0)  # each time it turns out to be 1 m farther on
        known = Estimate(2.0 * k, place, None, place)
        assert not search.is_needed(known)
        doubt = Estimate(2.0 * k + 1.0, place, None, place, "ambiguous")
        assert search.is_needed(doubt)
        search.decide(doubt, (), doubt.time)
        assert search.end(Estimate(2.0 * k + 1.5, place @ Pose2D(1.0, 0.0), None, place @ Pose2D(1.0, 0.0)))


def test_a_search_does_not_end_where_earlier_doubts_ended_in_vain():
    """It drives while it looks around, and may come to where it would not begin."""
    search, here, there = Relocalization(ROBOT), Pose2D(0.0, 0.0), Pose2D(2.0, 0.0)
    for k in range(3):
        assert not search.is_needed(Estimate(2.0 * k, here, None, here))
        search.decide(Estimate(2.0 * k + 1.0, here, None, here, "lost"), (), 2.0 * k + 1.0)
        assert not search.end(Estimate(2.0 * k + 1.5, here, None, here))
    assert not search.is_needed(Estimate(7.0, here, None, here, "lost"))
    elsewhere = Estimate(8.0, there, None, there, "lost")
    assert search.is_needed(elsewhere)
    search.decide(elsewhere, (), 8.0)
    assert search.is_needed(Estimate(9.0, here, None, here, "lost"))
