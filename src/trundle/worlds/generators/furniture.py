"""Office furniture made of boxes, cylinders and spheres: desks, chairs, tables, sofas, plants.

The origin of each piece is on the floor, in its middle. Pieces for a wall have it behind them, at −y, and face +y.
"""

from __future__ import annotations

import numpy as np

from trundle.geometry import Pose3D
from trundle.geometry.solids import Color, Cylinder, Sphere
from trundle.worlds.generators.props import CHARCOAL, RUBBER, SEEN_TO, STEEL, WOOD, Part, box

DESK_SIZE = (1.6, 0.8)
"""Size of a desk, along the wall and into the room [m]."""

CABINET_SIZE = (0.9, 0.45)
TABLE_SIZE = (2.2, 1.0)
SOFA_SIZE = (1.8, 0.85)
PLANT_RADIUS = 0.34

_TOP_HEIGHT = 0.74  # of desks and tables [m]
_FRAME: Color = (0.88, 0.88, 0.87, 1.0)
_OAK: Color = (0.79, 0.66, 0.48, 1.0)
_POT: Color = (0.86, 0.84, 0.80, 1.0)
_SOIL: Color = (0.25, 0.19, 0.14, 1.0)
_CABINET: Color = (0.83, 0.84, 0.85, 1.0)
_SCREEN: Color = (0.10, 0.16, 0.24, 1.0)
LEAVES: tuple[Color, ...] = ((0.22, 0.47, 0.26, 1.0), (0.29, 0.55, 0.31, 1.0), (0.18, 0.40, 0.27, 1.0))
FABRICS: tuple[Color, ...] = (
    (0.20, 0.36, 0.52, 1.0),
    (0.24, 0.47, 0.45, 1.0),
    (0.76, 0.44, 0.22, 1.0),
    (0.34, 0.36, 0.40, 1.0),
)


def desk() -> list[Part]:
    """Return a desk with a drawer unit, a modesty panel at the wall and a screen."""
    length, depth = DESK_SIZE
    side = _TOP_HEIGHT - 0.04
    parts = [
        box("top", (length, depth, 0.04), (0.0, 0.0, _TOP_HEIGHT - 0.02), _OAK, "desk"),
        box("panel", (length - 0.08, 0.04, side - 0.06), (0.0, -depth / 2.0 + 0.06, side / 2.0 + 0.03), _FRAME, "desk"),
        box("drawers", (0.42, depth - 0.16, side - 0.04), (length / 2.0 - 0.25, 0.02, side / 2.0), _FRAME, "desk"),
        box("leg", (0.05, depth - 0.06, side), (-length / 2.0 + 0.03, 0.0, side / 2.0), _FRAME, "desk"),
        box("screen_foot", (0.22, 0.16, 0.02), (-0.1, -0.2, _TOP_HEIGHT + 0.01), CHARCOAL, "desk"),
        box("screen_neck", (0.05, 0.04, 0.14), (-0.1, -0.24, _TOP_HEIGHT + 0.09), CHARCOAL, "desk"),
        box("screen", (0.62, 0.04, 0.36), (-0.1, -0.2, _TOP_HEIGHT + 0.34), _SCREEN, "desk"),
        box("keyboard", (0.42, 0.14, 0.02), (-0.1, 0.14, _TOP_HEIGHT + 0.01), CHARCOAL, "desk"),
    ]
    return parts


def chair(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return a swivel chair that faces +y: its back is at −y; without low objects an armchair down to the floor."""
    fabric = FABRICS[rng.integers(len(FABRICS))]
    if not low_objects:
        return [
            box("seat", (0.50, 0.54, SEEN_TO), (0.0, 0.0, SEEN_TO / 2.0), fabric, "chair"),
            box("back", (0.42, 0.07, 0.46), (0.0, -0.23, 0.73), fabric, "chair"),
        ]
    return [
        Part("base", Cylinder(0.26, 0.09), Pose3D((0.0, 0.0, 0.065)), CHARCOAL, "chair"),
        Part("stem", Cylinder(0.04, 0.32), Pose3D((0.0, 0.0, 0.27)), STEEL, "chair"),
        Part("seat", Cylinder(0.25, 0.08), Pose3D((0.0, 0.0, 0.47)), fabric, "chair"),
        box("back", (0.42, 0.07, 0.46), (0.0, -0.23, 0.76), fabric, "chair"),
    ]


def cabinet(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return a cabinet with two doors, or an open shelf with books; without low objects always with doors."""
    length, depth = CABINET_SIZE
    height = float(rng.choice((1.0, 1.3)))
    if rng.random() < 0.5 or not low_objects:
        parts = [box("body", (length, depth - 0.02, height), (0.0, -0.01, height / 2.0), _CABINET, "cabinet")]
        for side, x in (("left", -0.25), ("right", 0.25)):
            door = (length / 2.0 - 0.06, 0.02, height - 0.14)
            parts.append(box(f"door_{side}", door, (x * 0.88, depth / 2.0 - 0.01, height / 2.0), _FRAME, "cabinet"))
        return parts
    parts = [box("back", (length, 0.04, height), (0.0, -depth / 2.0 + 0.02, height / 2.0), WOOD, "cabinet")]
    for side, x in (("left", -1.0), ("right", 1.0)):
        centre = (x * (length / 2.0 - 0.02), 0.02, height / 2.0)
        parts.append(box(f"side_{side}", (0.04, depth - 0.04, height), centre, WOOD, "cabinet"))
    shelves = 3 if height < 1.2 else 4
    pitch = (height - 0.12) / (shelves - 1)
    for level in range(shelves):
        z = 0.10 + level * pitch
        parts.append(box(f"shelf_{level + 1}", (length - 0.08, depth - 0.04, 0.03), (0.0, 0.02, z), WOOD, "cabinet"))
        if level < shelves - 1:
            width, tall = float(rng.uniform(0.3, 0.76)), float(rng.uniform(0.5, 0.75)) * pitch
            x = -(length - 0.1 - width) / 2.0
            color = FABRICS[rng.integers(len(FABRICS))]
            parts.append(
                box(f"books_{level + 1}", (width, 0.26, tall), (x, 0.0, z + 0.015 + tall / 2.0), color, "books")
            )
    return parts


def table() -> list[Part]:
    """Return a meeting table on two pedestals."""
    length, depth = TABLE_SIZE
    parts = [box("top", (length, depth, 0.05), (0.0, 0.0, _TOP_HEIGHT - 0.025), _OAK, "table")]
    for side, x in (("west", -1.0), ("east", 1.0)):
        centre = (x * 0.34 * length, 0.0, (_TOP_HEIGHT - 0.05) / 2.0)
        parts.append(box(f"pedestal_{side}", (0.14, 0.56, _TOP_HEIGHT - 0.05), centre, CHARCOAL, "table"))
    return parts


def sofa(rng: np.random.Generator) -> list[Part]:
    """Return a sofa for two."""
    length, depth = SOFA_SIZE
    red, green, blue, _ = fabric = FABRICS[rng.integers(len(FABRICS))]
    light = (min(1.0, red + 0.08), min(1.0, green + 0.08), min(1.0, blue + 0.08), 1.0)
    parts = [
        box("base", (length, depth, 0.26), (0.0, 0.0, 0.17), fabric, "sofa"),
        box("back", (length, 0.20, 0.50), (0.0, -depth / 2.0 + 0.10, 0.55), fabric, "sofa"),
    ]
    for side, sign in (("left", -1.0), ("right", 1.0)):
        arm = (sign * (length / 2.0 - 0.09), 0.10, 0.43)
        parts.append(box(f"arm_{side}", (0.18, depth - 0.20, 0.26), arm, fabric, "sofa"))
        cushion = (sign * 0.355, 0.10, 0.36)
        parts.append(box(f"cushion_{side}", (0.69, depth - 0.24, 0.12), cushion, light, "sofa"))
    return parts


def plant(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return a potted plant; without low objects in a wider and taller pot."""
    radius, inner, height = (0.20, 0.17, 0.40) if low_objects else (0.28, 0.25, SEEN_TO)
    parts = [
        Part("pot", Cylinder(radius, height), Pose3D((0.0, 0.0, height / 2.0)), _POT, "plant"),
        Part("soil", Cylinder(inner, 0.02), Pose3D((0.0, 0.0, 0.41 if low_objects else height + 0.01)), _SOIL, "plant"),
    ]
    turn = float(rng.uniform(0.0, 2.0 * np.pi))
    for index, (reach, z, radius) in enumerate(((0.0, 1.05, 0.24), (0.13, 0.76, 0.20), (0.12, 0.82, 0.19))):
        angle = turn + index * np.pi
        pose = Pose3D((reach * float(np.cos(angle)), reach * float(np.sin(angle)), z))
        color = LEAVES[(index + int(rng.integers(len(LEAVES)))) % len(LEAVES)]
        parts.append(Part(f"leaves_{index + 1}", Sphere(radius), pose, color, "plant"))
    return parts


def whiteboard() -> list[Part]:
    """Return a board on a wall that is 4 cm behind its origin; it hangs 0.7 m above the floor."""
    return [
        box("board", (1.6, 0.03, 0.55), (0.0, -0.02, 1.0), (0.97, 0.97, 0.98, 1.0), "board"),
        box("tray", (1.2, 0.08, 0.03), (0.0, 0.01, 0.72), RUBBER, "board"),
    ]
