"""Floods of unknown cells, against SciPy's labels."""

import numpy as np
import pytest
import scipy

from trundle._core import flood_free, flood_largest

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
SHAPES = [(1, 1), (1, 40), (40, 1), (7, 8), (23, 17), (40, 65)]


def noise(shape: tuple[int, int], share: float, seed: int) -> np.ndarray:
    walls = np.random.default_rng(seed).random(shape) < share
    return np.where(walls, OCCUPIED, UNKNOWN).astype(np.int8)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("share", [0.0, 0.1, 0.35, 0.45, 0.9, 1.0])
def test_the_largest_area_becomes_free_and_of_equal_ones_the_first(shape, share):
    for seed in range(6):
        cells = noise(shape, share, seed)
        labels, count = scipy.ndimage.label(cells == UNKNOWN)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
        expected = cells.copy()
        if count:
            expected[labels == 1 + np.argmax(sizes)] = FREE  # Labels go by first cell, argmax takes the first.
        assert flood_largest(cells) == (sizes.max() if count else 0)
        assert np.array_equal(cells, expected)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("share", [0.0, 0.1, 0.35, 0.45, 0.9])
def test_what_is_joined_to_a_seed_becomes_free(shape, share):
    for seed in range(6):
        cells = noise(shape, share, seed)
        seeds = np.random.default_rng(100 + seed).integers(0, shape, (2, 2))
        labels, _ = scipy.ndimage.label(cells == UNKNOWN)
        reached = {labels[row, col] for row, col in seeds if cells[row, col] == UNKNOWN}
        expected = cells.copy()
        expected[np.isin(labels, list(reached))] = FREE
        assert flood_free(cells, seeds) == (expected == FREE).sum()
        assert np.array_equal(cells, expected)


@pytest.mark.parametrize("turns", range(4))
def test_a_spiral_is_one_area(turns):
    cells = np.full((41, 41), OCCUPIED, dtype=np.int8)
    row, col, step = 0, 0, (0, 1)
    for length in [40, 40, 40, *(length for length in range(38, 0, -2) for _ in range(2))]:
        for _ in range(length):
            cells[row, col] = UNKNOWN
            row, col = row + step[0], col + step[1]
        step = (step[1], -step[0])
    cells = np.rot90(cells, turns).copy()
    open_cells = int((cells == UNKNOWN).sum())
    assert 800 < open_cells < 900
    again = cells.copy()
    assert flood_largest(cells) == open_cells
    start = np.argwhere(again == UNKNOWN)[:1]
    assert flood_free(again, start) == open_cells
