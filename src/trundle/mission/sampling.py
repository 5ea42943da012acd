"""Starts and goals picked from a map's free space by seed."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, ScenarioError
from trundle.geometry import Pose2D
from trundle.values import as_number, check_kind, check_seed

MIN_DISTANCE = 5.0
"""Between start and goal, in a straight line [m], where the map has room for it."""

_HEADINGS = 72  # between two of them, a corner of a robot of 1 m moves less than the margin
_MARGIN = 0.05  # [m]
_BATCHES = (4, 8, 16, 32)  # cells tried at a time, at first few: a mission mostly needs two
_MAX_PLACES = 256  # places where a robot can turn, looked for at most
_MAX_TRIED = 8192  # cells tried at most
_LEAST_DISTANCE = 0.5  # [m]: closer than this is no mission
_TIGHT_CLEARANCE = (0.03, 0.25)  # [m]
_TIGHT_BATCH = 256
_MAX_TIGHT_BATCHES = 400


@dataclass(frozen=True, slots=True)
class _Place:
    """A cell's centre where the robot can turn on the spot, and the number of the free area that it is in."""

    x: float
    y: float
    area: int


def sample_mission(
    costmap: Costmap,
    seed: int = 0,
    *,
    min_distance: float = MIN_DISTANCE,
    start: Pose2D | Sequence[float] | None = None,
    goal: Pose2D | Sequence[float] | None = None,
) -> tuple[Pose2D, Pose2D]:
    """Pick a start and a goal, or the one that is not given.

    Both are centres of cells where the robot can turn all round, with random yaws, in one area that is nowhere
    narrower than the robot. That is no promise of a path: bends may be too tight. Where the map has no two such places
    `min_distance` apart, the farthest found are taken.

    Args:
        costmap: The map as the robot sees it.
        seed: The same seed gives the same poses.
        min_distance: Between the two, in a straight line [m].
        start: The start, if it is given.
        goal: The goal, if it is given.

    Raises:
        ScenarioError: If the map has no room for it.
        InputError: If both are given, or `min_distance` is not a number of 0 or more.
    """
    check_kind(costmap, Costmap, "a mission's costmap", "Costmap.from_grid(grid, robot) makes one")
    if start is not None and goal is not None:
        raise InputError("start and goal are both given: there is nothing to pick")
    if not (math.isfinite(as_number(min_distance, "min_distance")) and min_distance >= 0.0):
        raise InputError(f"min_distance must be a number of metres of 0 or more, got {min_distance}")
    rng = np.random.default_rng(check_seed(seed))
    areas = _find_areas(costmap)
    given = start if start is not None else goal
    if given is None:
        ends = _pick_two(costmap, areas, rng, min_distance)
        poses = [Pose2D(place.x, place.y, _random_yaw(rng)) for place in ends]
        return poses[0], poses[1]
    fixed = Pose2D.of(given)
    other = _pick_other(costmap, areas, rng, min_distance, fixed)
    picked = Pose2D(other.x, other.y, _random_yaw(rng))
    return (fixed, picked) if start is not None else (picked, fixed)


def sample_tight_ends(costmap: Costmap, seed: int = 0) -> tuple[Pose2D, Pose2D]:
    """Pick a start and a goal without room for a turn on the spot.

    Both are random poses whose footprint is free by 0.03 to 0.25 m, at least 0.5 m apart, in one area where the
    centre of the footprint's inscribed circle can go. That is no promise of a path for the footprint.

    Args:
        costmap: The map as the robot sees it.
        seed: The same seed gives the same poses.

    Raises:
        ScenarioError: If no two such poses are found.
    """
    check_kind(costmap, Costmap, "a mission's costmap", "Costmap.from_grid(grid, robot) makes one")
    rng = np.random.default_rng(check_seed(seed))
    areas, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), diagonal=False)
    poses = _tight_poses(costmap, areas, rng)
    start, area = next(poses, (None, 0))
    if start is not None:
        for pose, its_area in poses:
            if its_area == area and pose.distance_to(start) >= _LEAST_DISTANCE:
                return start, pose
    low, high = _TIGHT_CLEARANCE
    raise ScenarioError(
        f"no start and goal can be picked: the map has no two poses, joined by free space and at least "
        f"{_LEAST_DISTANCE:g} m apart, where the footprint is free by {low:g} to {high:g} m"
    )


def _tight_poses(
    costmap: Costmap, areas: npt.NDArray[np.int32], rng: np.random.Generator
) -> Iterator[tuple[Pose2D, int]]:
    """Random poses that are free by little, each with the number of its area."""
    cells, half = np.flatnonzero(areas > 0), 0.5 * costmap.resolution
    low, high = _TIGHT_CLEARANCE
    for _ in range(_MAX_TIGHT_BATCHES if len(cells) else 0):
        rows, cols = np.unravel_index(rng.choice(cells, _TIGHT_BATCH), areas.shape)
        x, y = (centre + rng.uniform(-half, half, _TIGHT_BATCH) for centre in costmap.cell_to_world(rows, cols))
        yaw = rng.uniform(-math.pi, math.pi, _TIGHT_BATCH)
        poses = np.round(np.column_stack([x, y, yaw]), 4)
        clearance = costmap.clearance(poses, cap=2.0 * high)
        for index in np.flatnonzero((clearance >= low) & (clearance <= high)):
            yield Pose2D(*poses[index].tolist()), int(areas[rows[index], cols[index]])


_MOST_KEPT = 4_000_000  # cells
_areas: WeakKeyDictionary[Costmap, npt.NDArray[np.int32]] = WeakKeyDictionary()


def _find_areas(costmap: Costmap) -> npt.NDArray[np.int32]:
    """Return the area's number of each cell that is wide enough, else 0; kept for the next mission on this costmap."""
    areas = _areas.get(costmap)
    if areas is None:
        areas, _ = label_components(_wide_enough(costmap).view(np.uint8), diagonal=False)
        if areas.size <= _MOST_KEPT:
            areas.flags.writeable = False
            _areas[costmap] = areas
    return areas


def _wide_enough(costmap: Costmap) -> npt.NDArray[np.bool_]:
    """Known cells farther from obstacles than half of the robot's width."""
    corners = costmap.footprint
    edges = np.roll(corners, -1, axis=0) - corners
    normals = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    across = corners @ normals.T
    half_width = (float((across.max(axis=0) - across.min(axis=0)).min()) + costmap.resolution) / 2.0
    decay = costmap.cost_scaling_factor * max(0.0, half_width - costmap.inscribed_radius)
    wide = costmap.data < min(INSCRIBED, int(252.0 * math.exp(-decay)) + 1)
    return wide if costmap.unseen is None else wide & ~costmap.unseen


def _pick_two(
    costmap: Costmap, areas: npt.NDArray[np.int32], rng: np.random.Generator, min_distance: float
) -> tuple[_Place, _Place]:
    places: list[_Place] = []
    best, best_distance = None, _LEAST_DISTANCE
    for place in itertools.islice(_places(costmap, areas, rng), _MAX_PLACES):
        for other in places:
            distance = math.hypot(place.x - other.x, place.y - other.y)
            if place.area != other.area or distance < best_distance:
                continue
            if distance >= min_distance:
                return other, place
            best, best_distance = (other, place), distance
        places.append(place)
    if best is None:
        raise ScenarioError(
            "no start and goal can be picked: the map has no two places, joined by free space and at least "
            f"{_LEAST_DISTANCE:g} m apart, where the robot (swing radius {costmap.circumscribed_radius:.2f} m) can turn"
        )
    return best


def _pick_other(
    costmap: Costmap, areas: npt.NDArray[np.int32], rng: np.random.Generator, min_distance: float, fixed: Pose2D
) -> _Place:
    if not costmap.contains(*(int(index) for index in costmap.world_to_cell(fixed.x, fixed.y))):
        raise ScenarioError(f"({fixed.x:g}, {fixed.y:g}) lies outside the map, which covers {_extent(costmap)}")
    area = _area_near(costmap, areas, fixed)
    if area == 0:
        raise ScenarioError(
            f"nothing can be picked to go with ({fixed.x:g}, {fixed.y:g}): the robot cannot stand there; give both ends"
        )
    best, best_distance = None, _LEAST_DISTANCE
    places = _places(costmap, np.where(areas == area, areas, 0), rng)
    for place in itertools.islice(places, _MAX_PLACES):
        distance = math.hypot(place.x - fixed.x, place.y - fixed.y)
        if distance >= min_distance:
            return place
        if distance >= best_distance:
            best, best_distance = place, distance
    if best is None:
        raise ScenarioError(
            f"nothing can be picked to go with ({fixed.x:g}, {fixed.y:g}): no place joined to it by free space leaves "
            f"room to turn (swing radius {costmap.circumscribed_radius:.2f} m)"
        )
    return best


def _extent(costmap: Costmap) -> str:
    rows, cols = costmap.shape
    x, y = costmap.cell_to_world(np.array([-0.5, -0.5, rows - 0.5, rows - 0.5]), np.array([-0.5, cols - 0.5] * 2))
    return f"x {x.min():g} to {x.max():g}, y {y.min():g} to {y.max():g} m"


def _area_near(costmap: Costmap, areas: npt.NDArray[np.int32], pose: Pose2D) -> int:
    """Label of the area nearest to a pose, 0 where none is within the swing radius.

    A robot may stand closer to a wall than it could pass along it.
    """
    row, col = np.nonzero(areas > 0)
    x, y = costmap.cell_to_world(row, col)
    distances = np.hypot(x - pose.x, y - pose.y)
    if len(distances) == 0 or distances.min() > costmap.circumscribed_radius + costmap.resolution:
        return 0
    nearest = int(distances.argmin())
    return int(areas[row[nearest], col[nearest]])


def _places(costmap: Costmap, areas: npt.NDArray[np.int32], rng: np.random.Generator) -> Iterator[_Place]:
    """Places in random order where the robot can turn by 360°."""
    cells = np.flatnonzero(areas > 0)
    drawn = rng.choice(cells, size=min(_MAX_TRIED, len(cells)), replace=False)
    headings = np.arange(_HEADINGS) * (2.0 * math.pi / _HEADINGS)
    sizes = itertools.chain(_BATCHES, itertools.repeat(_BATCHES[-1]))
    first = 0
    while first < len(drawn):
        size = next(sizes)
        row, col = np.unravel_index(drawn[first : first + size], areas.shape)
        first += size
        x, y = costmap.cell_to_world(row, col)
        poses = np.column_stack([np.repeat(x, _HEADINGS), np.repeat(y, _HEADINGS), np.tile(headings, len(x))])
        clear = costmap.clearance(poses, cap=2.0 * _MARGIN).reshape(-1, _HEADINGS).min(axis=1) >= _MARGIN
        for index in np.flatnonzero(clear):
            area = int(areas[row[index], col[index]])
            yield _Place(round(float(x[index]), 6), round(float(y[index]), 6), area)


def _random_yaw(rng: np.random.Generator) -> float:
    return round(float(rng.uniform(-math.pi, math.pi)), 4)
