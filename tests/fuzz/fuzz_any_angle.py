"""Fuzz the ways in any direction: whatever is asked, a way that an oracle agrees with or a typed error."""

from __future__ import annotations

import itertools
import math
import random
from typing import Any

import numpy as np

from fuzz.fuzz_grid_search import make_map, pick, update
from support.visibility import is_free_line, visibility_lengths
from trundle.errors import InputError, PlanningError
from trundle.planning import GridPath, GridSearch, PointPath, any_angle_path
from trundle.planning.point_path import PointMethod

LARGEST_GRAPH = 40
"""Cells of a map on which every way is compared with the visibility graph's."""


def ask(
    search: GridSearch, start: Any, goal: Any, method: PointMethod | None
) -> GridPath | PointPath | tuple[type, str]:
    """A way, over cells without a method, or the error that says why there is none."""
    try:
        return search.any_angle_path(start, goal, method=method) if method else search.shortest_path(start, goal)
    except (InputError, PlanningError) as error:
        return type(error), str(error)


def check(blocked: np.ndarray, search: GridSearch, start: Any, goal: Any) -> None:
    """Exact, Theta* and the way over cells agree on what is reachable, on errors, and on which is the shortest."""
    exact, theta, octile, back = (
        *(ask(search, start, goal, method) for method in ("exact", "theta_star", None)),
        ask(search, goal, start, "exact"),
    )
    if not (isinstance(exact, PointPath) and isinstance(theta, PointPath) and isinstance(back, PointPath)):
        assert exact == theta == octile
        return
    assert isinstance(octile, GridPath)
    assert exact.status == theta.status == octile.status
    assert back.length == exact.length
    if exact.status != "found":
        return
    assert math.dist(start, goal) * (1.0 - 1e-12) <= exact.length <= min(octile.length, theta.length) * (1.0 + 1e-12)
    for path in (exact, theta):
        assert path.waypoints[[0, -1]].tolist() == [list(start), list(goal)]
        for a, b in itertools.pairwise(path.waypoints.tolist()):
            assert is_free_line(blocked, [v + 0.5 for v in a], [v + 0.5 for v in b]), (a, b)
    if blocked.size <= LARGEST_GRAPH:
        expected = visibility_lengths(blocked, tuple(start), [tuple(goal)])[0]
        assert math.isclose(exact.length, expected, rel_tol=1e-12), (exact.length, expected)


def one_round(generator: random.Random) -> None:
    """One map, searched, changed and searched again."""
    blocked = make_map(generator)
    if generator.random() < 0.5:
        blocked = blocked[: generator.randrange(1, 8), : generator.randrange(1, 8)]
    current = np.array(blocked != 0)
    search = GridSearch(blocked, method=generator.choice(("auto", "jps")))
    for _ in range(generator.randrange(1, 4)):
        for _ in range(generator.randrange(1, 4)):
            check(current, search, pick(generator, search.shape, 0.03), pick(generator, search.shape, 0.03))
        update(generator, [search], current)
    free = np.argwhere(~current).tolist()
    if free:
        start, goal = generator.choice(free), generator.choice(free)
        assert any_angle_path(current, start, goal) == search.any_angle_path(start, goal)
