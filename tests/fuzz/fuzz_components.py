"""Components, gaps and floods of cells: as SciPy labels them and as a walk from cell to cell finds them."""

from __future__ import annotations

import random

import numpy as np
import numpy.typing as npt
import scipy

from fuzz.loop import attempt, rng_of, spoil
from support.cell_oracles import gaps_by_hand
from trundle._core import flood_free, flood_largest, label_components, mark_gaps

SIDES = (1, 2, 3, 7, 8, 9, 15, 16, 17, 30, 63, 64, 65)


def make_mask(generator: random.Random) -> npt.NDArray[np.uint8]:
    shape = generator.choice(SIDES), generator.choice(SIDES)
    share = generator.choice((0.0, 0.05, 0.4, 0.6, 0.95, 1.0))
    return (rng_of(generator).random(shape) < share).astype(np.uint8) * np.uint8(generator.choice((1, 255)))


def check_labels(mask: npt.NDArray[np.uint8], diagonal: bool) -> None:
    labels, table = label_components(mask, diagonal)
    expected, count = scipy.ndimage.label(mask, np.ones((3, 3)) if diagonal else None)
    assert len(table) == count
    pairs = {*zip(labels.ravel().tolist(), expected.ravel().tolist(), strict=True)}
    assert len(pairs) == count + bool((mask == 0).any())
    assert table[:, 0].tolist() == np.bincount(labels.ravel(), minlength=count + 1)[1:].tolist()
    for row, place in zip(table.tolist(), scipy.ndimage.find_objects(labels), strict=True):
        assert row[1:] == [place[0].start, place[0].stop, place[1].start, place[1].stop]


def check_floods(generator: random.Random, mask: npt.NDArray[np.uint8]) -> None:
    cells = np.where(mask, generator.choice((100, 0, 7)), -1).astype(np.int8)
    labels, count = scipy.ndimage.label(cells == -1)
    sizes = np.bincount(labels.ravel(), minlength=count + 1)[1:]
    expected, flooded = cells.copy(), cells.copy()
    if count:
        expected[labels == 1 + np.argmax(sizes)] = 0
    assert flood_largest(flooded) == (sizes.max() if count else 0)
    assert np.array_equal(flooded, expected)
    seeds = rng_of(generator).integers(0, cells.shape, (generator.choice((0, 1, 1, 3)), 2))
    reached = np.isin(labels, list({labels[row, col] for row, col in seeds.tolist()} - {0}))
    flooded = cells.copy()
    assert flood_free(flooded, seeds) == reached.sum()
    assert np.array_equal(flooded, np.where(reached, 0, cells))


def one_round(generator: random.Random) -> None:
    mask = make_mask(generator)
    limit, diagonal = generator.choice((0.0, 1.0, 1.5, 3.0, 4.3, 50.0, 1e6)), generator.random() < 0.5
    if generator.random() < 0.3:
        attempt(label_components, spoil(generator, (mask, diagonal)))
        attempt(mark_gaps, spoil(generator, (mask, limit)))
        cells = np.where(mask, 100, -1).astype(np.int8)
        seeds = rng_of(generator).integers(0, mask.shape, (2, 2))
        attempt(flood_free, spoil(generator, (cells, seeds)))
        attempt(flood_largest, spoil(generator, (cells,)))
        return
    check_labels(mask, diagonal)
    check_floods(generator, mask)
    if mask.size < 400:
        assert np.array_equal(mark_gaps(mask, limit), gaps_by_hand(mask, limit))
