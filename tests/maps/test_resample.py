from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, resample_axis_aligned


def random_grid(seed: int, yaw: float, shape=(20, 30)) -> OccupancyGrid:
    generator = np.random.default_rng(seed)
    data = generator.choice(np.array([-1, 0, 0, 0, 40, 100], dtype=np.int8), shape)
    return OccupancyGrid(data, 0.1, Pose2D(*generator.uniform(-5, 5, 2), yaw))


def squares(grid: OccupancyGrid, where: np.ndarray) -> np.ndarray:
    rows, cols = np.nonzero(where)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    local = (np.stack([cols, rows], axis=1)[:, None, :] + corners) * grid.resolution
    return shapely.polygons(grid.origin.transform_points(local.reshape(-1, 2)).reshape(-1, 4, 2))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 1000), yaw=st.floats(-math.pi, math.pi), resolution=st.sampled_from([None, 0.05, 0.17]))
def test_no_obstacle_is_lost_and_the_rest_is_the_nearest_cell(seed, yaw, resolution):
    grid = random_grid(seed, yaw)
    aligned = resample_axis_aligned(grid, resolution=resolution)
    assert aligned.origin.yaw == 0.0
    everything = squares(aligned, np.ones(aligned.shape, dtype=bool))
    expected = np.full(aligned.data.size, -1)
    x, y = aligned.cell_to_world(*np.indices(aligned.shape))
    row, col = grid.world_to_cell(x.ravel(), y.ravel())
    inside = grid.contains(row, col)
    expected[inside] = grid.data[row[inside], col[inside]]
    least = expected.copy()
    for value in (40, 100):
        tree = shapely.STRtree(shapely.buffer(squares(grid, grid.data == value), -1e-5))
        hit = np.unique(tree.query(everything, predicate="intersects")[0])
        least[hit] = np.maximum(least[hit], value)
    most = expected.copy()
    for value in (40, 100):
        tree = shapely.STRtree(squares(grid, grid.data == value))
        hit = np.unique(tree.query(everything, predicate="intersects")[0])
        most[hit] = np.maximum(most[hit], value)
    assert (least <= aligned.data.ravel()).all()
    assert (aligned.data.ravel() <= most).all()


@pytest.mark.parametrize(("turns", "expected"), [(1, 1), (2, 2), (3, 3), (-1, 3)])
def test_quarter_turns_are_lossless(turns, expected):
    grid = random_grid(7, turns * math.pi / 2)
    assert np.array_equal(resample_axis_aligned(grid).data, np.rot90(grid.data[::-1], expected)[::-1])


def test_an_aligned_map_is_given_back():
    grid = random_grid(1, 0.0)
    assert resample_axis_aligned(grid) is grid


def test_what_cannot_be_is_refused():
    with pytest.raises(MapError, match="resolution"):
        resample_axis_aligned(random_grid(1, 0.1), resolution=0.0)
    with pytest.raises(MapError, match="use larger cells"):
        resample_axis_aligned(random_grid(1, 0.1), max_cells=100)
