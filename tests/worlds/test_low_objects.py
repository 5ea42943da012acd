"""Worlds without low objects: what a planar lidar sees is all that a robot could touch."""

import pytest
import scipy

from trundle.errors import InputError
from trundle.maps import OccupancyGrid
from trundle.worlds import World

BAND = (0.05, 0.62)
"""What Nova Carter could touch [m]."""
PLANES = (0.2, 0.297, 0.36, 0.418)
"""Heights of planar lidars' beams [m]."""
RESOLUTION = 0.0125
NEAR = 0.03
"""What is this near to something that is seen [m] is not a surprise."""

SIZES = {"warehouse": (22.0, 16.0), "office": (18.0, 14.0), "lot": (24.0, 22.0)}


def missed(world, plane):
    """Solid area [m²] that is free in what a lidar's plane shows, and can be reached there from the seed."""
    # Both maps of the bounds of the world, so that their cells are the same.
    low, high = world.bounds
    bounds = ((low[0], low[1]), (high[0], high[1]))
    solid = OccupancyGrid.from_world(world, resolution=RESOLUTION, z_range=BAND, bounds=bounds)
    seen = OccupancyGrid.from_world(world, resolution=RESOLUTION, z_range=(plane - 1e-4, plane + 1e-4), bounds=bounds)
    hidden = (solid.data == 100) & (scipy.ndimage.distance_transform_edt(seen.data != 100) * RESOLUTION > NEAR)
    return float((hidden & (seen.data == 0)).sum()) * RESOLUTION**2  # free is what can be reached


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(SIZES))
@pytest.mark.parametrize("plane", PLANES)
def test_a_lidar_sees_all_that_a_robot_could_touch(name, plane):
    for seed in range(2):
        world = World.generate(name, seed=seed, size=SIZES[name], low_objects=False)
        assert missed(world, plane) == 0.0, seed


@pytest.mark.parametrize("name", sorted(SIZES))
def test_otherwise_there_are_objects_that_it_misses(name):
    assert missed(World.generate(name, seed=1, size=SIZES[name]), 0.418) > 0.5


@pytest.mark.parametrize("name", sorted(SIZES))
def test_whether_there_are_low_objects_is_true_or_false(name):
    with pytest.raises(InputError, match=f"{name}: low_objects must be true or false, got 'no'"):
        World.generate(name, low_objects="no")


def test_forklifts_carry_crates_that_hide_their_forks():
    (crowd,) = World.generate("warehouse", low_objects=False, forklifts=1).movers
    for plane in PLANES:
        seen = [part for part in crowd.parts if part.bounds()[0][2] < plane < part.bounds()[1][2]]
        assert max(part.bounds()[1][0] for part in seen) == max(part.bounds()[1][0] for part in crowd.parts)
        assert max(part.bounds()[1][1] for part in seen) == max(part.bounds()[1][1] for part in crowd.parts)
    (bare,) = World.generate("warehouse", forklifts=1).movers
    assert bare.parts is None
