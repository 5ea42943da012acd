"""Outlines and random maps for costmaps."""

import numpy as np

from trundle.maps.grid import OccupancyGrid

SQUARE = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))
LONG = ((0.14, 0.25), (-0.607, 0.25), (-0.607, -0.25), (0.14, -0.25))


def make_grid(rows, cols, density, seed, resolution=0.05):
    rng = np.random.default_rng(seed)
    data = np.where(rng.random((rows, cols)) < density, 100, 0).astype(np.int8)
    data[rng.random((rows, cols)) < density / 2] = -1
    return OccupancyGrid(data, resolution)
