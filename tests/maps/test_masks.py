import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask


def frame(rows, cols, resolution=0.05, origin=(0.0, 0.0, 0.0)):
    return OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), resolution, Pose2D(*origin))


def corners(grid, row, col):
    square = np.array([[col, row], [col + 1, row], [col + 1, row + 1], [col, row + 1]]) * grid.resolution
    return shapely.Polygon(grid.origin.transform_points(square))


def save_mask(folder, values, extra="", mode="raw", name="mask.yaml"):
    """Write a mask with a 0.5 m cell per value, and extra lines in the YAML."""
    path = folder / name
    OccupancyGrid(np.array(values, dtype=np.int8), 0.5).save(path, mode=mode)
    path.write_text(path.read_text() + extra)
    return path


def test_a_mask_on_the_maps_own_cells_keeps_out_exactly_its_cells():
    data = np.zeros((6, 8), dtype=np.int8)
    data[2, 3:5] = 100
    costs = KeepoutMask(OccupancyGrid(data, 0.05)).costs_on(frame(6, 8))
    assert (costs == np.where(data == 100, 254, 0)).all()


def test_a_coarser_mask_with_another_origin_keeps_out_all_cells_that_it_touches():
    # One cell of 0.1 m from x 0.12 to 0.22: it reaches into columns 2 (0.10..0.15) to 4 (0.20..0.25).
    costs = KeepoutMask(OccupancyGrid([[100]], 0.1, Pose2D(0.12, 0.12))).costs_on(frame(8, 8))
    expected = np.zeros((8, 8))
    expected[2:5, 2:5] = 254
    assert (costs == expected).all()


def test_a_finer_mask_keeps_out_a_cell_for_its_smallest_part():
    data = np.zeros((10, 10), dtype=np.int8)
    data[5, 9] = 100
    costs = KeepoutMask(OccupancyGrid(data, 0.01)).costs_on(frame(2, 2))
    assert costs.tolist() == [[0, 0], [0, 254]]


def test_values_between_raise_the_cost_as_in_nav2_and_unknown_says_nothing():
    mask = KeepoutMask(OccupancyGrid([[0, 1, 50, 99, 100, -1]], 0.05))
    assert mask.costs_on(frame(1, 6)).tolist() == [[0, 3, 127, 251, 254, 0]]


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    resolution=st.floats(0.02, 0.3),
    turn=st.sampled_from([0.0, math.pi / 2, 0.3, -2.0]),
    map_turn=st.sampled_from([0.0, 0.7]),
)
def test_no_kept_out_area_is_lost_whatever_the_frames(seed, resolution, turn, map_turn):
    rng = np.random.default_rng(seed)
    data = np.where(rng.random((5, 5)) < 0.2, 100, 0).astype(np.int8)
    grid = OccupancyGrid(data, resolution, Pose2D(*rng.uniform(0.2, 0.6, 2), turn))
    ground = frame(10, 12, 0.12, (-0.1, -0.2, map_turn))
    try:
        costs = KeepoutMask(grid).costs_on(ground)
    except MapError:
        zone = shapely.union_all([corners(grid, r, c) for r in range(5) for c in range(5)])
        assert (
            zone.intersection(shapely.union_all([corners(ground, r, c) for r in range(10) for c in range(12)])).area
            < 1e-6
        )
        return
    zone = shapely.union_all([corners(grid, row, col) for row, col in np.argwhere(data == 100)])
    shared = np.array([[corners(ground, r, c).intersection(zone).area for c in range(12)] for r in range(10)])
    # The resampling may leave out 2 % of a cell's edge, and takes in what it touches.
    least = 0.02 * min(resolution, 0.12) * 0.2
    assert (costs[shared > least] == 254).all()
    apart = np.array([[corners(ground, r, c).distance(zone) > 1e-6 for c in range(12)] for r in range(10)])
    assert (costs[apart & np.bool_(data.any())] == 0).all()


@pytest.mark.parametrize("origin", [(0.41, 0.0, 0.0), (-0.21, 0.0, 0.0), (0.0, 0.31, 0.0), (0.42, 0.3, 0.8)])
def test_a_mask_beside_the_map_is_refused(origin):
    mask = KeepoutMask(OccupancyGrid(np.full((4, 4), 100), 0.05, Pose2D(*origin)), "zones.yaml")
    with pytest.raises(MapError, match=r"zones\.yaml: the mask does not overlap the map: it covers x"):
        mask.costs_on(frame(6, 8))


def test_a_keepout_mask_is_read_as_a_ros_map(tmp_path):
    mask = KeepoutMask.load(save_mask(tmp_path, [[0, 100]], "type: 0\nbase: 0.0\nmultiplier: 1.0\n"))
    assert mask.grid.data.tolist() == [[0, 100]]
    assert mask.name.endswith("mask.yaml")


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ("type: 1\n", "not a keep-out mask: it has type 1, a speed mask in percent"),
        ("base: 100\nmultiplier: -1\n", "not a keep-out mask: it has base and multiplier"),
        ("type: 7\n", r"mask\.yaml:\d+:7: type is 7; it must be one of 0 \(a keep-out mask\)"),
        ("type: fast\n", "type is 'fast'; it must be a finite number"),
    ],
)
def test_another_kind_of_mask_is_no_keepout_mask(tmp_path, extra, message):
    with pytest.raises(MapError, match=message):
        KeepoutMask.load(save_mask(tmp_path, [[0, 100]], extra))


@pytest.mark.parametrize("grid", [None, 3, "mask.yaml", np.zeros((4, 4), np.int8)], ids=repr)
@pytest.mark.parametrize("kind", [KeepoutMask, SpeedMask])
def test_a_mask_needs_a_grid_and_is_loaded_from_a_path(kind, grid):
    with pytest.raises(MapError, match="needs an OccupancyGrid"):
        kind(grid)
    if not isinstance(grid, str):
        with pytest.raises(MapError, match=r"KeepoutMask\(grid\)"):
            kind.load(grid)


def test_a_missing_mask_is_named():
    for kind in (KeepoutMask, SpeedMask):
        with pytest.raises(MapError, match=r"nowhere\.yaml"):
            kind.load("nowhere.yaml")


def test_limits_are_base_and_multiplier_in_percent_of_the_top_speed():
    mask = SpeedMask(OccupancyGrid([[0, 40, 70]], 1.0), base=100.0, multiplier=-1.0)
    assert mask.limit_at([0.5, 1.5, 2.5], [0.5, 0.5, 0.5], 2.0) == pytest.approx([math.inf, 1.2, 0.6])


def test_limits_may_be_metres_a_second_and_there_are_none_beyond_the_mask():
    mask = SpeedMask(OccupancyGrid([[5]], 1.0, Pose2D(1.0, 1.0, math.pi / 2)), "absolute", multiplier=0.1)
    x, y = np.array([[0.5, 1.5], [0.5, 2.5]]), np.array([[1.5, 1.5], [0.5, 1.5]])
    assert mask.limit_at(x, y, 2.0).tolist() == [[0.5, math.inf], [math.inf, math.inf]]


def test_a_speed_masks_yaml_may_say_what_its_values_mean_and_the_caller_may_say_otherwise(tmp_path):
    path = save_mask(tmp_path, [[0, 60]], "type: 2\nbase: 0.2\nmultiplier: 0.01\n")
    assert SpeedMask.load(path).limits(2.0)[60] == pytest.approx(0.8)
    assert SpeedMask.load(path, unit="percent", base=0.0, multiplier=0.5).limits(2.0)[60] == pytest.approx(0.6)
    assert SpeedMask.load(save_mask(tmp_path, [[0, 60]], name="plain.yaml")).limits(2.0)[60] == pytest.approx(1.2)


def test_nav2s_tutorial_mask_of_mode_scale_is_slower_where_it_is_darker(tmp_path):
    path = save_mask(tmp_path, [[0, 40, 70]], "type: 1\nbase: 100.0\nmultiplier: -1.0\n", mode="scale")
    path.write_text(path.read_text().replace("0.65", "1.0").replace("0.196", "0.0"))
    mask = SpeedMask.load(path)
    assert mask.limit_at(mask.grid.cell_to_world(0, 1)[0], 0.25, 1.0) == pytest.approx(0.6, abs=0.011)
    assert mask.limit_at(mask.grid.cell_to_world(0, 2)[0], 0.25, 1.0) == pytest.approx(0.3, abs=0.011)
    assert mask.limit_at(0.25, 0.25, 1.0) == math.inf


@pytest.mark.parametrize(
    ("values", "options", "message"),
    [
        (
            [[0, 100]],
            {"base": 100.0, "multiplier": -1.0},
            r"at \(0.75, 0.25\) has 100, a limit of 100 \+ -1 · 100 = 0 %",
        ),
        ([[60, 0]], {"multiplier": 2.0}, r"= 120 %; a limit must be above 0 and at most 100 %"),
        ([[60, 0]], {"unit": "absolute", "base": -100.0}, r"= -40 m/s; a limit must be above 0 m/s"),
        ([[0, -1]], {}, r"at \(0.75, 0.25\) is unknown"),
        ([[0, 10]], {"unit": "knots"}, "unit is 'knots'"),
        ([[0, 10]], {"base": math.nan}, "must be finite"),
    ],
)
def test_limits_that_cannot_be_kept_are_refused(values, options, message):
    with pytest.raises(MapError, match=message):
        SpeedMask(OccupancyGrid(values, 0.5), **options)


@pytest.mark.parametrize("kind", [0, 3])
def test_another_kind_of_mask_is_no_speed_mask(tmp_path, kind):
    with pytest.raises(MapError, match=f"type {kind}, .* is not a speed mask"):
        SpeedMask.load(save_mask(tmp_path, [[0, 50]], f"type: {kind}\n"))
