from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from trundle.errors import MapError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, convert_grid, resample_axis_aligned

finite = st.floats(-3.0, 3.0)
yaws = st.one_of(st.floats(-math.pi, math.pi), st.sampled_from([0.0, 1.5708, math.pi]))
origins = st.tuples(finite, finite, yaws)


def random_grid(seed: int, origin=(0.0, 0.0, 0.0), resolution=0.1, shape=(12, 17)) -> OccupancyGrid:
    data = np.random.default_rng(seed).choice(np.array([-1, 0, 0, 0, 0, 0, 30, 70, 100], dtype=np.int8), shape)
    return OccupancyGrid(data, resolution, Pose2D(*origin))


def look_up(grid: OccupancyGrid, x, y):
    """Values at points, unknown outside."""
    row, col = grid.world_to_cell(x, y)
    inside = grid.contains(row, col)
    values = np.full(np.shape(x), -1)
    values[inside] = grid.data[row[inside], col[inside]]
    return values, inside


def points_in(grid: OccupancyGrid, where, steps=5):
    """Points all over some cells, a thirtieth of a cell away from their edges; shape (cells, points) for x and y."""
    rows, cols = np.nonzero(where)
    down, right = (part.ravel() for part in np.meshgrid(*2 * [np.linspace(-0.467, 0.467, steps)]))
    return grid.cell_to_world(rows[:, None] + down, cols[:, None] + right)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 1000),
    origin=origins,
    other_origin=st.none() | origins,
    other_resolution=st.sampled_from([0.1, 0.13, 0.05]),
    resolution=st.sampled_from([None, 0.05, 0.2, 0.07, 0.33]),
    align=st.booleans(),
    crop=st.sampled_from([None, "content", ((-20.0, -20.0), (0.4, 0.9)), ((-0.33, -20.0), (20.0, 20.0))]),
)
def test_no_obstacle_is_lost_and_free_is_free_all_over(
    seed, origin, other_origin, other_resolution, resolution, align, crop
):
    sources = [random_grid(seed, origin)]
    if other_origin is not None:
        sources.append(random_grid(seed + 1, other_origin, other_resolution))
    try:
        made = convert_grid(
            sources[0], other=dict(enumerate(sources)).get(1), resolution=resolution, align=align, crop=crop
        ).grid
    except MapError:
        assume(crop in (None, "content"))
        raise
    assert made.resolution == (resolution or 0.1)
    assert made.origin.yaw == (0.0 if align else sources[0].origin.yaw)
    for source in sources:
        for lowest in (65, 100):
            values, inside = look_up(made, *points_in(source, source.data >= lowest, 3))
            assert (values[inside] >= lowest).all()
            if crop is None or crop == "content":
                assert inside.all()
    x, y = points_in(made, made.data == 0)
    values = np.array([look_up(source, x, y)[0] for source in sources])
    assert (values.max(axis=0) < 65).all()
    whole = (values == 0).all(axis=2)
    assert whole.any(axis=0).all()


def test_nothing_asked_for_is_the_same_map():
    grid = random_grid(1, (1.0, 2.0, 0.7))
    made = convert_grid(grid)
    assert np.array_equal(made.grid.data, grid.data)
    assert (made.grid.origin, made.grid.resolution, made.losses) == (grid.origin, 0.1, ())


def test_a_crop_keeps_whole_cells_where_they_are():
    grid = random_grid(1, (-0.5, -0.2, 0.0))
    made = convert_grid(grid, crop=((0.0, 0.05), (0.5, 0.31)))
    assert np.array_equal(made.grid.data, grid.data[2:6, 5:10])
    assert made.grid.origin.as_tuple() == (0.0, 0.0, 0.0)
    gone = np.count_nonzero(grid.data != -1) - np.count_nonzero(made.grid.data != -1)
    assert [(loss.kind, loss.cells) for loss in made.losses] == [("cropped", gone)]


def test_a_crop_does_not_grow_a_map_and_may_be_smaller_than_a_cell():
    grid = random_grid(1)
    assert convert_grid(grid, crop=((-5.0, -5.0), (5.0, 5.0))).grid.shape == grid.shape
    assert convert_grid(grid, crop=((0.51, 0.52), (0.52, 0.53))).grid.data.tolist() == [[grid.data[5, 5]]]


def test_a_crop_of_a_turned_map_covers_the_rectangle_and_loses_nothing_in_it():
    grid = random_grid(4, (0.3, 0.1, 0.6), shape=(40, 40))
    made = convert_grid(grid, crop=((-0.2, 1.0), (0.9, 1.7))).grid
    assert made.origin.yaw == 0.6
    assert made.data.size < grid.data.size
    x, y = np.meshgrid(np.linspace(-0.19, 0.89, 30), np.linspace(1.01, 1.69, 30))
    assert np.array_equal(look_up(made, x, y)[0], look_up(grid, x, y)[0])


def test_a_crop_may_make_a_resolution_possible():
    grid = random_grid(1)
    with pytest.raises(MapError, match="more than 1000 cells"):
        convert_grid(grid, resolution=0.01, max_cells=1000)
    assert convert_grid(grid, resolution=0.01, max_cells=1000, crop=((0, 0), (0.2, 0.2))).grid.shape == (20, 20)


def test_a_crop_to_the_content_drops_unknown_borders_alone():
    data = np.full((6, 8), -1)
    data[1:4, 2:7] = 0
    data[2, 4] = -1
    made = convert_grid(OccupancyGrid(data, 0.5, Pose2D(1.0, 1.0)), crop="content")
    assert made.grid.data.tolist() == data[1:4, 2:7].tolist()
    assert made.grid.origin == Pose2D(2.0, 1.5)
    assert made.losses == ()


@pytest.mark.parametrize(
    ("prefer", "expected"),
    [
        ("occupied", [100, 100, 40, 100, 100, 0, -1]),
        ("free", [0, 0, 0, 100, 100, 0, -1]),
        ("first", [0, 100, 40, 100, 100, 0, -1]),
        ("second", [100, 0, 0, 100, 100, 0, -1]),
    ],
)
def test_which_map_wins(prefer, expected):
    first = OccupancyGrid(np.array([[0, 100, 40, 100, -1, 0, -1]]), 0.1)
    second = OccupancyGrid(np.array([[100, 0, 0, -1, 100, -1, -1]]), 0.1)
    made = convert_grid(first, other=second, prefer=prefer)
    assert made.grid.data.tolist() == [expected]
    (loss,) = made.losses
    assert (loss.kind, loss.cells) == ("disagreement", 3)
    assert "2 of them occupied in one of them alone" in loss.message


def test_maps_side_by_side_are_joined_without_loss():
    whole = random_grid(5, (-1.0, 0.5, 0.0), shape=(10, 20))
    left = OccupancyGrid(whole.data[:7, :12], 0.1, whole.origin)
    right = OccupancyGrid(whole.data[2:, 8:], 0.1, Pose2D(-0.2, 0.7, 0.0))
    expected = whole.data.copy()
    expected[7:, :8] = expected[:2, 12:] = -1
    for first, second in ((left, right), (right, left)):
        made = convert_grid(first, other=second)
        assert np.array_equal(made.grid.data, expected)
        assert made.grid.origin.as_tuple() == pytest.approx(whole.origin.as_tuple(), abs=1e-12)
        assert [loss for loss in made.losses if loss.kind != "moved"] == []


def test_a_second_map_half_a_cell_off_grows_and_the_first_does_not():
    first = OccupancyGrid(np.array([[100, 0, 0, 0]]), 0.1)
    second = OccupancyGrid(np.array([[0, 0, 100]]), 0.1, Pose2D(0.15, 0.0))
    made = convert_grid(first, other=second)
    assert made.grid.data.tolist() == [[100, 0, 0, 100, 100]]
    assert [loss.kind for loss in made.losses] == ["resampled", "disagreement"]
    assert made.losses[0].message.startswith("the second map ")


@pytest.mark.parametrize("side", [101, 1001])
def test_far_coarser_cells_lose_no_obstacle_at_the_border(side):
    data = np.zeros((side, side), dtype=np.int8)
    data[-1, :] = 100
    grid = OccupancyGrid(data, 0.01)
    for made in (convert_grid(grid, resolution=1.0).grid, resample_axis_aligned(grid, resolution=1.0)):
        assert made.shape == (side // 100 + 1, side // 100 + 1)
        assert (made.data[-1] == 100).all()


def test_what_is_lost_is_said():
    grid = random_grid(2, (0.0, 0.0, 0.5))
    kinds = {
        "coarser": [loss.kind for loss in convert_grid(grid, resolution=0.2).losses],
        "finer": [loss.kind for loss in convert_grid(grid, resolution=0.05).losses],
        "aligned": [loss.kind for loss in convert_grid(grid, align=True).losses],
        "rounded": [loss.kind for loss in convert_grid(random_grid(2, (0, 0, 1.5708)), align=True).losses],
    }
    assert kinds == {"coarser": ["resampled"], "finer": [], "aligned": ["resampled"], "rounded": ["moved"]}
    assert "turned by 28.65°" in convert_grid(grid, align=True).losses[0].message


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": 0.0}, "resolution must be a positive"),
        ({"resolution": -1.0}, "resolution must be a positive"),
        ({"resolution": math.nan}, "resolution must be a positive"),
        ({"resolution": 1e-9}, "is more than 400000000 cells"),
        ({"resolution": 1e-320}, "far too large"),
        ({"max_cells": 10}, "a map of 17 x 12 cells is more than 10 cells"),
        ({"prefer": "best"}, "prefer is 'best'; it must be one of occupied, free, first, second"),
        ({"crop": "contents"}, "crop must be"),
        ({"crop": (0, 0, 1, 1)}, "crop must be"),
        ({"crop": ((0, 0), (0, 1))}, "smaller first"),
        ({"crop": ((0, 0), (math.inf, 1))}, "crop must be"),
        ({"crop": ((3, 3), (4, 4))}, r"no part of the map lies in x 3 to 4.* measures 1.7 x 1.2 m"),
        (
            {"other": OccupancyGrid(np.zeros((1, 1), dtype=np.int8), 0.1, Pose2D(1e9, 1e9))},
            "is more than 400000000 cells",
        ),
    ],
)
def test_what_cannot_be_is_refused(options, message):
    with pytest.raises(MapError, match=message):
        convert_grid(random_grid(1), **options)


def test_a_map_without_content_has_none_to_crop_to():
    with pytest.raises(MapError, match="all cells of the map are unknown"):
        convert_grid(OccupancyGrid(np.full((2, 2), -1), 0.1), crop="content")
