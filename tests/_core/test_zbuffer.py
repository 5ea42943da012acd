import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle._core import draw_triangles

SIZE = 16


def cast(triangles, scale, near, perspective):
    """The oracle: every pixel's ray against every triangle; also how far from sure each answer is."""
    cols, rows = np.meshgrid(np.arange(SIZE) + 0.5 - SIZE / 2.0, SIZE / 2.0 - np.arange(SIZE) - 0.5)
    flat = np.stack([cols / scale, rows / scale, np.ones((SIZE, SIZE))], axis=-1)
    origins, rays = (flat * 0.0, flat) if perspective else (flat * (1.0, 1.0, 0.0), flat * (0.0, 0.0, 1.0))
    faces, depths = np.full((SIZE, SIZE), -1), np.full((SIZE, SIZE), math.inf)
    doubt = np.full((SIZE, SIZE), math.inf)
    for index, (a, b, c) in enumerate(triangles):
        normal = np.cross(b - a, c - a)
        across = rays @ normal
        edge_on = np.abs(across) < 1e-6
        t = np.where(edge_on, math.inf, ((a - origins) @ normal) / np.where(edge_on, 1.0, across))
        points = origins + rays * np.where(edge_on, 0.0, t)[..., None]
        sides = [np.cross(q - p, points - p) @ normal for p, q in ((a, b), (b, c), (c, a))]
        inside = np.min(sides, axis=0) / max(normal @ normal, 1e-12)
        doubt = np.where(edge_on, 0.0, np.minimum(doubt, np.abs(inside)))
        if perspective:
            doubt = np.where(edge_on, 0.0, np.minimum(doubt, np.abs(t - near)))
        met = ~edge_on & (inside > 0.0) & ((t > near) | (not perspective))
        rival = met & np.isfinite(depths)
        doubt[rival] = np.minimum(doubt[rival], np.abs(t[rival] - depths[rival]))
        nearer = met & (t < depths)
        faces[nearer], depths[nearer] = index, t[nearer]
    return faces, depths, doubt


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
