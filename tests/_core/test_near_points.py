"""Points near a robot, against the same in NumPy."""

import math

import numpy as np
import pytest

from support.near_points_oracle import outline_clearances as clearances_slowly
from support.near_points_oracle import points_around as points_slowly
from trundle._core import outline_clearances, points_around

OUTLINE = np.array([(0.3, -0.2), (0.3, 0.2), (-0.1, 0.2), (-0.1, -0.2)])
SIDES = np.array([(1.0, 0.0, 0.3), (0.0, 1.0, 0.2), (-1.0, 0.0, 0.1), (0.0, -1.0, 0.2)])
NOTHING, NO_TIMES, HERE = np.zeros((0, 2)), np.zeros(0), np.zeros((1, 3))
RNG = np.random.default_rng(4)
POINTS = RNG.uniform(-2.0, 2.0, (80, 2))
SOME_MOVE = np.where(RNG.random((80, 1)) < 0.2, RNG.uniform(-1.0, 1.0, (80, 2)), 0.0)
POSES = RNG.uniform(-1.0, 1.0, (6, 3))


@pytest.mark.parametrize("velocities", [NOTHING, SOME_MOVE], ids=["all stand", "some move"])
def test_points_around_a_pose_are_those_of_numpy(velocities):
    arguments = (POINTS, velocities, np.array((0.3, -0.2, 0.7)), 0.4, 1.1, 1.5)
    for found, expected in zip(points_around(*arguments), points_slowly(*arguments), strict=True):
        assert 0 < len(found) < len(POINTS)
        assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("rank", [1, 3])
@pytest.mark.parametrize("times", [NO_TIMES, np.linspace(0.0, 1.0, 6)], ids=["now", "later"])
def test_clearances_are_those_of_numpy(times, rank):
    arguments = (POINTS, SOME_MOVE, POSES, times, OUTLINE, SIDES, 0.3, rank)
    assert outline_clearances(*arguments) == pytest.approx(clearances_slowly(*arguments), abs=1e-12)


def test_a_point_in_front_is_as_far_as_the_outline_leaves():
    ahead = np.array([(0.5, 0.0)])
    for yaw, expected in ((0.0, 0.2), (math.pi, 0.4), (0.5 * math.pi, 0.3)):
        pose = np.array([(0.0, 0.0, yaw)])
        assert outline_clearances(ahead, 0.0 * ahead, pose, NO_TIMES, OUTLINE, SIDES, 1.0, 1) == pytest.approx(expected)


def test_with_fewer_points_than_the_rank_nothing_is_near():
    two = np.array([(0.4, 0.0), (0.0, 0.3)])
    assert outline_clearances(two, 0.0 * two, HERE, NO_TIMES, OUTLINE, SIDES, 1.0, 3).tolist() == [math.inf]
    assert outline_clearances(NOTHING, NOTHING, HERE, NO_TIMES, OUTLINE, SIDES, 1.0, 1).tolist() == [math.inf]


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("a velocity for each", (POINTS, NOTHING, HERE, NO_TIMES, OUTLINE, SIDES, 0.0, 1)),
        ("a time for each", (POINTS, SOME_MOVE, HERE, np.zeros(2), OUTLINE, SIDES, 0.0, 1)),
        ("rank", (POINTS, SOME_MOVE, HERE, NO_TIMES, OUTLINE, SIDES, 0.0, 0)),
        ("poses", (POINTS, SOME_MOVE, POINTS, NO_TIMES, OUTLINE, SIDES, 0.0, 1)),
    ],
)
def test_bad_arguments_are_refused(name, arguments):
    with pytest.raises(ValueError, match=name):
        outline_clearances(*arguments)
