"""`Unmapped`, `MoverChoice` and `MapErrors`: where the world and the robot's map differ."""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from trundle._core import label_components
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import ScenarioError
from trundle.files.yaml_config import Config, NotNegative, Positive
from trundle.geometry import FloatArray, Pose3D, path_length
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.maps import FREE, OCCUPIED, OccupancyGrid
from trundle.maps.cells import OCCUPIED_FROM
from trundle.planning.grid.grid_search import GridSearch
from trundle.worlds import World
from trundle.worlds.movers import AlongPath, Crowd, Motion, Mover, Waypoints
from trundle.worlds.movers.mover import body_named

_MOVER_COLOR = (0.55, 0.36, 0.70, 1.0)
_PLURALS = {"person": "people", "forklift": "forklifts"}

_Body = Literal["person", "forklift"]
_TimedPoint = Annotated[tuple[float, ...], Field(min_length=3, max_length=4)]
_Point = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]
_Sizes = Annotated[tuple[Positive, ...], Field(min_length=3, max_length=3)]
_RadiusHeight = Annotated[tuple[Positive, ...], Field(min_length=2, max_length=2)]
_Area = Annotated[tuple[float, ...], Field(min_length=4, max_length=4)]


class MoverChoice(Config):
    """A mover on a path, or a crowd.

    `{crowd: forklift, count: 6, speed: 1.2, sees_robot: false}`,
    `{name: cart, body: forklift, path: [[0, 0], [8, 0]], speed: 1.2, repeat: back_and_forth}`, or
    `{name: door, box: [1.0, 0.1, 2.0], waypoints: [[0, 2, 0], [5, 3, 0]]}`.

    Attributes:
        name: Its name, under which contacts are reported; if None, `people` or `forklifts` of a crowd.
        crowd: What a crowd is of.
        count: How many there are in the crowd.
        sees_robot: Whether a crowd stops for the robot and goes around it.
        area: (x0, y0, x1, y1) [m]: where the crowd stays. If None, anywhere in the world.
        seed: Seed of the crowd's random places. If None, the scenario's.
        body: The body of a mover. Either this, `box` or `cylinder`.
        box: Size (x, y, z) [m] of a mover that is a box on the floor.
        cylinder: Radius and height [m] of a mover that is a cylinder on the floor.
        waypoints: (t, x, y) or (t, x, y, yaw) each [s, m, m, rad], which a mover passes. Either this or `path`.
        path: (x, y) each [m], followed at constant speed.
        speed: Along the path, or the fastest of the crowd [m/s]. If None, 1.2.
        start_s: When a mover sets off along its path [s].
        interpolation: Between the points: straight, or a smooth Catmull-Rom curve.
        repeat: After the last point: stay there, start again, or return in reverse.
    """

    name: str | None = None
    crowd: _Body | None = None
    count: Annotated[int, Field(ge=1, le=1000)] = 1
    sees_robot: bool = True
    area: _Area | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    body: _Body | None = None
    box: _Sizes | None = None
    cylinder: _RadiusHeight | None = None
    waypoints: Annotated[tuple[_TimedPoint, ...], Field(min_length=1)] | None = None
    path: Annotated[tuple[_Point, ...], Field(min_length=2)] | None = None
    speed: Positive | None = None
    start_s: NotNegative = 0.0
    interpolation: Literal["linear", "catmull_rom"] = "linear"
    repeat: Literal["once", "loop", "back_and_forth"] = "once"

    @model_validator(mode="after")
    def _check(self) -> Self:
        given = {name for name, field in type(self).model_fields.items() if getattr(self, name) != field.default}
        if self.crowd is not None:
            extra = given & {"body", "box", "cylinder", "waypoints", "path", "start_s", "interpolation", "repeat"}
            if extra:
                raise ValueError(f"{', '.join(sorted(extra))}: not of a crowd, which goes to random places")
        else:
            extra = given & {"count", "sees_robot", "area", "seed"}
            if extra:
                raise ValueError(f"{', '.join(sorted(extra))}: only of a crowd; give crowd: person or crowd: forklift")
            if self.name is None:
                raise ValueError("a mover needs a name")
            if (self.body is not None) + (self.box is not None) + (self.cylinder is not None) != 1:
                raise ValueError("give one of body, box and cylinder, or crowd")
            if (self.waypoints is None) == (self.path is None):
                raise ValueError("give either waypoints or path")
            if self.waypoints is not None and given & {"speed", "start_s"}:
                raise ValueError("speed and start_s are for path; waypoints have times")
        self.make()
        return self

    def make(self) -> Mover | Crowd:
        """Make the mover or the crowd.

        Raises:
            WorldError: If the times do not increase, or other values do not fit together.
        """
        speed = 1.2 if self.speed is None else self.speed
        if self.crowd is not None:
            x0, y0, x1, y1 = self.area or (0.0, 0.0, 0.0, 0.0)
            return Crowd(
                self.name or _PLURALS[self.crowd],
                self.count,
                self.crowd,
                speed,
                self.sees_robot,
                None if self.area is None else (x0, y0, x1, y1),
                seed=self.seed,
            )
        motion: Motion
        if self.waypoints is not None:
            motion = Waypoints(self.waypoints, self.interpolation, self.repeat)
        else:
            motion = AlongPath(self.path or (), speed, self.interpolation, self.repeat, self.start_s)
        return Mover(self.name or "", self._parts(), motion, self.body or "")

    def _parts(self) -> tuple[Solid, ...]:
        if self.body is not None:
            return body_named(self.body)
        if self.box is not None:
            x, y, z = self.box
            return (Solid("box", Box((x, y, z)), Pose3D((0.0, 0.0, z / 2.0)), _MOVER_COLOR),)
        radius, height = self.cylinder or (0.0, 0.0)
        return (Solid("cylinder", Cylinder(radius, height), Pose3D((0.0, 0.0, height / 2.0)), _MOVER_COLOR),)


KIND = "unmapped box"
"""`Solid.kind` of the boxes."""

_BESIDE_PATH_M = 1.0
_TRIES = 200
_STREAM = 0x0B0C5
_BOX_COLOR = (0.72, 0.45, 0.20, 1.0)


def _as_range(value: object) -> object:
    """Take one number as a range that has no other."""
    return (value, value) if isinstance(value, int | float) and not isinstance(value, bool) else value


def _check_ascending(values: tuple[Any, Any]) -> tuple[Any, Any]:
    if values[0] > values[1]:
        raise PydanticCustomError(
            "range", "the least comes first: {first} is above {last}", {"first": values[0], "last": values[1]}
        )
    return values


_Count = Annotated[int, Field(ge=0, le=1000)]
Counts = Annotated[
    tuple[_Count, _Count],
    BeforeValidator(_as_range, json_schema_input_type=int | list[int]),
    AfterValidator(_check_ascending),
]
"""How many: a number, or the least and the most."""

Lengths = Annotated[
    tuple[Positive, Positive],
    BeforeValidator(_as_range, json_schema_input_type=float | list[float]),
    AfterValidator(_check_ascending),
]
"""A length [m]: a number, or the least and the most."""


class Unmapped(Config):
    """Boxes in the world that are not on the robot's map: `{boxes: [5, 30]}`.

    They stand where the map has room for the robot, away from its start and its goals, drawn by the scenario's seed.
    Nothing promises that a path is left.

    Attributes:
        boxes: How many: a number, or the least and the most.
        size: Edges on the floor [m]: a number, or the least and the most.
        height: Height of the boxes [m]: a number, or the least and the most.
        near_path: Share of them, 0 to 1, whose middle is within 1 m of the shortest path on the map.
        room: Distance that they keep from where the robot turns at its start and its goals [m].
    """

    boxes: Counts = (5, 30)
    size: Lengths = (0.3, 0.8)
    height: Lengths = (0.6, 1.2)
    near_path: Annotated[float, Field(ge=0.0, le=1.0)] = 0.5
    room: NotNegative = 0.3

    def add_to(self, world: World, costmap: Costmap, ends: Sequence[Sequence[float]], seed: int) -> World:
        """Make the world with the boxes.

        Args:
            world: The world.
            costmap: The robot's map of it.
            ends: Its start and goals, in order: (x, y, …) [m], map frame.
            seed: The same seed gives the same boxes.

        Raises:
            ScenarioError: If the map has no room for them.
        """
        rng = np.random.default_rng([_STREAM, seed])
        count = int(rng.integers(self.boxes[0], self.boxes[1] + 1))
        points = np.array([end[:2] for end in ends], dtype=np.float64).reshape(-1, 2)
        places = FreePlaces(costmap, points, rng, "unmapped", "box")
        solids: list[Solid] = []
        for number in range(count):
            size = rng.uniform(*self.size, 2)
            height = float(rng.uniform(*self.height))
            clear = costmap.circumscribed_radius + 0.5 * math.hypot(*size) + self.room
            x, y = places.draw(beside_path=rng.random() < self.near_path, clear=clear)
            pose = Pose3D.planar(x, y, 0.5 * height, float(rng.uniform(-math.pi, math.pi)))
            box = Box((float(size[0]), float(size[1]), height))
            solids.append(Solid(f"unmapped_{number}", box, pose, _BOX_COLOR, KIND))
        return replace(world, solids=(*world.solids, *solids))


class FreePlaces:
    """Draws places for boxes: cells where the middle of the robot can be.

    Args:
        costmap: The robot's map.
        points: Its start and goals [m], shape (N, 2).
        rng: Draws them.
        key: Key of the scenario, for messages.
        what: What is placed, likewise.
    """

    def __init__(self, costmap: Costmap, points: FloatArray, rng: np.random.Generator, key: str, what: str) -> None:
        self._costmap, self._points, self._rng = costmap, points, rng
        self._key, self._what, self._plural = key, what, {"box": "boxes"}.get(what, f"{what}s")
        self._free = np.argwhere(costmap.data < INSCRIBED)

    @cached_property
    def _path(self) -> FloatArray:
        return _shortest_path(self._costmap, self._points)

    def draw(self, *, clear: float, beside_path: bool = False) -> tuple[float, float]:
        """Draw a place that is farther than `clear` [m] from the start and the goals."""
        for _ in range(_TRIES if len(self._free) else 0):
            x, y = self._beside_path() if beside_path and path_length(self._path) > 0.0 else self._anywhere()
            far = np.hypot(*(self._points - (x, y)).T).min(initial=math.inf) > clear
            if far and self._costmap.cost_at(x, y) < INSCRIBED:
                return x, y
        raise ScenarioError(
            f"{self._key}: the map has no room for a {self._what} that is {clear:.2f} m away from the start and the "
            f"goals; give fewer or smaller {self._plural}, or less room"
        )

    def _anywhere(self) -> tuple[float, float]:
        row, col = self._free[self._rng.integers(len(self._free))]
        x, y = self._costmap.cell_to_world(row, col)
        return float(x), float(y)

    def _beside_path(self) -> tuple[float, float]:
        lengths = np.hypot(*np.diff(self._path, axis=0).T)
        at = self._rng.choice(len(lengths), p=lengths / lengths.sum())
        first, last = self._path[at], self._path[at + 1]
        off, direction = self._rng.uniform(0.0, _BESIDE_PATH_M), self._rng.uniform(-math.pi, math.pi)
        x, y = first + self._rng.random() * (last - first)
        return float(x + off * math.cos(direction)), float(y + off * math.sin(direction))


def _shortest_path(costmap: Costmap, points: FloatArray) -> FloatArray:
    """Points of the shortest path of the robot's inscribed disc [m], shape (N, 2); of as many legs as have one."""
    search = GridSearch(costmap.data >= INSCRIBED)
    rows, cols = costmap.world_to_cell(points[:, 0], points[:, 1])
    tolerance = _BESIDE_PATH_M / costmap.resolution
    line: list[FloatArray] = []
    for start, goal in itertools.pairwise(np.stack([rows, cols], axis=1).tolist()):
        path = search.any_angle_path(start, goal, start_tolerance=tolerance, goal_tolerance=tolerance)
        if path.status == "found":
            line.append(np.stack(costmap.cell_to_world(path.waypoints[:, 0], path.waypoints[:, 1]), axis=1))
    return np.concatenate(line) if line else np.zeros((0, 2))


_MISSING_STREAM, _GHOST_STREAM = zlib.crc32(b"missing from the map"), zlib.crc32(b"ghosts on the map")


class MapErrors(Config):
    """What is wrong on the robot's map: `{missing: 0.25, ghosts: 12}`. The world stays as it is.

    Planner, costmap and localizer get the wrong map. Start and goals are those that would be picked without errors. The
    seed of the scenario decides what is wrong.

    Attributes:
        missing: Share of the smaller objects that are left out, 0 to 1. An object is what hangs together on the map.
        largest: An object is small if it is at most so long and so wide on the map [m].
        ghosts: How many boxes are on the map that are not in the world: a number, or the least and the most. They are
            where the robot could be, away from its start and its goals. Nothing promises that the map has a path left.
        size: Edges of the ghosts [m]: a number, or the least and the most.
        room: Distance that ghosts keep from where the robot turns at its start and its goals [m].
    """

    missing: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    largest: Positive = 2.0
    ghosts: Counts = (0, 0)
    size: Lengths = (0.3, 0.8)
    room: NotNegative = 0.3

    def change(
        self, grid: OccupancyGrid, costmap: Costmap, ends: Sequence[Sequence[float]], seed: int
    ) -> OccupancyGrid:
        """Make the map that the robot gets.

        Args:
            grid: The true map.
            costmap: The robot's costmap of it.
            ends: Start and goals, in order: (x, y, …) [m], map frame.
            seed: The same seed gives the same errors.

        Raises:
            ScenarioError: If the map has no room for the ghosts.
        """
        cells = grid.data.copy()
        self._leave_out(cells, grid.resolution, np.random.default_rng([_MISSING_STREAM, seed]))
        rng = np.random.default_rng([_GHOST_STREAM, seed])
        places = FreePlaces(costmap, np.array([end[:2] for end in ends], dtype=np.float64), rng, "map_errors", "ghost")
        for _ in range(int(rng.integers(self.ghosts[0], self.ghosts[1] + 1))):
            size, yaw = rng.uniform(*self.size, 2), float(rng.uniform(-math.pi, math.pi))
            clear = costmap.circumscribed_radius + 0.5 * math.hypot(*size) + self.room
            _draw_box(cells, grid, places.draw(clear=clear), size, yaw)
        return replace(grid, data=cells)

    def _leave_out(self, cells: np.ndarray, resolution: float, rng: np.random.Generator) -> None:
        """Free the cells of a share of the small objects, and the unknown ones that these enclose."""
        taken = cells != FREE
        labels, table = label_components(taken.view(np.uint8), True)
        long = np.maximum(table[:, 2] - table[:, 1], table[:, 4] - table[:, 3]) * resolution
        solid = np.bincount(labels[cells >= OCCUPIED_FROM], minlength=len(table) + 1)[1:] > 0
        small = np.flatnonzero(solid & (long <= self.largest + 1e-9))
        chosen = rng.permutation(small)[: round(self.missing * len(small))]
        gone = np.zeros(len(table) + 1, dtype=bool)
        gone[chosen + 1] = True
        cells[gone[labels]] = FREE


def _draw_box(cells: np.ndarray, grid: OccupancyGrid, place: tuple[float, float], size: FloatArray, yaw: float) -> None:
    """Occupy the cells whose centres are in a box, and at least the one of its middle."""
    row, col = (int(one) for one in grid.world_to_cell(*place))
    reach = math.ceil(0.5 * math.hypot(*size) / grid.resolution)
    rows, cols = np.mgrid[
        max(row - reach, 0) : min(row + reach + 1, cells.shape[0]),
        max(col - reach, 0) : min(col + reach + 1, cells.shape[1]),
    ]
    x, y = grid.cell_to_world(rows, cols)
    dx, dy = x - place[0], y - place[1]
    along, across = dx * math.cos(yaw) + dy * math.sin(yaw), dy * math.cos(yaw) - dx * math.sin(yaw)
    inside = (np.abs(along) <= 0.5 * size[0]) & (np.abs(across) <= 0.5 * size[1])
    cells[rows[inside], cols[inside]] = OCCUPIED
    cells[row, col] = OCCUPIED
