"""Steered runs, in the kinematic simulator and in MuJoCo."""

import math
import threading

import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.mission import (
    DropBox,
    End,
    LiveRun,
    Manual,
    Outcome,
    Pause,
    Release,
    Restart,
    Session,
    SetGoal,
    Steering,
    StepOnce,
    Trajectory,
)
from trundle.navigation import Navigator
from trundle.sim import simulate
from trundle.worlds import World

GOAL, OTHER = (3.0, 4.5), (1.5, 4.5)
BACKENDS = ("kinematic", "mujoco")


@pytest.fixture(scope="module")
def world(room):
    return World.from_map(room)


@pytest.fixture(params=BACKENDS)
def sim(request, world, carter):
    with simulate(world, carter, backend=request.param) as made:
        yield made


@pytest.fixture
def steering():
    return Steering()


def drive(session, periods):
    return [session.step() for _ in range(periods)]


def same(one, other):
    for name in Trajectory.columns():
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    return len(one)


# Pausing --------------------------------------------------------------------------------------------------------------


def test_a_pause_holds_the_time_and_a_step_is_one_period(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    drive(session, 3)
    steering.put(Pause())
    for _ in range(3):
        assert not session.steer()
        assert session.time == pytest.approx(0.15)
    for period in (4, 5):
        steering.put(StepOnce())
        step = session.step()
        assert (step.index, step.steering.paused) == (period, True)
        assert session.time == pytest.approx(0.05 * period, abs=1e-12)
        assert not session.steer()
    steering.put(Pause(False))
    assert session.run().outcome is Outcome.ARRIVED


def test_a_run_that_waits_goes_on_when_another_thread_says_so(sim, navigator, start, steering):
    steering.put(Pause())
    threading.Timer(0.2, steering.put, [Pause(False)]).start()
    episode = Session(sim, navigator, start, GOAL, steering=steering).run()
    assert episode.outcome is Outcome.ARRIVED


# Goals ----------------------------------------------------------------------------------------------------------------


def test_a_goal_replaces_those_that_are_left_and_others_queue(sim, navigator, start, steering):
    session = Session(sim, navigator, start, [GOAL, (6.0, 4.5)], steering=steering)
    drive(session, 20)
    steering.put(SetGoal(OTHER))
    steering.put(SetGoal((2.5, 1.5, 0.0), append=True))
    assert session.step().steering.goals == (OTHER, (2.5, 1.5, 0.0))
    episode = session.run()
    assert (episode.outcome, episode.goals_reached) == (Outcome.ARRIVED, 2)
    assert episode.goals == (OTHER, (2.5, 1.5, 0.0))
    assert episode.trajectory.x[-1] == pytest.approx(2.5, abs=0.3)


def test_goals_that_are_driven_through_queue_too(sim, navigator, start, steering):
    session = Session(sim, navigator, start, [OTHER, GOAL], through=True, steering=steering)
    drive(session, 10)
    steering.put(SetGoal((6.0, 4.5), append=True))
    episode = session.run()
    assert (episode.outcome, episode.goals_reached) == (Outcome.ARRIVED, 3)


@pytest.mark.parametrize("append", [False, True])
def test_a_goal_in_a_wall_is_refused_and_the_run_goes_on(sim, navigator, start, steering, append):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    drive(session, 5)
    said = []
    steering.put(SetGoal((4.0, 1.0), append), by="ann", refused=said.append)
    step = session.step()
    assert step.steering.goals == (GOAL,)
    assert len(said) == 1
    assert "4.00, 1.00" in said[0]
    assert session.directives[0].refused == said[0]
    assert session.run().outcome is Outcome.ARRIVED


def test_a_navigator_without_a_goal_waits_for_one(sim, navigator, start, steering):
    session = Session(sim, navigator, start, None, steering=steering)
    assert {step.state.pose.x for step in drive(session, 10)} == {start.x}
    steering.put(SetGoal(OTHER))
    drive(session, 400)
    assert (session.outcome, session.steering.goals) == (None, (OTHER,))
    assert session.state.pose.distance_to(Pose2D(*OTHER)) < 0.3
    steering.put(End("seen enough"))
    assert session.step() is None
    assert (session.outcome, session.message) == (Outcome.FINISHED, "seen enough")


# By hand --------------------------------------------------------------------------------------------------------------


def by_hand(session, steering, command, periods):
    steps = []
    for _ in range(periods):
        steering.put(Manual(*command), by="ann")
        steps.append(session.step())
    return steps


def test_a_command_by_hand_stops_before_a_wall(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    steps = by_hand(session, steering, (0.6, 0.0), 120)
    assert steps[3].steering.manual == Twist2D(0.6, 0.0)
    assert (steps[3].steering.by, steps[3].steering.held_back) == ("ann", "")
    assert session.state.contacts == ()
    assert session.state.twist.v == pytest.approx(0.0, abs=0.01)
    assert steps[-1].steering.held_back == "stopped before an obstacle of the costmap"
    assert session.state.pose.x > 2.5  # the block is at 3.6 m
    back = by_hand(session, steering, (-0.6, 0.0), 40)
    assert back[-1].steering.held_back == ""
    assert session.state.pose.x < 2.6
    steering.put(Release())
    assert session.run().outcome is Outcome.ARRIVED


def test_after_a_command_by_hand_the_robot_stands_until_it_is_released(sim, navigator, start, steering, monkeypatch):
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    session = Session(sim, navigator, start, GOAL, steering=steering)
    steering.put(Manual(-0.3, 0.0), by="ann")
    moving = drive(session, 20)
    assert moving[-1].steering.manual == Twist2D(-0.3, 0.0)
    now[0] += 0.31
    standing = drive(session, 20)
    assert standing[0].steering.manual == Twist2D()
    assert standing[-1].state.twist.v == pytest.approx(0.0, abs=1e-3)
    assert [given.by for given in session.directives] == ["ann", "dead-man"]
    steering.put(Release())
    assert session.run().outcome is Outcome.ARRIVED


# Boxes ----------------------------------------------------------------------------------------------------------------


def test_a_dropped_box_is_in_the_scans_and_not_in_the_way_of_the_state(room, world, carter, start, steering):
    for backend in BACKENDS:
        with simulate(world, carter, backend=backend, lidar=True) as sim:
            navigator = Navigator(room, carter)
            session = Session(sim, navigator, start, (1.5, 4.5), steering=steering)
            before = drive(session, 20)[-1]
            steering.put(DropBox(1.5, 3.2, 0.3, (0.4, 0.4, 0.8)))
            after = drive(session, 2)[-1]
            assert after.state.pose.distance_to(before.state.pose) < 0.2
            assert sim.world.solids[-1].name == "dropped_box_1"
            episode = session.run()
            assert episode.outcome is Outcome.ARRIVED
            assert episode.metrics.contacts == ()
            sim.reset(start)
            assert sim.world is world


# In real time ---------------------------------------------------------------------------------------------------------


def test_a_live_run_steps_pauses_and_restarts(make_sim, navigator, start, steering):
    seeds = []

    def make(seed):
        seeds.append(seed)
        return Session(make_sim(), navigator, start, GOAL, steering=steering, seed=seed or 0)

    live = LiveRun(make, steering, speed=math.inf)
    assert live.status.state == "idle"
    steering.put(Pause())
    steering.put(StepOnce())
    steering.put(Restart("next"))
    episode = live.run()
    assert (episode.outcome, episode.seed, seeds) == (Outcome.ARRIVED, 1, [None, 1])
    assert (live.status.state, live.status.run, live.status.speed) == ("ended", 2, math.inf)
