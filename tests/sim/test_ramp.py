import math

import pytest

from trundle.errors import InputError
from trundle.geometry import Twist2D
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.ramp import CommandRamp, count_steps


@pytest.mark.parametrize("name", ["nova_carter", "turtlebot3_burger"])
def test_every_step_is_that_of_the_limits(name):
    robot = Robot.load(name)
    ramp = CommandRamp(robot, 0.005)
    twist = Twist2D()
    for command in (Twist2D(9.0, -9.0), Twist2D(-0.1, 0.3), Twist2D(0.05, 0.0), Twist2D(0.05, 0.0)):
        for motion in ramp.advance(command, 37):
            twist = robot.limits.approach(twist, command, 0.005)
            assert (motion.v, motion.w) == (twist.v, twist.w)
            assert (motion.left, motion.right) == pytest.approx(robot.wheel_speeds(twist), abs=1e-12)


def test_a_wheels_own_limit_holds_and_the_twist_is_what_the_wheels_drive():
    robot = Robot.load("nova_carter")
    drive = robot.drive.model_copy(update={"max_wheel_speed": 5.0})
    robot = robot.model_copy(update={"drive": drive})
    motion = CommandRamp(robot, 0.005).advance(Twist2D(0.8, 0.5), 200)[-1]
    assert motion.right == 5.0
    twist = drive.twist(WheelSpeeds(motion.left, motion.right))
    assert (motion.v, motion.w) == pytest.approx((twist.v, twist.w))


@pytest.mark.parametrize(("dt", "steps"), [(0.005, 1), (0.05, 10), (0.1, 20), (1.0, 200)])
def test_a_period_is_a_number_of_steps(dt, steps):
    assert count_steps(dt, 0.005) == steps


@pytest.mark.parametrize("dt", [0.0, -0.05, 0.0125, 1.0 / 30.0, math.nan, math.inf])
def test_any_other_period_is_refused(dt):
    with pytest.raises(InputError, match=r"not a multiple of the physics step of 0\.005 s"):
        count_steps(dt, 0.005)


def test_a_period_of_too_many_steps_is_refused():
    with pytest.raises(InputError, match="more than 10,000,000"):
        count_steps(200.0, 1e-5)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (Twist2D(5.0, 0.0), "(5 m/s, 0 rad/s) is above the limits of nova_carter and is clipped to (0.8 m/s, 0 rad/s)"),
        (Twist2D(0.0, -2.0), "(0 m/s, -2 rad/s) is above the limits of nova_carter and is clipped to (0 m/s, -0.7 rad"),
    ],
)
def test_a_clipped_command_is_reported_once(command, message, caplog):
    ramp = CommandRamp(Robot.load("nova_carter"), 0.005)
    for _ in range(3):
        ramp.advance(command, 10)
    ramp.reset()
    ramp.advance(command, 10)
    assert [message in record.getMessage() for record in caplog.records] == [True]


def test_a_clipped_wheel_is_reported_once(caplog):
    robot = Robot.load("nova_carter")
    robot = robot.model_copy(update={"drive": robot.drive.model_copy(update={"max_wheel_speed": 3.0})})
    ramp = CommandRamp(robot, 0.005)
    ramp.advance(Twist2D(0.4, 0.0), 200)
    assert caplog.records == []
    ramp.advance(Twist2D(0.8, 0.0), 200)
    assert ["clipped to 3 rad/s, the drive's max_wheel_speed" in record.getMessage() for record in caplog.records] == [
        True
    ]


def test_a_command_at_the_limits_is_not_reported(caplog):
    ramp = CommandRamp(Robot.load("nova_carter"), 0.005)
    ramp.advance(Twist2D(0.8 + 1e-12, -0.7), 100)
    assert caplog.records == []
