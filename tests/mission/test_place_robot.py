"""A robot that is put somewhere else in a run, steps of several periods, and runs that keep only their end."""

import math

import numpy as np
import pytest

from support.sessions import drive
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.mission import (
    GivenDirective,
    Outcome,
    Pause,
    PlaceRobot,
    Session,
    Steering,
    StepOnce,
    Trajectory,
    load_directives,
    save_directives,
)
from trundle.navigation import CommandScript
from trundle.sim import simulate

GOAL, THERE = (3.0, 4.5), (6.0, 4.5, math.pi)


def test_the_robot_drives_on_from_where_it_was_put(sim, navigator, start, steering):
    applied = []
    session = Session(sim, navigator, start, GOAL, steering=steering)
    before = drive(session, 20)[-1]
    steering.put(PlaceRobot(*THERE), applied=lambda: applied.append(session.state.pose))
    assert session.steer()
    assert applied[0].as_tuple() == pytest.approx(THERE, abs=1e-6)
    assert session.state.odometry == before.state.odometry
    assert session.estimate.pose == session.state.pose
    assert session.time == pytest.approx(1.0)
    episode = session.run()
    assert episode.outcome is Outcome.ARRIVED
    assert episode.trajectory.x[21] == pytest.approx(6.0, abs=0.1)


def test_a_localizer_does_not_notice(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering, localizer="odometry")
    drive(session, 20)
    believed = session.estimate.pose
    steering.put(PlaceRobot(*THERE))
    session.steer()
    assert session.estimate.pose == believed
    drive(session, 2)
    assert session.estimate.pose.distance_to(believed) < 0.1


def test_while_paused_it_is_there_at_once(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    steering.put(Pause())
    steering.put(PlaceRobot(*THERE))
    assert not session.steer()
    assert session.state.pose.as_tuple() == pytest.approx(THERE, abs=1e-6)
    assert session.time == 0.0


def test_where_it_would_touch_something_it_is_refused(sim, navigator, start, steering):
    said, applied = [], []
    session = Session(sim, navigator, start, GOAL, steering=steering)
    drive(session, 3)
    pose = session.state.pose
    steering.put(PlaceRobot(0.0, 0.0), refused=said.append, applied=lambda: applied.append(1))
    session.steer()
    assert "the robot would touch" in said[0]
    assert (session.state.pose, applied) == (pose, [])


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_the_run_is_repeated_from_its_directives(backend, world, carter, tmp_path):
    steering = Steering()
    with simulate(world, carter, backend=backend) as sim:
        script = CommandScript([(0.4, 0.3, 2.0)])
        session = Session(sim, script, (1.5, 1.5, 0.0), None, monitor=False, steering=steering)
        drive(session, 10)
        steering.put(PlaceRobot(*THERE), by="ann")
        first = session.run()
    save_directives(tmp_path / "directives.json", first.directives)
    given = load_directives(tmp_path / "directives.json")
    with simulate(world, carter, backend=backend) as sim:
        script = CommandScript([(0.4, 0.3, 2.0)])
        second = Session(sim, script, (1.5, 1.5, 0.0), None, monitor=False, directives=given).run()
    for name in Trajectory.columns():
        np.testing.assert_array_equal(getattr(first.trajectory, name), getattr(second.trajectory, name))
    assert second.directives == first.directives


def test_a_step_may_be_several_periods(sim, navigator, start, steering):
    session = Session(sim, navigator, start, GOAL, steering=steering)
    steering.put(Pause())
    steering.put(StepOnce(3))
    count = 0
    while session.steer():
        session.drive()
        count += 1
    assert count == 3
    assert session.time == pytest.approx(0.15)


def test_both_are_read_as_they_were_written(tmp_path):
    given = (GivenDirective(0, 0.0, PlaceRobot(1.0, 2.0, 0.5)), GivenDirective(1, 0.1, StepOnce(7)))
    save_directives(tmp_path / "directives.json", given)
    assert load_directives(tmp_path / "directives.json") == given


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PlaceRobot(math.nan, 0.0), "x of a place must be a number"),
        (lambda: PlaceRobot(0.0, 0.0, "left"), "yaw of a place must be a number"),
        (lambda: StepOnce(0), "periods of a step must be an integer from 1"),
    ],
)
def test_bad_numbers_are_one_clear_error(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_a_run_without_an_end_keeps_its_last_seconds(world, carter, navigator, start):
    steering = Steering()
    with simulate(world, carter, backend="kinematic") as sim:
        session = Session(sim, navigator, start, GOAL, steering=steering, keeps_s=2.0)
        steps = drive(session, 100)
        for number in range(30):
            steering.put(PlaceRobot(1.5 + 0.1 * number, 1.5))
            drive(session, 5)
        episode = session.finish()
    assert steps[-1].index == 100
    assert len(episode.trajectory) == 41
    assert episode.trajectory.time[-1] == pytest.approx(12.5)
    assert episode.trajectory.time[0] == pytest.approx(10.5)
    used = episode.trajectory.path
    assert used.min() >= 0
    assert used.max() == len(episode.paths) - 1
    assert len(episode.paths) < 20


def test_the_place_is_a_pose():
    assert PlaceRobot(1.0, 2.0, 3.0 * math.pi).pose == Pose2D(1.0, 2.0, math.pi)


def test_its_distance_is_that_of_the_whole_run(world, carter, navigator, start):
    def length(keeps_s):
        with simulate(world, carter, backend="kinematic") as sim:
            session = Session(sim, navigator, start, GOAL, keeps_s=keeps_s)
            drive(session, 120)
            return session.finish().metrics.distance_m

    whole = length(None)
    assert whole > 2.0
    assert length(1.0) == pytest.approx(whole)
