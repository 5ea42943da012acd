"""Which contacts end a run, and what a collision monitor does in one."""

from dataclasses import replace

import numpy as np
import pytest

from support.sessions import steps_of
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.mission import Outcome, Rules, Session, run
from trundle.navigation import CommandScript
from trundle.sim import Contact, MoverState
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World
from trundle.worlds.movers import Mover, Waypoints

FORWARD = [(0.4, 0.0, 2.0)]


def touch(sim, when, *, name="person", mover=True):
    """Let a simulator report a contact where `when(state)`."""

    def changed(state):
        movers = (MoverState(name, Pose2D(0.0, 0.0)),) if mover else ()
        contacts = (Contact("chassis", name, 1.0, 2.0),) if when(state) else ()
        return replace(state, movers=movers, contacts=contacts)

    step, reset = sim.step, sim.reset
    sim.step = lambda command, dt: changed(step(command, dt))
    sim.reset = lambda pose, *, seed=0: changed(reset(pose, seed=seed))
    return sim


def test_a_mover_that_runs_into_a_standing_robot_does_not_end_the_run(make_sim, start):
    waits = [(0.0, 0.0, 1.0), (0.4, 0.0, 1.0)]
    sim = touch(make_sim(), lambda state: 0.3 < state.time < 0.6)
    episode = run(sim, CommandScript(waits), start, None)
    assert episode.outcome is Outcome.FINISHED
    assert episode.metrics.standing_contacts == ("person",)
    assert episode.metrics.contacts == ()


def test_by_the_rules_of_a_benchmark_every_contact_is_a_collision(make_sim, start):
    waits = [(0.0, 0.0, 1.0), (0.4, 0.0, 1.0)]
    sim = touch(make_sim(), lambda state: 0.3 < state.time < 0.6)
    episode = run(sim, CommandScript(waits), start, None, rules=Rules(every_contact=True))
    assert episode.outcome is Outcome.COLLIDED
    assert (episode.metrics.contacts, episode.metrics.standing_contacts) == (("person",), ())


def test_a_touch_that_began_while_the_robot_stood_stays_one(make_sim, start):
    waits = [(0.0, 0.0, 0.5), (0.4, 0.0, 1.0)]
    episode = run(touch(make_sim(), lambda state: 0.3 < state.time < 0.8), CommandScript(waits), start, None)
    assert (episode.metrics.contacts, episode.metrics.standing_contacts) == ((), ("person",))


def test_a_mover_that_a_moving_robot_touches_is_a_collision(make_sim, start):
    episode = run(touch(make_sim(), lambda state: state.time > 0.3), CommandScript(FORWARD), start, None)
    assert episode.outcome is Outcome.COLLIDED
    assert (episode.metrics.contacts, episode.metrics.standing_contacts) == (("person",), ())
    assert "the chassis touches person" in episode.message


def test_a_second_touch_counts_for_itself(make_sim, start):
    waits = [(0.0, 0.0, 0.5), (0.4, 0.0, 2.0)]
    sim = touch(make_sim(), lambda state: 0.2 < state.time < 0.4 or state.time > 1.0)
    episode = run(sim, CommandScript(waits), start, None)
    assert episode.outcome is Outcome.COLLIDED
    assert (episode.metrics.contacts, episode.metrics.standing_contacts) == (("person",), ("person",))


def test_a_solid_that_a_standing_robot_touches_is_a_collision(make_sim, start):
    sim = touch(make_sim(), lambda state: state.time > 0.3, name="rack", mover=False)
    episode = run(sim, CommandScript([(0.0, 0.0, 1.0)]), start, None)
    assert episode.metrics.contacts == ("rack",)


@pytest.mark.parametrize(("height", "lidar", "unseen"), [(0.3, True, ("box",)), (0.9, True, ()), (0.3, False, ())])
def test_contacts_that_no_lidar_could_see_are_named(carter, height, lidar, unseen):
    box = Solid("box", Box((0.2, 2.0, height)), Pose3D((1.5, 0.0, height / 2.0)))
    with KinematicSimulator(World("boxes", (box,)), carter, lidar=lidar) as sim:
        episode = run(sim, CommandScript([(0.8, 0.0, 3.0)]), (0.0, 0.0), None, monitor=False)
    assert episode.metrics.contacts == ("box",)
    assert episode.metrics.unseen_contacts == unseen


def test_a_cart_that_runs_into_a_robot_is_seen_in_the_steps_and_counted(carter):
    body = Solid("body", Box((0.4, 0.4, 1.0)), Pose3D((0.0, 0.0, 0.5)))
    cart = Mover("cart", (body,), Waypoints([(0.0, 3.0, 0.0), (4.0, 0.0, 0.0)]))
    with KinematicSimulator(World("hall", (), movers=(cart,)), carter, lidar=True) as sim:
        session = Session(sim, CommandScript([(0.0, 0.0, 4.0)]), (0.0, 0.0), monitor=False)
        places = [step.movers[0].pose.x for step in steps_of(session)]
    assert places[0] == pytest.approx(3.0 - 0.75 * 0.05)
    assert session.outcome is Outcome.FINISHED
    metrics = session.finish().metrics
    assert (metrics.standing_contacts, metrics.contacts, metrics.unseen_contacts) == (("cart",), (), ())


# Collision monitors ---------------------------------------------------------------------------------------------------


class Report:
    def __init__(self, command, action):
        self.command, self.action = command, action


class Blinking:
    """Stops the robot in every other half second."""

    def reset(self):
        self.times = []

    def check(self, command, twist, scans, time, odometry):
        self.times.append(time)
        return Report(Twist2D(), "stop") if time % 1.0 >= 0.5 else Report(command, "none")


def test_every_command_passes_the_monitor(make_sim, start):
    monitor = Blinking()
    session = Session(make_sim(), CommandScript([(0.4, 0.0, 3.0)]), start, monitor=monitor)
    steps = steps_of(session)
    episode = session.finish()
    assert monitor.times == pytest.approx(np.arange(60) * 0.05)
    assert {step.monitor.action for step in steps if step.sent != step.command} == {"stop"}
    assert all(step.command == Twist2D(0.4, 0.0) for step in steps)
    assert episode.metrics.monitor_stops == 3
    np.testing.assert_array_equal(episode.trajectory.commanded_v[1:], [step.sent.v for step in steps])


def test_scans_bring_a_monitor_unless_it_is_switched_off(carter):
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((2.5, 0.0, 0.5)))
    script = CommandScript([(0.8, 0.0, 6.0)])
    with KinematicSimulator(World("wall", (wall,)), carter, lidar=True) as sim:
        watched = run(sim, script, (0.0, 0.0), None)
        blind = run(sim, script, (0.0, 0.0), None, monitor=False)
    assert watched.outcome is Outcome.FINISHED
    assert watched.metrics.monitor_stops is not None
    assert blind.metrics.contacts == ("wall",)
    assert blind.metrics.monitor_stops is None


def test_without_scans_there_is_no_monitor_unless_asked_for(make_sim, start):
    assert run(make_sim(), CommandScript(FORWARD), start, None).metrics.monitor_stops is None
    asked = run(make_sim(), CommandScript(FORWARD), start, None, monitor=True)
    assert asked.metrics.monitor_stops == 1  # no lidar sends anything
