"""Rays from far away and next to each other; that they are right is in tests/sim and tests/fuzz."""

import math

import numpy as np
import pytest

from support.scan_compare_oracle import compare_scan as compare_slowly
from trundle._core import cast_grid_rays, cast_outline_rays, compare_scan

WALL = np.array([[2.0, -1.0, 2.0, 1.0]])
NO_DISCS = np.empty((0, 3))


@pytest.mark.parametrize("step", [1e-300, 5e-324, 1e-18])
@pytest.mark.parametrize("count", [1, 3])
def test_rays_that_lie_on_each_other_all_meet_the_wall(step, count):
    found = cast_outline_rays(WALL, NO_DISCS, 0.0, 0.0, 0.0, step, count, 10.0)
    assert found == pytest.approx([2.0] * count)
    assert np.isinf(cast_outline_rays(WALL, NO_DISCS, 0.0, 0.0, math.pi, step, count, 10.0)).all()


@pytest.mark.parametrize("away", [1e6, 1e19, 1e300])
def test_a_ray_from_far_away_meets_the_cells_or_nothing(away):
    blocked = np.ones((4, 4), np.uint8)
    (found,) = cast_grid_rays(blocked, -away, 2.0, np.array([0.0]), 2.0 * away)
    assert found == pytest.approx(away)
    assert np.isinf(cast_grid_rays(blocked, -away, 2.0, np.array([math.pi]), 2.0 * away)).all()


def test_points_against_a_scan_are_judged_as_in_numpy():
    rng = np.random.default_rng(3)
    bearings = np.arange(360) * math.radians(1.0)
    ranges = rng.uniform(1.0, 8.0, 360)
    through = np.minimum(np.minimum(ranges, np.roll(ranges, 1)), np.roll(ranges, -1))
    ends = np.column_stack([0.5 + ranges * np.cos(bearings + 0.3), -1.0 + ranges * np.sin(bearings + 0.3)])
    points = np.concatenate([rng.uniform(-8.0, 8.0, (300, 2)), ends + rng.normal(0.0, 0.02, ends.shape)])
    arguments = (bearings, through, ends, 0.5, -1.0, 0.3, math.radians(1.0), points, 0.07, 2)
    found = compare_scan(*arguments)
    assert np.array_equal(found, compare_slowly(*arguments))
    assert set(found.tolist()) == {0, 1, 2}


@pytest.mark.parametrize("aside", [-1, 17])
def test_too_many_beams_aside_are_refused(aside):
    nothing = np.empty((0, 2))
    with pytest.raises(ValueError, match="0 to 16 beams"):
        compare_scan(np.empty(0), np.empty(0), nothing, 0.0, 0.0, 0.0, 0.1, nothing, 0.1, aside)
