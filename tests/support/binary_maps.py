"""Random maps of blocked and free cells, by seed."""

import numpy as np

SIZES = (1, 2, 3, 7, 20, 61, 62, 63, 64, 65, 66, 126, 127, 128, 129, 190)


def make_map(rows, cols, kind, seed):
    """Random cells, boxes, rooms with doors, or clutter of 4 x 4 cells."""
    rng = np.random.default_rng(seed)
    if kind == "cells":
        return rng.random((rows, cols)) < rng.choice([0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7])
    blocked = np.zeros((rows, cols), bool)
    if kind == "boxes":
        for _ in range(rng.integers(1, max(2, rows * cols // 100))):
            row, col, (height, width) = rng.integers(rows), rng.integers(cols), rng.integers(1, 12, 2)
            blocked[row : row + height, col : col + width] = True
    elif kind == "rooms":
        for _ in range(rng.integers(0, 6)):
            blocked[rng.integers(rows)] = blocked[:, rng.integers(cols)] = True
        blocked &= rng.random((rows, cols)) < 0.93
    else:
        coarse = rng.random(((rows + 3) // 4, (cols + 3) // 4)) < rng.choice([0.1, 0.3, 0.45])
        blocked = np.kron(coarse, np.ones((4, 4)))[:rows, :cols].astype(bool)
    return blocked
