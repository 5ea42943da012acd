"""Which contacts are counted as the robot's own."""

import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.mission.running.run_log import RunLog
from trundle.observation import Estimate
from trundle.robots import WheelSpeeds
from trundle.sim import Contact, MoverState, RobotState

STILL, STAND = WheelSpeeds(0.0, 0.0), Twist2D()
HERE = Pose2D(0.0, 0.0)


def make_log(*steps, moved_m=0.0):
    """A log of (what is touched, true speed [m/s], what was sent); the last step is so far [m] from the others."""
    log = RunLog()
    movers = (MoverState("cart", Pose2D(1.0, 0.0)),)
    for index, (names, speed, sent) in enumerate(steps):
        contacts = tuple(Contact("chassis", name, 0.0, 0.0) for name in names)
        pose = Pose2D(moved_m, 0.0) if index == len(steps) - 1 else HERE
        state = RobotState(0.05 * index, pose, Twist2D(speed, 0.0), STILL, STILL, HERE, contacts, movers=movers)
        log.add(state, sent, Estimate(0.05 * index, HERE), 0, None)
    return log


@pytest.mark.parametrize("other", ["rack", "cart2"])
def test_what_a_standing_robot_is_pushed_against_is_no_collision(other):
    log = make_log(((), 0.0, STAND), (("cart",), 0.4, STAND), (("cart", other), 0.4, STAND), ((other,), 0.1, STAND))
    assert tuple(log.standing_contacts) == ("cart", other)
    assert not log.contacts
    assert log.hit is None


def test_a_pushed_robot_that_drives_collides():
    log = make_log(((), 0.0, STAND), (("cart",), 0.4, STAND), (("cart", "rack"), 0.4, Twist2D(0.1, 0.0)))
    assert tuple(log.standing_contacts) == ("cart",)
    assert tuple(log.contacts) == ("rack",)


def test_a_push_that_is_over_spares_nothing_more():
    slides = [((), 0.4, STAND)]
    steps = [((), 0.0, STAND), (("cart",), 0.4, STAND), *slides, (("rack",), 0.3, STAND)]
    assert not make_log(*steps).contacts
    steps = [((), 0.0, STAND), (("cart",), 0.4, STAND), *(12 * slides), (("rack",), 0.3, STAND)]
    assert not make_log(*steps).contacts
    stops, drives, again = (
        [((), 0.0, STAND)],
        [((), 0.4, Twist2D(0.4, 0.0))],
        [((), 0.4, STAND), (("rack",), 0.3, STAND)],
    )
    for ends in (stops, drives):
        steps = [((), 0.0, STAND), (("cart",), 0.4, STAND), *(12 * slides), *ends, *again]
        assert not make_log(*steps[:2], *steps[-3:]).contacts  # at once
        assert tuple(make_log(*steps).contacts) == ("rack",)


def test_what_it_is_pushed_against_at_once_is_spared_too():
    log = make_log(((), 0.0, STAND), (("rack", "cart"), 0.4, STAND))
    assert tuple(log.standing_contacts) == ("rack", "cart")
    assert not log.contacts
    drives_off = Twist2D(0.1, 0.0)
    assert not make_log(((), 0.0, STAND), (("rack", "cart"), 0.4, drives_off)).contacts
    assert tuple(make_log(((), 0.1, STAND), (("rack", "cart"), 0.4, drives_off)).contacts) == ("rack", "cart")


def test_what_it_leans_against_after_a_push_is_the_same_touch_until_it_has_moved():
    pushed = [((), 0.0, STAND), (("cart", "rack"), 0.4, STAND), *(40 * [((), 0.0, STAND)])]
    creeps = Twist2D(0.01, 0.0)
    assert not make_log(*pushed, (("rack",), 0.01, creeps)).contacts
    assert tuple(make_log(*pushed, (("shelf",), 0.01, creeps)).contacts) == ("shelf",)
    assert tuple(make_log(*pushed, ((), 0.2, creeps), (("rack",), 0.2, creeps)).contacts) == ("rack",)
    assert tuple(make_log(*pushed, (("rack",), 0.01, creeps), moved_m=0.1).contacts) == ("rack",)


def test_a_robot_that_slides_back_after_a_push_touches_nothing_by_itself():
    pushed = [((), 0.0, STAND), (("cart",), 0.4, STAND)]
    waits = [((), 0.0, STAND)]
    assert not make_log(*pushed, *(40 * waits), (("rack",), 0.1, STAND)).contacts
    assert tuple(make_log(*pushed, *(40 * waits), (("rack",), 0.0, Twist2D(0.01, 0.0))).contacts) == ("rack",)
    assert tuple(make_log(*pushed, *(80 * waits), (("rack",), 0.1, STAND)).contacts) == ("rack",)
