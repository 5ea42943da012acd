from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, find_file_losses
from trundle.maps.cells import VALUES, count_values, from_ranks, to_ranks
from trundle.maps.ros_writer import choose_mode, read_back

cells = hnp.arrays(np.int8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.integers(-1, 100))


@settings(max_examples=30, deadline=None)
@given(data=cells)
def test_values_are_counted_and_ranks_are_their_order(data):
    assert count_values(data).tolist() == [np.count_nonzero(data == value) for value in VALUES]
    assert np.array_equal(from_ranks(to_ranks(data)), data)
    by_care = sorted(VALUES.tolist(), key=lambda value: 64.5 if value == -1 else value)
    assert to_ranks(np.array([by_care], dtype=np.int8)).tolist() == [list(range(102))]


@pytest.mark.parametrize("name", ["trinary.png", "trinary.pgm", "scale.png", "raw.png", "raw.pgm", "movingai"])
@settings(max_examples=25, deadline=None)
@given(data=cells)
def test_the_losses_are_what_is_not_read_back(tmp_path_factory, name, data):
    grid = OccupancyGrid(data, 1.0)
    mode, _, image = name.partition(".")
    folder = tmp_path_factory.mktemp("map")
    if mode == "movingai":
        grid.save(folder / "a.map")
        again, losses = OccupancyGrid.load(folder / "a.map"), find_file_losses(grid, "movingai")
    else:
        grid.save(folder / "a.yaml", mode=mode, image_format=image)
        again, losses = OccupancyGrid.load(folder / "a.yaml"), find_file_losses(grid, "ros", mode)
    assert sum(loss.cells for loss in losses) == np.count_nonzero(again.data != data)
    assert bool(losses) == bool((again.data != data).any())
    assert mode != "raw" or not losses


def test_what_each_mode_makes_of_each_value_is_said():
    data = np.array([[-1, 0, 20, 21, 64, 65, 99, 100]], dtype=np.int8)
    grid = OccupancyGrid(data, 0.5, Pose2D(1.0, 2.0, 0.5))
    (trinary,) = find_file_losses(grid, "ros", "trinary")
    assert (trinary.kind, trinary.cells) == ("values", 5)
    assert trinary.message == (
        "mode trinary does not keep 5 cells between free and occupied: 1 become free, 2 become occupied, 2 become "
        "unknown; mode raw keeps them"
    )
    (scale,) = find_file_losses(grid, "ros", "scale")
    assert "3 another value" in scale.message
    kinds = {loss.kind: loss for loss in find_file_losses(grid, "movingai")}
    assert list(kinds) == ["unknown", "values", "resolution", "origin"]
    assert kinds["unknown"].cells == 1
    assert "cells of 0.5 m are read as 1 m" in kinds["resolution"].message
    assert "(1, 2, 0.5) is read as (0, 0, 0)" in kinds["origin"].message


def test_no_obstacle_becomes_free_in_any_file():
    for mode in ("trinary", "scale", "raw"):
        assert (read_back(mode)[VALUES >= 65] >= 65).all()


def test_the_mode_that_is_chosen_keeps_everything():
    assert choose_mode(OccupancyGrid(np.array([[-1, 0, 100]]), 0.1)) == "trinary"
    assert choose_mode(OccupancyGrid(np.array([[-1, 0, 99]]), 0.1)) == "raw"
