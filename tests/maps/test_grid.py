from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid


@given(
    origin=st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-math.pi, math.pi)),
    resolution=st.floats(1e-3, 10.0),
    cell=st.tuples(st.integers(-50, 5000), st.integers(-50, 5000)),
)
def test_a_cells_centre_lies_in_the_cell_for_any_origin_and_yaw(origin, resolution, cell):
    grid = OccupancyGrid(np.zeros((1, 1), dtype=np.int8), resolution, Pose2D(*origin))
    row, col = grid.world_to_cell(*grid.cell_to_world(*cell))
    assert (int(row), int(col)) == cell


@given(
    origin=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(-math.pi, math.pi)),
    resolution=st.floats(1e-2, 10.0),
    point=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3)),
)
def test_a_point_is_within_half_a_cell_of_its_cells_centre(origin, resolution, point):
    grid = OccupancyGrid(np.zeros((1, 1), dtype=np.int8), resolution, Pose2D(*origin))
    x, y = grid.cell_to_world(*grid.world_to_cell(*point))
    turned = Pose2D(0.0, 0.0, -grid.origin.yaw).transform_points([(x - point[0], y - point[1])])[0]
    assert np.abs(turned).max() <= resolution / 2 + 1e-9


def test_conversions_are_vectorised():
    grid = OccupancyGrid(np.zeros((4, 5), dtype=np.int8), 0.5, Pose2D(1.0, 2.0, 0.3))
    rows, cols = np.meshgrid(np.arange(4), np.arange(5), indexing="ij")
    x, y = grid.cell_to_world(rows, cols)
    assert x.shape == y.shape == (4, 5)
    back = grid.world_to_cell(x, y)
    assert np.array_equal(back, (rows, cols))
    assert grid.contains(*back).all()
    assert grid.contains([-1, 0, 4, 0], [0, -1, 0, 5]).tolist() == [False] * 4


def test_the_data_is_copied_and_read_only():
    source = np.zeros((2, 3), dtype=np.int64)
    grid = OccupancyGrid(source, 1.0)
    source[0, 0] = 100
    assert grid.data[0, 0] == 0
    assert grid.data.dtype == np.int8
    with pytest.raises(ValueError, match="read-only"):
        grid.data[0, 0] = 1


@pytest.mark.parametrize(
    "data", [np.zeros(3), np.zeros((0, 3)), np.zeros((2, 2)), np.full((2, 2), 101), np.full((2, 2), -2), [["a"]]]
)
def test_data_that_is_no_grid_is_refused(data):
    with pytest.raises(MapError, match="occupancy grid"):
        OccupancyGrid(data, 0.05)


@pytest.mark.parametrize("resolution", [0.0, -1.0, math.nan, math.inf])
def test_a_resolution_that_is_none_is_refused(resolution):
    with pytest.raises(MapError, match="resolution"):
        OccupancyGrid(np.zeros((1, 1), dtype=np.int8), resolution)
