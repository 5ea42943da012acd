"""Rays from far away and next to each other; that they are right is in tests/sim and tests/fuzz."""

import math

import numpy as np
import pytest

from support.moved_points_oracle import find_moved as find_moved_slowly
from trundle._core import cast_grid_rays, cast_outline_rays, find_moved

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


def test_what_has_moved_is_found_as_in_numpy():
    """Two discs and a wall; one disc has moved."""
    rim = 0.3 * np.column_stack([np.cos(np.arange(8.0)), np.sin(np.arange(8.0))])
    wall = np.column_stack([np.full(60, 5.0), np.linspace(-2.0, 2.0, 60)])
    earlier = np.concatenate([rim + np.array((2.0, 1.5)), rim + np.array((2.0, -1.0)), wall])
    points = np.concatenate([rim + np.array((2.0, 0.5)), rim + np.array((2.0, -1.0)), wall])
    angles, here = np.linspace(-math.pi, math.pi, 720), np.zeros(3)
    through = np.where(np.abs(angles) < 0.5, 4.9, 0.0)
    nowhere = np.zeros(720)
    arguments = (points, here, angles, nowhere, earlier, here, angles, through, 0.5)
    velocities, moves, edges = find_moved(*arguments)
    assert moves
    assert velocities[:8] == pytest.approx(np.full((8, 2), (0.0, -2.0)))
    assert not velocities[8:].any()
    for found, expected in zip((velocities, moves, edges), find_moved_slowly(*arguments), strict=True):
        assert np.allclose(found, expected)


@pytest.mark.parametrize("sees", ["what comes", "what leaves"])
def test_all_of_a_thing_that_slides_along_the_beams_moves(sees):
    """A wall of 2 m passes at 0.5 m; only its ends tell."""
    earlier = np.column_stack([np.full(101, 0.5), np.linspace(-1.0, 1.0, 101)])
    points, angles, here = earlier + np.array((0.0, 0.3)), np.linspace(-math.pi, math.pi, 720), np.zeros(3)
    nothing, everywhere = np.full(720, -np.inf), np.full(720, 9.0)
    ends = np.where(np.abs(angles) > math.atan2(1.05, 0.5), everywhere, nothing)
    behind = np.where(angles < -math.atan2(0.75, 0.5), everywhere, nothing)
    through = (nothing, ends) if sees == "what comes" else (behind, nothing)
    arguments = (points, here, angles, through[0], earlier, here, angles, through[1], 0.25)
    velocities, moves, edges = find_moved(*arguments)
    assert moves
    assert velocities == pytest.approx(np.full((101, 2), (0.0, 1.2)))
    assert (len(edges) > 0) == (sees == "what comes")
    for found, expected in zip((velocities, moves, edges), find_moved_slowly(*arguments), strict=True):
        assert np.allclose(found, expected)


@pytest.mark.parametrize(
    ("index", "value", "message"),
    [
        (0, np.zeros((2, 3)), "points"),
        (1, np.zeros(2), "poses"),
        (2, np.zeros(3), "a range for each angle"),
        (7, np.zeros(3), "a range for each angle"),
        (8, 0.0, "one after the other"),
    ],
)
def test_scans_that_cannot_be_compared_are_refused(index, value, message):
    arguments = [*2 * [np.zeros((2, 2)), np.zeros(3), np.zeros(2), np.zeros(2)], 0.25]
    arguments[index] = value
    with pytest.raises(ValueError, match=message):
        find_moved(*arguments)
