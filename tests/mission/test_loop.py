import math
import time
from dataclasses import replace

import numpy as np
import pytest

from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, run
from trundle.navigation import AgentReport, NavigationStatus, Navigator
from trundle.sim import Contact


class Log:
    """An observer that records its calls, and may fail or press Ctrl-C at one step."""

    def __init__(self, *, raises_at=None, error=None, fails_at_end=False):
        self.raises_at = raises_at
        self.error = error or RuntimeError("full")
        self.fails_at_end = fails_at_end
        self.info = None
        self.steps = []
        self.episode = None

    def on_start(self, run):
        self.info = run

    def on_step(self, step):
        self.steps.append(step)
        if step.index == self.raises_at:
            raise self.error

    def on_end(self, episode):
        self.episode = episode
        if self.fails_at_end:
            raise self.error


def same(one, other):
    return all(
        np.array_equal(getattr(one.trajectory, name), getattr(other.trajectory, name))
        for name in one.trajectory.columns()
    )


def test_a_free_goal_is_reached_around_the_block(make_sim, navigator, start):
    episode = run(make_sim(), navigator, start, (6.5, 1.5, math.pi / 2))
    assert episode.outcome is Outcome.ARRIVED
    assert episode.arrived
    end = episode.trajectory.poses[-1]
    assert math.hypot(end[0] - 6.5, end[1] - 1.5) <= 0.25
    assert abs(end[2] - math.pi / 2) <= 0.25
    assert episode.goals == ((6.5, 1.5, math.pi / 2),)
    assert episode.goals_reached == 1
    metrics = episode.metrics
    assert metrics.distance_m > 5.5
    assert metrics.path_length_m == pytest.approx(episode.paths[0].length)
    assert metrics.measured_on == "map"
    assert math.dist(start.as_tuple()[:2], (6.5, 1.5)) < metrics.shortest_path_m < metrics.path_length_m
    assert metrics.spl == pytest.approx(metrics.shortest_path_m / metrics.distance_m)
    assert 0.3 < metrics.min_clearance_m < 0.9
    assert 0.0 <= metrics.mean_cross_track_error_m <= metrics.max_cross_track_error_m < 0.3
    assert metrics.time_s == pytest.approx(episode.trajectory.time[-1])
    assert metrics.planning_ms > 0.0
    assert metrics.real_time_factor > 1.0
    assert metrics.contacts == ()


def test_the_trajectory_has_a_row_per_control_period_and_starts_at_the_start(make_sim, navigator, start):
    log = Log()
    trajectory = run(make_sim(), navigator, start, (3.0, 4.5), observers=[log]).trajectory
    assert trajectory.poses[0].tolist() == list(start.as_tuple())
    assert np.allclose(np.diff(trajectory.time), navigator.dt)
    assert trajectory.commanded_v[0] == 0.0
    # The command of a row is that of the period that ends there: the simulator has driven it.
    np.testing.assert_allclose(trajectory.v, trajectory.commanded_v)
    assert [step.index for step in log.steps] == list(range(len(trajectory)))
    assert [step.state.time for step in log.steps] == trajectory.time.tolist()
    assert log.info.start == start
    assert log.steps[-1].command.v == trajectory.commanded_v[-1]


def test_several_goals_are_reached_in_order(make_sim, navigator, start):
    goals = [(1.5, 4.5), (6.5, 4.5, 0.0), Pose2D(6.5, 1.5, -1.0)]
    episode = run(make_sim(), navigator, start, goals)
    assert episode.outcome is Outcome.ARRIVED
    assert episode.goals_reached == 3
    assert episode.goals == ((1.5, 4.5), (6.5, 4.5, 0.0), (6.5, 1.5, -1.0))
    trajectory = episode.trajectory
    assert (np.diff(trajectory.goal) >= 0).all()
    for index, goal in enumerate(episode.goals):
        last = trajectory.poses[trajectory.goal == index][-1]
        assert math.hypot(last[0] - goal[0], last[1] - goal[1]) <= 0.25
    assert len(episode.paths) == 3
    assert episode.metrics.path_length_m == pytest.approx(sum(path.length for path in episode.paths), rel=0.1)


def test_a_blocked_or_outside_pose_is_bad_input_and_nothing_moves(make_sim, navigator, start):
    sim, log = make_sim(), Log()
    with pytest.raises(BlockedPoseError):
        run(sim, navigator, (4.0, 1.0, 0.0), (6.5, 1.5), observers=[log])
    with pytest.raises(BlockedPoseError):
        run(sim, navigator, start, [(1.5, 4.5), (4.0, 1.0)], observers=[log])
    with pytest.raises(OutsideMapError):
        run(sim, navigator, start, (60.0, 1.5), observers=[log])
    assert sim.seeds == []
    assert log.info is None


@pytest.mark.parametrize("goal", [[], (1.0,), (1.0, 2.0, 3.0, 4.0), (math.nan, 1.0), [(1.0, 2.0), (1.0,)]])
def test_a_goal_that_is_no_pose_is_refused(make_sim, navigator, start, goal):
    with pytest.raises(InputError):
        run(make_sim(), navigator, start, goal)


@pytest.mark.parametrize("limit", [0.0, -1.0, math.nan, math.inf])
def test_a_time_limit_that_is_not_positive_is_refused(make_sim, navigator, start, limit):
    with pytest.raises(InputError, match="time limit"):
        run(make_sim(), navigator, start, (6.5, 1.5), time_limit_s=limit)


def test_an_unreachable_goal_is_the_outcome_no_path(make_sim, carter, start):
    data = np.zeros((120, 160), dtype=np.int8)
    data[:, 80:82] = 100
    episode = run(make_sim(), Navigator(OccupancyGrid(data, 0.05), carter), start, (6.5, 1.5))
    assert episode.outcome is Outcome.NO_PATH
    assert len(episode.trajectory) == 1
    assert episode.message
    assert episode.metrics.spl == 0.0
    assert episode.metrics.max_cross_track_error_m is None
    assert episode.metrics.smoothness_rad_per_m is None


def test_an_unreachable_later_goal_is_no_path_after_the_earlier_ones(make_sim, carter, start):
    data = np.zeros((120, 160), dtype=np.int8)
    data[:, 80:82] = 100
    navigator = Navigator(OccupancyGrid(data, 0.05), carter)
    episode = run(make_sim(), navigator, start, [(1.5, 4.0), (6.5, 1.5)])
    assert episode.outcome is Outcome.NO_PATH
    assert episode.goals_reached == 1


def test_how_the_robot_would_stand_at_an_unreachable_goal_is_not_bad_input(make_sim, carter):
    data = np.zeros((120, 160), dtype=np.int8)
    data[:, 80:82] = 100
    navigator = Navigator(OccupancyGrid(data, 0.05), carter)
    # At the first goal, 0.3 m from the map's edge, it could stand with its nose to the edge alone.
    episode = run(make_sim(), navigator, (6.5, 1.5, 0.0), [(0.3, 3.0), (6.5, 4.0)])
    assert episode.outcome is Outcome.NO_PATH
    assert episode.goals_reached == 0


def test_the_time_limit_ends_a_run(make_sim, navigator, start):
    episode = run(make_sim(), navigator, start, (6.5, 1.5), time_limit_s=2.0)
    assert episode.outcome is Outcome.TIMED_OUT
    assert episode.metrics.time_s == pytest.approx(2.0)
    assert episode.metrics.spl == 0.0


def test_a_robot_that_does_not_move_is_stuck(make_sim, navigator, start):
    episode = run(make_sim(drag=1.0), navigator, start, (6.5, 1.5))
    assert episode.outcome is Outcome.STUCK
    assert episode.metrics.distance_m == 0.0


def test_every_contact_of_a_period_is_in_the_metrics(make_sim, navigator, start):
    sim = make_sim(wall_x=3.0)
    step = sim.step

    def step_with_more(command, dt):
        state = step(command, dt)
        more = tuple(Contact("wheel_left", name, 0.0, 0.0) for name in ("post", "rack", "wall"))
        return replace(state, contacts=state.contacts + more) if state.contacts else state

    sim.step = step_with_more
    assert run(sim, navigator, start, (6.5, 1.5)).metrics.contacts == ("wall", "post", "rack")


def test_a_contact_ends_the_run_and_is_named(make_sim, navigator, start):
    episode = run(make_sim(wall_x=3.0), navigator, start, (6.5, 1.5))
    assert episode.outcome is Outcome.COLLIDED
    assert episode.metrics.contacts == ("wall",)
    assert "wall" in episode.message
    assert (episode.trajectory.x[:-1] <= 3.0).all()


def test_a_contact_at_the_start_is_a_collision_at_time_0(make_sim, navigator, start):
    episode = run(make_sim(wall_x=1.0), navigator, start, (6.5, 1.5))
    assert episode.outcome is Outcome.COLLIDED
    assert episode.metrics.time_s == 0.0
    assert "at the start" in episode.message


def test_a_run_that_goes_on_after_a_contact_is_still_a_collision(make_sim, navigator, start):
    episode = run(make_sim(wall_x=3.0), navigator, start, (6.5, 1.5), stop_on_contact=False)
    assert episode.outcome is Outcome.COLLIDED
    assert episode.goals_reached == 1
    assert episode.metrics.spl == 0.0


def test_a_simulator_that_breaks_down_aborts_the_run_with_its_data(make_sim, navigator, start):
    log = Log()
    episode = run(make_sim(breaks_at=1.0), navigator, start, (6.5, 1.5), observers=[log])
    assert episode.outcome is Outcome.ABORTED
    assert "left the world" in episode.message
    assert log.episode.metrics.time_s == pytest.approx(1.0)


def test_ctrl_c_aborts_the_run_with_its_data(make_sim, navigator, start):
    log = Log()
    stop = Log(raises_at=10, error=KeyboardInterrupt())
    episode = run(make_sim(), navigator, start, (6.5, 1.5), observers=[stop, log])
    assert episode.outcome is Outcome.ABORTED
    assert len(episode.trajectory) == 11
    assert log.episode is not None
    assert episode.observer_errors == ()


def test_an_observer_that_fails_is_dropped_and_changes_nothing(make_sim, navigator, start):
    alone = run(make_sim(), navigator, start, (3.0, 4.5))
    broken, ends_badly, interrupted, log = (
        Log(raises_at=3),
        Log(fails_at_end=True),
        Log(fails_at_end=True, error=KeyboardInterrupt()),
        Log(),
    )
    episode = run(make_sim(), navigator, start, (3.0, 4.5), observers=[broken, ends_badly, interrupted, log])
    assert same(alone, episode)
    assert len(broken.steps) == 4
    assert broken.episode is None
    assert log.episode is not None
    assert len(log.steps) == len(episode.trajectory)
    assert [type(error) for error in episode.observer_errors] == [RuntimeError, RuntimeError, KeyboardInterrupt]


def test_slow_observers_do_not_change_a_run(make_sim, navigator, start):
    class Slow(Log):
        def on_step(self, step):
            time.sleep(0.001)

    assert same(
        run(make_sim(), navigator, start, (3.0, 4.5)),
        run(make_sim(), navigator, start, (3.0, 4.5), observers=[Slow()]),
    )


def test_the_seed_reaches_the_simulator(make_sim, navigator, start):
    sim = make_sim()
    assert run(sim, navigator, start, (3.0, 4.5), seed=17).seed == 17
    assert sim.seeds == [17]


def test_a_navigator_that_only_says_it_arrived_is_not_believed(make_sim, navigator, start, monkeypatch):
    claim = AgentReport(NavigationStatus.ARRIVED)
    monkeypatch.setattr(navigator, "update", lambda observation, estimate: Twist2D())
    monkeypatch.setattr(navigator, "report", lambda *, rollouts=False: claim)
    episode = run(make_sim(), navigator, start, (6.5, 1.5))
    assert episode.outcome is Outcome.STUCK
    assert episode.goals_reached == 0


def test_a_start_at_the_goal_has_arrived(make_sim, navigator, start):
    episode = run(make_sim(), navigator, start, start)
    assert episode.outcome is Outcome.ARRIVED
    assert episode.metrics.time_s == 0.0
    assert episode.metrics.spl == 1.0
