"""Fuzz hybrid A*: whatever is asked, a path or a part of one whose footprint is free all along, or a typed error."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from fuzz.loop import attempt, spoil
from support.swept import swept_area_blocked
from trundle._core import flood_poses
from trundle.costmap import Costmap
from trundle.errors import InputError, PlanningError
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning import Cancellation
from trundle.planning.cancellation import Patience
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import Query, cell_at
from trundle.planning.search_rounds import find_enclosure

SIZES = (1, 3, 20, 41, 64, 64, 90, 90)
EXTREME = (0.0, -1.0, 1e-9, 1e-3, 1e3, 1e9, math.nan, math.inf)
NUMBERS = {
    "minimum_turning_radius": (0.01, 0.3, 0.4, 1.0, 20.0, 1e4),
    "reverse_penalty": (1.0, 2.0, 50.0),
    "change_penalty": (0.0, 0.3, 10.0),
    "turn_penalty": (0.0, 0.5, 10.0),
    "cost_weight": (0.0, 2.0, 100.0),
    "heuristic_weight": (1.0, 1.2, 10.0),
    "cell_size": (0.01, 0.1, 0.33, 5.0),
    "padding": (0.0, 0.001, 0.02, 0.2),
    "spacing": (0.01, 0.05, 1.0),
    "start_tolerance": (0.0, 0.3, 5.0),
    "goal_tolerance": (0.0, 0.3, 5.0),
}


def make_costmap(generator: random.Random) -> Costmap:
    """Clutter, rooms or nothing, anywhere, at any scale, for a footprint of any size."""
    rows, cols = generator.choice(SIZES), generator.choice(SIZES)
    rng = np.random.default_rng(generator.randrange(2**32))
    data = np.where(rng.random((rows, cols)) < generator.choice((0.0, 0.0, 0.005, 0.03, 0.4)), 100, 0).astype(np.int8)
    data[rng.random((rows, cols)) < generator.choice((0.0, 0.0, 0.0, 0.01))] = -1
    if generator.random() < 0.3:
        data[:, :: generator.choice((5, 20, 40))] = 100
        data[:: generator.choice((3, 15)), :] = 0
    resolution = generator.choice((0.01, 0.05, 0.1, 0.1, 0.7))
    origin = Pose2D(generator.choice((0.0, -3.0, 1e4)), generator.uniform(-5, 5), generator.choice((0.0, 0.5, math.pi)))
    size = resolution * generator.choice((1.0, 1.0, 1.0, 4.0, 100.0))
    front, back, side = (size * generator.choice((0.2, 0.7, 1.5, 3.0)) for _ in range(3))
    outline = np.array([(front, side), (-back, side), (-back, -side), (front, -side)])
    return Costmap.from_grid(OccupancyGrid(data, resolution, origin), outline, generator.choice((None, 0.0)))


def make_planner(generator: random.Random) -> HybridAStarPlanner | None:
    """A planner of any options; none where these are refused."""
    options: dict[str, Any] = {
        "motion_model": generator.choice(("dubins", "reeds_shepp")),
        "in_place": generator.random() < 0.4,
        "allow_partial": generator.random() < 0.3,
        "max_expansions": generator.choice((1, 50, 1500)),
    }
    for name, values in NUMBERS.items():
        if generator.random() < 0.4:
            options[name] = generator.choice(values)
        if generator.random() < 0.02:
            options[name] = generator.choice(EXTREME)
    try:
        return HybridAStarPlanner(**options)
    except InputError:
        return None


def make_pose(generator: random.Random, costmap: Costmap) -> Pose2D:
    """A pose on the map, its border or beside it."""
    rows, cols = costmap.shape
    share = [generator.choice((generator.random(),) * 20 + (0.0, 1.0, 1.1)) for _ in range(2)]
    x, y = costmap.resolution * cols * share[0], costmap.resolution * rows * share[1]
    return costmap.origin @ Pose2D(x, y, generator.choice((0.0, math.pi, generator.uniform(-3, 3))))


def between(path: Path) -> FloatArray:
    """Poses along a path's lines and turns, four to each."""
    steps = np.diff(path.poses, axis=0)
    steps[:, 2] = np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi
    share = np.linspace(0.25, 1.0, 4)[:, np.newaxis, np.newaxis]
    return (path.poses[:-1] + share * steps).reshape(-1, 3)


def one_round(generator: random.Random) -> int:
    """One map and one planner, asked a few times; how many paths there were."""
    costmap, planner = make_costmap(generator), make_planner(generator)
    found = 0
    for _ in range(generator.randrange(1, 5)):
        start, goal = make_pose(generator, costmap), make_pose(generator, costmap)
        cancel = Cancellation()
        if generator.random() < 0.1:
            cancel.cancel()
        free = generator.random() < 0.2
        if planner is None:
            continue
        try:
            path = planner.plan(costmap, start, Goal(goal.x, goal.y) if free else goal, cancel=cancel)
        except PlanningError:
            continue
        check(costmap, planner, path)
        if generator.random() < 0.05:
            first, last = (End(pose, cell_at(costmap, pose.x, pose.y)) for pose in (path.start, path.goal))
            query = Query(costmap, first, last, first, last, yaw_free=False)
            assert find_enclosure(query, Patience(None, None, "none")) is None
        found += 1
    if generator.random() < 0.1:
        flood_spoiled(generator, costmap)
    return found


def flood_spoiled(generator: random.Random, costmap: Costmap) -> None:
    side = costmap.resolution * np.array(costmap.shape)[::-1]
    ends = [np.array([*(generator.random() * side), generator.uniform(-4, 4)]) for _ in range(2)]
    arguments = costmap.data, costmap.resolution, costmap.footprint, ends[0], True, ends[1], False
    attempt(flood_poses, spoil(generator, (*arguments, 0.5 * costmap.resolution, 30, 10_000, 0.01, None)))


def check(costmap: Costmap, planner: HybridAStarPlanner, path: Path) -> None:
    assert math.isfinite(path.cost)
    assert path.status == "found" or (path.status == "partial" and planner.settings.allow_partial)
    assert path.backward.shape == (len(path) - 1,)
    # With no room at an end poses are checked 5 mm apart, and something as thin may be between them.
    thinner = costmap.footprint * (1.0 - min(0.5, 0.005 / costmap.inscribed_radius))
    turns = np.abs(np.remainder(np.diff(path.poses[:, 2]) + np.pi, 2 * np.pi) - np.pi)
    if turns.max(initial=0.0) > 0.5:  # the poses of a turn in place are far apart, and lie on an arc
        return
    assert not costmap.footprint_collides(between(path), outline=thinner).any()
    if len(path) < 500:
        assert swept_area_blocked(costmap, path, thinner) == 0.0
    if not planner.settings.in_place:
        lengths = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
        assert (turns <= 1.01 * lengths * np.pi / 2 / planner.settings.minimum_turning_radius + 1e-4).all()
