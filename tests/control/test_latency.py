import math
import random

import pytest

from trundle.control.latency import DelayedCommands
from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.wrapper import DelayedSimulator
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
HERE = Pose2D(1.0, 2.0, 0.3)
DT = 0.05


def test_without_a_delay_the_robot_is_where_it_is():
    commands = DelayedCommands(CARTER.limits)
    commands.send(Twist2D(1.0, 0.0), 0.0)
    assert commands.predict(HERE, Twist2D(0.2, 0.1), 0.0) == (HERE, Twist2D(0.2, 0.1))


def test_before_any_command_arrives_the_robot_goes_on_as_it_moves():
    commands = DelayedCommands(CARTER.limits, 0.2)
    commands.send(Twist2D(0.0, 0.0), 0.0)
    pose, twist = commands.predict(Pose2D(0.0, 0.0), Twist2D(0.5, 0.0), 0.0)
    assert pose.x == pytest.approx(0.5 * 0.2)
    assert twist.v == pytest.approx(0.5)


def test_a_command_that_was_sent_acts_within_the_limits_of_acceleration():
    commands = DelayedCommands(CARTER.limits, 0.2)
    commands.send(Twist2D(1.0, 0.0), 0.0)
    commands.send(Twist2D(0.0, 0.0), 0.1)
    pose, twist = commands.predict(Pose2D(0.0, 0.0), Twist2D(0.0, 0.0), 0.1)  # stands until 0.2, then drives until 0.3
    assert twist.v == pytest.approx(CARTER.limits.linear_acceleration * 0.1)
    assert pose.x == pytest.approx(0.5 * CARTER.limits.linear_acceleration * 0.1**2)


def test_what_was_really_sent_replaces_the_last_command():
    commands = DelayedCommands(CARTER.limits, 0.1)
    commands.send(Twist2D(1.0, 0.0), 0.0)
    commands.replace_last(Twist2D(0.0, 0.0))
    assert commands.predict(HERE, Twist2D(0.0, 0.0), 0.1)[0] == HERE


def test_a_time_that_starts_over_drops_later_commands():
    commands = DelayedCommands(CARTER.limits, 0.1)
    commands.send(Twist2D(1.0, 0.0), 5.0)
    commands.send(Twist2D(0.0, 0.0), 0.0)
    assert commands.in_effect(10.0) == Twist2D(0.0, 0.0)


@pytest.mark.parametrize("delay_s", [0.03, 0.05, 0.1, 0.17, 0.4])
def test_the_prediction_is_where_a_simulated_robot_is_when_the_command_arrives(delay_s):
    rng, commands = random.Random(3), DelayedCommands(CARTER.limits, delay_s)
    with KinematicSimulator(World("empty", ()), CARTER) as inner:
        sim, seen = DelayedSimulator(inner, delay_s), []
        inner.on_substep = seen.append
        state, predicted = sim.reset(HERE), []
        for _ in range(60):
            predicted.append((state.time + delay_s, *commands.predict(state.pose, state.twist, state.time)))
            command = Twist2D(rng.uniform(-0.5, 1.0), rng.uniform(-1.0, 1.0))
            commands.send(command, state.time)
            state = sim.step(command, DT)
    true = {round(each.time, 3): each for each in seen}
    checked = [(pose, twist, true[round(time, 3)]) for time, pose, twist in predicted if round(time, 3) in true]
    assert len(checked) > 40
    for pose, twist, each in checked:
        assert pose.distance_to(each.pose) < 0.004  # each physics step holds its end's speed
        assert math.isclose(pose.yaw, each.pose.yaw, abs_tol=0.01)
        assert (twist.v, twist.w) == pytest.approx((each.twist.v, each.twist.w), abs=1e-6)
