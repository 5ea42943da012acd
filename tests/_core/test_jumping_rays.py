"""Rays that jump through a field of distances meet what rays from cell to cell meet, to the last bit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.ndimage import distance_transform_cdt

from trundle._core import cast_grid_rays, cast_jumping_rays, chebyshev_field

TURN = np.linspace(-math.pi, math.pi, 720)


def cells(share, shape, seed=0):
    return (np.random.default_rng(seed).random(shape) < share).astype(np.uint8)


@pytest.mark.parametrize("share", [0.0005, 0.01, 0.3, 1.0])
def test_the_field_is_the_chessboard_distance(share):
    blocked = cells(share, (300, 710))
    expected = np.minimum(distance_transform_cdt(1 - blocked, metric="chessboard"), 255)
    assert np.array_equal(chebyshev_field(blocked), expected)


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (0, 3), (400, 2)])
def test_the_field_of_nothing_blocked_is_as_far_as_a_byte_holds(shape):
    assert np.array_equal(chebyshev_field(np.zeros(shape, np.uint8)), np.full(shape, 255))


@pytest.mark.parametrize("reach", [0.0, 17.3, 240.0, 1e5])
@pytest.mark.parametrize("share", [0.0, 0.0005, 0.01, 0.2])
def test_rays_are_equal_bit_for_bit(share, reach):
    blocked = cells(share, (776, 480))
    field = chebyshev_field(blocked)
    for x, y in np.random.default_rng(1).uniform((0.0, 0.0), (480.0, 776.0), (40, 2)).tolist():
        walked, jumped = cast_grid_rays(blocked, x, y, TURN, reach), cast_jumping_rays(field, x, y, TURN, reach)
        assert walked.tobytes() == jumped.tobytes()


@given(
    place=st.tuples(st.integers(-2, 82), st.integers(-2, 62)),
    towards=st.lists(st.tuples(st.integers(0, 40), st.integers(0, 30)), min_size=1, max_size=40),
    share=st.sampled_from((0.003, 0.05)),
)
def test_rays_through_corners_of_cells_are_equal_bit_for_bit(place, towards, share):
    """From middles, borders and corners of cells, to corners."""
    blocked = cells(share, (30, 40))
    field, (x, y) = chebyshev_field(blocked), (place[0] / 2.0, place[1] / 2.0)
    angles = np.array([math.atan2(row - y, col - x) for col, row in towards])
    for turned in (angles, np.nextafter(angles, 9.0), np.round(angles / (math.pi / 8.0)) * (math.pi / 8.0)):
        walked, jumped = cast_grid_rays(blocked, x, y, turned, 90.0), cast_jumping_rays(field, x, y, turned, 90.0)
        assert walked.tobytes() == jumped.tobytes()


def test_a_long_ray_has_the_sum_of_the_walk():
    """Ten thousand cells, of which each adds its rounding."""
    blocked = np.zeros((5, 10_000), np.uint8)
    blocked[:, -1] = 1
    angles = np.linspace(-2e-4, 2e-4, 64)
    walked = cast_grid_rays(blocked, 0.3, 2.4, angles, 1e5)
    assert np.isfinite(walked).all()
    assert walked.tobytes() == cast_jumping_rays(chebyshev_field(blocked), 0.3, 2.4, angles, 1e5).tobytes()


@pytest.mark.parametrize(("x", "reach"), [(math.nan, 3.0), (math.inf, 3.0), (1.0, -1.0), (1.0, math.inf)])
def test_what_is_not_finite_is_refused(x, reach):
    with pytest.raises(ValueError, match="finite"):
        cast_jumping_rays(np.ones((2, 2), np.uint8), x, 1.0, np.zeros(1), reach)
