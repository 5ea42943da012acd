"""A control period of an ideal robot, against the same in Python: equal to the bit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.period_oracle import drive_period as drive_slowly
from trundle._core import drive_period
from trundle.geometry import Twist2D
from trundle.robots import Robot
from trundle.sim.ramp import CommandRamp

LIMITS = np.array([1.2, 0.6, 2.0, 0.0125, 0.025, 0.14, 0.413, 6.0, 0.005])
AT_REST = np.zeros(11)

speeds = st.floats(-3.0, 3.0) | st.just(0.0)


def same(found, expected):
    assert np.array_equal(found[0], expected[0])
    assert found[1:] == expected[1:]


def test_a_straight_line_speeds_up_and_then_is_even():
    rows, (west, east, south, north), is_cut = drive_period(AT_REST, 0.05, 0.0, LIMITS, 10)
    assert rows[:, 7].tolist() == pytest.approx([0.0125, 0.025, 0.0375] + [0.05] * 7)
    assert rows[-1, 0] == pytest.approx(0.005 * (0.075 + 7 * 0.05))
    assert (west, east) == (rows[0, 0], rows[-1, 0])
    assert (south, north, is_cut) == (0.0, 0.0, False)
    assert rows[-1, 3] == rows[-1, 4] == pytest.approx(rows[-1, 0] / 0.14)


def test_a_command_above_the_limits_is_cut():
    rows, _, is_cut = drive_period(AT_REST, -5.0, 0.0, np.where(np.arange(9) == 7, math.inf, LIMITS), 100)
    assert is_cut
    assert rows[-1, 7] == -0.6


def test_wheels_turn_no_faster_than_they_can():
    rows, _, is_cut = drive_period(AT_REST, 1.0, 1.0, LIMITS, 400)
    assert is_cut
    assert np.abs(rows[:, 9:]).max() == 6.0
    assert rows[-1, 5] == 1.0 > rows[-1, 7]


@given(
    first=st.tuples(speeds, speeds),
    second=st.tuples(speeds, speeds),
    yaw=st.floats(-4.0, 4.0),
    steps=st.integers(1, 30),
)
def test_it_is_the_same_in_python(first, second, yaw, steps):
    state = np.array([1.0, -2.0, yaw, *[0.0] * 8])
    for command in (first, second, second):
        found = drive_period(state, *command, LIMITS, steps)
        same(found, drive_slowly(state, *command, LIMITS, steps))
        state = found[0][-1]


@given(first=st.tuples(speeds, speeds), second=st.tuples(speeds, speeds))
def test_the_ramp_is_that_of_the_other_simulators(first, second):
    ramp, state = CommandRamp(Robot.load("nova_carter"), 0.005), AT_REST
    for command in (first, second):
        motions = ramp.advance(Twist2D(*command), 10)
        rows, _, _ = drive_period(state, *command, ramp.numbers, 10)
        assert rows[:, 7:].tolist() == [list(motion) for motion in motions]
        state = rows[-1]


@pytest.mark.parametrize(
    "arguments",
    [
        (np.zeros(10), 0.1, 0.0, LIMITS, 10),
        (AT_REST, 0.1, 0.0, LIMITS[:8], 10),
        (AT_REST, 0.1, 0.0, np.zeros(9), 10),
        (AT_REST, 0.1, 0.0, LIMITS, 0),
    ],
)
def test_other_shapes_and_no_steps_are_refused(arguments):
    with pytest.raises(ValueError, match=r"numbers|positive|steps"):
        drive_period(*arguments)
