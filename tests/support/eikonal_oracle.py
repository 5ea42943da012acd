"""The cost to go in any direction by plain iteration: every cell from its four neighbours, until nothing changes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def solve_eikonal(
    costs: npt.NDArray[np.float64], seeds: list[tuple[int, int]], values: list[float]
) -> npt.NDArray[np.float64]:
    """First-order upwind solution of |∇u| = cost, infinite in walls (infinite costs) and where none is reached."""
    free = np.isfinite(costs)
    field = np.full(costs.shape, np.inf)
    for (row, col), value in zip(seeds, values, strict=True):
        if free[row, col]:
            field[row, col] = min(field[row, col], value)
    step = np.where(free, costs, 0.0)
    while True:
        framed = np.pad(field, 1, constant_values=np.inf)
        across = np.minimum(framed[1:-1, :-2], framed[1:-1, 2:])
        along = np.minimum(framed[:-2, 1:-1], framed[2:, 1:-1])
        low, high = np.minimum(across, along), np.maximum(across, along)
        reached = np.isfinite(low)
        low, high = np.where(reached, low, 0.0), np.where(np.isfinite(high), high, 1e300)
        apart = np.minimum(high - low, step)
        both = low + 0.5 * (apart + np.sqrt(np.maximum(2.0 * step**2 - apart**2, 0.0)))
        new = np.where(high - low >= step, low + step, both)
        new = np.minimum(field, np.where(reached & free, new, np.inf))
        if np.array_equal(new, field):
            return field
        field = new
