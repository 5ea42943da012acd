import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.geometry import Twist2D
from trundle.robots import Limits

LIMITS = Limits(
    linear_speed=0.8, reverse_speed=0.3, angular_speed=0.7, linear_acceleration=2.5, angular_acceleration=3.2
)


def test_speeds_are_cut_each_on_its_own():
    assert LIMITS.clamp(Twist2D(2.0, -2.0)) == Twist2D(0.8, -0.7)
    assert LIMITS.clamp(Twist2D(-2.0, 0.1)) == Twist2D(-0.3, 0.1)


def test_without_a_reverse_speed_it_is_the_forward_one():
    limits = LIMITS.model_copy(update={"reverse_speed": None})
    assert limits.clamp(Twist2D(-2.0, 0.0)).v == -0.8


def test_approach_takes_one_step_and_does_not_overshoot():
    assert LIMITS.approach(Twist2D(), Twist2D(0.8, 0.7), 0.1) == Twist2D(0.25, 0.32000000000000006)
    assert LIMITS.approach(Twist2D(0.79, 0.0), Twist2D(0.8, 0.0), 0.1) == Twist2D(0.8, 0.0)
    assert LIMITS.approach(Twist2D(0.8, 0.0), Twist2D(0.0, 0.0), 0.1).v == pytest.approx(0.55)


@given(
    v=st.floats(-0.3, 0.8), w=st.floats(-0.7, 0.7), cv=st.floats(-9, 9), cw=st.floats(-9, 9), dt=st.floats(0.001, 1.0)
)
def test_approach_stays_within_all_limits(v, w, cv, cw, dt):
    after = LIMITS.approach(Twist2D(v, w), Twist2D(cv, cw), dt)
    assert -0.3 - 1e-12 <= after.v <= 0.8 + 1e-12
    assert abs(after.w) <= 0.7 + 1e-12
    assert abs(after.v - v) <= 2.5 * dt + 1e-12
    assert abs(after.w - w) <= 3.2 * dt + 1e-12
