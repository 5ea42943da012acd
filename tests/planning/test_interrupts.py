"""Long calls let Python's signal handlers run, so that Ctrl-C ends them."""

import os
import signal
import threading
from contextlib import contextmanager

import numpy as np
import pytest

from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import Cancellation, GridSearch, cost_field, create_planner
from trundle.planning.grid.grid_paths import STATUSES
from trundle.planning.grid_planners.footprint_planner import cell_weights

SIZE = 3000
pytestmark = pytest.mark.skipif(not hasattr(signal, "SIGUSR1"), reason="needs a signal of one's own")


@contextmanager
def soon(handler):
    """Sends a signal a moment after the block began, for this handler."""
    before = signal.signal(signal.SIGUSR1, lambda number, frame: handler())
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGUSR1))
    timer.start()
    try:
        yield
    finally:
        timer.join()
        signal.signal(signal.SIGUSR1, before)


def clutter():
    """Random cells in which no path is straight, and two free corners that are connected."""
    blocked = np.random.default_rng(0).random((SIZE, SIZE)) < 0.3
    blocked[:2], blocked[-2:], blocked[:, :2] = False, False, False
    return blocked, (0, SIZE - 1), (SIZE - 1, SIZE - 1)


def grid_search(method, call):
    blocked, start, goal = clutter()
    search = GridSearch(blocked, method=method)
    many = np.array([start] * 50), np.array([goal] * 50)
    return lambda cancel: call(search, many, cancel).status


def field(cancel):
    costs = np.tile(np.random.default_rng(0).integers(1, 200, (500, 500)).astype(np.uint8), (8, 8))
    try:
        cost_field(costs, (0, 0), threads=1, cancel=cancel)
    except PlanningStoppedError as error:
        return [error.status]
    return ["found"]


def least_cost(cancel):
    costs = np.tile(np.random.default_rng(0).integers(0, 200, (500, 500)).astype(np.uint8), (8, 8))
    kernel = _core.LeastCost(cell_weights(50.0, 0.8))
    ends = np.array([[0.5, 0.5], [3999.5, 3999.5]])
    return [STATUSES[kernel.find(costs, (0, 0), (3999, 3999), ends, None, cancel.flag)[0]]]


def weighted(cancel):
    costs = np.zeros((6000, 6000), dtype=np.uint8)
    costs[:, 5998] = 254
    cost = _core.grid_search(
        costs, np.repeat([1, 0], [254, 2]).astype(np.uint16), (0, 0), (0, 5999), 4, None, cancel.flag
    )[1]
    return ["cancelled" if np.isnan(cost) else "found"]


def hybrid_astar():
    cells = np.zeros((400, 400), dtype=np.int8)
    cells[196:204] = 100
    cells[196:204, 195:205] = 0  # the inscribed circle goes through, the robot does not
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), ((1.0, 0.65), (-0.4, 0.65), (-0.4, -0.15), (1.0, -0.15)))
    chosen = create_planner("hybrid_astar", max_expansions=10**8, in_place=True)

    def ask(cancel):
        try:
            return [chosen.plan(costmap, Pose2D(5.0, 5.0), Pose2D(15.0, 15.0), cancel=cancel).status]
        except PlanningStoppedError as error:
            return [error.status]

    return ask


CALLS = {
    "plan_many, astar": lambda: grid_search("astar", lambda s, q, stop: s.plan_many(*q, cancel=stop)),
    "plan_many, jps": lambda: grid_search("jps", lambda s, q, stop: s.plan_many(*q, threads=1, cancel=stop)),
    "any_angle_paths": lambda: grid_search("jps", lambda s, q, stop: s.any_angle_paths(*q, cancel=stop)),
    "cost_field": lambda: field,
    "least_cost": lambda: least_cost,
    "grid_search": lambda: weighted,
    "hybrid_astar": hybrid_astar,
}


@pytest.mark.parametrize("call", CALLS)
def test_a_handler_runs_while_a_long_call_goes_on(call):
    stop, ask = Cancellation(), CALLS[call]()
    with soon(stop.cancel):
        assert "cancelled" in ask(stop)


@pytest.mark.parametrize("call", CALLS)
def test_what_a_handler_raises_ends_a_long_call(call):
    stop, ask = Cancellation(), CALLS[call]()

    def interrupt():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), soon(interrupt):
        ask(stop)
    assert not stop.cancelled


def test_a_search_goes_on_as_before_after_an_interrupt():
    blocked = clutter()[0]
    search = GridSearch(blocked[:400], method="astar")
    before = search.shortest_path((0, 0), (0, 2999)).length
    many = np.array([(0, 0)] * 5000), np.array([search.nearest_reachable((0, 0), (399, 2500))] * 5000)

    def interrupt():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), soon(interrupt):
        search.plan_many(*many)
    search.update(0, slice(100, 102), False)
    assert search.shortest_path((0, 0), (0, 2999)).length == before
