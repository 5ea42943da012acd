import math

import pytest

from trundle.doctor import needed_odometry
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.odometry_errors import OdometryErrors
from trundle.worlds import World

CARTER = Robot.load("nova_carter")


def off_after(distance, command=Twist2D(1.0, 0.0), **errors):
    """How far the odometry is from the truth [m] after a drive of this length [m]."""
    with OdometryErrors(**errors).simulate(KinematicSimulator(World("empty", ()), CARTER)) as sim:
        before = state = sim.reset(Pose2D(0.0, 0.0))
        driven = 0.0
        while driven < distance:
            state = sim.step(command, 0.05)
            driven += state.pose.distance_to(before.pose)
            before = state
        return state.pose.distance_to(state.odometry)


@pytest.mark.parametrize("distance", [10.0, 30.0])
def test_a_simulated_drive_with_these_errors_ends_at_the_edge_of_the_tolerance(distance):
    (need,) = needed_odometry([distance])
    assert need.tolerance == 0.25
    assert off_after(distance, scale=need.scale) == pytest.approx(0.25, rel=0.01)
    assert off_after(distance, heading=need.heading) == pytest.approx(0.25, rel=0.02)
    assert off_after(distance, heading=need.heading, command=Twist2D(1.0, 0.3)) < 0.25


def test_a_longer_mission_and_a_smaller_tolerance_need_more():
    short, long = needed_odometry()
    assert (short.distance, long.distance) == (10.0, 30.0)
    assert long.scale == pytest.approx(short.scale / 3.0)
    assert long.heading == pytest.approx(short.heading / 9.0)
    assert needed_odometry(tolerance=0.1)[0].scale == pytest.approx(0.01)


def test_one_degree_per_metre_is_too_much_for_ten_metres():
    assert math.degrees(needed_odometry()[0].heading) < 0.3


@pytest.mark.parametrize("given", [{"distances": [0.0]}, {"tolerance": -1.0}, {"tolerance": math.nan}])
def test_lengths_that_cannot_be_are_refused(given):
    with pytest.raises(InputError):
        needed_odometry(**given)
