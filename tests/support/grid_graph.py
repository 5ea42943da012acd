"""Shortest paths over the cells of a grid by SciPy's Dijkstra, on the graph of all steps: an oracle of searches."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

NO_COST = 1e-12
"""Weight of a step of cost 0: SciPy reads 0 as no edge."""


def grid_graph(
    costs: npt.NDArray[np.float64],
    wall: npt.NDArray[np.bool_],
    connectivity: int = 8,
    steps: tuple[float, float] = (1.0, math.sqrt(2.0)),
) -> scipy.sparse.csr_matrix:
    """A step costs its length (straight, diagonal) times the mean of two cells; a diagonal needs both beside it."""
    rows, cols = costs.shape
    index = np.arange(rows * cols).reshape(rows, cols)
    starts, ends, prices = [], [], []
    for down, right in [(0, 1), (1, 0)] + ([(1, 1), (1, -1)] if connectivity == 8 else []):
        low, high = max(0, -right), cols - max(0, right)
        here = slice(0, rows - down), slice(low, high)
        there = slice(down, rows), slice(low + right, high + right)
        free = ~wall[here] & ~wall[there]
        if down and right:
            free &= ~wall[here[0], there[1]] & ~wall[there[0], here[1]]
        starts.append(index[here][free])
        ends.append(index[there][free])
        prices.append(((costs[here] + costs[there]) * 0.5 * steps[bool(down and right)])[free])
    weights = np.maximum(np.concatenate(prices), NO_COST)
    return scipy.sparse.csr_matrix(
        (weights, (np.concatenate(starts), np.concatenate(ends))), shape=(index.size, index.size)
    )


def cheapest_costs(
    costs: npt.NDArray[np.float64],
    wall: npt.NDArray[np.bool_],
    sources: Sequence[tuple[int, int]],
    connectivity: int = 8,
    steps: tuple[float, float] = (1.0, math.sqrt(2.0)),
) -> npt.NDArray[np.float64]:
    """Cost from each cell to the nearest source, infinity where there is no path; sources lie in free cells."""
    graph = grid_graph(np.where(wall, 0.0, costs), wall, connectivity, steps)
    indices = [row * costs.shape[1] + col for row, col in sources]
    return scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=indices, min_only=True).reshape(costs.shape)
