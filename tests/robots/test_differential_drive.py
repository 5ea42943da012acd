import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.geometry import Twist2D
from trundle.robots import DifferentialDrive, Robot, WheelSpeeds


def make_drive(**changes):
    values = {"wheel_radius": 0.03, "track_width": 0.1125, "left_joint": "left", "right_joint": "right"}
    return DifferentialDrive(**{**values, **changes})


def test_wheel_speeds_are_isaac_sims_known_answer():
    assert make_drive().wheel_command(Twist2D(0.3, 1.0)) == pytest.approx((8.125, 11.875), abs=1e-12)


def test_each_wheel_is_clipped_on_its_own_as_isaac_sim_clips():
    assert make_drive(max_wheel_speed=9.0).wheel_command(Twist2D(0.3, 1.0)) == pytest.approx((8.125, 9.0), abs=1e-12)


def test_v_and_w_are_clipped_before_the_wheels():
    drive = make_drive()
    command = drive.wheel_command(Twist2D(5.0, -7.0), max_linear_speed=0.3, max_angular_speed=1.0)
    assert command == pytest.approx((11.875, 8.125), abs=1e-12)


def test_straight_and_spin():
    drive = make_drive(wheel_radius=0.14, track_width=0.4132)
    assert drive.wheel_speeds(Twist2D(0.7, 0.0)) == pytest.approx((5.0, 5.0))
    spin = drive.wheel_speeds(Twist2D(0.0, 1.0))
    assert spin == pytest.approx((-0.2066 / 0.14, 0.2066 / 0.14))


@given(v=st.floats(-10, 10), w=st.floats(-10, 10), radius=st.floats(0.01, 1.0), track=st.floats(0.05, 2.0))
def test_forward_and_inverse_kinematics_are_inverse(v, w, radius, track):
    drive = make_drive(wheel_radius=radius, track_width=track)
    back = drive.twist(drive.wheel_speeds(Twist2D(v, w)))
    assert math.isclose(back.v, v, abs_tol=1e-9)
    assert math.isclose(back.w, w, abs_tol=1e-9)


@given(left=st.floats(-50, 50), right=st.floats(-50, 50))
def test_wheels_to_twist_and_back(left, right):
    drive = make_drive()
    assert drive.wheel_speeds(drive.twist(WheelSpeeds(left, right))) == pytest.approx((left, right), abs=1e-9)


def test_a_robots_command_holds_its_limits():
    robot = Robot.load("nova_carter")
    assert robot.wheel_command(Twist2D(9.0, 0.0)) == pytest.approx((0.8 / 0.14, 0.8 / 0.14))
    assert robot.twist(robot.wheel_speeds(Twist2D(0.3, 0.2))).v == pytest.approx(0.3)
