"""Cost fields against SciPy's Dijkstra on the graph of the same definition."""

import subprocess
import sys
import threading

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.grid_graph import cheapest_costs
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, PlanningStoppedError
from trundle.planning import Cancellation, cost_field


def by_dijkstra(costs: npt.NDArray[np.generic], goals: list[tuple[int, int]], connectivity: int = 8):
    walls = {"uint8": 255, "uint16": 65535, "float32": np.inf}
    wall = costs == walls[costs.dtype.name]
    return cheapest_costs(costs.astype(np.float64), wall, goals, connectivity)


def assert_same(field: npt.NDArray[np.float32], expected: npt.NDArray[np.float64]) -> None:
    np.testing.assert_array_equal(np.isfinite(field), np.isfinite(expected))
    reached = np.isfinite(expected)
    np.testing.assert_allclose(field[reached], expected[reached], rtol=5e-7, atol=1e-6)


@st.composite
def grids(draw: st.DrawFn):
    shape = draw(st.tuples(*[st.one_of(st.integers(1, 9), st.sampled_from([31, 32, 33, 40, 65]))] * 2))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    dtype = draw(st.sampled_from([np.uint8, np.uint16, np.float32]))
    top = draw(st.sampled_from([2, 50, 255 if dtype == np.uint8 else 60_000]))
    costs = random.integers(draw(st.integers(0, 1)), top, shape).astype(dtype)
    if dtype == np.float32:
        costs += random.random(shape, dtype=np.float32)
    wall = np.inf if dtype == np.float32 else np.iinfo(dtype).max
    costs[random.random(shape) < draw(st.sampled_from([0.0, 0.1, 0.3, 0.45, 0.7]))] = wall
    free = np.argwhere(costs != wall)
    if len(free) == 0:
        costs[0, 0] = 1
        free = np.array([[0, 0]])
    goals = free[random.integers(0, len(free), draw(st.integers(1, 4)))]
    return costs, [tuple(goal) for goal in goals.tolist()]


@settings(max_examples=150, deadline=None)
@given(grids(), st.sampled_from([4, 8]), st.sampled_from([1, 2, 3]))
def test_every_cell_costs_what_dijkstra_finds(grid, connectivity: int, threads: int) -> None:
    costs, goals = grid
    field = cost_field(costs, goals, connectivity=connectivity, threads=threads)
    assert_same(field, by_dijkstra(costs, goals, connectivity))


def maze(seed: int, rows: int, cols: int) -> npt.NDArray[np.uint8]:
    random = np.random.default_rng(seed)
    costs = random.integers(1, 200, (rows, cols)).astype(np.uint8)
    costs[::4, :] = 255
    for row in range(0, rows, 4):
        costs[row, random.integers(0, cols, 2)] = 1
    return costs


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_long_paths_through_many_tiles_are_exact(threads: int) -> None:
    costs = maze(3, 150, 210)
    free = np.argwhere(costs != 255)
    goals = [tuple(free[0].tolist()), tuple(free[-1].tolist())]
    assert_same(cost_field(costs, goals, threads=threads), by_dijkstra(costs, goals))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_long_maps_of_uneven_costs_are_exact(dtype: type[np.generic]) -> None:
    # Tiles are settled several times, and more of them in a row than the kernel keeps numbers of; costs of paths over
    # uint16 cells exceed 32 bits.
    random = np.random.default_rng(7)
    costs = random.integers(1, 200 if dtype == np.uint8 else 60_000, (45, 1500)).astype(dtype)
    costs[random.random(costs.shape) < 0.2] = np.inf if dtype == np.float32 else np.iinfo(dtype).max
    goal = np.argwhere(np.isfinite(costs) & (costs < 200 if dtype == np.uint8 else costs < 60_000))[100]
    expected = by_dijkstra(costs, [tuple(goal.tolist())])
    for threads in (1, 2):
        assert_same(cost_field(costs, goal, threads=threads), expected)


def test_the_number_of_threads_changes_no_bit() -> None:
    costs = maze(5, 300, 333).astype(np.float32) + np.float32(0.3)
    costs[costs > 255] = np.inf
    goal = np.argwhere(np.isfinite(costs))[1000]
    first = cost_field(costs, goal, threads=1)
    for threads in (2, 3, 8):
        np.testing.assert_array_equal(cost_field(costs, goal, threads=threads), first)


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits the memory as Linux does")
def test_where_no_more_threads_are_to_be_had_those_that_run_do_the_work() -> None:
    # Each thread asks for a stack, and there is room for a few.
    code = """
import resource
import numpy as np
from trundle.planning import cost_field
field = cost_field(np.ones((200, 200), np.uint8), (0, 0), threads=1)
size = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (size + (64 << 20), resource.RLIM_INFINITY))
assert np.array_equal(cost_field(np.ones((200, 200), np.uint8), (0, 0), threads=1024), field)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_an_open_floor_has_octile_distances() -> None:
    field = cost_field(np.ones((70, 90), dtype=np.uint8), (10, 20))
    dr, dc = np.abs(np.arange(70) - 10)[:, None], np.abs(np.arange(90) - 20)[None, :]
    np.testing.assert_allclose(field, np.maximum(dr, dc) + (np.sqrt(2.0) - 1.0) * np.minimum(dr, dc), rtol=5e-7)


@pytest.mark.parametrize("goal", [(31, 31), (32, 32), (31, 50), (0, 32), (63, 63), (40, 31)])
def test_goals_at_the_edges_of_tiles_count_beyond_them(goal: tuple[int, int]) -> None:
    costs = np.full((64, 64), 2, dtype=np.uint8)
    for connectivity in (4, 8):
        assert_same(cost_field(costs, goal, connectivity=connectivity), by_dijkstra(costs, [goal], connectivity))


def test_costs_beyond_32_bits_are_still_exact() -> None:
    costs = np.full((3, 3000), 65534, dtype=np.uint16)
    field = cost_field(costs, (1, 0))
    np.testing.assert_allclose(field[1], 65534.0 * np.arange(3000), rtol=1e-7)
    costs[:, 2000] = 65535
    field = cost_field(costs, (1, 0))
    assert np.isinf(field[:, 2000:]).all()
    assert field[1, 1999] == np.float32(65534.0 * 1999)


def test_the_highest_and_the_lowest_accepted_costs_are_exact() -> None:
    # The longest path through a map visits all of it; numbers below 1.2e-38 are kept with fewer digits.
    for cost, exact in ((2e36, 1e-6), (1e-37, 1e-6), (1e-44, 0.1)):
        costs = np.full((5, 7), cost, dtype=np.float32)
        costs[1, :-1] = costs[3, 1:] = np.inf
        field = cost_field(costs, (0, 0))
        assert field[4, 6] == pytest.approx(22 * float(costs[0, 0]), rel=exact)
        assert np.isfinite(field).sum() == np.isfinite(costs).sum()


def test_costs_of_0_lead_where_higher_ones_do() -> None:
    costs = np.zeros((40, 70), dtype=np.float32)
    costs[::3] = np.float32(0.5)
    costs[:, 20] = np.inf
    costs[7, 20] = -0.0
    assert_same(cost_field(costs, (39, 60)), by_dijkstra(costs, [(39, 60)]))


def test_free_travel_costs_nothing() -> None:
    field = cost_field(np.zeros((40, 40), dtype=np.float32), (3, 3))
    assert (field == 0.0).all()


def test_a_mask_is_walls_and_floor() -> None:
    blocked = np.zeros((5, 9), dtype=bool)
    blocked[:4, 4] = True
    field = cost_field(blocked, (0, 0))
    assert np.isinf(field[0, 4])
    assert field[0, 8] == pytest.approx(by_dijkstra(np.where(blocked, 255, 1).astype(np.uint8), [(0, 0)])[0, 8])


@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.uint32, np.float64])
def test_other_types_are_converted_once(dtype: type) -> None:
    costs = np.random.default_rng(1).integers(1, 100, (20, 30))
    np.testing.assert_array_equal(cost_field(costs.astype(dtype), (0, 0)), cost_field(costs.astype(dtype), [(0, 0)]))
    np.testing.assert_allclose(
        cost_field(costs.astype(dtype), (0, 0)), cost_field(costs.astype(np.uint16), (0, 0)), rtol=5e-7
    )


def test_views_of_arrays_are_taken() -> None:
    costs = np.random.default_rng(2).integers(1, 100, (60, 80)).astype(np.uint8)
    np.testing.assert_array_equal(cost_field(costs[::2, ::-1], (0, 0)), cost_field(costs[::2, ::-1].copy(), (0, 0)))


@pytest.mark.parametrize(
    ("costs", "message"),
    [
        (np.ones(5), r"shape \(rows, cols\)"),
        (np.ones((0, 5)), r"at least one cell"),
        (np.full((2, 2), np.nan), r"\(0, 0\) is nan"),
        (np.array([[1.0, -0.5]]), r"\(0, 1\) is -0.5"),
        (np.array([[1.0, 1e300]]), r"\(0, 1\) is 1e\+300"),
        (np.full((2, 4), 3e38, dtype=np.float32), r"from 0 to 2.13e\+37"),
        ([[1, 2], [3]], "shape"),
        (np.array([[1.0, -np.inf]], dtype=np.float32), r"\(0, 1\) is -inf"),
        (np.array([[1, -1]]), "from 0 to 65535"),
        (np.array([[1, 70000]]), "from 0 to 65535"),
        (np.array([["a"]]), "cannot be used"),
        (np.ones((2, 2), dtype=complex), "cannot be used"),
    ],
)
def test_bad_costs_are_refused_by_what_is_wrong(costs: npt.NDArray[np.generic], message: str) -> None:
    with pytest.raises(InputError, match=message):
        cost_field(costs, (0, 0))


def test_bad_goals_are_refused_with_their_cell() -> None:
    costs = np.ones((4, 6), dtype=np.uint8)
    costs[2, 3] = 255
    with pytest.raises(OutsideMapError) as outside:
        cost_field(costs, [(0, 0), (4, 0)])
    assert outside.value.cell == (4, 0)
    with pytest.raises(BlockedPoseError) as blocked:
        cost_field(costs, (2, 3))
    assert blocked.value.cell == (2, 3)
    for goals in ([], (1.0, 2.0), (1, 2, 3), [[1, 2, 3]], "ab"):
        with pytest.raises(InputError, match="goals need integers"):
            cost_field(costs, goals)


@pytest.mark.parametrize(
    "options", [{"connectivity": 6}, {"threads": 0}, {"threads": 5000}, {"threads": "2"}, {"threads": 1.5}]
)
def test_bad_options_are_refused(options: dict[str, int]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        cost_field(np.ones((2, 2), dtype=np.uint8), (0, 0), **options)


def test_a_field_is_stopped_by_its_deadline_and_by_hand() -> None:
    costs = np.ones((2000, 1500), dtype=np.uint8)
    for threads in (1, 2):
        with pytest.raises(PlanningStoppedError, match=r"2000 x 1500 was not done when 1e-09 s passed \(deadline_s\)"):
            cost_field(costs, (0, 0), threads=threads, deadline_s=1e-9)
    cancel = Cancellation()
    field = cost_field(costs[:50], (0, 0), deadline_s=1e6, cancel=cancel)
    assert field[0, -1] == 1499.0
    cancel.cancel()
    with pytest.raises(PlanningStoppedError, match="when it was cancelled"):
        cost_field(costs, (0, 0), deadline_s=1e6, cancel=cancel)


@pytest.mark.slow
def test_a_running_field_is_cancelled_from_another_thread() -> None:
    costs = np.random.default_rng(0).integers(1, 200, (6000, 6000)).astype(np.uint8)
    cancel = Cancellation()
    timer = threading.Timer(0.02, cancel.cancel)
    timer.start()
    with pytest.raises(PlanningStoppedError, match="cancelled"):
        cost_field(costs, (0, 0), cancel=cancel)
    timer.join()


@pytest.mark.parametrize(("option", "value"), [("deadline_s", 0.0), ("deadline_s", np.nan), ("cancel", True)])
def test_bad_limits_are_refused(option: str, value: object) -> None:
    with pytest.raises(InputError, match=option):
        cost_field(np.ones((2, 2), dtype=np.uint8), (0, 0), **{option: value})
