import math

import numpy as np
import pytest

from trundle.control.mppi.guide import Route
from trundle.geometry import Pose2D
from trundle.path import Path

CUSP = Path(
    np.array([[0, 0, 0], [2, 0, 0], [1, 0, 0], [1, 0, math.pi / 2], [1, 2, math.pi / 2]]),
    backward=np.array([False, True, False, False]),
)


def test_it_keeps_corners_directions_and_length():
    route = Route(CUSP)
    assert route.along[-1] == pytest.approx(CUSP.length)
    assert np.hypot(*np.diff(route.poses[:, :2], axis=0).T).max() <= 0.05 + 1e-9
    for pose in CUSP.poses:
        assert np.abs(route.poses - pose).sum(axis=1).min() < 1e-9
    driven = route.along[route.backward]
    assert (driven.min(), driven.max()) == (pytest.approx(2.05), pytest.approx(3.0))


def test_the_robot_is_found_ahead_of_where_it_was():
    route = Route(Path(np.array([[0, 0, 0], [4, 0, 0]])))
    for x in np.linspace(0.0, 4.0, 30):
        route.advance(Pose2D(float(x), 0.3))
        assert route.left_m == pytest.approx(4.0 - x, abs=0.03)
    route.advance(Pose2D(1.0, 0.0))
    assert route.left_m == pytest.approx(0.0)


def test_it_does_not_pass_a_change_of_direction():
    route = Route(CUSP)
    for x in np.linspace(0.0, 2.0, 21):
        route.advance(Pose2D(float(x), 0.0))
    for _ in range(5):
        route.advance(Pose2D(1.0, 1.0))
    assert route.along[route.index] <= 2.0 + 1e-9


def test_what_is_left_begins_where_the_robot_is_and_ends_at_the_goal():
    route = Route(CUSP)
    route.jump(CUSP.length - 2.5)
    rest = route.rest(Pose2D(1.5, 0.1, 0.4))
    assert rest.start.as_tuple() == pytest.approx((1.5, 0.0, 0.4))
    assert rest.goal.as_tuple() == pytest.approx(CUSP.goal.as_tuple())
    assert rest.length == pytest.approx(CUSP.length - 2.5, abs=0.05)
    assert rest.backward.any()
    assert not rest.backward[-1]


def test_a_turn_in_place_alone_is_a_route():
    route = Route(Path(np.array([[1, 1, 0], [1, 1, 1.5]])))
    assert route.left_m == 0.0
    route.advance(Pose2D(1.0, 1.0, 0.2))
    assert route.index == len(route.poses) - 1


def test_its_last_turn_is_what_it_does_at_its_end():
    turn = [[0, 0, 0], [2, 0, 0], [2, 0, 1.0]]
    assert Route(Path(np.array(turn))).last_turn[[0, -1], 2].tolist() == [0.0, 1.0]
    assert Route(Path(np.array(turn[:2]))).last_turn.tolist() == [[2, 0, 0]]
    assert Route(Path(np.array(turn[:1]))).last_turn.tolist() == [[0, 0, 0]]
