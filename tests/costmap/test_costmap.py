import math
import pickle

import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from support.cost_grids import LONG, SQUARE, make_grid
from trundle.costmap import FREE_SPACE, INSCRIBED, LETHAL, NO_INFORMATION, Costmap
from trundle.errors import InputError, MapError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.robots import Robot


def expected_costs(data, resolution, inscribed, radius, factor):
    """Nav2's numbers from SciPy's exact distances."""
    blocked = (data < 0) | (data == 100)
    distances = scipy.ndimage.distance_transform_edt(~blocked) * resolution
    if not blocked.any():
        distances[:] = np.inf
    costs = (252.0 * np.exp(-factor * np.maximum(0.0, distances - inscribed))).astype(np.uint8)
    costs[distances > max(radius, inscribed) + 1e-9] = 0
    costs[distances <= inscribed + 1e-9] = INSCRIBED
    costs[data == 100] = LETHAL
    costs[data < 0] = NO_INFORMATION
    return costs


def test_one_obstacle_gives_nav2s_costs():
    data = np.zeros((1, 41), np.int8)
    data[0, 20] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), SQUARE, 0.5, 10.0)
    row = costmap.data[0]
    assert row[20] == LETHAL
    assert (row[16:20] == INSCRIBED).all()
    assert row[15] == int(252 * math.exp(-10 * (0.25 - 0.2)))
    assert row[10] == int(252 * math.exp(-10 * (0.5 - 0.2)))
    assert row[9] == FREE_SPACE
    assert (row == row[::-1]).all()


def test_unknown_stays_unknown_and_inflates():
    data = np.zeros((1, 9), np.int8)
    data[0, 0] = -1
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.1), SQUARE)
    assert costmap.data[0, 0] == NO_INFORMATION
    assert costmap.data[0, 1] == INSCRIBED


def test_only_100_is_occupied_as_in_nav2s_trinary_costmap():
    data = np.array([[0, 1, 65, 99, 0]], np.int8)
    assert (Costmap.from_grid(OccupancyGrid(data, 0.1), SQUARE).data == FREE_SPACE).all()


def test_the_inscribed_radius_is_kept_when_the_inflation_is_smaller():
    data = np.zeros((1, 9), np.int8)
    data[0, 4] = 100
    costs = Costmap.from_grid(OccupancyGrid(data, 0.1), SQUARE, 0.0).data[0]
    assert costs.tolist() == [0, 0, 253, 253, 254, 253, 253, 0, 0]


def test_the_default_inflation_reaches_past_the_circumscribed_radius():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((4, 4), np.int8), 0.05), Robot.load("nova_carter"))
    assert costmap.circumscribed_radius == pytest.approx(0.6565, abs=1e-3)
    assert costmap.inscribed_radius == pytest.approx(0.14)
    assert costmap.inflation_radius >= costmap.circumscribed_radius + 0.3 - 1e-12


@settings(max_examples=60, deadline=None)
@given(
    rows=st.sampled_from([1, 2, 3, 17, 40]),
    cols=st.sampled_from([1, 2, 31, 32, 33, 63, 64, 65, 127, 130, 200]),
    density=st.sampled_from([0.0, 0.001, 0.01, 0.1, 0.9]),
    radius=st.floats(0.0, 3.0),
    transpose=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_inflation_matches_scipy(rows, cols, density, radius, transpose, seed):
    grid = make_grid(cols, rows, density, seed) if transpose else make_grid(rows, cols, density, seed)
    costmap = Costmap.from_grid(grid, SQUARE, radius, 3.0)
    expected = expected_costs(grid.data, 0.05, costmap.inscribed_radius, radius, 3.0)
    np.testing.assert_array_equal(costmap.data, expected)


@pytest.mark.parametrize("radius_cells", [179, 180, 181, 182, 300])
def test_inflation_matches_scipy_where_squares_outgrow_16_bits(radius_cells):
    data = np.zeros((330, 401), np.int8)
    data[3, 7] = data[300, 390] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.1), SQUARE, radius_cells * 0.1, 0.02)
    expected = expected_costs(data, 0.1, costmap.inscribed_radius, radius_cells * 0.1, 0.02)
    np.testing.assert_array_equal(costmap.data, expected)


def test_a_costmap_cannot_be_written_to():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((3, 3), np.int8), 0.1), SQUARE)
    with pytest.raises(ValueError, match="read-only"):
        costmap.data[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        costmap.footprint[0, 0] = 1.0


def test_writable_costs_are_copied():
    data = np.zeros((3, 3), np.uint8)
    costmap = Costmap(data, 0.1, Pose2D(0, 0), np.array(SQUARE), 1.0)
    data[:] = LETHAL
    assert (costmap.data == 0).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"inflation_radius": -1.0}, "inflation_radius"),
        ({"inflation_radius": math.nan}, "inflation_radius"),
        ({"inflation_radius": 1e9}, "inflation_radius"),
        ({"inflation_radius": "1"}, "inflation_radius"),
        ({"cost_scaling_factor": "3"}, "cost_scaling_factor"),
        ({"cost_scaling_factor": -1.0}, "cost_scaling_factor"),
        ({"cost_scaling_factor": math.inf}, "cost_scaling_factor"),
    ],
)
def test_bad_inflation_numbers_are_named(options, message):
    with pytest.raises(InputError, match=message):
        Costmap.from_grid(OccupancyGrid(np.zeros((3, 3), np.int8), 0.1), SQUARE, **options)


@pytest.mark.parametrize(
    ("outline", "message"),
    [
        ([(0, 0), (1, 0)], "at least 3"),
        ([(1, 1), (-1, 1), (0, 0.2), (-1, -1), (1, -1)], "convex"),
        ([(1, 1), (2, 1), (2, 2), (1, 2)], "inside the footprint"),
        ([(1, 1), (math.nan, 1), (-1, -1)], "finite"),
        ([(1, 0), (-0.8, 0.6), (0.3, -0.95), (0.3, 0.95), (-0.8, -0.6)], "convex"),
    ],
)
def test_bad_footprints_are_refused(outline, message):
    with pytest.raises(InputError, match=message):
        Costmap.from_grid(OccupancyGrid(np.zeros((3, 3), np.int8), 0.1), outline)


@pytest.mark.parametrize(
    "data", [np.zeros((3, 3), np.int8), np.zeros(3, np.uint8), np.zeros((0, 3), np.uint8)], ids=["int8", "1d", "empty"]
)
def test_bad_costs_are_refused(data):
    with pytest.raises(MapError, match="uint8"):
        Costmap(data, 0.1, Pose2D(0, 0), np.array(SQUARE), 1.0)


@pytest.mark.parametrize("resolution", [0.0, -0.1, math.nan, math.inf, "0.1"])
def test_a_resolution_that_is_no_size_is_refused(resolution):
    with pytest.raises(MapError, match="resolution"):
        Costmap(np.zeros((3, 3), np.uint8), resolution, Pose2D(0, 0), SQUARE, 1.0)


def test_a_clockwise_outline_is_turned_round():
    grid = OccupancyGrid(np.zeros((3, 3), np.int8), 0.1)
    clockwise = Costmap.from_grid(grid, SQUARE[::-1]).footprint
    assert clockwise.tolist() == [list(corner) for corner in SQUARE]


def test_cost_at_reads_cells_and_is_unknown_outside():
    data = np.zeros((10, 20), np.int8)
    data[5, 7] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.5, Pose2D(-3.0, 2.0, 0.7)), SQUARE)
    x, y = costmap.cell_to_world([5, 0], [7, 19])
    assert costmap.cost_at(x, y).tolist() == [LETHAL, FREE_SPACE]
    assert costmap.cost_at(1e6, 0.0) == NO_INFORMATION
    assert costmap.cost_at([[1e6], [x[0]]], [[0.0], [y[0]]]).tolist() == [[NO_INFORMATION], [LETHAL]]


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(st.integers(1, 40), st.integers(1, 70)),
    radius=st.sampled_from([0.0, 0.3, 0.9]),
    masked=st.booleans(),
)
def test_local_updates_equal_a_rebuild(seed, shape, radius, masked):
    rng = np.random.default_rng(seed)
    data = make_grid(*shape, 0.05, seed).data.copy()
    keepout = None
    if masked:
        painted = rng.choice(np.array([0, 0, 0, 30, 100], dtype=np.int8), (5, 5))
        keepout = KeepoutMask(OccupancyGrid(painted, 0.13, Pose2D(-0.1, -0.2)))
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), LONG, radius, 3.0, keepout=keepout)
    for _ in range(3):
        row, col = int(rng.integers(shape[0])), int(rng.integers(shape[1]))
        rows = slice(row, int(rng.integers(row, shape[0])) + 1)
        cols = slice(col, int(rng.integers(col, shape[1])) + 1)
        values = rng.choice(np.array([-1, 0, 0, 0, 50, 100], dtype=np.int8), data[rows, cols].shape)
        data[rows, cols] = values
        costmap = costmap.update(rows, cols, values)
        rebuilt = Costmap.from_grid(OccupancyGrid(data, 0.05), LONG, radius, 3.0, keepout=keepout)
        assert (costmap.data == rebuilt.data).all()


def test_an_update_makes_a_new_costmap_and_leaves_the_old_one():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((40, 40), np.int8), 0.05, Pose2D(1.0, 2.0)), SQUARE)
    changed = costmap.update(slice(10, 12), slice(None), 100)
    assert (changed.data[10:12] == LETHAL).all()
    assert not costmap.data.any()
    assert (
        changed.update(slice(10, 12), slice(0, 40), np.zeros((2, 40), np.int8)).data.tolist() == costmap.data.tolist()
    )
    assert (changed.origin, changed.resolution) == (costmap.origin, costmap.resolution)
    assert not changed.data.flags.writeable


@pytest.mark.parametrize(
    ("rows", "cols", "values"),
    [
        (slice(0, 5), slice(0, 2), 100),
        (slice(2, 2), slice(0, 2), 100),
        (slice(-1, 2), slice(0, 2), 100),
        (slice(0, 4, 2), slice(0, 2), 100),
        (1, slice(0, 2), 100),
        (slice(0, 2), slice(0, 2), 101),
        (slice(0, 2), slice(0, 2), -2),
        (slice(0, 2), slice(0, 2), 0.5),
        (slice(0, 2), slice(0, 2), [[1], [0, 0]]),
        (slice(0, 2), slice(0, 2), None),
        (slice(0, 2), slice(0, 2), [100, 0]),
    ],
)
def test_what_cannot_be_updated_is_refused(rows, cols, values):
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((4, 4), np.int8), 0.05), SQUARE)
    with pytest.raises(InputError):
        costmap.update(rows, cols, values)


def test_what_is_kept_out_is_lethal_and_inflates_for_the_robot():
    painted = np.zeros((1, 41), np.int8)
    painted[0, 20] = 100
    mask = KeepoutMask(OccupancyGrid(painted, 0.05))
    free = OccupancyGrid(np.zeros((1, 41), np.int8), 0.05)
    costmap = Costmap.from_grid(free, SQUARE, 0.5, 10.0, keepout=mask)
    assert (costmap.data == Costmap.from_grid(OccupancyGrid(painted, 0.05), SQUARE, 0.5, 10.0).data).all()
    assert costmap.update(slice(0, 1), slice(0, 41), 0).data[0, 20] == LETHAL


def test_a_mask_raises_the_cost_of_free_cells_and_leaves_unknown_ones_unknown():
    grid = OccupancyGrid(np.array([[0, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]], np.int8), 0.1)
    mask = KeepoutMask(OccupancyGrid(np.full((1, 12), 50, np.int8), 0.1))
    data = Costmap.from_grid(grid, SQUARE, 0.3, keepout=mask).data[0]
    assert data[1] == NO_INFORMATION
    assert data[2] == INSCRIBED
    assert (data[5:] == 127).all()


def test_keepout_costs_of_another_shape_are_refused():
    with pytest.raises(MapError, match="keepout"):
        Costmap(np.zeros((2, 2), np.uint8), 0.1, Pose2D(0, 0), SQUARE, 0.5, keepout=np.zeros((2, 3), np.uint8))


def test_a_costmap_knows_what_changed_since_an_earlier_one():
    outline = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))
    floor = OccupancyGrid(np.zeros((60, 80), np.int8), 0.05)
    first = Costmap.from_grid(floor, outline)
    second = first.update(slice(10, 12), slice(20, 21), 100)
    third = second.update(slice(50, 55), slice(70, 71), -1)
    assert third.changes_since(third.version) == []
    assert len(third.changes_since(second.version)) == 1
    assert len(third.changes_since(first.version)) == 2
    assert first.changes_since(second.version) is None
    assert Costmap.from_grid(floor, outline).changes_since(first.version) is None
    changed = np.zeros((60, 80), bool)
    for rows, cols in third.changes_since(first.version):
        changed[rows, cols] = True
    assert (first.data == third.data)[~changed].all()
    last = third
    for _ in range(20):
        last = last.update(slice(0, 1), slice(0, 1), 0)
    assert last.changes_since(third.version) is None
    assert pickle.loads(pickle.dumps(last)).changes_since(last.version) is None
