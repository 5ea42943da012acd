"""The row filters of PNG: as the specification writes them, byte by byte."""

from __future__ import annotations

import random

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.cell_oracles import unfilter_by_hand
from trundle._core import png_unfilter


def one_round(generator: random.Random) -> None:
    shape = generator.randrange(0, 6), generator.choice((1, 2, 3, 4, 9, 17, 40))
    lines = rng_of(generator).integers(0, 256, shape).astype(np.uint8)
    lines[:, 0] %= 5
    step = generator.choice((1, 2, 3, 4, 6, 8, 50))
    if generator.random() < 0.3:
        lines[:, 0] += generator.choice((0, 1, 250))
        attempt(png_unfilter, spoil(generator, (lines, step)))
        return
    assert np.array_equal(png_unfilter(lines, step), unfilter_by_hand(lines, step))
