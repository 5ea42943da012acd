"""The `corridors` generator: a row of halls whose doors get narrower, to find the narrowest a robot can pass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.errors import WorldError
from trundle.geometry.solids import Color, Solid
from trundle.worlds.generators.props import Part, box, place
from trundle.worlds.options import check_number, check_numbers, check_seed
from trundle.worlds.world import World

DOOR_WIDTHS = (2.0, 1.6, 1.4, 1.2, 1.1, 1.0, 0.9, 0.8)
"""Default widths of the doors [m]."""

_OUTER = 0.2  # thickness of the outer walls [m]
_JAMB = 0.12  # width of a door's coloured posts [m]
_PROUD = 0.03  # how far they protrude from the wall [m]
_WALL: Color = (0.84, 0.85, 0.86, 1.0)
_BASE: Color = (0.46, 0.51, 0.57, 1.0)
_INNER: Color = (0.72, 0.75, 0.78, 1.0)


def generate_corridors(
    *,
    seed: int = 0,
    door_widths: Sequence[float] | str | float = DOOR_WIDTHS,
    door_depth: float = 0.2,
    spacing: float = 3.0,
    hall_width: float = 4.0,
    stagger: float = 0.0,
    wall_height: float = 1.2,
) -> World:
    """Generate halls along x, each joined to the next by a door of an exact width.

    The posts of a door go from green (the widest) to red (the narrowest). The origin and the seed point are in
    the middle of the first hall; hall `i`, from 0, lies about x = i · (spacing + door_depth).

    Args:
        seed: Determines on which side of the middle the doors are, if `stagger` is above 0.
        door_widths: Clear widths [m] in order along x, 1 to 40 of them.
        door_depth: Length of the passage through a door [m], 0.05 to 10.
        spacing: Length of a hall between two doors [m], 1 to 30.
        hall_width: Width of the halls [m], 1 to 30.
        stagger: How far doors are off the middle: 0 not at all, 1 as far as the hall allows.
        wall_height: Height of the walls [m], 0.3 to 10.

    Raises:
        WorldError: If a value is out of range, or a door is too wide for the hall.
    """
    rng = np.random.default_rng(check_seed("corridors", seed))
    widths = check_numbers("corridors", "door_widths", door_widths, 0.1, 20.0, most=40)
    depth = check_number("corridors", "door_depth", door_depth, 0.05, 10.0)
    spacing = check_number("corridors", "spacing", spacing, 1.0, 30.0)
    hall = check_number("corridors", "hall_width", hall_width, 1.0, 30.0)
    stagger = check_number("corridors", "stagger", stagger, 0.0, 1.0)
    height = check_number("corridors", "wall_height", wall_height, 0.3, 10.0)
    if max(widths) > hall - 2.0 * _JAMB:
        raise WorldError(
            f"corridors: a door of {max(widths):g} m does not fit between its posts in a hall of {hall:g} m; make "
            f"hall_width at least {max(widths) + 2.0 * _JAMB:g} m"
        )
    solids = _outer_walls(len(widths), depth, spacing, hall, height)
    for index, width in enumerate(widths):
        x = spacing / 2.0 + depth / 2.0 + index * (spacing + depth)
        reach = stagger * ((hall - width) / 2.0 - _JAMB)
        y = reach * float(rng.choice((-1.0, 1.0)))
        solids += _door(index + 1, x, y, width, depth, hall, height, _post_color(width, widths))
    return World("corridors", tuple(solids), ((0.0, 0.0),))


def _outer_walls(doors: int, depth: float, spacing: float, hall: float, height: float) -> list[Solid]:
    length = (doors + 1) * spacing + doors * depth
    middle = (length - spacing) / 2.0
    base = 0.3 * height
    parts: list[Part] = []
    for name, x, y, size in (
        ("north", middle, (hall + _OUTER) / 2.0, (length + 2.0 * _OUTER, _OUTER)),
        ("south", middle, -(hall + _OUTER) / 2.0, (length + 2.0 * _OUTER, _OUTER)),
        ("west", -(spacing + _OUTER) / 2.0, 0.0, (_OUTER, hall)),
        ("east", length - (spacing - _OUTER) / 2.0, 0.0, (_OUTER, hall)),
    ):
        parts.append(box(f"{name}_base", (*size, base), (x, y, base / 2.0), _BASE, "wall"))
        parts.append(box(name, (*size, height - base), (x, y, (height + base) / 2.0), _WALL, "wall"))
    return place(parts, "wall", 0.0, 0.0, 0.0)


def _door(
    number: int, x: float, y: float, width: float, depth: float, hall: float, height: float, color: Color
) -> list[Solid]:
    """Return the wall beside a door, and its two posts: they bound the opening."""
    parts: list[Part] = []
    for side, sign in (("left", 1.0), ("right", -1.0)):
        edge = y + sign * width / 2.0
        post = height + 0.08
        size = (depth + 2.0 * _PROUD, _JAMB, post)
        parts.append(box(f"post_{side}", size, (x, edge + sign * _JAMB / 2.0, post / 2.0), color, "door"))
        begin, end = edge + sign * _JAMB, sign * hall / 2.0
        if abs(end - begin) > 1e-6:
            centre = (x, (begin + end) / 2.0, height / 2.0)
            parts.append(box(f"wall_{side}", (depth, abs(end - begin), height), centre, _INNER, "wall"))
    return place(parts, f"door_{number}", 0.0, 0.0, 0.0)


def _post_color(width: float, widths: Sequence[float]) -> Color:
    span = max(widths) - min(widths)
    narrow = 0.0 if span < 1e-9 else (max(widths) - width) / span
    stops = np.array([(0.24, 0.60, 0.36), (0.93, 0.74, 0.18), (0.80, 0.22, 0.18)])
    red, green, blue = (float(np.interp(narrow, (0.0, 0.5, 1.0), channel)) for channel in stops.T)
    return (red, green, blue, 1.0)
