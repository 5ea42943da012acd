"""A run that goes on after its goals, until it is ended."""

import pytest

from support.command_line import room
from trundle.mission import (
    DropBox,
    End,
    LiveRun,
    Manual,
    Outcome,
    Release,
    Restart,
    Session,
    SetGoal,
    Steering,
    WaitAtGoal,
)
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

START, GOAL, NEXT = (1.0, 1.0), (2.5, 1.0), (3.5, 2.0)


def drive(steering=None, directives=(), *, goal=GOAL, lidar=False):
    grid, robot = room(), Robot.load("nova_carter")
    simulator = KinematicSimulator(World.from_map(grid), robot, lidar=lidar)
    return Session(simulator, Navigator(grid, robot), START, goal, steering=steering, directives=directives)


def run_until(session, then, *, most=4000):
    """Drive until the run waits, and give the next of `then` each time; the times at which it waited."""
    waited = []
    for _ in range(most):
        if session.outcome is not None:
            return waited
        if session.steer():
            session.drive()
        elif session.outcome is None:
            waited.append(session.time)
            then.pop(0)()
    raise AssertionError("it did not end")


@pytest.fixture
def steering():
    steering = Steering()
    steering.put(WaitAtGoal())
    return steering


def test_a_run_that_has_arrived_waits_for_the_next_goal_and_ends_when_it_is_ended(steering):
    session = drive(steering)
    waited = run_until(session, [lambda: steering.put(SetGoal(NEXT)), lambda: steering.put(End("ended by page 1"))])
    episode = session.finish()
    assert len(waited) == 2
    assert episode.outcome is Outcome.ARRIVED
    assert episode.message.endswith("s; ended by page 1")
    assert [goal[:2] for goal in episode.goals] == [GOAL, NEXT]
    assert episode.goals_reached == 2
    assert episode.trajectory.time[-1] == waited[-1]  # the time stood still meanwhile


def test_without_it_arriving_ends_the_run():
    session = drive(Steering())
    assert run_until(session, []) == []
    assert session.outcome is Outcome.ARRIVED


def test_the_record_of_a_run_that_waited_repeats_it_exactly(steering):
    first = drive(steering)
    acts = [
        lambda: steering.put(SetGoal((100.0, 0.0))),  # refused: it is outside
        lambda: steering.put(SetGoal(NEXT)),
        lambda: (
            (steering.put(Manual(0.3, 0.0)), [first.steer() and first.drive() for _ in range(10)])
            and steering.put(Release())
        ),
        lambda: steering.put(SetGoal(GOAL)),
        lambda: steering.put(End()),
    ]
    run_until(first, acts)
    one, two = first.finish(), drive(directives=first.directives).run()
    assert (one.outcome, one.message, one.goals) == (two.outcome, two.message, two.goals)
    assert one.trajectory.time.tolist() == two.trajectory.time.tolist()
    assert one.trajectory.poses.tolist() == two.trajectory.poses.tolist()


def test_one_that_is_ended_on_the_way_or_away_from_its_goal_is_aborted(steering):
    session = drive(steering)
    steering.put(End())
    run_until(session, [])
    assert session.outcome is Outcome.ABORTED
    away = Steering()
    away.put(WaitAtGoal())
    session = drive(away)

    def leave():
        for _ in range(40):
            away.put(Manual(-0.5, 0.0))
            if session.steer():
                session.drive()
        away.put(Release())

    run_until(session, [leave, lambda: away.put(End())])
    assert session.outcome is Outcome.ABORTED


def test_a_goal_that_is_given_up_does_not_end_it(steering):
    session = drive(steering, goal=(6.5, 3.5), lidar=True)
    steering.put(DropBox(6.5, 3.5, size=(1.0, 1.0, 1.0)))
    waited = run_until(session, [lambda: steering.put(SetGoal(NEXT)), lambda: steering.put(End())])
    assert len(waited) == 2
    assert session.outcome is Outcome.ARRIVED


def test_a_restart_or_ctrl_c_at_the_goal_keeps_that_it_arrived(steering):
    session = drive(steering)
    run_until(session, [lambda: steering.put(Restart())])
    assert (session.outcome, session.restart) == (Outcome.ARRIVED, Restart())
    other = Steering()
    other.put(WaitAtGoal())
    session = drive(other)
    interrupt = KeyboardInterrupt()
    run_until(session, [lambda: session.abort(interrupt)])
    assert (session.outcome, session.error) == (Outcome.ARRIVED, interrupt)


def test_a_live_run_says_that_it_waits_and_takes_no_time_meanwhile(steering, monkeypatch):
    seen = []

    def wait(self, timeout_s=None):
        if timeout_s == 1.0:
            seen.append((live.status.state, live.status.time))
            if len(seen) == 3:
                self.put(End())
        return self.waiting > 0

    monkeypatch.setattr(Steering, "wait", wait)
    live = LiveRun(lambda _: drive(steering), steering, speed=50.0)
    assert live.run().outcome is Outcome.ARRIVED
    assert {state for state, _ in seen} == {"waiting"}
    assert len({time for _, time in seen}) == 1
