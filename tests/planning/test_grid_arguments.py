"""Errors of a `GridSearch`: invalid maps, ends, updates, queries and limits."""

import math
import threading

import numpy as np
import pytest

from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.planning import GridSearch


@pytest.mark.parametrize(
    ("start", "goal", "error", "cell", "words"),
    [
        ((3, 0), (0, 0), OutsideMapError, (3, 0), r"start \(3, 0\) lies outside.*rows are 0 to 2, columns 0 to 3"),
        ((0, 0), (0, -1), OutsideMapError, (0, -1), r"goal \(0, -1\) lies outside"),
        ((0, 0), (2**80, 0), OutsideMapError, (2**80, 0), "goal"),
        ((1, 1), (0, 0), BlockedPoseError, (1, 1), r"start \(1, 1\) is blocked"),
        ((0, 0), (1, 1), BlockedPoseError, (1, 1), r"goal \(1, 1\) is blocked"),
    ],
)
def test_an_end_that_cannot_be_is_a_typed_error_with_its_cell(start, goal, error, cell, words):
    blocked = np.zeros((3, 4), bool)
    blocked[1, 1] = True
    search = GridSearch(blocked)
    with pytest.raises(error, match=words) as caught:
        search.shortest_path(start, goal)
    assert caught.value.cell == cell
    if max(*start, *goal) < 2**62:
        with pytest.raises(error, match=f"query 1: the {words}") as caught:
            search.plan_many([(0, 0), start], [(0, 0), goal])
        assert caught.value.cell == cell


@pytest.mark.parametrize("cell", [(0.5, 1), "ab", (1,), (1, 2, 3), None, 7, {0, 1}, (None, 0), np.array([0.0, 1.0])])
def test_an_end_that_is_no_cell_is_an_input_error(cell):
    search = GridSearch(np.zeros((3, 4), bool))
    with pytest.raises(InputError, match="start must be a pair of integers"):
        search.shortest_path(cell, (0, 0))
    with pytest.raises(InputError, match="goal must be a pair of integers"):
        search.shortest_path((0, 0), cell)


@pytest.mark.parametrize(
    ("blocked", "options", "words"),
    [
        (np.zeros(5, bool), {}, r"shape \(rows, cols\)"),
        (np.zeros((2, 2, 2), bool), {}, r"shape \(rows, cols\)"),
        (np.zeros((0, 5), bool), {}, "at least one cell"),
        (np.zeros((2, 2)), {}, "float64"),
        (np.zeros((2, 2), np.int8), {}, "int8"),
        (np.array([["a"]]), {}, "bool or uint8"),
        ([[True], [True, False]], {}, r"shape \(rows, cols\)"),
        (np.zeros((2, 2), bool), {"connectivity": 6}, "connectivity is 4 or 8"),
        (np.zeros((2, 2), bool), {"method": "jsp"}, "method is one of"),
        (np.zeros((2, 2), bool), {"method": "jps", "connectivity": 4}, "for connectivity 8"),
    ],
)
def test_a_map_that_cannot_be_searched_is_an_input_error(blocked, options, words):
    with pytest.raises(InputError, match=words):
        GridSearch(blocked, **options)


def test_a_map_of_more_than_32_bits_of_cells_is_refused():
    huge = np.broadcast_to(np.zeros(1, bool), (70_000, 70_000))
    with pytest.raises(InputError, match="2\\^32 cells"):
        GridSearch(huge)


@pytest.mark.parametrize(
    ("rows", "cols", "values", "error", "words"),
    [
        (slice(0, 4), 0, True, OutsideMapError, "rows 0:4"),
        (slice(2, 1), 0, True, OutsideMapError, "rows 2:1"),
        ((-1, 1), 0, True, OutsideMapError, "rows -1:1"),
        (0, 4, True, OutsideMapError, "cols 4:5"),
        (0, slice(0, 4, 2), True, InputError, "without gaps"),
        (0, (1, 2, 3), True, InputError, "pair"),
        (0.5, 0, True, InputError, "all whole"),
        (0, "ab", True, InputError, "cols is a slice"),
        (slice(0, 2), slice(0, 2), np.zeros((2, 3), bool), InputError, r"shape \(2, 2\), got \(2, 3\)"),
        (0, 0, 1.5, InputError, "float64"),
    ],
)
def test_an_update_that_cannot_be_is_an_error(rows, cols, values, error, words):
    with pytest.raises(error, match=words):
        GridSearch(np.zeros((3, 4), bool)).update(rows, cols, values)


@pytest.mark.parametrize(
    ("starts", "goals", "options", "words"),
    [
        ([(0, 0)], [(0, 0), (0, 1)], {}, "1 starts and 2 goals"),
        ([(0.0, 0)], [(0, 0)], {}, "starts must be integers"),
        ([(0, 0)], [(0, 0, 0)], {}, "goals must be integers"),
        ([(0, 0), (1,)], [(0, 0)], {}, "starts must be integers"),
        ([()], [], {}, "starts must be integers"),
        ([(0, 0)], [(0, 0)], {"threads": 0}, "threads"),
        ([(0, 0)], [(0, 0)], {"deadline_s": 0.0}, "deadline_s"),
        ([(0, 0)], [(0, 0)], {"deadline_s": math.nan}, "deadline_s"),
    ],
)
def test_queries_that_cannot_be_are_an_input_error(starts, goals, options, words):
    with pytest.raises(InputError, match=words):
        GridSearch(np.zeros((3, 4), bool)).plan_many(starts, goals, **options)


@pytest.mark.parametrize("options", [{"deadline_s": "soon"}, {"cancel": threading.Event()}, {"deadline_s": -1}])
def test_limits_that_are_none_are_an_input_error(options):
    with pytest.raises(InputError, match="must be a"):
        GridSearch(np.zeros((3, 4), bool)).shortest_path((0, 0), (0, 1), **options)


def test_a_deadline_of_zero_is_an_input_error():
    with pytest.raises(InputError, match="positive number of seconds, got 0"):
        GridSearch(np.zeros((3, 4), bool)).shortest_path((0, 0), (0, 1), deadline_s=0)
