"""Inflation: costs by SciPy's exact distances, and local updates that equal a new costmap."""

from __future__ import annotations

import contextlib
import random
from typing import Any

import numpy as np
import scipy

from fuzz.loop import NUMBERS, attempt, rng_of, spoil
from trundle._core import inflate
from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.maps import KeepoutMask, OccupancyGrid

SIDES = (1, 2, 3, 17, 31, 32, 33, 63, 64, 65, 100, 127, 128, 129, 200)
OUTLINE = ((0.14, 0.25), (-0.607, 0.25), (-0.607, -0.25), (0.14, -0.25))


def make_cells(generator: random.Random) -> np.ndarray:
    shape = generator.choice(SIDES), generator.choice(SIDES)
    rng = rng_of(generator)
    cells = np.where(rng.random(shape) < generator.choice((0.0, 0.001, 0.02, 0.3, 1.0)), 100, 0).astype(np.int8)
    cells[rng.random(shape) < generator.choice((0.0, 0.0, 0.01, 0.5))] = -1
    cells[rng.random(shape) < generator.choice((0.0, 0.2))] = generator.choice((1, 50, 99))
    return cells


def check_inflation(generator: random.Random, cells: np.ndarray) -> None:
    radius = generator.choice((0, 1, 2, 7, 8, 9, 20, 63, 64, 65, 179, 180, 181, 260))
    entries = radius * radius + generator.choice((1, 1, radius + 1, 2 * radius + 1))
    table = rng_of(generator).integers(0, 256, entries).astype(np.uint8)
    if generator.random() < 0.2:
        attempt(inflate, spoil(generator, (cells, table)))
        return
    blocked = (cells < 0) | (cells >= 100)
    squares = np.full(cells.shape, entries)
    if blocked.any():
        squares = np.rint(scipy.ndimage.distance_transform_edt(~blocked) ** 2).astype(np.int64)
    expected = np.append(table, np.uint8(0))[np.minimum(squares, entries)]
    expected[cells >= 100] = 254
    expected[cells < 0] = 255
    assert np.array_equal(inflate(cells, table), expected)


def check_updates(generator: random.Random, cells: np.ndarray) -> None:
    radius, factor = generator.choice((0.0, 0.3, 1.0, 4.0)), generator.choice((0.0, 3.0, 50.0))
    keepout, rng = None, rng_of(generator)
    if generator.random() < 0.4:
        painted = rng.choice(np.array([0, 0, 0, 30, 100], dtype=np.int8), (5, 5))
        keepout = KeepoutMask(OccupancyGrid(painted, generator.choice((0.13, 3.0))))
    options: dict[str, Any] = {"inflation_radius": radius, "cost_scaling_factor": factor, "keepout": keepout}
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), OUTLINE, **options)
    for _ in range(generator.randrange(1, 5)):
        spans: list[Any] = []
        for count in cells.shape:
            first = generator.randrange(count)
            spans.append(slice(first, generator.randrange(first, count) + 1))
        values: Any = rng.choice(np.array([-1, 0, 0, 0, 50, 100]), cells[spans[0], spans[1]].shape)
        values = generator.choice((values, values.astype(np.int8), 100, 0, np.asfortranarray(values)))
        if generator.random() < 0.1:
            spoiled = spoil(generator, (*spans, values), (*NUMBERS, slice(0, 9999), slice(0, 1, 2), slice(2, 1)))
            with contextlib.suppress(InputError):
                costmap.update(*spoiled)
            continue
        costmap = costmap.update(spans[0], spans[1], values)
        cells[spans[0], spans[1]] = values
        fresh = Costmap.from_grid(OccupancyGrid(cells, 0.05), OUTLINE, **options)
        assert np.array_equal(costmap.data, fresh.data)


def one_round(generator: random.Random) -> None:
    cells = make_cells(generator)
    generator.choice((check_inflation, check_updates))(generator, cells)
