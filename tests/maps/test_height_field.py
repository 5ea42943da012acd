from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import MapError, OutputError
from trundle.maps import HeightField

SMALL = HeightField(np.array([[0.0, 1.0, 2.0], [4.0, 5.0, 9.0]]), 0.5, (10.0, -3.0))


def test_heights_lie_at_the_samples_and_are_bilinear_between():
    assert SMALL.bounds == ((10.0, -3.0), (11.0, -2.5))
    assert SMALL.height_at(10.5, -2.5) == 5.0
    assert SMALL.height_at(np.array([10.25, 10.75]), np.array([-2.75, -2.75])).tolist() == [2.5, 4.25]
    assert np.isnan(SMALL.height_at(np.array([9.99, 11.01, 10.5, math.nan]), np.array([-3.0, -3.0, -2.4, -3.0]))).all()
    with pytest.raises(ValueError, match="read-only"):
        SMALL.heights[0, 0] = 1.0


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.05, 0.9), st.floats(0, 4), st.floats(0, 2))
def test_a_plane_is_met_everywhere(a, b, resolution, x, y):
    field = HeightField.from_function(lambda x, y: a * x + b * y, ((0, 0), (4, 2)), resolution=resolution)
    assert field.height_at(x, y) == pytest.approx(a * x + b * y, abs=1e-9)


def test_a_constant_function_and_an_upper_corner_between_samples_will_do():
    field = HeightField.from_function(lambda x, y: 1.5, ((0, 0), (1, 0.7)), resolution=0.25)
    assert field.heights.shape == (4, 5)
    assert field.bounds == ((0, 0), (1.0, 0.75))


def test_a_file_gives_the_field_back(tmp_path):
    holes = HeightField(np.where(SMALL.heights > 5, np.nan, SMALL.heights), SMALL.resolution, SMALL.origin)
    holes.save(tmp_path / "floor.npz")
    again = HeightField.load(tmp_path / "floor.npz")
    assert np.array_equal(again.heights, holes.heights, equal_nan=True)
    assert (again.resolution, again.origin) == (0.5, (10.0, -3.0))
    np.savez(tmp_path / "plain.npz", heights=np.zeros((2, 2), dtype=np.float32), resolution=1)
    assert HeightField.load(tmp_path / "plain.npz").origin == (0.0, 0.0)


def test_files_that_cannot_be_are_refused_by_name(tmp_path):
    np.savez(tmp_path / "lacks.npz", height=np.zeros((2, 2)), resolution=1.0)
    np.savez(tmp_path / "origin.npz", heights=np.zeros((2, 2)), resolution=1.0, origin=[1.0])
    np.savez(tmp_path / "steps.npz", heights=np.zeros((2, 2)), resolution=[1.0, 2.0])
    np.savez(tmp_path / "objects.npz", heights=np.array([[{}, {}], [1, 2]]), resolution=1.0)
    np.save(tmp_path / "array.npy", np.zeros((2, 2)))
    SMALL.save(tmp_path / "torn.npz")
    (tmp_path / "torn.npz").write_bytes((tmp_path / "torn.npz").read_bytes()[:100])
    (tmp_path / "text.npz").write_text("heights: 1")
    (tmp_path / "empty.npz").write_bytes(b"")
    for name, message in (
        ("none.npz", "cannot read .*none.npz"),
        ("lacks.npz", "no array named 'heights' in it; there are: height, resolution"),
        ("origin.npz", "origin"),
        ("steps.npz", "steps.npz: "),
        ("objects.npz", "objects.npz: "),
        ("array.npy", "a single array, and not a .npz file"),
        ("torn.npz", "torn.npz: not a .npz file"),
        ("text.npz", "text.npz: not a .npz file"),
        ("empty.npz", "empty.npz: not a .npz file"),
    ):
        with pytest.raises(MapError, match=message):
            HeightField.load(tmp_path / name)


def test_nothing_half_is_written(tmp_path):
    with pytest.raises(MapError, match=r"must end in \.npz"):
        SMALL.save(tmp_path / "floor.npy")
    with pytest.raises(OutputError):
        SMALL.save(tmp_path / "none" / "floor.npz")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((np.zeros(4), 1.0), r"at least 2 x 2, got \(4,\)"),
        ((np.zeros((1, 5)), 1.0), "at least 2 x 2"),
        ((np.full((2, 2), np.inf), 1.0), "at most 1e[+]09 m"),
        ((np.zeros((2, 2)), 0.0), "resolution"),
        ((np.zeros((2, 2)), math.nan), "resolution"),
        ((np.zeros((2, 2)), 1.0, (0.0, math.nan)), "origin"),
        ((np.zeros((2, 2)), 1.0, (0.0, 0.0, 0.0)), "origin"),
        ((np.zeros((2, 2)), 1.0, (1e300, 0.0)), "origin"),
        ((np.zeros((2, 2)), 1e300), "width"),
        (("high", 1.0), "heights"),
    ],
)
def test_fields_that_cannot_be_are_refused(arguments, message):
    with pytest.raises(MapError, match=message):
        HeightField(*arguments)


@pytest.mark.parametrize(
    ("bounds", "resolution", "message"),
    [
        (((0, 0), (0, 1)), 0.1, "bounds"),
        (((0, 0), (math.nan, 1)), 0.1, "bounds"),
        (((0, 0), (1, 1)), 0.0, "resolution"),
        (((0, 0), (1e6, 1e6)), 0.05, "more than 100000000 samples"),
    ],
)
def test_functions_cannot_be_sampled_without_bounds_and_step(bounds, resolution, message):
    with pytest.raises(MapError, match=message):
        HeightField.from_function(lambda x, y: x, bounds, resolution=resolution)
