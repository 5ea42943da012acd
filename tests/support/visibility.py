"""An oracle for any-angle paths: which lines are free, by fractions, and Dijkstra over all corners of cells."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import scipy


def is_free_line(blocked: np.ndarray, a: Sequence[Any], b: Sequence[Any]) -> bool:
    """Whether a point can go straight from a to b, (y, x) with cell (row, col) as [row, row + 1] x [col, col + 1].

    The line is cut wherever it meets a border of cells. Each piece needs a free cell whose closed square holds its
    middle, and where two pieces meet, free cells of both must be joined by sides of free cells around the meeting.
    """
    start, end = ([Fraction(value) for value in point] for point in (a, b))
    cuts = {Fraction(0), Fraction(1)}
    for u, v in zip(start, end, strict=True):
        if u != v:
            cuts.update((line - u) / (v - u) for line in range(math.ceil(min(u, v)), math.floor(max(u, v)) + 1))
    at = [tuple(u + t * (v - u) for u, v in zip(start, end, strict=True)) for t in sorted(cuts)]
    before: set[tuple[int, int]] = set()
    for first, last in itertools.pairwise(at):
        now = _holders(blocked, [(u + v) / 2 for u, v in zip(first, last, strict=True)])
        if not now or (before and not _joined(before, now, _holders(blocked, first))):
            return False
        before = now
    return True


def _holders(blocked: np.ndarray, point: Sequence[Fraction]) -> set[tuple[int, int]]:
    """Free cells whose closed squares hold a point."""
    sides = [{math.floor(value), math.ceil(value) - 1} for value in point]
    return {
        (row, col)
        for row in sides[0]
        for col in sides[1]
        if 0 <= row < blocked.shape[0] and 0 <= col < blocked.shape[1] and not blocked[row, col]
    }


def _joined(before: set[tuple[int, int]], now: set[tuple[int, int]], around: set[tuple[int, int]]) -> bool:
    """Whether a cell of one set can be reached from one of another by sides, within the cells around."""
    reached = before & around
    while True:
        more = {c for c in around if any(abs(c[0] - r[0]) + abs(c[1] - r[1]) <= 1 for r in reached)}
        if more <= reached:
            return bool(reached & now)
        reached |= more


def visibility_lengths(blocked: np.ndarray, start: tuple[int, int], goals: Sequence[tuple[int, int]]) -> list[float]:
    """Lengths in cells of the shortest paths between centres of cells, infinite where there is none."""
    half = Fraction(1, 2)
    padded = np.pad(blocked, 1, constant_values=True).astype(int)
    around = padded[:-1, :-1] + padded[1:, :-1] + padded[:-1, 1:] + padded[1:, 1:]
    points: list[tuple[Any, Any]] = [(row + half, col + half) for row, col in (start, *goals)]
    points += [(row, col) for row, col in np.argwhere(around == 1).tolist()]
    graph = scipy.sparse.lil_matrix((len(points), len(points)))
    for (i, a), (j, b) in itertools.combinations(enumerate(points), 2):
        if a != b and is_free_line(blocked, a, b):
            graph[i, j] = math.dist(a, b)
    lengths = scipy.sparse.csgraph.dijkstra(graph.tocsr(), directed=False, indices=0)[1 : 1 + len(goals)].tolist()
    return [0.0 if goal == start else length for goal, length in zip(goals, lengths, strict=True)]
