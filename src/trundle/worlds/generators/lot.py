"""The `lot` generator: an open lot with kerbs and hedges round it, rows of parked vehicles, containers and cones.

The ground is `size` between the kerbs, centred on the origin. Rows of vehicles lie along x, on both sides of green
islands with lamp posts and trees; containers stand along the north edge. Cones are placed on the drives with
FREE_BESIDE clear on every side.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from trundle.geometry.solids import Color, Solid
from trundle.worlds.generators import yard
from trundle.worlds.generators.props import SEEN_TO, Part, box, place
from trundle.worlds.options import check_flag, check_number, check_seed, check_size, check_whole
from trundle.worlds.world import World

DRIVE = 5.0
"""Least width of the drives beside rows of vehicles, and round them [m]."""

FREE_BESIDE = 1.6
"""Least free width beside a cone [m]."""

BAY_WIDTH, BAY_LENGTH = 2.9, 5.6
"""Size of a parking bay [m]."""

MAX_SIZE = 150.0  # [m]

_KERB = 0.2  # width of a kerb [m]
_KERB_HEIGHT = 0.15
_ISLAND = 1.6  # width of a green island with its kerbs [m]
_VERGE = 1.5  # width of the grass round the lot [m]
_HEDGES: tuple[Color, ...] = ((0.20, 0.38, 0.20, 1.0), (0.24, 0.43, 0.23, 1.0), (0.18, 0.35, 0.21, 1.0))

Rect = tuple[float, float, float, float]
"""West, south, east and north edge [m]."""


def generate_lot(
    *,
    seed: int = 0,
    size: Sequence[float] | str = (36.0, 28.0),
    fill: float = 0.6,
    containers: float = 0.6,
    cones: int = 14,
    hedges: bool = True,
    low_objects: bool = True,
) -> World:
    """Generate an open lot that Nova Carter can drive across.

    Args:
        seed: The same seed and options make the same lot.
        size: Size of the ground between the kerbs, along x and y [m], 12 to 150 each.
        fill: Share of parking bays that are occupied, 0 to 1.
        containers: Share of container places that are occupied, 0 to 1.
        cones: Maximum number of traffic cones, 0 to 500; fewer are placed if they do not fit.
        hedges: Whether there are hedges behind the kerbs.
        low_objects: Whether there are objects that a planar lidar does not see, such as kerbs. Without them kerbs are
            walls, cones are bollards, and a lidar's beams meet every object at any height from 0.2 to 0.42 m.

    Raises:
        WorldError: If a value is out of range.
    """
    rng = np.random.default_rng(check_seed("lot", seed))
    length, width = check_size("lot", size, 12.0, MAX_SIZE)
    fill = check_number("lot", "fill", fill, 0.0, 1.0)
    containers = check_number("lot", "containers", containers, 0.0, 1.0)
    cones = check_whole("lot", "cones", cones, 0, 500)
    hedges = check_flag("lot", "hedges", hedges)
    low_objects = check_flag("lot", "low_objects", low_objects)
    kerb = _KERB_HEIGHT if low_objects else SEEN_TO
    solids = _edge(rng, length, width, kerb, hedges=hedges)
    boxes, taken = _containers(rng, length, width, containers)
    solids += boxes
    for number, y in enumerate(_island_rows(width), start=1):
        row, spots = _row(rng, f"row_{number}", y, length, fill, low_objects=low_objects)
        solids += row
        taken += spots
    solids += _cones(rng, length, width, cones, taken, low_objects=low_objects)
    return World("lot", tuple(solids), ((0.0, -width / 2.0 + DRIVE / 2.0),))


def _edge(rng: np.random.Generator, length: float, width: float, kerb: float, *, hedges: bool) -> list[Solid]:
    """Return kerbs round the ground, grass behind them, and hedges and a few trees on the grass."""
    parts: list[Part] = []
    across, green = 2.0 * _KERB, 2.0 * (_KERB + _VERGE)
    for name, along_x, sign in (
        ("north", True, 1.0),
        ("south", True, -1.0),
        ("east", False, 1.0),
        ("west", False, -1.0),
    ):
        for what, begin, thick, height, color in (
            ("kerb", 0.0, _KERB, kerb, yard.KERB),
            ("grass", _KERB, _VERGE, _KERB_HEIGHT - 0.02, yard.GRASS),
        ):
            reach = across if what == "kerb" else green
            off = begin + thick / 2.0
            if along_x:
                edges, centre = (length + reach, thick), (0.0, sign * (width / 2.0 + off))
            else:
                edges, centre = (thick, width + reach - 2.0 * thick), (sign * (length / 2.0 + off), 0.0)
            parts.append(box(f"{name}_{what}", (*edges, height), (*centre, height / 2.0), color, what))
        if hedges:
            parts += _hedge(rng, name, (length if along_x else width) + 1.6, sign, (length, width), along_x=along_x)
    solids = place(parts, "edge", 0.0, 0.0, 0.0)
    for number, (x, y) in enumerate(((-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)), start=1):
        at = (x * (length / 2.0 + _KERB + 0.45), y * (width / 2.0 + _KERB + 0.45))
        turn = math.atan2(-y, -x)
        solids += place(yard.lamp_post(), f"edge_lamp_{number}", *at, turn)
    return solids


def _hedge(
    rng: np.random.Generator, name: str, span: float, sign: float, size: tuple[float, float], *, along_x: bool
) -> list[Part]:
    """Return a straight hedge of pieces of unequal height, with a gap for the lamp posts at its ends."""
    parts: list[Part] = []
    count = max(1, round((span - 2.4) / 2.2))
    piece = (span - 2.4) / count
    off = (size[1] if along_x else size[0]) / 2.0 + _KERB + 0.85
    for index in range(count):
        at = (index - (count - 1) / 2.0) * piece
        height = float(rng.uniform(0.85, 1.1))
        color = _HEDGES[int(rng.integers(len(_HEDGES)))]
        deep = float(rng.uniform(0.62, 0.76))
        edges, centre = ((piece, deep), (at, sign * off)) if along_x else ((deep, piece), (sign * off, at))
        parts.append(box(f"{name}_hedge_{index + 1}", (*edges, height), (*centre, height / 2.0), color, "hedge"))
    return parts


def _containers(rng: np.random.Generator, length: float, width: float, share: float) -> tuple[list[Solid], list[Rect]]:
    """Return containers with their backs to the north kerb, some stacked two high."""
    long, wide, tall = yard.CONTAINER_SIZE
    solids: list[Solid] = []
    taken: list[Rect] = []
    count = int((length - 2.0) / (long + 0.5)) if width >= 3.0 * DRIVE + wide else 0
    for index in range(count):
        if rng.random() >= share:
            continue
        x = (index - (count - 1) / 2.0) * (long + 0.5)
        y = width / 2.0 - 0.05 - wide / 2.0
        turn = 0.0 if rng.random() < 0.5 else math.pi
        solids += place(yard.container(rng), f"container_{index + 1}", x, y, turn)
        if rng.random() < 0.3:
            for solid in place(yard.container(rng), f"container_{index + 1}_upper", x, y, turn):
                at_x, at_y, at_z = solid.pose.position
                solids.append(replace(solid, pose=replace(solid.pose, position=(at_x, at_y, at_z + tall))))
        taken.append((x - long / 2.0, y - wide / 2.0, x + long / 2.0, y + wide / 2.0))
    return solids, taken


def _island_rows(width: float) -> list[float]:
    """Return the middles of the islands along y: as many double rows of bays as fit, with drives round each."""
    depth = 2.0 * BAY_LENGTH + _ISLAND
    south = -width / 2.0 + DRIVE
    north = width / 2.0 - DRIVE - yard.CONTAINER_SIZE[1]
    count = int((north - south + DRIVE) / (depth + DRIVE))
    pitch = depth + DRIVE
    middle = (south + north) / 2.0
    return [middle + (index - (count - 1) / 2.0) * pitch for index in range(count)]


def _row(
    rng: np.random.Generator, name: str, y: float, length: float, fill: float, *, low_objects: bool
) -> tuple[list[Solid], list[Rect]]:
    """Return an island with lamp posts and trees on it, and vehicles in the bays on both sides."""
    bays = int((length - 2.0 * DRIVE) / BAY_WIDTH)
    if bays < 1:
        return [], []
    long = bays * BAY_WIDTH
    kerb = _KERB_HEIGHT if low_objects else SEEN_TO
    parts = [box("grass", (long - 2.0 * _KERB, _ISLAND - 2.0 * _KERB, 0.13), (0.0, 0.0, 0.065), yard.GRASS, "grass")]
    for side, sign in (("north", 1.0), ("south", -1.0)):
        centre = (0.0, sign * (_ISLAND - _KERB) / 2.0, kerb / 2.0)
        parts.append(box(f"kerb_{side}", (long, _KERB, kerb), centre, yard.KERB, "kerb"))
    for side, sign in (("east", 1.0), ("west", -1.0)):
        centre = (sign * (long - _KERB) / 2.0, 0.0, kerb / 2.0)
        parts.append(box(f"kerb_{side}", (_KERB, _ISLAND - 2.0 * _KERB, kerb), centre, yard.KERB, "kerb"))
    solids = place(parts, name, 0.0, y, 0.0)
    taken: list[Rect] = [(-long / 2.0, y - _ISLAND / 2.0, long / 2.0, y + _ISLAND / 2.0)]
    posts = max(2, round(long / 4.5))
    for index in range(posts):
        x = (index - (posts - 1) / 2.0) * (long - 1.2) / (posts - 1)
        if index % 3 == 0:
            solids += place(yard.lamp_post(), f"{name}_lamp_{index + 1}", x, y, math.pi / 2.0)
        else:
            solids += place(yard.tree(rng), f"{name}_tree_{index + 1}", x, y, 0.0)
    for bay in range(2 * bays):
        if rng.random() >= fill:
            continue
        column, side = bay % bays, 1.0 if bay < bays else -1.0
        x = (column - (bays - 1) / 2.0) * BAY_WIDTH + float(rng.uniform(-0.15, 0.15))
        at = y + side * (_ISLAND / 2.0 + 0.25 + yard.VAN_SIZE[0] / 2.0)
        turn = side * math.pi / 2.0 * (1.0 if rng.random() < 0.6 else -1.0) + float(rng.uniform(-0.03, 0.03))
        solids += place(yard.van(rng, low_objects=low_objects), f"{name}_vehicle_{bay + 1}", x, at, turn)
        reach = (yard.VAN_SIZE[1] / 2.0 + 0.1, yard.VAN_SIZE[0] / 2.0 + 0.1)
        taken.append((x - reach[0], at - reach[1], x + reach[0], at + reach[1]))
    return solids, taken


def _cones(
    rng: np.random.Generator, length: float, width: float, count: int, taken: Sequence[Rect], *, low_objects: bool
) -> list[Solid]:
    """Return cones in short lines, each with room on every side; the seed point stays free."""
    solids: list[Solid] = []
    spots: list[tuple[float, float]] = []
    start = (0.0, -width / 2.0 + DRIVE / 2.0)
    room = FREE_BESIDE + yard.CONE_RADIUS
    for _ in range(20 * count):
        if len(spots) == count:
            break
        if spots and rng.random() < 0.6:
            angle = float(rng.choice((0.0, math.pi / 2.0, math.pi)))
            x, y = spots[-1][0] + 2.2 * math.cos(angle), spots[-1][1] + 2.2 * math.sin(angle)
        else:
            x = float(rng.uniform(-length / 2.0 + room, length / 2.0 - room))
            y = float(rng.uniform(-width / 2.0 + room, width / 2.0 - room))
        inside = abs(x) <= length / 2.0 - room and abs(y) <= width / 2.0 - room
        apart = all(math.hypot(x - a, y - b) >= FREE_BESIDE + 2.0 * yard.CONE_RADIUS for a, b in spots)
        if inside and apart and math.hypot(x - start[0], y - start[1]) >= 3.0 and _clear(x, y, taken, room):
            spots.append((x, y))
            cone = yard.cone(low_objects=low_objects)
            solids += place(cone, f"cone_{len(spots)}", x, y, float(rng.uniform(-0.4, 0.4)))
    return solids


def _clear(x: float, y: float, taken: Sequence[Rect], room: float) -> bool:
    return all(math.hypot(max(a - x, 0.0, x - c), max(b - y, 0.0, y - d)) >= room for a, b, c, d in taken)
