import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.ray_picture import SIZE, cast
from trundle._core import draw_triangles

coordinate = st.floats(-3.0, 3.0)
triangle = st.tuples(*[st.tuples(coordinate, coordinate, st.floats(-1.0, 6.0))] * 3)


@settings(deadline=None)
@given(st.lists(triangle, min_size=1, max_size=4), st.booleans())
def test_each_pixel_shows_what_its_ray_meets_first(triangles, perspective):
    corners = np.array(triangles, dtype=np.float64)
    faces, depths = draw_triangles(corners, SIZE, SIZE, 6.0, 0.1, perspective)
    expected, distances, doubt = cast(corners, 6.0, 0.1, perspective)
    sure = doubt > 1e-6
    assert np.array_equal(faces[sure], expected[sure])
    assert np.allclose(depths[sure], distances[sure], rtol=1e-6, atol=1e-6)


def test_a_face_cut_by_the_near_plane_has_no_hole_where_its_parts_meet():
    face = np.array([[[0.0, 0.0, 5.0], [2.5, 0.5, 2.5], [-2.5, 0.5, -0.5]]])
    faces, depths = draw_triangles(face, SIZE, SIZE, 1.0, 0.1, True)
    assert faces[6, 3] == 0
    assert depths[6, 3] == pytest.approx(0.3184713375796178)


def test_an_empty_scene_shows_nothing():
    faces, depths = draw_triangles(np.zeros((0, 3, 3)), 4, 3, 1.0, 0.1, True)
    assert faces.shape == (3, 4)
    assert (faces == -1).all()
    assert np.isinf(depths).all()


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e300, -1e300])
def test_wild_numbers_draw_nothing_outside_the_picture(value):
    corners = np.array([[[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, value, 2.0]], [[value] * 3] * 3])
    for perspective in (True, False):
        faces, _ = draw_triangles(corners, 8, 8, 4.0, 0.1, perspective)
        assert faces.shape == (8, 8)


def test_bad_arguments_are_refused():
    triangle = np.zeros((1, 3, 3))
    for arguments in (
        (np.zeros((1, 4, 3)), 4, 4, 1.0, 0.1, True),
        (triangle, 0, 4, 1.0, 0.1, True),
        (triangle, 2**20, 2**20, 1.0, 0.1, True),
        (triangle, 4, 4, 0.0, 0.1, True),
        (triangle, 4, 4, math.nan, 0.1, True),
        (triangle, 4, 4, 1.0, 0.0, True),
    ):
        with pytest.raises(ValueError, match="need"):
            draw_triangles(*arguments)
