"""`Arena`: the maps that episodes take place on, and their missions: starts, goals, and the distances to these."""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, ScenarioError, WorldError
from trundle.geometry import FloatArray, Pose2D
from trundle.gym.navigation_settings import SPLITS, NavigationSettings, kind_of
from trundle.maps import OccupancyGrid
from trundle.mission.obstacles import Unmapped
from trundle.planning import cost_field
from trundle.robots import Robot
from trundle.sim.batch import MoverRecording
from trundle.sim.batch.simulator import choose_threads
from trundle.worlds import World
from trundle.worlds.movers import Crowd

_GOALS = 8
"""Goals of each map; each has a field of distances, of 4 bytes a cell."""

_STARTS = 256
_RECORDINGS = 4
"""Recordings of each world with movers: an episode is among one of them."""

_WORLDS_OF_A_SPLIT = 1_000_000_000
_WORLDS_OF_A_SEED = 10_000
_LEAST_DISTANCE = 0.5  # [m]


@dataclass(frozen=True, slots=True)
class Missions:
    """Missions of one map.

    Attributes:
        poses: (x, y, yaw) of the starts, map frame, shape (n, 3); a yaw of NaN is drawn for each episode.
        goals: (x, y) [m], shape (n, 2).
        fields: Which of the map's fields of distances is of the goal, shape (n,).
        distances: Shortest path [m], shape (n,).
    """

    poses: FloatArray
    goals: FloatArray
    fields: npt.NDArray[np.int64]
    distances: FloatArray


class Arena:
    """Maps with missions and movers.

    Args:
        robot: The robot.
        grids: The maps.
        names: What they are called.
        missions: Missions of each map.
        fields: Distances to the goals of each map [m], infinite where the robot cannot go, each of the map's shape.
        recordings: Recordings of the movers of each map, none or several.
        known: The maps that a robot has, where they lack something; else `grids`.
    """

    def __init__(
        self,
        robot: Robot,
        grids: Sequence[OccupancyGrid],
        names: Sequence[str],
        missions: Sequence[Missions],
        fields: Sequence[Sequence[npt.NDArray[np.float32]]],
        recordings: Sequence[Sequence[MoverRecording]],
        known: Sequence[OccupancyGrid] | None = None,
    ) -> None:
        self.robot, self.grids, self.names = robot, tuple(grids), tuple(names)
        self.known = self.grids if known is None else tuple(known)
        self.recordings = [each for of_map in recordings for each in of_map]
        self.recording_counts = np.array([len(of_map) for of_map in recordings])
        self.first_recording = _starts_of(self.recording_counts)
        counts = np.array([len(each.poses) for each in missions])
        self.mission_counts, self.first_mission = counts, _starts_of(counts)
        self.starts = np.concatenate([each.poses for each in missions])
        self.goals = np.concatenate([each.goals for each in missions])
        self.distances = np.concatenate([each.distances for each in missions])
        first_fields = _starts_of([len(of_map) for of_map in fields])
        self.mission_fields = np.concatenate([m.fields + at for m, at in zip(missions, first_fields, strict=True)])
        self.distances_to_goals = np.concatenate([field.ravel() for of_map in fields for field in of_map])
        self.field_starts = _starts_of([field.size for of_map in fields for field in of_map])
        self.shapes = np.array([grid.shape for grid in grids])
        self.map_starts = _starts_of(self.shapes.prod(axis=1))
        x, y, yaw = np.array([grid.origin.as_tuple() for grid in grids]).T
        self.frames = np.column_stack([x, y, np.cos(yaw), np.sin(yaw)])
        self.resolution = grids[0].resolution

    def cells_ahead(self, length: float, grids: Sequence[OccupancyGrid], threads: int) -> npt.NDArray[np.int32]:
        """Return, for each cell of each field, which cell is some way ahead on a path that keeps away from walls.

        Args:
            length: How far ahead [m].
            grids: The maps that the path is on: `grids` or `known`.
            threads: Number of threads.
        """
        maps = np.repeat(np.arange(len(self.grids)), self.mission_counts)
        steps = max(1, round(length / self.resolution))
        costmaps = [Costmap.from_grid(grid, self.robot) for grid in grids]
        guides = [_guide_costs(costmap) for costmap in costmaps]

        def descend_to(mission: int) -> npt.NDArray[np.int32]:
            cell = [int(index) for index in costmaps[maps[mission]].world_to_cell(*self.goals[mission])]
            return _descend(cost_field(guides[maps[mission]], cell, threads=1), steps)

        with ThreadPoolExecutor(threads) as pool:  # NumPy and the kernel leave Python to other threads
            return np.concatenate(list(pool.map(descend_to, np.unique(self.mission_fields, return_index=True)[1])))

    def costs(self) -> npt.NDArray[np.uint8]:
        """Return the costs of all maps that a robot has, one after the other."""
        return np.concatenate([Costmap.from_grid(grid, self.robot).data.ravel() for grid in self.known])


def _starts_of(sizes: Sequence[int] | npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return where each of several arrays begins that lie one after the other."""
    return np.cumsum([0, *sizes[:-1]])


def _descend(field: npt.NDArray[np.float32], steps: int) -> npt.NDArray[np.int32]:
    """Return the cell that some steps of steepest descent lead to, from each cell; numbered row after row."""
    rows, cols = field.shape
    around = np.pad(field, 1, constant_values=np.inf)
    best, cells = field.copy(), np.arange(rows * cols, dtype=np.int32).reshape(rows, cols)
    step = cells.copy()
    for down, right in ((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)):
        value = around[1 + down : 1 + down + rows, 1 + right : 1 + right + cols]
        better = value < best
        np.copyto(step, cells + np.int32(down * cols + right), where=better)
        np.copyto(best, value, where=better)
    step, ahead = step.ravel(), cells.ravel()
    while steps:  # by squares: 10 steps are 2 and 8
        if steps & 1:
            ahead = step[ahead]
        step = step[step]
        steps >>= 1
    return ahead


def _guide_costs(costmap: Costmap) -> npt.NDArray[np.uint8]:
    """Return costs of cells from 8, in the open, to 208, where the robot nearly touches something."""
    costs = 8 + (costmap.data.astype(np.int64) * 200) // (INSCRIBED - 1)
    return np.where(costmap.data >= INSCRIBED, 255, costs).astype(np.uint8)


def make_arena(settings: NavigationSettings, robot: Robot) -> Arena:
    """Make the maps, movers and missions of an environment.

    Raises:
        InputError: If a world or a map cannot be used.
        ScenarioError: If one has no room for a mission.
        WorldError: If one has no room for its movers.
    """
    places = [place for one, count in settings.given_worlds() for place in _places(settings, robot, one, count)]
    names, known = [name for name, _, _ in places], [grid for _, _, grid in places]
    grids, recordings = list[OccupancyGrid](), list[list[MoverRecording]]()
    for number, (_, world, grid) in enumerate(places):
        if settings.unmapped_boxes:
            world, grid = _add_boxes(settings, robot, world, grid, number)
        grids.append(grid)
        try:
            recordings.append(_record(settings, robot, world))
        except WorldError as error:
            raise WorldError(f"{names[number]}: {error}") from None

    def pick(number: int) -> tuple[Missions, list[npt.NDArray[np.float32]]]:
        rng = np.random.default_rng([settings.seed, SPLITS.index(settings.split), number])
        return pick_missions(grids[number], robot, rng, settings.min_distance, names[number])

    with ThreadPoolExecutor(choose_threads(settings.threads)) as pool:
        missions, fields = zip(*pool.map(pick, range(len(grids))), strict=True)
    return Arena(robot, grids, names, missions, fields, recordings, known if settings.unmapped_boxes else None)


def _add_boxes(
    settings: NavigationSettings, robot: Robot, world: World | None, grid: OccupancyGrid, number: int
) -> tuple[World, OccupancyGrid]:
    """Put boxes into a world where its map has room for the robot; return it and a map that has them."""
    if world is None:
        raise InputError("unmapped_boxes need a world: give World.from_map(grid) instead of the map")
    boxes = Unmapped(boxes=(settings.unmapped_boxes, settings.unmapped_boxes), near_path=0.0, room=0.0)
    seed = (settings.seed * len(SPLITS) + SPLITS.index(settings.split)) * _WORLDS_OF_A_SEED + number
    fuller = boxes.add_to(world, Costmap.from_grid(grid, robot), world.seeds, seed)
    (x, y), (rows, cols) = (grid.origin.x, grid.origin.y), grid.shape
    bounds = (x, y), (x + cols * grid.resolution, y + rows * grid.resolution)
    return fuller, make_map(settings, robot, fuller, bounds)


def pick_missions(
    grid: OccupancyGrid, robot: Robot, rng: np.random.Generator, least: float, name: str
) -> tuple[Missions, list[npt.NDArray[np.float32]]]:
    """Pick missions on a map, both ends where the robot can turn all round; and the fields of their goals.

    Raises:
        ScenarioError: If the map has no room for one.
    """
    costmap = Costmap.from_grid(grid, robot)
    beyond = costmap.circumscribed_radius + grid.resolution - costmap.inscribed_radius
    turning = costmap.data < int(252.0 * math.exp(-costmap.cost_scaling_factor * beyond))
    cells = np.argwhere(turning)
    rows: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    fields: list[npt.NDArray[np.float32]] = []
    for cell in cells[rng.permutation(len(cells))[: 4 * _GOALS]]:
        if len(fields) == _GOALS:
            break
        field = distances_to(costmap, cell)
        away = field[cells[:, 0], cells[:, 1]]
        reached = np.flatnonzero(np.isfinite(away))
        far = reached[away[reached] >= least]
        if len(far) == 0:  # the farther half, where there is no room for more
            far = reached[away[reached] >= max(_LEAST_DISTANCE, 0.5 * away[reached].max(initial=0.0))]
        if len(far) == 0:
            continue
        picked = far[rng.permutation(len(far))[:_STARTS]]
        x, y = costmap.cell_to_world(cells[picked, 0], cells[picked, 1])
        goal = np.array(costmap.cell_to_world(*cell), dtype=float)
        rows.append(
            (
                np.column_stack([x, y, np.full(len(x), np.nan)]),
                np.tile(goal, (len(x), 1)),
                away[picked].astype(np.float64),
            )
        )
        fields.append(field)
    if not rows:
        raise ScenarioError(
            f"{name}: no start and goal can be picked: there are no two joined places, {_LEAST_DISTANCE:g} m apart, "
            f"where {robot.name} (swing radius {costmap.circumscribed_radius:.2f} m) can turn; use a wider world or "
            "another robot"
        )
    of = np.repeat(np.arange(len(rows)), [len(poses) for poses, _, _ in rows])
    poses, goals, away = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    return Missions(poses, goals, of, away), fields


def distances_to(costmap: Costmap, cell: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return the length of the shortest path of base_link from every cell to one [m], infinite in walls."""
    walls = costmap.data >= INSCRIBED
    field = cost_field(np.where(walls, 255, 1).astype(np.uint8), cell, threads=1)
    return (field * np.float32(costmap.resolution)).astype(np.float32)


def _places(
    settings: NavigationSettings, robot: Robot, given: object, count: int
) -> list[tuple[str, World | None, OccupancyGrid]]:
    """Name, world and map of what an environment is given."""
    kind = kind_of(given)
    if kind == "map":
        if isinstance(given, OccupancyGrid):
            return [("map", None, given)]
        return [(Path(str(given)).stem, None, OccupancyGrid.load(str(given)))]
    if kind == "world":
        world = given if isinstance(given, World) else World.load(str(given))
        return [(world.name, world, make_map(settings, robot, world))]
    first = SPLITS.index(settings.split) * _WORLDS_OF_A_SPLIT + settings.seed * _WORLDS_OF_A_SEED
    worlds = [World.generate(str(given), seed=first + number, **settings.world_options) for number in range(count)]
    return [
        (f"{given}/{first + number}", world, make_map(settings, robot, world)) for number, world in enumerate(worlds)
    ]


def make_map(
    settings: NavigationSettings,
    robot: Robot,
    world: World,
    bounds: tuple[tuple[float, float], tuple[float, float]] | None = None,
) -> OccupancyGrid:
    """Make the map of a world in the robot's band of heights."""
    return OccupancyGrid.from_world(world, resolution=settings.resolution, z_range=robot.z_range, bounds=bounds)


def _record(settings: NavigationSettings, robot: Robot, world: World | None) -> list[MoverRecording]:
    if world is None:
        if settings.movers or settings.crowd:
            raise InputError("movers and crowds need a world: give World.from_map(grid) instead of the map")
        return []
    blind = (Crowd("people", settings.movers, sees_robot=False),) if settings.movers else ()
    seeing = (Crowd("crowd", settings.crowd),) if settings.crowd else ()
    return record_movers(settings, robot, replace(world, movers=(*world.movers, *blind, *seeing)))


def record_movers(settings: NavigationSettings, robot: Robot, world: World) -> list[MoverRecording]:
    """Record the movers of a world for episodes of the longest time.

    Crowds that do not see the robot are recorded once for each of several seeds. Where one does, all of the world's are
    computed in each episode.
    """
    if not world.movers:
        return []
    crowds = [mover for mover in world.movers if isinstance(mover, Crowd)]
    live = any(crowd.sees_robot for crowd in crowds)
    count = _RECORDINGS if crowds and not live else 1
    seeds = [SPLITS.index(settings.split) * 1000 + number for number in range(count)]
    return [
        MoverRecording.of_world(world, robot, duration_s=settings.max_time_s, seed=seed, period_s=0.1, live_crowds=live)
        for seed in seeds
    ]


def fixed_mission(
    grid: OccupancyGrid, robot: Robot, start: Pose2D, goal: tuple[float, float], name: str
) -> tuple[Missions, list[npt.NDArray[np.float32]]]:
    """Return the one mission of a map, and the field of its goal.

    Raises:
        ScenarioError: If no path leads from the start to the goal.
    """
    costmap = Costmap.from_grid(grid, robot)
    cell = np.array([int(index) for index in costmap.world_to_cell(*goal)])
    at = tuple(int(index) for index in costmap.world_to_cell(start.x, start.y))
    field = distances_to(costmap, cell) if costmap.contains(*cell) and costmap.data[tuple(cell)] < INSCRIBED else None
    if field is None or not costmap.contains(*at) or not np.isfinite(field[at]):
        raise ScenarioError(f"{name}: no path leads from {start.as_tuple()} to {goal} for {robot.name}")
    away = np.array([float(field[at])])
    return Missions(np.array([start.as_tuple()]), np.array([goal]), np.array([0]), away), [field]
