"""The `warehouse` generator: racks in rows, aisles of one exact width, and loose objects.

The floor is `size` between the walls, centred on the origin. Rows of racks run along x. West of them is a loading area,
east of them a cross aisle, and long rows have another cross aisle in the middle; along the north and the south wall
runs a lane. Loose objects are only in the loading area and the lanes, with `FREE_BESIDE` clear on every side that is
not against a wall, so that a robot of Nova Carter's size can reach every place between them and turn there. Where
forklifts drive, all of that is at least `FORKLIFT_ROOM` wide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle.errors import WorldError
from trundle.geometry.solids import Color, Solid
from trundle.worlds.generators.clutter import CARTONS, SAFETY_YELLOW, TOTES, Clutter, Rect
from trundle.worlds.generators.props import SEEN_TO, Part, box, place
from trundle.worlds.movers import Crowd, forklift_body
from trundle.worlds.options import check_flag, check_number, check_seed, check_size, check_whole
from trundle.worlds.world import World

CROSS_AISLE = 2.4  # [m]: room to turn for Nova Carter, whose tail swings on a radius of 0.656 m
LANE = 2.2  # least width of the lanes along the north and south walls [m]
FREE_BESIDE = 1.6  # least free width beside loose objects [m]
AISLE = 1.6  # [m]
FORKLIFT_ROOM = 2.8  # [m]: for a forklift of `forklift_body`, which turns on the spot within a radius of 1.1 m
RACK_DEPTH = 1.0  # [m]
FLUE = 0.1  # gap between two racks that stand back to back [m]
BAY = 2.7  # clear pitch of the uprights [m]
MAX_SIZE = 100.0  # [m]

_GUARD = 0.10  # thickness of the barrier at the end of a row [m]
_POST = 0.10  # edge of an upright [m]
_BEAM = 0.11  # height of a beam [m]
_FIRST_SHELF = 0.22  # top of the lowest shelf [m]
_SHELF_PITCH = 1.15  # from shelf to shelf [m]
_ROWS_SPLIT_AT = 7  # rows of at least this many bays have a cross aisle in the middle

_UPRIGHT: Color = (0.13, 0.29, 0.60, 1.0)
_ORANGE: Color = (0.93, 0.43, 0.09, 1.0)
_DECK: Color = (0.63, 0.65, 0.67, 1.0)
_WALL: Color = (0.86, 0.87, 0.86, 1.0)
_WALL_BASE: Color = (0.52, 0.57, 0.62, 1.0)
_DOOR: Color = (0.70, 0.73, 0.76, 1.0)


@dataclass(frozen=True, slots=True)
class _Layout:
    """Positions of the rows of racks.

    Attributes:
        room: What has to be free everywhere [m], because of what drives there.
        floor: The floor between the walls.
        field: Bounds of all rows, with the aisles between them.
        rows: South edge and number of racks back to back (1 or 2) of each row.
        runs: West end and number of bays of each run of racks within a row.
    """

    room: float
    floor: Rect
    field: Rect
    rows: tuple[tuple[float, int], ...]
    runs: tuple[tuple[float, int], ...]

    @property
    def cross_aisle(self) -> float:
        """Width of the cross aisles [m]."""
        return max(CROSS_AISLE, self.room)

    @property
    def beside(self) -> float:
        """Least free width beside loose objects [m]."""
        return max(FREE_BESIDE, self.room)


def generate_warehouse(
    *,
    seed: int = 0,
    size: Sequence[float] = (30.0, 20.0),
    aisle_width: float | None = None,
    levels: int = 3,
    fill: float = 0.85,
    clutter: float = 1.0,
    wall_height: float = 4.0,
    low_objects: bool = True,
    forklifts: int = 0,
    people: int = 0,
    mover_speed: float = 1.2,
    sees_robot: bool = True,
) -> World:
    """Generate a warehouse that Nova Carter can drive through everywhere.

    Args:
        seed: The same seed and options make the same warehouse.
        size: Size of the floor between the walls, along x and y [m], up to 100 each.
        aisle_width: Between the faces of two rows of racks [m], 1 to 10. If None, 1.6, or 2.8 with forklifts.
        levels: Shelf levels per rack, 1 to 6.
        fill: Share of rack places that hold goods, 0 to 1.
        clutter: Number of loose objects, relative to the default; 0 (none) to 3.
        wall_height: Height of the walls [m].
        low_objects: Whether there are objects that a planar lidar does not see, such as empty pallets, forks, low
            boxes and empty shelves. Without them its beams meet every object at any height from 0.2 to 0.42 m, and
            forklifts that drive carry crates.
        forklifts: Number of forklifts that drive to random places, as a `Crowd` named `forklifts`; 0 to 100. With any,
            lanes and cross aisles are at least 2.8 m wide, and so is what is free beside loose objects.
        people: Number of people who walk to random places, as a `Crowd` named `people`; 0 to 100.
        mover_speed: The fastest of them [m/s], 0.1 to 10.
        sees_robot: Whether they stop for the robot and go around it.

    Raises:
        WorldError: If a value is out of range, or the floor has no room for two rows of racks with their aisles.
    """
    seed = check_seed("warehouse", seed)
    levels = check_whole("warehouse", "levels", levels, 1, 6)
    forklifts = check_whole("warehouse", "forklifts", forklifts, 0, 100)
    room = FORKLIFT_ROOM if forklifts else 0.0
    if aisle_width is None:
        aisle_width = max(AISLE, room)
    aisle_width = check_number("warehouse", "aisle_width", aisle_width, 1.0, 10.0)
    fill = check_number("warehouse", "fill", fill, 0.0, 1.0)
    clutter = check_number("warehouse", "clutter", clutter, 0.0, 3.0)
    wall_height = check_number("warehouse", "wall_height", wall_height, 0.7, 20.0)
    low_objects = check_flag("warehouse", "low_objects", low_objects)
    sees_robot = check_flag("warehouse", "sees_robot", sees_robot)
    mover_speed = check_number("warehouse", "mover_speed", mover_speed, 0.1, 10.0)
    movers = tuple(
        Crowd(name, count, kind, mover_speed, sees_robot, parts=parts)
        for name, kind, count, parts in (
            ("forklifts", "forklift", forklifts, None if low_objects else forklift_body(loaded=True)),
            ("people", "person", check_whole("warehouse", "people", people, 0, 100), None),
        )
        if count
    )
    layout = _lay_out(check_size("warehouse", size, 1.0, MAX_SIZE), aisle_width, room)
    rng = np.random.default_rng(seed)
    solids = _walls(layout.floor, wall_height)
    number = 0
    for south, depth in layout.rows:
        for west, bays in layout.runs:
            for index in range(depth):
                number += 1
                y = south + RACK_DEPTH / 2.0 + index * (RACK_DEPTH + FLUE)
                rack = _rack(rng, bays, levels, fill, low_objects=low_objects)
                solids += place(rack, f"rack_{number}", west + _GUARD, y, 0.0)
            solids += _guards(f"row_{number}", west, bays, south, depth, low_objects=low_objects)
    loose = Clutter(rng, layout.floor, layout.field, layout.cross_aisle, layout.beside, low_objects)
    solids += loose.scatter(clutter)
    seeds = (((layout.field.x1 + layout.floor.x1) / 2.0, 0.0),)
    return World("warehouse", tuple(solids), seeds, movers=movers)


def _run_length(bays: int) -> float:
    return bays * BAY + _POST + 2.0 * _GUARD


def _row_depth(racks: int) -> float:
    return racks * RACK_DEPTH + (racks - 1) * FLUE


def _lay_out(size: tuple[float, float], aisle: float, room: float) -> _Layout:
    length, width = size
    cross, lane = max(CROSS_AISLE, room), max(LANE, room)
    least = (2.0 * cross + _run_length(1), 2.0 * lane + 2.0 * RACK_DEPTH + aisle)
    if length < least[0] or width < least[1]:
        raise WorldError(
            f"warehouse: size {length:g} x {width:g} m has no room for two rows of racks with an aisle of {aisle:g} m "
            f"and room to turn at their ends; make it at least {least[0]:.1f} x {least[1]:.1f} m"
        )
    floor = Rect(-length / 2.0, -width / 2.0, length / 2.0, width / 2.0)
    loading = min(8.0, max(cross, 0.22 * length, min(0.4 * length, 6.0)))
    loading = min(loading, length - cross - _run_length(1))
    left = length - loading - cross
    bays = int((left - _POST - 2.0 * _GUARD) / BAY)
    west = floor.x0 + loading
    runs: list[tuple[float, int]] = [(west, bays)]
    if bays >= _ROWS_SPLIT_AT:
        bays = int((left - cross - 2.0 * (_POST + 2.0 * _GUARD)) / BAY)
        first = bays // 2
        runs = [(west, first), (west + _run_length(first) + cross, bays - first)]
    racks = _racks_in_rows(width - 2.0 * lane, aisle)
    depth = sum(_row_depth(count) for count in racks) + (len(racks) - 1) * aisle
    south = -depth / 2.0
    rows: list[tuple[float, int]] = []
    for count in racks:
        rows.append((south, count))
        south += _row_depth(count) + aisle
    east = runs[-1][0] + _run_length(runs[-1][1])
    return _Layout(room, floor, Rect(west, -depth / 2.0, east, depth / 2.0), tuple(rows), tuple(runs))


def _racks_in_rows(room: float, aisle: float) -> list[int]:
    """Return racks back to back in each row: as many pairs as fit, then a single one; at least two rows."""
    pairs = int((room + aisle) / (_row_depth(2) + aisle))
    left = room + aisle - pairs * (_row_depth(2) + aisle)
    singles = int(left / (RACK_DEPTH + aisle))
    if pairs + singles < 2:
        return [1, 1]
    return [2] * pairs + [1] * singles


def _walls(floor: Rect, height: float) -> list[Solid]:
    """Return four walls of 0.2 m around the floor, each with a darker lower part, and doors in the west wall."""
    thick, base = 0.2, min(0.9, 0.3 * height)
    length, width = floor.x1 - floor.x0, floor.y1 - floor.y0
    parts: list[Part] = []
    for name, x, y, along_x, along_y in (
        ("north", 0.0, floor.y1 + thick / 2.0, length + 2.0 * thick, thick),
        ("south", 0.0, floor.y0 - thick / 2.0, length + 2.0 * thick, thick),
        ("west", floor.x0 - thick / 2.0, 0.0, thick, width),
        ("east", floor.x1 + thick / 2.0, 0.0, thick, width),
    ):
        parts.append(box(f"{name}_base", (along_x, along_y, base), (x, y, base / 2.0), _WALL_BASE, "wall"))
        parts.append(box(name, (along_x, along_y, height - base), (x, y, (height + base) / 2.0), _WALL, "wall"))
    door_width, door_height = 3.0, 0.8 * height
    doors = int((width - 2.0) / (door_width + 2.0))
    for index in range(doors):
        y = (index - (doors - 1) / 2.0) * width / max(1, doors)
        centre = (floor.x0 + 0.015, y, door_height / 2.0)
        parts.append(box(f"door_{index + 1}", (0.03, door_width, door_height), centre, _DOOR, "wall"))
        for side, offset in (("left", -1.0), ("right", 1.0)):
            jamb = (floor.x0 + 0.03, y + offset * (door_width / 2.0 + 0.06), door_height / 2.0)
            name = f"door_{index + 1}_jamb_{side}"
            parts.append(box(name, (0.06, 0.12, door_height), jamb, SAFETY_YELLOW, "wall"))
    return place(parts, "wall", 0.0, 0.0, 0.0)


def _rack(rng: np.random.Generator, bays: int, levels: int, fill: float, *, low_objects: bool) -> list[Part]:
    """Return one rack: x from 0 along its bays, y across it about 0; its faces, at ±RACK_DEPTH / 2, are the uprights'.

    Without low objects, panels in place of the lowest beams hide the lowest shelf, which may be empty.
    """
    length = bays * BAY + _POST
    height = _FIRST_SHELF + (levels - 1) * _SHELF_PITCH + 0.55
    face = (RACK_DEPTH - _POST) / 2.0
    parts: list[Part] = []
    for index in range(bays + 1):
        for side, y in (("south", -face), ("north", face)):
            centre = (_POST / 2.0 + index * BAY, y, height / 2.0)
            parts.append(box(f"upright_{index + 1}_{side}", (_POST, _POST, height), centre, _UPRIGHT, "rack"))
    for level in range(levels):
        top = _FIRST_SHELF + level * _SHELF_PITCH
        deck = box(
            f"shelf_{level + 1}",
            (length - 0.02, RACK_DEPTH - 0.12, 0.03),
            (length / 2.0, 0.0, top - 0.015),
            _DECK,
            "rack",
        )
        parts.append(deck)
        for side, y in (("south", -1.0), ("north", 1.0)):
            height, middle = _BEAM, top - _BEAM / 2.0 + 0.02
            if level == 0 and not low_objects:
                height, middle = SEEN_TO - 0.1, (SEEN_TO + 0.1) / 2.0
            centre = (length / 2.0, y * (RACK_DEPTH / 2.0 - 0.045), middle)
            name = f"beam_{level + 1}_{side}"
            parts.append(box(name, (length - 0.01, 0.06, height), centre, _ORANGE, "rack"))
        parts += _goods(rng, bays, level, top, fill)
    return parts


def _goods(rng: np.random.Generator, bays: int, level: int, top: float, fill: float) -> list[Part]:
    """Return goods on one shelf: two places in each bay, each empty, with a carton (or two, stacked) or with totes."""
    parts: list[Part] = []
    pitch = (BAY - _POST) / 2.0
    room = _SHELF_PITCH - _BEAM - 0.06
    for place_index in range(2 * bays):
        bay, half = divmod(place_index, 2)
        x = _POST + bay * BAY + (half + 0.5) * pitch
        name = f"goods_{level + 1}_{place_index + 1}"
        if rng.random() >= fill:
            continue
        if rng.random() < 0.2:
            color = TOTES[rng.integers(len(TOTES))]
            size = (0.56, 0.78, float(rng.uniform(0.34, 0.5)))
            for index, offset in enumerate((-0.3, 0.3)[: int(rng.integers(1, 3))]):
                centre = (x + offset, 0.0, top + size[2] / 2.0)
                parts.append(box(f"{name}_tote_{index + 1}", size, centre, color, "goods"))
            continue
        color = CARTONS[rng.integers(len(CARTONS))]
        size = (float(rng.uniform(0.75, 1.15)), float(rng.uniform(0.7, 0.84)), float(rng.uniform(0.45, 0.9)) * room)
        x += float(rng.uniform(-0.5, 0.5)) * (pitch - size[0] - 0.06)
        parts.append(box(f"{name}_carton", size, (x, 0.0, top + size[2] / 2.0), color, "goods"))
        left = room - size[2]
        if left > 0.25 and rng.random() < 0.35:
            small = (0.7 * size[0], 0.8 * size[1], float(rng.uniform(0.5, 1.0)) * left)
            centre = (x, 0.0, top + size[2] + small[2] / 2.0)
            color = CARTONS[rng.integers(len(CARTONS))]
            parts.append(box(f"{name}_carton_top", small, centre, color, "goods"))
    return parts


def _guards(name: str, west: float, bays: int, south: float, racks: int, *, low_objects: bool) -> list[Solid]:
    """Return yellow barriers that close both ends of a row."""
    depth, height = _row_depth(racks), 0.42 if low_objects else SEEN_TO
    parts = []
    for end, x in (("west", west + _GUARD / 2.0), ("east", west + _run_length(bays) - _GUARD / 2.0)):
        y = south + depth / 2.0
        parts.append(box(f"guard_{end}", (_GUARD, depth, height), (x, y, height / 2.0), SAFETY_YELLOW, "rack"))
    return place(parts, name, 0.0, 0.0, 0.0)
