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
    data = generator.choice(np.array([-1, 0, 0, 0, 0, 40, 80, 100], dtype=np.int8), shape)
    return OccupancyGrid(data, 0.1, Pose2D(*generator.uniform(-5, 5, 2), yaw))


def squares(grid: OccupancyGrid, where: np.ndarray) -> np.ndarray:
    rows, cols = np.nonzero(where)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    local = (np.stack([cols, rows], axis=1)[:, None, :] + corners) * grid.resolution
    return shapely.polygons(grid.origin.transform_points(local.reshape(-1, 2)).reshape(-1, 4, 2))


def care(values) -> np.ndarray:
    """Position of cell values in the order free, 1 to 64, unknown, 65 to 99, occupied."""
    order = [*range(65), -1, *range(65, 101)]
    return np.array([order.index(value) for value in np.ravel(values)])


yaws = st.one_of(
    st.floats(-math.pi, math.pi),
    st.sampled_from([0.0, 1.5708, -math.pi / 2, math.pi, 1e-5, 0.001, math.pi / 4]),
)


@pytest.mark.slow
@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 1000), yaw=yaws, resolution=st.sampled_from([None, 0.05, 0.07, 0.17, 0.3, 1.1]))
def test_a_cell_has_the_most_careful_value_of_all_that_it_overlaps(seed, yaw, resolution):
    grid = random_grid(seed, yaw)
    aligned = resample_axis_aligned(grid, resolution=resolution)
    assert aligned.origin.yaw == 0.0
    everything = squares(aligned, np.ones(aligned.shape, dtype=bool))
    found = care(aligned.data)
    # Edges may be moved by a fiftieth of a cell, so that each old cell is once a bit smaller and once a bit larger.
    for change, is_bound in ((-0.0021, np.less_equal), (0.0021, np.greater_equal)):
        bound = np.zeros(len(found), dtype=int)
        whole = shapely.buffer(shapely.unary_union(squares(grid, np.ones(grid.shape, dtype=bool))), -change)
        bound[~shapely.covers(whole, everything)] = care(-1)[0]
        for value in (40, -1, 80, 100):
            tree = shapely.STRtree(shapely.buffer(squares(grid, grid.data == value), change, join_style="mitre"))
            hit = tree.query(everything, predicate="intersects")[0]
            bound[hit] = np.maximum(bound[hit], care(value)[0])
        assert is_bound(bound, found).all()


@pytest.mark.parametrize("resolution", [0.1, 0.05, 0.1 / 3])
def test_finer_cells_and_back_are_lossless(resolution):
    grid = random_grid(3, 0.0)
    finer = resample_axis_aligned(grid, resolution=resolution)
    times = round(0.1 / resolution)
    assert np.array_equal(finer.data, np.kron(grid.data, np.ones((times, times), dtype=np.int8)))
    again = resample_axis_aligned(finer, resolution=0.1)
    assert np.array_equal(again.data, grid.data)
    assert again.origin == grid.origin


def test_coarser_cells_by_hand():
    data = np.array([[0, 0, 0, -1, 0], [0, 0, 0, 0, 0], [0, 40, -1, 80, 0]], dtype=np.int8)
    grid = OccupancyGrid(data, 0.1, Pose2D(1.0, 2.0))
    assert resample_axis_aligned(grid, resolution=0.2).data.tolist() == [[0, -1, -1], [-1, 80, -1]]
    # Of 0.15 m: the columns 0 to 1.5, 1.5 to 3, 3 to 4.5 and 4.5 to 6.
    assert resample_axis_aligned(grid, resolution=0.15).data.tolist() == [[0, 0, -1, -1], [40, -1, 80, -1]]


@pytest.mark.parametrize("resolution", [0.1 + 1e-9, 0.10000000149011612, 0.05000000074505806])
def test_a_resolution_of_single_precision_is_the_same_lattice(resolution):
    grid = random_grid(3, 0.0)
    times = round(0.1 / resolution)
    expected = np.kron(grid.data, np.ones((times, times), dtype=np.int8))
    assert np.array_equal(resample_axis_aligned(grid, resolution=resolution).data, expected)


def test_a_yaw_of_four_decimals_is_a_quarter_turn():
    grid = random_grid(7, 1.5708)
    aligned = resample_axis_aligned(grid)
    assert np.array_equal(aligned.data, np.rot90(grid.data[::-1])[::-1])
    assert aligned.origin.as_tuple() == pytest.approx((grid.origin.x - 2.0, grid.origin.y, 0.0), abs=1e-12)


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
    with pytest.raises(MapError, match="more than 100 cells"):
        resample_axis_aligned(random_grid(1, 0.1), max_cells=100)
