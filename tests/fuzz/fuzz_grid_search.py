"""Fuzz the searches over binary grids: whatever is asked, an answer that all methods agree on or a typed error."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from support.grid_steps import DIAGONAL, STRAIGHT, count_steps, path_costs_from
from trundle.errors import BlockedPoseError, InputError, PlanningError
from trundle.planning import Cancellation, GridSearch

SIZES = (1, 2, 3, 5, 8, 31, 60, 61, 62, 63, 64, 65, 66, 120, 126, 127, 128, 129, 200)
SPOILED: tuple[Any, ...] = (
    None,
    -1,
    2**31,
    2**63,
    -(2**63),
    2**70,
    0.5,
    "1",
    (),
    (1,),
    (1, 2, 3),
    b"ab",
    [None, 1],
    {},
)
EXTREME = (-1.0, math.nan, math.inf, 1e300, None)
METHODS = ("auto", "jps", "astar")


def make_map(generator: random.Random) -> np.ndarray:
    """A map of any kind of density, often a view of a larger one."""
    rows, cols = generator.choice(SIZES), generator.choice(SIZES)
    rng = np.random.default_rng(generator.randrange(2**32))
    step_row, step_col = generator.choice((1, 1, -1, 2)), generator.choice((1, 1, -1, 3))
    base = rng.random((rows * abs(step_row), cols * abs(step_col))) < generator.choice(
        (0.0, 0.02, 0.1, 0.3, 0.6, 1.0, *[generator.random()] * 6)
    )
    if generator.random() < 0.3:
        base[:: generator.choice((2, 4, 9))] = True
        base[:, :: generator.choice((3, 7, 64))] = False
    view = base[::step_row, ::step_col]
    view = view.T if generator.random() < 0.3 else view
    return view if generator.random() < 0.5 else view.astype(np.uint8) * generator.choice((1, 128, 255))


def pick(generator: random.Random, shape: tuple[int, int], spoil: float) -> Any:
    """A cell, at the border more often than not, and sometimes something else."""
    if generator.random() < spoil:
        return generator.choice(SPOILED)
    cell: list[Any] = [generator.choice((0, count - 1, generator.randrange(count))) for count in shape]
    if generator.random() < spoil:
        cell[generator.randrange(2)] = generator.choice((*SPOILED, *shape))
    return generator.choice((tuple, list))(cell)


def ask(searches: list[GridSearch], start: Any, goal: Any, **limits: Any) -> None:
    """Every search gives the same length, or the same error."""
    answers: set[Any] = set()
    for search in searches:
        try:
            path = search.shortest_path(start, goal, **limits)
        except (InputError, PlanningError) as error:
            answers.add((type(error), str(error)))
            continue
        cells = path.cells
        if path.status == "found":
            assert len(cells) > 0
            answers.add(round(path.length, 6))
        else:
            assert len(cells) == 0
            answers.add(path.status)
    assert len(answers) == 1, answers


def ask_many(generator: random.Random, searches: list[GridSearch]) -> None:
    """Many queries at once, of any methods, ends moved or not: all are answered, or refused by a typed error."""
    shape = searches[0].shape
    ends = [[pick(generator, shape, 0.01) for _ in range(generator.choice((0, 1, 3, 20)))] for _ in range(2)]
    cancel = Cancellation()
    if generator.random() < 0.2:
        cancel.cancel()
    tolerances = {
        name: generator.choice((0.0, 1.5, 40.0, *EXTREME)) if generator.random() < 0.4 else 0.0
        for name in ("start_tolerance", "goal_tolerance")
    }
    options: dict[str, Any] = {**tolerances, "partial": generator.random() < 0.4, "cancel": cancel, "deadline_s": 1e3}
    for search in searches:
        for plan in (search.plan_many, search.any_angle_paths):
            try:
                paths = plan(*ends, threads=generator.choice((1, 2, 3)), **options)
            except (InputError, PlanningError):
                continue
            assert len(list(paths)) == len(ends[0])
            assert (paths.length >= 0.0)[(paths.status == "found") | (paths.status == "partial")].all()


def ask_moved(generator: random.Random, search: GridSearch, current: np.ndarray) -> None:
    """Ends moved by at most their tolerance, to where a search between the moved ends finds the same path."""
    start, goal = (tuple(generator.randrange(count) for count in search.shape) for _ in range(2))
    reach, partial = generator.choice((0.0, 1.0, 2.5, 100.0)), generator.random() < 0.5
    try:
        path = search.shortest_path(start, goal, start_tolerance=reach, goal_tolerance=reach, partial=partial)
    except BlockedPoseError as error:
        refused = error.cell
    else:
        refused = None
    if refused is not None:
        assert current[refused]
        return
    assert max(path.start_snapped, path.goal_snapped) <= reach
    if path.status == "unreachable":
        assert not partial
        return
    first, last = (tuple(cell) for cell in path.waypoints[[0, -1]].tolist())
    assert math.isclose(math.dist(first, start), path.start_snapped, abs_tol=1e-9)
    assert math.isclose(math.dist(last, goal), path.goal_snapped + path.remaining, abs_tol=1e-9)
    assert (path.status == "partial") == (path.remaining > 0.0)
    assert path.length == search.shortest_path(first, last).length


def check_dijkstra(generator: random.Random, searches: list[GridSearch], current: np.ndarray) -> None:
    """From one cell to many, corners and itself among them: the lengths of SciPy's Dijkstra, to the last step."""
    free = np.argwhere(~current)
    if len(free) == 0:
        return
    start = tuple(generator.choice(free).tolist())
    corners = [(row, col) for row in (0, current.shape[0] - 1) for col in (0, current.shape[1] - 1)]
    goals = [start, *[cell for cell in corners if not current[cell]]]
    goals += [tuple(generator.choice(free).tolist()) for _ in range(6)]
    costs = path_costs_from(current, start, searches[0].connectivity)
    for search in searches:
        many = search.plan_many([start] * len(goals), goals, threads=1)
        for goal, path in zip(goals, many, strict=True):
            if math.isinf(costs[goal]):
                assert (path.status, path.length) == ("unreachable", math.inf)
                continue
            straight, diagonal = count_steps(current, path, start, goal, search.connectivity)
            assert goal == start or straight * STRAIGHT + diagonal * DIAGONAL == costs[goal]
            assert math.isclose(path.length, straight + diagonal * math.sqrt(2.0), rel_tol=1e-12)
            assert path == search.shortest_path(start, goal)


def one_round(generator: random.Random) -> None:
    """One map, searched, changed and searched again."""
    blocked = make_map(generator)
    connectivity = generator.choice((4, 8, 8, 8))
    searches = [GridSearch(blocked, connectivity, method=m) for m in (METHODS if connectivity == 8 else ("auto",))]
    shape = searches[0].shape
    current = np.array(blocked != 0)
    for _ in range(generator.randrange(1, 5)):
        for _ in range(generator.randrange(1, 8)):
            ask(searches, pick(generator, shape, 0.1), pick(generator, shape, 0.1))
        check_dijkstra(generator, searches, current)
        update(generator, searches, current)
    check_dijkstra(generator, searches, current)
    ask([GridSearch(current, connectivity), *searches], pick(generator, shape, 0.0), pick(generator, shape, 0.0))
    ask_many(generator, searches)
    for search in searches:
        ask_moved(generator, search, current)


def update(generator: random.Random, searches: list[GridSearch], current: np.ndarray) -> None:
    """A rectangle of new values, or one that all refuse."""
    spans: list[Any] = []
    for count in current.shape:
        first = generator.randrange(count + 1)
        spans.append(generator.choice((slice(first, generator.randrange(first, count + 1)), slice(first, None))))
    place = current[spans[0], spans[1]]
    rng = np.random.default_rng(generator.randrange(2**32))
    values: Any = rng.random(place.shape) < generator.choice((0.0, 0.2, 0.5, 1.0))
    values = generator.choice((values, values.astype(np.uint8), np.asfortranarray(values), True, False))
    spoiled = generator.random() < 0.1
    if spoiled:
        bad = (*SPOILED, slice(0, 9999), slice(3, 1), (5, 2), slice(None, None, 2))
        spans[generator.randrange(2)] = generator.choice(bad)
    refused = 0
    for search in searches:
        try:
            search.update(spans[0], spans[1], values)
        except (InputError, PlanningError):
            refused += 1
    assert refused == (len(searches) if spoiled else 0)
    if not spoiled:
        place[:] = values
