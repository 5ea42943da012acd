import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.evaluation.row import MOST_POINTS, simplify
from trundle.mission.metrics import distances_to_polyline


def test_a_straight_line_is_its_ends():
    assert simplify(np.linspace([0.0, 0.0], [10.0, 5.0], 1000)) == (0.0, 0.0, 10.0, 5.0)


def test_corners_are_kept():
    corner = np.concatenate([np.linspace([0, 0], [4, 0], 50), np.linspace([4, 0], [4, 3], 50)])
    assert simplify(corner) == (0.0, 0.0, 4.0, 0.0, 4.0, 3.0)


def test_a_robot_that_did_not_move_is_one_place():
    assert set(simplify(np.full((40, 2), 1.5))) == {1.5}
    assert simplify(np.array([[1.0, 2.0]])) == (1.0, 2.0)


@pytest.mark.parametrize("most", [2, 5, MOST_POINTS])
def test_there_are_at_most_so_many_points(most):
    angle = np.linspace(0.0, 20.0 * np.pi, 5000)
    trail = simplify(np.column_stack([angle * np.cos(angle), angle * np.sin(angle)]), most)
    assert len(trail) == 2 * most


@given(st.lists(st.tuples(st.floats(-20, 20), st.floats(-20, 20)), min_size=1, max_size=60))
def test_all_points_are_near_what_is_kept(points):
    line = np.array(points)
    kept = np.array(simplify(line)).reshape(-1, 2)
    assert distances_to_polyline(line, kept).max() <= 0.01 + 0.008  # the tolerance, and half a diagonal of rounding
