"""`Arena`: the maps that episodes take place on, and their missions: starts, goals, and the distances to these."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import InputError, ScenarioError
from trundle.geometry import FloatArray, Pose2D
from trundle.gym.settings import SPLITS, NavigationSettings
from trundle.maps import OccupancyGrid
from trundle.planning import cost_field
from trundle.robots import Robot
from trundle.sim.batch import MoverRecording
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
        fields: Which field of distances is of the goal, shape (n,).
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
        missions: Of each map.
        fields: Distances to goals [m], infinite where the robot cannot go, each of the shape of its map.
        recordings: Of the movers of each map, none or several.
    """

    def __init__(
        self,
        robot: Robot,
        grids: Sequence[OccupancyGrid],
        names: Sequence[str],
        missions: Sequence[Missions],
        fields: Sequence[npt.NDArray[np.float32]],
        recordings: Sequence[Sequence[MoverRecording]],
    ) -> None:
        self.robot, self.grids, self.names = robot, tuple(grids), tuple(names)
        self.recordings = [each for of_map in recordings for each in of_map]
        self.recording_counts = np.array([len(of_map) for of_map in recordings])
        self.first_recording = np.cumsum([0, *self.recording_counts[:-1]])
        counts = np.array([len(each.poses) for each in missions])
        self.mission_counts, self.first_mission = counts, np.cumsum([0, *counts[:-1]])
        self.starts = np.concatenate([each.poses for each in missions])
        self.goals = np.concatenate([each.goals for each in missions])
        self.distances = np.concatenate([each.distances for each in missions])
        self.mission_fields = np.concatenate([each.fields for each in missions])
        self._values = np.concatenate([field.ravel() for field in fields])
        self._offsets = np.cumsum([0, *(field.size for field in fields[:-1])])
        self.shapes = np.array([grid.shape for grid in grids])
        self._frames = np.array([grid.origin.as_tuple() for grid in grids])
        self._turns = np.column_stack([np.cos(self._frames[:, 2]), np.sin(self._frames[:, 2])])
        self.resolution = grids[0].resolution
        self._guides: npt.NDArray[np.float32] | None = None

    def cells_of(self, points: FloatArray, maps: npt.NDArray[np.int64]) -> tuple[npt.NDArray[np.int64], ...]:
        """Return (row, col) of points (x, y), map frame, shape (…, 2), each on its map; not clipped."""
        frames, turns = self._frames[maps], self._turns[maps]
        dx, dy = points[..., 0] - frames[..., 0], points[..., 1] - frames[..., 1]
        along = (turns[..., 0] * dx + turns[..., 1] * dy) / self.resolution
        up = (turns[..., 0] * dy - turns[..., 1] * dx) / self.resolution
        return np.floor(up).astype(np.int64), np.floor(along).astype(np.int64)

    def points_of(self, row: Any, col: Any, maps: npt.NDArray[np.int64]) -> FloatArray:
        """Return the centres (x, y) of cells, map frame [m], shape (…, 2)."""
        frames, turns = self._frames[maps], self._turns[maps]
        along, up = (col + 0.5) * self.resolution, (row + 0.5) * self.resolution
        x = frames[..., 0] + turns[..., 0] * along - turns[..., 1] * up
        return np.stack([x, frames[..., 1] + turns[..., 1] * along + turns[..., 0] * up], axis=-1)

    def field_at(
        self,
        row: npt.NDArray[np.int64],
        col: npt.NDArray[np.int64],
        maps: npt.NDArray[np.int64],
        fields: Any,
        *,
        guide: bool = False,
    ) -> FloatArray:
        """Return the distance to the goal from cells [m], or the cost to go there of `guides`.

        It is infinite in walls and beyond the map.
        """
        values = self.guides if guide else self._values
        inside = self.is_inside(row, col, maps)
        if inside.all():
            return values[self._offsets[fields] + row * self.shapes[maps, 1] + col].astype(np.float64)
        at = self._offsets[fields] + np.where(inside, row * self.shapes[maps, 1] + col, 0)
        return np.where(inside, values[at], np.inf)

    def is_inside(
        self, row: npt.NDArray[np.int64], col: npt.NDArray[np.int64], maps: npt.NDArray[np.int64]
    ) -> npt.NDArray[np.bool_]:
        """Return whether cells are on their map."""
        rows, cols = self.shapes[maps].T
        return (row >= 0) & (row < rows) & (col >= 0) & (col < cols)

    @property
    def guides(self) -> npt.NDArray[np.float32]:
        """Costs to go to the goals on paths that keep away from walls; made on first use."""
        if self._guides is None:
            maps = np.repeat(np.arange(len(self.grids)), self.mission_counts)
            costmaps = [Costmap.from_grid(grid, self.robot) for grid in self.grids]
            found: list[npt.NDArray[np.float32]] = []
            for mission in np.unique(self.mission_fields, return_index=True)[1]:
                costmap = costmaps[maps[mission]]
                cell = [int(index) for index in costmap.world_to_cell(*self.goals[mission])]
                found.append(cost_field(_guide_costs(costmap), cell, threads=1).ravel())
            self._guides = np.concatenate(found)
        return self._guides


def _guide_costs(costmap: Costmap) -> npt.NDArray[np.uint8]:
    """Costs of cells from 8, in the open, to 208, where the robot nearly touches something."""
    costs = 8 + (costmap.data.astype(np.int64) * 200) // (INSCRIBED - 1)
    return np.where(costmap.data >= INSCRIBED, 255, costs).astype(np.uint8)


def make_arena(settings: NavigationSettings, robot: Robot) -> Arena:
    """Make the maps, movers and missions of an environment.

    Raises:
        InputError: If a world or a map cannot be used.
        ScenarioError: If one has no room for a mission.
    """
    given = settings.world
    each = list(given) if isinstance(given, Sequence) and not isinstance(given, str) else [given]
    if not each:
        raise InputError("an environment needs at least one world")
    places = [place for one in each for place in _places(settings, robot, one)]
    grids, names, missions, fields = [], [], [], list[npt.NDArray[np.float32]]()
    recordings: list[list[MoverRecording]] = []
    for number, (name, world, grid) in enumerate(places):
        rng = np.random.default_rng([settings.seed, SPLITS.index(settings.split), number])
        found, of_goals = pick_missions(grid, robot, rng, settings.min_distance, name, first_field=len(fields))
        grids.append(grid)
        names.append(name)
        missions.append(found)
        fields += of_goals
        recordings.append(_record(settings, robot, world))
    return Arena(robot, grids, names, missions, fields, recordings)


def pick_missions(
    grid: OccupancyGrid, robot: Robot, rng: np.random.Generator, least: float, name: str, *, first_field: int
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
    of = np.repeat(np.arange(len(rows)), [len(poses) for poses, _, _ in rows]) + first_field
    poses, goals, away = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    return Missions(poses, goals, of, away), fields


def distances_to(costmap: Costmap, cell: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return the length of the shortest path of base_link from every cell to one [m], infinite in walls."""
    walls = costmap.data >= INSCRIBED
    field = cost_field(np.where(walls, 255, 1).astype(np.uint8), cell, threads=1)
    return (field * np.float32(costmap.resolution)).astype(np.float32)


def _places(settings: NavigationSettings, robot: Robot, given: object) -> list[tuple[str, World | None, OccupancyGrid]]:
    """Name, world and map of what an environment is given."""
    if isinstance(given, OccupancyGrid):
        return [("map", None, given)]
    if isinstance(given, World):
        return [(given.name, given, make_map(settings, robot, given))]
    if not isinstance(given, str | Path):
        raise InputError(f"a world must be a name, a file, a World or an OccupancyGrid, got {type(given).__name__}")
    if Path(given).suffix in (".yaml", ".map"):
        return [(Path(given).stem, None, OccupancyGrid.load(given))]
    if Path(given).suffix:
        world = World.load(given)
        return [(world.name, world, make_map(settings, robot, world))]
    first = SPLITS.index(settings.split) * _WORLDS_OF_A_SPLIT + settings.seed * _WORLDS_OF_A_SEED
    worlds = [
        World.generate(str(given), seed=first + number, **settings.world_options) for number in range(settings.worlds)
    ]
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
    grid: OccupancyGrid, robot: Robot, start: Pose2D, goal: tuple[float, float], name: str, *, first_field: int
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
    return Missions(np.array([start.as_tuple()]), np.array([goal]), np.array([first_field]), away), [field]
