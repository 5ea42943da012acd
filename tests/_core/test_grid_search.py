import numpy as np
import pytest
import scipy
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle import _core

STRAIGHT, DIAGONAL = 70, 99


def make_weights(neutral=50.0, factor=0.8):
    weights = np.floor(neutral + factor * np.arange(256)).astype(np.uint16)
    weights[253:] = 0
    return weights


def make_costs(rows, cols, density, seed):
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 253, (rows, cols)).astype(np.uint8)
    costs[rng.random((rows, cols)) < 0.5] = 0
    costs[rng.random((rows, cols)) < density] = rng.choice(np.array([253, 254, 255], np.uint8))
    return costs


def oracle(costs, weights, start, goal, connectivity):
    """Cost by SciPy's Dijkstra on the graph of all steps, or infinity."""
    rows, cols = costs.shape
    w = weights[costs].astype(np.int64)
    index = np.arange(rows * cols).reshape(rows, cols)
    sources, targets, prices = [], [], []
    steps = [(0, 1), (1, 0)] + ([(1, 1), (1, -1)] if connectivity == 8 else [])
    for dr, dc in steps:
        here = (slice(0, rows - dr), slice(0, cols - dc) if dc >= 0 else slice(1, cols))
        there = (slice(dr, rows), slice(dc, cols) if dc >= 0 else slice(0, cols - 1))
        free = (w[here] > 0) & (w[there] > 0)
        if dr and dc:
            free &= (w[here[0], there[1]] > 0) & (w[there[0], here[1]] > 0)
        sources.append(index[here][free])
        targets.append(index[there][free])
        prices.append(((w[here] + w[there]) * (DIAGONAL if dr and dc else STRAIGHT))[free])
    size = rows * cols
    graph = scipy.sparse.csr_matrix(
        (np.concatenate(prices), (np.concatenate(sources), np.concatenate(targets))), shape=(size, size)
    )
    distances = scipy.sparse.csgraph.dijkstra(graph, directed=False, indices=index[start])
    return distances[index[goal]] / (2 * STRAIGHT)


def path_cost(costs, weights, cells):
    """Cost of a path, with a check that each of its steps is allowed."""
    total = 0
    w = weights[costs].astype(np.int64)
    for (r0, c0), (r1, c1) in zip(cells[:-1].tolist(), cells[1:].tolist(), strict=True):
        assert max(abs(r1 - r0), abs(c1 - c0)) == 1
        assert w[r0, c1] > 0
        assert w[r1, c0] > 0
        total += (w[r0, c0] + w[r1, c1]) * (DIAGONAL if r0 != r1 and c0 != c1 else STRAIGHT)
    return total / (2 * STRAIGHT)


@settings(max_examples=150, deadline=None)
@given(
    rows=st.integers(1, 30),
    cols=st.integers(1, 30),
    density=st.sampled_from([0.0, 0.1, 0.3, 0.45]),
    connectivity=st.sampled_from([4, 8]),
    weighted=st.booleans(),
    seed=st.integers(0, 2**32 - 1),
)
def test_cost_is_dijkstras(rows, cols, density, connectivity, weighted, seed):
    costs = make_costs(rows, cols, density, seed)
    weights = make_weights() if weighted else make_weights(1.0, 0.0)
    rng = np.random.default_rng(seed + 1)
    start = (int(rng.integers(rows)), int(rng.integers(cols)))
    goal = (int(rng.integers(rows)), int(rng.integers(cols)))
    costs[start] = costs[goal] = 7
    cells, cost = _core.grid_search(costs, weights, start, goal, connectivity)
    expected = oracle(costs, weights, start, goal, connectivity)
    if np.isinf(expected):
        assert len(cells) == 0
        return
    assert cost == expected
    assert tuple(cells[0]) == start
    assert tuple(cells[-1]) == goal
    assert path_cost(costs, weights, cells) == expected
    _, backwards = _core.grid_search(costs, weights, goal, start, connectivity)
    assert backwards == cost


@pytest.mark.parametrize("seed", range(6))
def test_cost_is_dijkstras_on_larger_maps(seed):
    costs = make_costs(120, 147, 0.2, seed)
    costs[3, 4] = costs[117, 139] = 0
    _, cost = _core.grid_search(costs, make_weights(), (3, 4), (117, 139))
    assert cost == oracle(costs, make_weights(), (3, 4), (117, 139), 8)


def test_start_is_goal():
    cells, cost = _core.grid_search(np.zeros((1, 1), np.uint8), make_weights(), (0, 0), (0, 0))
    assert cells.tolist() == [[0, 0]]
    assert cost == 0.0


def test_corners_are_not_cut():
    costs = np.zeros((2, 2), np.uint8)
    costs[0, 1] = 254
    cells, cost = _core.grid_search(costs, make_weights(), (0, 0), (1, 1))
    assert cells.tolist() == [[0, 0], [1, 0], [1, 1]]
    assert cost == 100.0
    costs[1, 0] = 254
    assert len(_core.grid_search(costs, make_weights(), (0, 0), (1, 1))[0]) == 0


def test_a_blocked_end_has_no_path():
    costs = np.zeros((3, 3), np.uint8)
    costs[2, 2] = 253
    assert len(_core.grid_search(costs, make_weights(), (0, 0), (2, 2))[0]) == 0
    assert len(_core.grid_search(costs, make_weights(), (2, 2), (0, 0))[0]) == 0


def test_a_path_cost_above_32_bits_is_exact():
    rows = 601
    costs = np.full((rows, rows), 252, np.uint8)
    costs[1::4, :-1] = 254
    costs[3::4, 1:] = 254
    weights = make_weights(10_000.0, 0.0)
    cells, cost = _core.grid_search(costs, weights, (0, 0), (rows - 1, 0))
    assert cost == path_cost(costs, weights, cells)
    assert cost * 2 * STRAIGHT > 2**32


def test_bad_arguments_are_refused():
    costs = np.zeros((3, 4), np.uint8)
    with pytest.raises(IndexError):
        _core.grid_search(costs, make_weights(), (0, 0), (3, 0))
    with pytest.raises(IndexError):
        _core.grid_search(costs, make_weights(), (0, -1), (0, 0))
    with pytest.raises(ValueError, match="256"):
        _core.grid_search(costs, make_weights()[:255].copy(), (0, 0), (0, 1))
    with pytest.raises(ValueError, match="connectivity"):
        _core.grid_search(costs, make_weights(), (0, 0), (0, 1), 6)
