"""Steered runs, in the kinematic simulator and in MuJoCo."""

import math
import threading

import numpy as np
import pytest

from mission.conftest import BACKENDS
from support.sessions import drive
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.mission import (
    DropBox,
    End,
    Episode,
    GivenDirective,
    Manual,
    Outcome,
    Pause,
    Release,
    Scenario,
    Session,
    SetGoal,
    Speed,
    StepOnce,
    Trajectory,
)
from trundle.navigation import CommandScript, Navigator
from trundle.record.run_folder import RunFolder
from trundle.sim import simulate
from trundle.worlds import World

GOAL, OTHER = (3.0, 4.5), (1.5, 4.5)


@pytest.fixture
def wall(monkeypatch):
    """The wall time [s] of dead-man switches, in a list of one."""
    now = [100.0]
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    return now


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


def test_a_command_by_hand_stops_before_a_wall(sim, navigator, start, steering, wall):
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


def test_after_a_command_by_hand_the_robot_stands_until_it_is_released(sim, navigator, start, steering, wall):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    steering.put(Manual(-0.3, 0.0), by="ann")
    moving = drive(session, 20)
    assert moving[-1].steering.manual == Twist2D(-0.3, 0.0)
    wall[0] += 0.31
    standing = drive(session, 20)
    assert standing[0].steering.manual == Twist2D()
    assert standing[-1].state.twist.v == pytest.approx(0.0, abs=1e-3)
    assert [given.by for given in session.directives] == ["ann", "dead-man"]
    steering.put(Release())
    assert session.run().outcome is Outcome.ARRIVED


def test_a_command_by_hand_stops_before_a_box_that_only_lidars_see(world, carter, room, start, steering, wall):
    for backend in BACKENDS:
        with simulate(world, carter, backend=backend, lidar=True) as sim:
            session = Session(sim, Navigator(room, carter), start, GOAL, steering=steering)
            drive(session, 4)
            x, y, yaw = session.state.pose.as_tuple()
            steering.put(DropBox(x + 1.2 * math.cos(yaw), y + 1.2 * math.sin(yaw), yaw, (0.3, 0.6, 0.6)))
            steps = by_hand(session, steering, (0.6, 0.0), 80)
            assert session.state.contacts == ()
            assert session.state.twist.v == pytest.approx(0.0, abs=0.02)
            assert steps[-1].steering.held_back != ""
            assert session.finish().metrics.contacts == ()


# Time limits ----------------------------------------------------------------------------------------------------------


def test_goals_and_driving_by_hand_extend_the_default_time_limit(make_sim, navigator, start, steering, wall):
    session = Session(make_sim(), navigator, start, GOAL, steering=steering)
    first = session.info.time_limit_s
    by_hand(session, steering, (0.1, 0.0), 40)
    steering.put(Release())
    drive(session, 1)
    steering.put(SetGoal(OTHER, append=True))
    episode = session.run()
    assert episode.time_limit_s > first + 2.0 + 60.0
    again = Session(make_sim(), navigator, start, GOAL, steering=steering, time_limit_s=1.0)
    by_hand(again, steering, (0.1, 0.0), 40)
    assert (again.outcome, again.time) == (Outcome.TIMED_OUT, pytest.approx(1.0))


# Boxes ----------------------------------------------------------------------------------------------------------------


@pytest.mark.slow
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


@pytest.mark.parametrize("y", [0.9, 0.0])
def test_a_box_counts_in_the_clearance_from_when_it_was_dropped(carter, steering, y):
    posts = tuple(Solid(f"post {x}", Box((0.1, 0.1, 1.0)), Pose3D((x, 3.0, 0.5))) for x in (-1.0, 3.0))
    script = CommandScript([(0.4, 0.0, 5.0)])
    with simulate(World("posts", posts), carter, backend="kinematic") as sim:
        session = Session(sim, script, (0.0, 0.0), steering=steering, stop_on_contact=False)
        drive(session, 10)
        steering.put(DropBox(1.0, y, 0.0, (0.4, 0.4, 0.5)))
        steering.put(DropBox(-0.7, 0.0, 0.0, (0.4, 0.4, 0.5)))  # nearest to where the robot was
        episode = session.run()
    width = carter.planar.outline[:, 1].max()
    behind = episode.trajectory.x[10] + carter.planar.outline[:, 0].min() + 0.5
    expected = 0.0 if y == 0.0 else min(0.9 - 0.2 - width, behind)
    assert episode.metrics.min_clearance_m == pytest.approx(expected, abs=1e-6)
    assert episode.metrics.contacts == (("dropped_box_1",) if y == 0.0 else ())


# Records --------------------------------------------------------------------------------------------------------------


def steer_all(session, steering):
    """Give a run one of each directive that does not end it, at different times."""
    drive(session, 10)
    steering.put(SetGoal(OTHER), by="ann")
    drive(session, 10)
    steering.put(Pause())
    steering.put(StepOnce())
    steering.put(Speed(math.inf))
    session.step()
    steering.put(Pause(False))
    by_hand(session, steering, (0.5, 0.4), 25)
    steering.put(SetGoal((4.0, 1.0)))
    drive(session, 5)
    steering.put(Release(), by="ann")
    steering.put(SetGoal((6.0, 4.5), append=True))
    drive(session, 10)
    steering.put(DropBox(3.0, 3.7, 0.2, (0.3, 0.4, 0.6)))
    return session.run()


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_a_steered_run_is_repeated_bit_for_bit_from_its_folder(backend, room, steering, tmp_path, wall):
    room.save(tmp_path / "room.yaml")
    scenario = Scenario.make(
        map=str(tmp_path / "room.yaml"), start=(1.5, 1.5, 0.0), goal=GOAL, backend=backend, lidar=True, seed=3
    )
    with scenario.build() as mission, RunFolder(tmp_path / "one", scenario=scenario, video=False) as folder:
        first = steer_all(mission.session(steering=steering, observers=[folder]), steering)
    assert first.outcome is Outcome.ARRIVED
    kinds = ["SetGoal", "Pause", "StepOnce", "Speed", "Pause", "Manual", "SetGoal", "Release", "SetGoal", "DropBox"]
    assert [type(given.directive).__name__ for given in first.directives] == kinds
    assert [given.refused != "" for given in first.directives] == [False] * 6 + [True] + [False] * 3
    (tmp_path / "one").rename(tmp_path / "moved")
    again = Scenario.load(tmp_path / "moved")
    assert again.directives == str(tmp_path / "moved" / "directives.json")
    with again.build() as mission, RunFolder(tmp_path / "two", scenario=again, video=False) as folder:
        second = mission.run(observers=[folder])
    assert same(first.trajectory, second.trajectory) > 100
    assert second.directives == first.directives
    assert (second.message, second.goals) == (first.message, first.goals)
    assert Episode.load(tmp_path / "two").directives == first.directives
    assert Scenario.load(tmp_path / "two").directives == str(tmp_path / "two" / "directives.json")


def test_a_record_that_ends_while_the_run_is_paused_ends_the_run(sim, navigator, start):
    given = [GivenDirective(4, 0.2, Pause())]
    episode = Session(sim, navigator, start, GOAL, directives=given).run()
    assert (episode.outcome, len(episode.trajectory)) == (Outcome.ABORTED, 5)
    assert "its record has no more directives" in episode.message
