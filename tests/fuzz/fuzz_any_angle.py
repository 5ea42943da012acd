"""Fuzz the paths in any direction: whatever is asked, a path that an oracle agrees with or a typed error."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np

from fuzz.fuzz_grid_search import make_map, pick, update
from support.visibility import is_free_line, visibility_lengths
from trundle.errors import InputError, PlanningError
from trundle.planning import GridPath, GridSearch, PointPath, any_angle_path

Path: TypeAlias = GridPath | PointPath

LARGEST_GRAPH = 40
"""Cells of a map on which every path is compared with the visibility graph's."""


def ask(find: Callable[..., Path], start: Any, goal: Any) -> Path | tuple[type, str]:
    """What a search finds, or the error that says why it finds nothing."""
    try:
        return find(start, goal)
    except (InputError, PlanningError) as error:
        return type(error), str(error)


def check(blocked: np.ndarray, search: GridSearch, start: Any, goal: Any) -> None:
    """The paths of a point and over cells agree on what is reachable, on errors, and on which is the shorter."""
    exact, back = ask(search.any_angle_path, start, goal), ask(search.any_angle_path, goal, start)
    octile = ask(search.shortest_path, start, goal)
    if not (isinstance(exact, PointPath) and isinstance(back, PointPath)):
        assert exact == octile
        return
    assert isinstance(octile, GridPath)
    assert exact.status == octile.status
    assert back.length == exact.length
    if exact.status != "found":
        return
    assert math.dist(start, goal) * (1.0 - 1e-12) <= exact.length <= octile.length * (1.0 + 1e-12)
    assert exact.waypoints[[0, -1]].tolist() == [list(start), list(goal)]
    for a, b in itertools.pairwise(exact.waypoints.tolist()):
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
