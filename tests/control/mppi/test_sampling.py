"""Where MPPI samples, where it follows the path itself, and what it does where there is no room."""

import math
from dataclasses import replace

import numpy as np
import pytest

from support.mppi_runs import CARTER, DT, FEW, STRAIGHT, arrives, as_array, costmap_with, follow, scaled, walker
from trundle.control.mppi import MppiController
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.path import Path

# Handing over to the planned path ------------------------------------------------------------------------------------


def narrow(gap):
    """A corridor from x = -1 to 1 m with a gap [m] on each side of a Carter, on cell edges."""
    half = 0.25 + gap
    return costmap_with((-1.0, half + 0.01, 0.99, 1.5), (-1.0, -1.5, 0.99, -half - 0.01))


def where_it_samples(costmap, tracks=(), **settings):
    """The x [m] of each tick of a straight drive, and whether it drew samples there."""
    controller = MppiController(CARTER, **FEW, **settings)
    controller.set_tracks(tracks)
    xs, sampled = [], []
    pose, twist = STRAIGHT.start, Twist2D()
    controller.set_path(STRAIGHT)
    while pose.x < 2.9 and len(xs) < 400:
        twist = CARTER.limits.approach(twist, controller.compute_velocity(pose, twist, costmap, DT), DT)
        pose = twist.integrate(pose, DT)
        xs.append(pose.x)
        sampled.append(controller.rollouts() is not None)
        assert (controller.intent is not None) == sampled[-1]
        assert not costmap.footprint_collides(np.array(pose.as_tuple()))[0]
    assert pose.x > 2.9
    return np.array(xs), np.array(sampled)


def test_it_follows_the_path_itself_where_that_leaves_little_room():
    xs, sampled = where_it_samples(narrow(0.09), sampling_room=0.1)
    assert not sampled[(xs > -1.0) & (xs < 1.0)].any()
    assert sampled[(xs < -2.2) | (xs > 2.0)].all()
    changes = np.count_nonzero(sampled[1:] != sampled[:-1])
    assert changes == 2


@pytest.mark.slow
def test_it_draws_samples_where_there_is_room_or_it_is_told_to():
    assert where_it_samples(narrow(0.15))[1].all()
    xs, sampled = where_it_samples(narrow(0.1), sampling_room=0.2)
    assert not sampled[(xs > -1.0) & (xs < 1.0)].any()
    xs, sampled = where_it_samples(narrow(0.1), sampling_room=0.0)
    assert sampled[(xs > -1.0) & (xs < 1.0)].all()
    # What moves is predicted by the samples alone.
    xs, sampled = where_it_samples(narrow(0.1), [walker(0.0, 4.0, 0.5, 0.0)], sampling_room=0.2)
    assert sampled[(xs > -1.0) & (xs < 1.0)].all()


@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_the_room_that_samples_need_grows_with_the_robot(scale):
    robot = scaled(scale)
    assert MppiController(robot).settings.room_of(robot) == pytest.approx(0.01 * scale)


class Swaying:
    """Takes the place of the sampler: it drives to and fro, whatever the samples say."""

    def __init__(self, sampler):
        self.sampler, self.ticks = sampler, 0

    def __getattr__(self, name):
        return getattr(self.sampler, name)

    def step(self, *args):
        self.ticks += 1
        answer = self.sampler.step(*args)
        return replace(answer, command=Twist2D(0.5 if self.ticks % 60 < 30 else -0.5, 0.0))


def test_samples_that_bring_it_no_further_are_given_up_for_ever_longer_stretches():
    controller = MppiController(CARTER, **FEW)
    controller._sampler = Swaying(controller._sampler)
    sampled = []
    poses, twists, _ = follow(
        controller,
        STRAIGHT,
        costmap_with(),
        seconds=120.0,
        each=lambda time: sampled.append(controller.rollouts() is not None),
    )
    assert arrives(poses, STRAIGHT.goal)
    assert sum(abs(twist.v) for twist in twists) * DT < 20.0
    followed = np.flatnonzero(np.diff(np.array(sampled, np.int8)) == -1)
    assert 2 <= len(followed) <= 5


def test_it_turns_round_where_there_is_room_before_an_end_that_has_none():
    # The end is a bay of 0.9 m; a robot that faces away would have to turn in it.
    costmap = costmap_with((1.0, 0.45, 5.0, 5.0), (1.0, -5.0, 5.0, -0.45), (3.4, -0.45, 5.0, 0.45))
    poses, _, _ = follow(MppiController(CARTER, **FEW), STRAIGHT, costmap, start=Pose2D(-3.0, 0.0, math.pi))
    assert arrives(poses, STRAIGHT.goal)
    assert not costmap.footprint_collides(as_array(poses)).any()
    assert all(abs(wrap_angle(pose.yaw)) < 0.5 * math.pi for pose in poses if pose.x > 1.0)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_turns_at_the_end_in_the_direction_that_is_free(side):
    # A wall stands where the tail would pass in the shorter turn.
    low, high = sorted((-0.6 * side, -1.0 * side))
    costmap = costmap_with((-0.4, low, 0.4, high))
    turned = [(0.0, 0.0, -side * angle) for angle in (0.0, 1.84, 3.68)]
    path = Path(np.array([(-0.5, 0.0, 0.0), *turned]))
    start = Pose2D(-0.03, 0.0, 0.0)  # as near the end as counts as there
    poses, _, reasons = follow(MppiController(CARTER, **FEW), path, costmap, start=start)
    assert abs(wrap_angle(poses[-1].yaw - path.goal.yaw)) < 0.05
    assert costmap.clearance(as_array(poses)).min() > 0.02
    assert "the outline would touch something" not in reasons
