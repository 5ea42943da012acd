import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from support.cell_oracles import gaps_by_hand
from trundle._core import label_components, mark_gaps


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    rows=st.integers(1, 30),
    cols=st.integers(1, 30),
    share=st.floats(0.0, 1.0),
    diagonal=st.booleans(),
)
def test_components_are_those_of_scipy(seed, rows, cols, share, diagonal):
    mask = (np.random.default_rng(seed).random((rows, cols)) < share).astype(np.uint8)
    labels, table = label_components(mask, diagonal)
    expected, count = scipy.ndimage.label(mask, np.ones((3, 3)) if diagonal else None)
    assert labels.dtype == np.int32
    assert len(table) == count
    assert len({*zip(labels.ravel(), expected.ravel(), strict=True)}) == count + (mask == 0).any()
    for index, (cells, row, row_end, col, col_end) in enumerate(table, start=1):
        found_rows, found_cols = np.nonzero(labels == index)
        assert cells == len(found_rows)
        assert (row, row_end) == (found_rows.min(), found_rows.max() + 1)
        assert (col, col_end) == (found_cols.min(), found_cols.max() + 1)


def test_a_spiral_is_one_area():
    free = np.zeros((41, 41), dtype=bool)
    for ring in range(0, 20, 2):
        free[ring, ring : -ring or None] = free[-1 - ring, ring : -ring or None] = True
        free[ring : -ring or None, ring] = free[ring : -ring or None, -1 - ring] = True
        free[ring + 1, ring] = ring == 0
        free[ring + 2 : ring + 3, ring + 1] = True
    expected, count = scipy.ndimage.label(free)
    labels, table = label_components(free.view(np.uint8), False)
    assert len(table) == count
    assert np.array_equal(labels, expected)


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    rows=st.integers(1, 16),
    cols=st.integers(1, 16),
    share=st.floats(0.0, 0.6),
    limit=st.sampled_from([0.0, 1.0, 1.5, 3.0, 4.3, 50.0]),
)
def test_gaps_are_the_short_runs_in_four_directions(seed, rows, cols, share, limit):
    blocked = (np.random.default_rng(seed).random((rows, cols)) < share).astype(np.uint8)
    assert np.array_equal(mark_gaps(blocked, limit), gaps_by_hand(blocked, limit))


def test_a_limit_that_is_no_length_is_refused():
    with pytest.raises(ValueError, match="limit"):
        mark_gaps(np.zeros((2, 2), dtype=np.uint8), float("nan"))
