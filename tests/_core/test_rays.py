"""Rays from far away and next to each other; that they are right is in tests/sim and tests/fuzz."""

import math

import numpy as np
import pytest

from trundle._core import cast_grid_rays, cast_outline_rays

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
