"""The `office` generator: rooms on both sides of corridors, joined by cross corridors at the ends.

The floor is `size` between the outer walls, centred on the origin. Corridors run along x; each has a row of rooms north
and south of it, and every room has one door of the same clear width. Furniture stands along the walls, meeting tables
in the middle; a lane of width `FREE_LANE` stays free from each door to the middle of its room.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle.errors import WorldError
from trundle.geometry.solids import Color, Solid
from trundle.worlds.generators import furniture
from trundle.worlds.generators.props import SEEN_TO, Part, box, place
from trundle.worlds.options import check_flag, check_number, check_seed, check_size
from trundle.worlds.world import World

ROOM_DEPTH = (3.4, 4.6)
"""Least and usual depth of rooms, from the corridor to the wall behind [m]."""

ROOM_WIDTH = (3.4, 5.6)
"""Least and usual greatest width of rooms along the corridor [m]."""

FREE_LANE = 1.4
"""Width kept free of furniture behind a door [m]."""

MAX_SIZE = 100.0  # [m]

_WALL = 0.12  # thickness of inner walls [m]
_OUTER = 0.25  # thickness of the outer walls [m]
_POST = 0.06  # of a door frame [m]
_BASE_HEIGHT = 0.12  # of the skirting [m]
_WALL_COLOR: Color = (0.91, 0.90, 0.87, 1.0)
_GLASS_COLOR: Color = (0.62, 0.74, 0.80, 1.0)
_OUTER_COLOR: Color = (0.74, 0.76, 0.77, 1.0)
_SKIRTING: Color = (0.35, 0.38, 0.42, 1.0)
_FRAME_COLOR: Color = (0.30, 0.33, 0.37, 1.0)
_LEAF_COLOR: Color = (0.70, 0.53, 0.35, 1.0)


@dataclass(frozen=True, slots=True)
class _Room:
    """A room: the floor between its walls [m], and the side of the corridor (+1 north, −1 south)."""

    name: str
    x0: float
    x1: float
    y0: float
    y1: float
    side: int
    door_x: float

    @property
    def width(self) -> float:
        return self.x1 - self.x0

    @property
    def depth(self) -> float:
        return self.y1 - self.y0


def generate_office(
    *,
    seed: int = 0,
    size: Sequence[float] | str = (24.0, 14.0),
    corridor_width: float = 2.2,
    door_width: float = 1.2,
    furnishing: float = 0.85,
    open_doors: bool = True,
    wall_height: float = 1.4,
    low_objects: bool = True,
) -> World:
    """Generate an office floor where Nova Carter can drive into every room.

    Args:
        seed: The same seed and options make the same office.
        size: Size of the floor between the outer walls, along x and y [m], up to 100 each.
        corridor_width: Width of the corridors [m], 1 to 6.
        door_width: Clear width of every door [m], 0.6 to 2.
        furnishing: Share of furniture places that are filled, 0 (bare rooms) to 1.
        open_doors: Whether doors have leaves that stand open into the room, or are plain openings.
        wall_height: Height of the walls [m], 1.3 to 10; low by default, so that pictures from above show the rooms.
        low_objects: Whether there is furniture that a planar lidar does not see as wide as it is, such as swivel
            chairs and low tables. Without it its beams meet every object at any height from 0.2 to 0.42 m.

    Raises:
        WorldError: If a value is out of range, or the floor has no room for a corridor with rooms on both sides.
    """
    rng = np.random.default_rng(check_seed("office", seed))
    length, width = check_size("office", size, 1.0, MAX_SIZE)
    corridor = check_number("office", "corridor_width", corridor_width, 1.0, 6.0)
    door = check_number("office", "door_width", door_width, 0.6, 2.0)
    furnishing = check_number("office", "furnishing", furnishing, 0.0, 1.0)
    open_doors = check_flag("office", "open_doors", open_doors)
    low_objects = check_flag("office", "low_objects", low_objects)
    height = check_number("office", "wall_height", wall_height, 1.3, 10.0)
    corridors, depth = _stack_corridors(length, width, corridor)
    half = length / 2.0 - corridor
    solids = _outer_walls(length, width, height)
    number = 0
    for index, y in enumerate(corridors):
        for side in (-1, 1):
            near = y + side * (corridor / 2.0 + _WALL)
            far = y + side * (corridor / 2.0 + _WALL + depth)
            shared = (index > 0 and side < 0) or (index < len(corridors) - 1 and side > 0)
            rooms = _divide(rng, half, (min(near, far), max(near, far)), -side, number, door)
            number += len(rooms)
            solids += _row_walls(rooms, half, door, height, behind=side > 0 and shared, leaves=open_doors)
            for room in rooms:
                solids += _furnish(rng, room, door, furnishing, low_objects=low_objects)
    return World("office", tuple(solids), ((0.0, corridors[0]),))


def _stack_corridors(length: float, width: float, corridor: float) -> tuple[list[float], float]:
    """Return middles of the corridors along y, from south to north, and the depth of the rooms [m]."""
    least_length = 2.0 * corridor + 2.0 * _WALL + ROOM_WIDTH[0]
    least_width = corridor + 2.0 * (_WALL + ROOM_DEPTH[0])
    if length < least_length or width < least_width:
        raise WorldError(
            f"office: size {length:g} x {width:g} m has no room for a corridor of {corridor:g} m with rooms on both "
            f"sides; make it at least {least_length:.1f} x {least_width:.1f} m"
        )
    # Two rows of rooms, their walls to the corridor, the corridor, and a wall to the next storey of rooms.
    count = max(1, round((width + _WALL) / (corridor + 2.0 * ROOM_DEPTH[1] + 3.0 * _WALL)))
    while (depth := (width - count * (corridor + 2.0 * _WALL) - (count - 1) * _WALL) / (2.0 * count)) < ROOM_DEPTH[0]:
        count -= 1
    pitch = corridor + 2.0 * depth + 3.0 * _WALL
    return [(index - (count - 1) / 2.0) * pitch for index in range(count)], depth


def _divide(
    rng: np.random.Generator, half: float, span: tuple[float, float], side: int, number: int, door: float
) -> list[_Room]:
    """Return rooms side by side from −half to half along x, of unequal widths, each with a place for its door."""
    least, most = max(ROOM_WIDTH[0], door + 1.2), ROOM_WIDTH[1]
    inner = 2.0 * half - _WALL
    count = max(1, min(round(inner / ((least + most) / 2.0 + _WALL)), int(inner / (least + _WALL))))
    spare = inner - count * (least + _WALL)
    if spare < 0.0:
        raise WorldError(
            f"office: a door of {door:g} m does not fit into a room of {inner - _WALL:.2f} m; make door_width "
            "smaller or the office longer"
        )
    shares = rng.dirichlet(np.full(count, 4.0)) * spare
    rooms: list[_Room] = []
    x = -half + _WALL
    for index, share in enumerate(shares.tolist()):
        end = x + least + share
        hinge = 0.35 + _POST + door / 2.0
        door_x = x + hinge if rng.random() < 0.5 else end - hinge
        rooms.append(_Room(f"room_{number + index + 1}", x, end, *span, side, door_x))
        x = end + _WALL
    return rooms


def _outer_walls(length: float, width: float, height: float) -> list[Solid]:
    parts: list[Part] = []
    for name, x, y, size in (
        ("north", 0.0, (width + _OUTER) / 2.0, (length + 2.0 * _OUTER, _OUTER)),
        ("south", 0.0, -(width + _OUTER) / 2.0, (length + 2.0 * _OUTER, _OUTER)),
        ("west", -(length + _OUTER) / 2.0, 0.0, (_OUTER, width)),
        ("east", (length + _OUTER) / 2.0, 0.0, (_OUTER, width)),
    ):
        parts += _wall(name, size, (x, y), height, _OUTER_COLOR)
    return place(parts, "wall", 0.0, 0.0, 0.0)


def _wall(name: str, size: tuple[float, float], centre: tuple[float, float], height: float, color: Color) -> list[Part]:
    top = height - _BASE_HEIGHT
    return [
        box(f"{name}_base", (*size, _BASE_HEIGHT), (*centre, _BASE_HEIGHT / 2.0), _SKIRTING, "wall"),
        box(name, (*size, top), (*centre, _BASE_HEIGHT + top / 2.0), color, "wall"),
    ]


def _row_walls(
    rooms: Sequence[_Room], half: float, door: float, height: float, *, behind: bool, leaves: bool
) -> list[Solid]:
    """Return the walls of a row of rooms: to the corridor, between the rooms, at both ends, and optionally behind."""
    first = rooms[0]
    side = first.side
    front = (first.y1 if side > 0 else first.y0) + side * _WALL / 2.0
    back = (first.y0 if side > 0 else first.y1) - side * _WALL / 2.0
    solids: list[Solid] = []
    middle, depth = (first.y0 + first.y1) / 2.0, first.depth
    for room in rooms:
        parts = _wall("side", (_WALL, depth), (room.x0 - _WALL / 2.0, middle), height, _WALL_COLOR)
        opening = door / 2.0 + _POST
        begin, end = room.x0 - _WALL, room.x1 + (_WALL if room is rooms[-1] else 0.0)
        for name, low, high in (
            ("front_west", begin, room.door_x - opening),
            ("front_east", room.door_x + opening, end),
        ):
            glazed = high - low > 1.5
            centre = ((low + high) / 2.0, front)
            parts += _wall(name, (high - low, _WALL), centre, height, _GLASS_COLOR if glazed else _WALL_COLOR)
        solids += place(parts, f"{room.name}_wall", 0.0, 0.0, 0.0)
        solids += place(_door(room, door, front, height, leaf=leaves), f"{room.name}_door", 0.0, 0.0, 0.0)
    parts = _wall("end", (_WALL, depth), (rooms[-1].x1 + _WALL / 2.0, middle), height, _WALL_COLOR)
    if behind:
        parts += _wall("back", (2.0 * half, _WALL), (0.0, back), height, _WALL_COLOR)
    return solids + place(parts, f"{rooms[-1].name}_wall", 0.0, 0.0, 0.0)


def _door(room: _Room, width: float, front: float, height: float, *, leaf: bool) -> list[Part]:
    """Return two posts, and a leaf that stands open at a right angle beside the nearer side wall."""
    parts: list[Part] = []
    for name, sign in (("west", -1.0), ("east", 1.0)):
        x = room.door_x + sign * (width + _POST) / 2.0
        size = (_POST, _WALL + 0.04, height + 0.04)
        parts.append(box(f"post_{name}", size, (x, front, (height + 0.04) / 2.0), _FRAME_COLOR, "door"))
    if leaf:
        hinge = -1.0 if room.door_x < (room.x0 + room.x1) / 2.0 else 1.0
        x = room.door_x + hinge * (width / 2.0 + 0.03)
        y = front - room.side * (_WALL / 2.0 + 0.03 + width / 2.0)
        tall = height - 0.1
        parts.append(box("leaf", (0.04, width - 0.04, tall), (x, y, 0.03 + tall / 2.0), _LEAF_COLOR, "door"))
    return parts


def _furnish(
    rng: np.random.Generator, room: _Room, door: float, furnishing: float, *, low_objects: bool
) -> list[Solid]:
    """Furnish a room: with desks, a meeting table or a lounge, and with cabinets and plants where there is space."""
    fit = _Furnisher(room, door, rng, furnishing, low_objects=low_objects)
    use = float(rng.random())
    if use < 0.22 and room.width >= 4.2 and room.depth >= 4.0:
        fit.meeting()
    elif use < 0.36:
        fit.lounge()
    else:
        fit.desks()
    fit.storage()
    return fit.solids


class _Furnisher:
    """Furnishes one room, in a frame with its origin in the middle of the back wall and +y towards the door."""

    def __init__(
        self, room: _Room, door: float, rng: np.random.Generator, furnishing: float, *, low_objects: bool
    ) -> None:
        self._room = room
        self._low_objects = low_objects
        self._rng = rng
        self._furnishing = furnishing
        self._door_x = (room.door_x - (room.x0 + room.x1) / 2.0) * room.side
        self._counts: dict[str, int] = {}
        self._taken: list[tuple[float, float, float, float]] = []
        # From the door to the middle of the room, and a place to turn there.
        free = max(FREE_LANE, door + 0.2) / 2.0
        self._free = (self._door_x - free, room.depth / 2.0 - 0.1, self._door_x + free, room.depth)
        self.solids: list[Solid] = []

    def desks(self) -> None:
        """Put desks along the back wall, each with a chair in front of it."""
        length, depth = furniture.DESK_SIZE
        count = int((self._room.width - 0.2) / (length + 0.15))
        pitch = self._room.width / max(1, count)
        for index in range(count):
            if self._rng.random() >= self._furnishing:
                continue
            x = (index - (count - 1) / 2.0) * pitch
            y = 0.04 + depth / 2.0
            self._put("desk", furniture.desk(), x, y, 0.0, length, depth)
            aside, turn = float(self._rng.uniform(-0.1, 0.1)), float(self._rng.uniform(-0.5, 0.5))
            chair = furniture.chair(self._rng, low_objects=self._low_objects)
            self._put("chair", chair, x - 0.1 + aside, y + 0.72, math.pi + turn, 0.6, 0.6)

    def meeting(self) -> None:
        """Put a table with six chairs nearer to the back wall than to the door, and a board on the back wall."""
        room, (length, depth) = self._room, furniture.TABLE_SIZE
        x, y = -math.copysign(min(0.4, (room.width - length) / 2.0 - 0.7), self._door_x), 1.55
        self._put("board", furniture.whiteboard(), x, 0.04, 0.0, 1.6, 0.1)
        self._put("table", furniture.table(), x, y, 0.0, length, depth)
        for column in (-0.7, 0.0, 0.7):
            for side, turn in ((-1.0, 0.0), (1.0, math.pi)):
                if self._rng.random() < max(self._furnishing, 0.3):
                    at = (x + column, y + side * (depth / 2.0 + 0.18))
                    sway = float(self._rng.uniform(-0.25, 0.25))
                    chair = furniture.chair(self._rng, low_objects=self._low_objects)
                    self._put("chair", chair, *at, turn + sway, 0.5, 0.3, overlap=True)

    def lounge(self) -> None:
        """Put a sofa at the back wall, and a low table in front of it if there is room."""
        if self._rng.random() >= max(self._furnishing, 0.3):
            return
        length, depth = furniture.SOFA_SIZE
        self._put("sofa", furniture.sofa(self._rng), 0.0, 0.05 + depth / 2.0, 0.0, length, depth)
        height, middle = (0.34, 0.20) if self._low_objects else (SEEN_TO, SEEN_TO / 2.0)
        table = [box("top", (0.8, 0.45, height), (0.0, 0.0, middle), (0.86, 0.85, 0.82, 1.0), "table")]
        self._put("table", table, 0.0, depth + 0.55, 0.0, 0.8, 0.45)

    def storage(self) -> None:
        """Put cabinets along the side walls and plants in the corners, where they leave the lane free."""
        room, rng = self._room, self._rng
        long, deep = furniture.CABINET_SIZE
        half = room.width / 2.0
        for sign, turn in ((-1.0, -math.pi / 2.0), (1.0, math.pi / 2.0)):
            x = sign * (half - 0.03 - deep / 2.0)
            for slot in range(int((room.depth - 2.2) / (long + 0.05))):
                if rng.random() < 0.7 * self._furnishing:
                    y = 1.55 + (slot + 0.5) * (long + 0.05)
                    self._put("cabinet", furniture.cabinet(rng, low_objects=self._low_objects), x, y, turn, deep, long)
            reach = furniture.PLANT_RADIUS + 0.02
            for y in (reach, room.depth - reach):
                if rng.random() < 0.6 * self._furnishing:
                    size = 2.0 * furniture.PLANT_RADIUS
                    self._put(
                        "plant",
                        furniture.plant(rng, low_objects=self._low_objects),
                        sign * (half - reach),
                        y,
                        0.0,
                        size,
                        size,
                    )

    def _put(
        self,
        kind: str,
        parts: list[Part],
        x: float,
        y: float,
        turn: float,
        extent_x: float,
        extent_y: float,
        *,
        overlap: bool = False,
    ) -> None:
        """Place a piece if it blocks no lane, otherwise skip it. Extents are along the room's axes."""
        rect = (x - extent_x / 2.0, y - extent_y / 2.0, x + extent_x / 2.0, y + extent_y / 2.0)
        blocked = [self._free] if overlap else [self._free, *self._taken]
        if any(_overlap(rect, other) for other in blocked):
            return
        self._taken.append(rect)
        self._counts[kind] = self._counts.get(kind, 0) + 1
        room = self._room
        back = room.y0 if room.side > 0 else room.y1
        world_x = (room.x0 + room.x1) / 2.0 + room.side * x
        yaw = turn + (0.0 if room.side > 0 else math.pi)
        name = f"{room.name}_{kind}_{self._counts[kind]}"
        self.solids += place(parts, name, world_x, back + room.side * y, yaw)


def _overlap(a: tuple[float, float, float, float], b: tuple[float, float, float, float]) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
