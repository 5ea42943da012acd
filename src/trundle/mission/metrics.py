"""`compute_metrics`: the metrics of a run, and the ground truth of its surroundings that they are measured on."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle._core import chebyshev_field, polyline_distances
from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.geometry import FloatArray, path_length, wrap_angles
from trundle.geometry.solids import Solid, solids_bounds
from trundle.mission.episode import Metrics
from trundle.mission.trajectory import Trajectory
from trundle.path import Path
from trundle.planning.grid.grid_search import GridSearch
from trundle.robots import Robot
from trundle.sim.clearance import least_clearance, map_extent, map_world
from trundle.worlds import World

MeasuredOn: TypeAlias = Literal["world", "map", "nothing"]

CLEARANCE_CAP = 2.0
"""Clearances are capped at this [m]."""

_FIRST = 12  # poses in the tightest places, measured first

_RESOLUTION_M = 0.05
"""Resolution of the world's map where the robot has none [m]."""

_END_TOLERANCE_M = 0.5
"""How far an end of the shortest path may be moved: the cells hold all of every solid, and more at its edges."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What was measured around the robot; see `Metrics` for what it means.

    Attributes:
        min_clearance_m: [m]; none where nothing is known.
        shortest_path_m: [m]; none where the robot did not arrive.
        measured_on: "world", "map" where the simulator does not know its solids, "nothing" without a map.
        closest: Index of the pose where the robot was closest to a solid, to within a cell; none where it is not known.
    """

    min_clearance_m: float | None
    shortest_path_m: float | None
    measured_on: MeasuredOn
    closest: int | None = None


@dataclass(frozen=True, slots=True)
class DroppedBox:
    """A solid that was put into the world of a run.

    Attributes:
        index: Index of the first pose of the trajectory from which on it was there.
        solid: The solid.
    """

    index: int
    solid: Solid


class TrueMaps:
    """The true map of a world for a robot, kept for the next run there if that needs a map of the same extent.

    All runs need the same whose ends and trajectory are within the world.
    """

    def __init__(self) -> None:
        self._key: tuple[object, ...] | None = None
        self._map: Costmap | None = None
        self._held: tuple[World, Robot] | None = None  # so that no other objects get their ids
        self._bounds: tuple[World, tuple[FloatArray, FloatArray]] | None = None
        self._search: tuple[Costmap, GridSearch] | None = None
        self._free: tuple[Costmap, npt.NDArray[np.uint8]] | None = None

    def get(self, world: World, robot: Robot, points: FloatArray, *, resolution: float, margin: float) -> Costmap:
        """Return the map that `map_world` makes."""
        bounds = self.bounds(world)
        extent = map_extent(world, points, resolution=resolution, margin=margin, bounds=bounds)
        key = (id(world), id(robot), extent)
        if self._map is None or key != self._key:
            self._key, self._map = key, map_world(world, robot, points, resolution=resolution, margin=margin)
            self._held = (world, robot)
        return self._map

    def bounds(self, world: World) -> tuple[FloatArray, FloatArray]:
        """Return bounds (low, high) [m] of each solid of a world, each of shape (N, 3)."""
        if self._bounds is None or self._bounds[0] is not world:
            self._bounds = world, solids_bounds(world.solids)
        return self._bounds[1]

    def search(self, true_map: Costmap) -> GridSearch:
        """Return what finds shortest paths of the footprint's inscribed disc on a map."""
        if self._search is None or self._search[0] is not true_map:
            self._search = true_map, GridSearch(true_map.data >= INSCRIBED)
        return self._search[1]

    def free(self, true_map: Costmap) -> npt.NDArray[np.uint8]:
        """Return the Chebyshev distance [cells] of each cell of a map to the nearest one that a solid reaches into."""
        if self._free is None or self._free[0] is not true_map:
            self._free = true_map, chebyshev_field((true_map.data >= LETHAL).view(np.uint8))
        return self._free[1]


class Measure(Protocol):
    """Measures a run's surroundings; see `measure_truth`."""

    def __call__(
        self,
        poses: FloatArray,
        ends: Sequence[Sequence[float]],
        robot: Robot,
        world: World | None,
        costmap: Costmap | None,
        *,
        arrived: bool,
        touched: bool,
    ) -> Truth:
        """Measure it."""
        ...


def measure_truth(
    poses: FloatArray,
    ends: Sequence[Sequence[float]],
    robot: Robot,
    world: World | None,
    costmap: Costmap | None,
    *,
    arrived: bool,
    touched: bool,
    true_maps: TrueMaps | None = None,
) -> Truth:
    """Measure a run's surroundings.

    Args:
        poses: Driven (x, y, yaw) [m, m, rad], map frame, shape (N, 3).
        ends: Start and goals, in order: (x, y, …).
        robot: What drove.
        world: Where it drove; none where that is not known.
        costmap: The robot's own first one, which stands for the world where there is none; none where it has none.
        arrived: Whether a shortest path is asked for.
        touched: Whether there was a contact: nothing is nearer.
        true_maps: Where the map of the world is kept for the next run.
    """
    points = np.array([end[:2] for end in ends], dtype=np.float64)
    maps = TrueMaps() if true_maps is None else true_maps
    if world is not None:
        resolution = _RESOLUTION_M if costmap is None else costmap.resolution
        margin = CLEARANCE_CAP + robot.circumscribed_radius + 2.0 * resolution
        around = np.concatenate([poses[:, :2], points])
        true_map = maps.get(world, robot, around, resolution=resolution, margin=margin)
    elif costmap is not None:
        true_map = costmap
    else:
        return Truth(0.0 if touched else None, None, "nothing")
    coarse = _near_clearances(true_map, poses, None if world is None else maps.free(true_map))
    if touched:
        clearance = 0.0
    elif world is not None:
        clearance = least_clearance(
            world, robot, poses, coarse, resolution=true_map.resolution, cap=CLEARANCE_CAP, bounds=maps.bounds(world)
        )
    else:
        clearance = float(coarse.min())
    shortest = shortest_length(true_map, points, poses[:, :2], search=maps.search(true_map)) if arrived else None
    return Truth(clearance, shortest, "map" if world is None else "world", int(coarse.argmin()))


def _near_clearances(costmap: Costmap, poses: FloatArray, free: npt.NDArray[np.uint8] | None) -> FloatArray:
    """Return clearances [m] of poses, shape (N,), exact near the least one, and otherwise at least what is near.

    Near is what `least_clearance` looks at more closely. On a map with room around all poses, `free` tells which are
    in the tightest places; a few of these tell how far near is.
    """
    if free is None:
        return costmap.clearance(poses, CLEARANCE_CAP)
    rows, cols = costmap.world_to_cell(poses[:, 0], poses[:, 1])
    room = (free[rows, cols].astype(np.float64) - 1.0) * costmap.resolution - costmap.circumscribed_radius
    tightest = room.argpartition(min(_FIRST, len(room) - 1))[:_FIRST]
    least = float(costmap.clearance(poses[tightest], CLEARANCE_CAP).min())
    limit = min(CLEARANCE_CAP, least + 2.0 * costmap.resolution)
    near = np.flatnonzero(room <= limit)
    clearances = np.full(len(poses), limit)
    clearances[near] = costmap.clearance(poses[near], limit)
    return clearances


def near_boxes(truth: Truth, boxes: Sequence[DroppedBox], poses: FloatArray, robot: Robot) -> Truth:
    """Count boxes that were dropped during a run: in the clearance from then on, and not in the shortest path.

    Args:
        truth: What was measured without them.
        boxes: The boxes.
        poses: Driven (x, y, yaw) [m, m, rad], map frame, shape (N, 3).
        robot: What drove.
    """
    if truth.min_clearance_m is None:
        return truth
    least, closest = truth.min_clearance_m, truth.closest
    for box in boxes:
        after = poses[box.index :]
        far = np.full(len(after), CLEARANCE_CAP)
        world = World(box.solid.name, (box.solid,))
        clearance = least_clearance(world, robot, after, far, resolution=_RESOLUTION_M, cap=CLEARANCE_CAP)
        if clearance < least:
            x, y, _ = box.solid.pose.position
            least, closest = clearance, box.index + int(np.hypot(after[:, 0] - x, after[:, 1] - y).argmin())
    return replace(truth, min_clearance_m=least, closest=closest)


def shortest_length(
    true_map: Costmap, points: FloatArray, driven: FloatArray, *, search: GridSearch | None = None
) -> float:
    """Return the length [m] of the shortest path of the footprint's inscribed disc through some points in turn.

    It is the shortest in any direction past the cells that the disc's centre must keep off; cells that the robot has
    driven through count as free, as it has shown.

    Args:
        true_map: Where the disc collides.
        points: Start and goals [m], shape (M, 2).
        driven: Where the robot was [m], shape (N, 2).
        search: Finds paths on that map, where it was made before.
    """
    row, col = _driven_cells(true_map, driven)
    if search is None or (true_map.data[row, col] >= INSCRIBED).any():
        blocked = true_map.data >= INSCRIBED
        blocked[row, col] = False
        search = GridSearch(blocked)
    tolerance = _END_TOLERANCE_M / true_map.resolution
    rows, cols = true_map.world_to_cell(points[:, 0], points[:, 1])
    cells = np.stack([rows, cols], axis=1).tolist()
    length = 0.0
    for leg, (start, goal) in enumerate(itertools.pairwise(cells)):
        path = search.any_angle_path(start, goal, start_tolerance=tolerance, goal_tolerance=tolerance)
        if path.status != "found":
            length += math.dist(points[leg], points[leg + 1])  # No path is shorter.
            continue
        turns = path.waypoints[1:-1]
        inner = np.stack(true_map.cell_to_world(turns[:, 0], turns[:, 1]), axis=1)
        line = np.concatenate([points[leg, None], inner, points[leg + 1, None]])
        length += path_length(line)
    return length


def _driven_cells(true_map: Costmap, driven: FloatArray) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return rows and columns of the cells of a driven line, by which a path among cells may follow it."""
    steps = np.diff(driven, axis=0)
    parts = np.maximum(np.ceil(4.0 * np.hypot(*steps.T) / true_map.resolution).astype(int), 1)
    number = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    shares = number / np.repeat(parts, parts)
    between = np.repeat(driven[:-1], parts, axis=0) + shares[:, None] * np.repeat(steps, parts, axis=0)
    points = np.concatenate([between, driven[-1:]])
    rows, cols = true_map.world_to_cell(points[:, 0], points[:, 1])
    # A diagonal step needs the two cells beside it.
    row, col = np.concatenate([rows, rows[:-1], rows[1:]]), np.concatenate([cols, cols[1:], cols[:-1]])
    inside = true_map.contains(row, col)
    return row[inside], col[inside]


_LEAST_DISTANCE = 0.01  # [m]: below it, turning per distance is meaningless


def compute_metrics(
    trajectory: Trajectory,
    paths: Sequence[Path],
    costmap: Costmap | None,
    *,
    arrived: bool,
    path_length_m: float,
    planning_s: float,
    replans: int,
    wall_s: float,
    contacts: Sequence[str],
    standing_contacts: Sequence[str] = (),
    unseen_contacts: Sequence[str] = (),
    monitor_stops: int | None = None,
    recoveries: int = 0,
    standing_reasons: Mapping[str, int] | None = None,
    lost_s: float = 0.0,
    forgotten_m: float = 0.0,
    truth: Truth | None = None,
) -> Metrics:
    """Compute the metrics of a run; see `Metrics` for their definitions.

    Args:
        trajectory: The run.
        paths: What its column `path` counts.
        costmap: What the clearance is measured on where the truth is not known; none where there is none.
        arrived: Whether it was a success.
        path_length_m: Length [m] of the first plans to all goals.
        planning_s: Wall time spent on planning [s].
        replans: Plans beyond the first ones.
        wall_s: Wall time of the loop [s].
        contacts: What was touched.
        standing_contacts: What ran into the robot while it stood.
        unseen_contacts: What was touched and no lidar could see.
        monitor_stops: How often a collision monitor stopped the robot; none without one.
        recoveries: Number of steps of recovery that ran.
        standing_reasons: In how many control periods the controller made no progress, by reason. If None, never.
        lost_s: Time [s] in which the localizer did not say that it is localized.
        forgotten_m: How far the robot was driven [m] before the trajectory begins, of which that is all that is kept.
        truth: What was measured around the robot. If None, that nothing is known but the costmap and the plans, and
            `path_length_m` stands for the shortest path.
    """
    if truth is None:
        shortest_m = path_length_m if arrived else None
        truth = Truth(None, shortest_m, "nothing")
        if costmap is not None:
            clearance = float(costmap.clearance(trajectory.poses, CLEARANCE_CAP).min())
            truth = Truth(clearance, shortest_m, "map")
    distance = path_length(np.column_stack([trajectory.x, trajectory.y]))
    turning = float(np.abs(wrap_angles(np.diff(trajectory.yaw))).sum())
    errors = cross_track_errors(trajectory, paths)
    misplaced = np.hypot(*(trajectory.estimates[:, :2] - trajectory.poses[:, :2]).T)
    simulated = float(trajectory.time[-1])
    shortest = truth.shortest_path_m or 0.0
    whole = forgotten_m + distance
    longest = max(whole, shortest)
    return Metrics(
        time_s=simulated,
        distance_m=whole,
        path_length_m=path_length_m,
        spl=(shortest / longest if longest > 0.0 else 1.0) if arrived else 0.0,
        min_clearance_m=truth.min_clearance_m,
        mean_cross_track_error_m=float(errors.mean()) if len(errors) else None,
        max_cross_track_error_m=float(errors.max()) if len(errors) else None,
        smoothness_rad_per_m=turning / distance if distance >= _LEAST_DISTANCE else None,
        planning_ms=planning_s * 1e3,
        replans=replans,
        real_time_factor=simulated / wall_s if wall_s > 0.0 else 0.0,
        contacts=tuple(contacts),
        shortest_path_m=truth.shortest_path_m,
        measured_on=truth.measured_on,
        standing_contacts=tuple(standing_contacts),
        unseen_contacts=tuple(unseen_contacts),
        position_error_m=float(misplaced[-1]),
        localization_error_m=float(misplaced.mean()),
        localization_error_p95_m=_percentile_95(misplaced),
        lost_s=lost_s,
        monitor_stops=monitor_stops,
        recoveries=recoveries,
        standing_reasons=dict(sorted((standing_reasons or {}).items(), key=lambda item: -item[1])),
    )


def _percentile_95(values: FloatArray) -> float:
    """Return the 95 % quantile, as `np.percentile` does, which imports more of NumPy in each worker."""
    return float(np.interp(0.95 * (len(values) - 1), np.arange(len(values)), np.sort(values)))


def cross_track_errors(trajectory: Trajectory, paths: Sequence[Path]) -> FloatArray:
    """Return the distance [m] from base_link to the path followed, for every row that has one; shape (M,), M ≤ N."""
    parts: list[FloatArray] = []
    for index, path in enumerate(paths):
        rows = trajectory.path == index
        if rows.any():
            parts.append(distances_to_polyline(trajectory.poses[rows, :2], path.poses[:, :2]))
    return np.concatenate(parts) if parts else np.zeros(0)


def distances_to_polyline(points: FloatArray, corners: FloatArray) -> FloatArray:
    """Return the distance [m] of each of `points` (N, 2) from a polyline with `corners` (M, 2), M ≥ 1."""
    return polyline_distances(np.ascontiguousarray(points), np.ascontiguousarray(corners))
