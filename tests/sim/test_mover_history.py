import numpy as np

from trundle.geometry import Pose2D
from trundle.sim import MoverState
from trundle.sim.mover_history import TRAIL_S, MoverHistory


def at(x):
    return (MoverState("cart", Pose2D(x, 0.0)), MoverState("person", Pose2D(0.0, 2.0 * x)))


def driven(seconds):
    history = MoverHistory()
    for step in range(round(seconds / 0.05) + 1):
        history.add(0.05 * step, at(0.05 * step))
    return history


def test_a_trail_reaches_back_eight_seconds_from_the_time_that_is_shown():
    history = driven(20.0)
    shown = history.at(12.01)
    assert [state.pose.x for state in shown.states] == [12.0, 0.0]
    cart, person = shown.trails
    np.testing.assert_allclose([cart[0, 0], cart[-1, 0]], [12.0 - TRAIL_S, 12.0])
    np.testing.assert_allclose(person[-1], [0.0, 24.0])
    assert len(history.trails()) == 2


def test_nothing_is_shown_before_the_first_step_and_without_movers():
    history = MoverHistory()
    history.add(0.0, ())
    assert len(history) == 0
    assert history.at(1.0) == ((), ())
    assert history.trails() == []
    assert driven(1.0).at(-0.5).states == ()


def test_a_time_that_starts_over_is_a_new_run():
    history = driven(5.0)
    history.add(0.0, at(7.0))
    assert [len(trail) for trail in history.at(5.0).trails] == [1, 1]
