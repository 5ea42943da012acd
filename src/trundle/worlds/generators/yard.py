"""Outdoor objects made of boxes, cylinders and spheres: vans, containers, lamp posts, cones, trees.

The origin of each is on the ground, in its middle, x forward. Anything a low robot could touch is in its height band.
"""

from __future__ import annotations

import math

import numpy as np

from trundle.geometry import Pose3D
from trundle.geometry.solids import Color, Cylinder, Sphere
from trundle.worlds.generators.furniture import LEAVES
from trundle.worlds.generators.props import CHARCOAL, DARK_WOOD, RUBBER, STEEL, Part, box

VAN_SIZE = (5.0, 2.0)
"""Length and width [m]."""

CONTAINER_SIZE = (6.06, 2.44, 2.59)  # ISO 668, a 20-foot container [m]
CONE_RADIUS = 0.19

KERB: Color = (0.78, 0.78, 0.76, 1.0)
GRASS: Color = (0.40, 0.55, 0.30, 1.0)
_GLASS: Color = (0.13, 0.18, 0.22, 1.0)
_CONE: Color = (0.95, 0.42, 0.10, 1.0)
_WHITE: Color = (0.95, 0.95, 0.94, 1.0)
PAINTS: tuple[Color, ...] = (
    (0.93, 0.93, 0.92, 1.0),
    (0.22, 0.36, 0.56, 1.0),
    (0.68, 0.70, 0.72, 1.0),
    (0.62, 0.18, 0.16, 1.0),
    (0.24, 0.42, 0.36, 1.0),
    (0.90, 0.72, 0.22, 1.0),
)
_CONTAINERS: tuple[Color, ...] = (
    (0.60, 0.24, 0.17, 1.0),
    (0.16, 0.34, 0.50, 1.0),
    (0.20, 0.44, 0.37, 1.0),
    (0.80, 0.58, 0.20, 1.0),
)
_ALONG_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)


def van(rng: np.random.Generator, *, low_objects: bool = True) -> list[Part]:
    """Return a delivery van, or a car of the same length; without low objects its floor is lower."""
    length, width = VAN_SIZE
    paint, kind = PAINTS[rng.integers(len(PAINTS))], "vehicle"
    # The floor of the body is 0.25 m high: low enough for a robot's band, and so it is an obstacle in the map.
    parts = [box("sill", (length - 0.1, width - 0.06, 0.2), (0.0, 0.0, 0.35), CHARCOAL, kind)]
    if not low_objects:
        parts = [box("sill", (length, width + 0.05, 0.4), (0.0, 0.0, 0.25), CHARCOAL, kind)]
    if rng.random() < 0.55:
        parts += [
            box("cargo", (3.5, width, 1.65), (-0.75, 0.0, 1.275), paint, kind),
            box("cab", (0.85, width - 0.08, 1.25), (1.425, 0.0, 1.075), paint, kind),
            box("bonnet", (0.65, width - 0.1, 0.62), (2.175, 0.0, 0.76), paint, kind),
            box("windscreen", (0.06, width - 0.3, 0.5), (1.86, 0.0, 1.38), _GLASS, kind),
            box("windows", (0.55, width - 0.05, 0.42), (1.45, 0.0, 1.40), _GLASS, kind),
        ]
    else:
        parts += [
            box("body", (length - 0.3, width - 0.1, 0.45), (0.0, 0.0, 0.675), paint, kind),
            box("windows", (2.5, width - 0.28, 0.42), (-0.3, 0.0, 1.11), _GLASS, kind),
            box("roof", (2.2, width - 0.3, 0.07), (-0.35, 0.0, 1.355), paint, kind),
        ]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        lamp = (length / 2.0 - 0.14, sign * 0.68, 0.68)
        parts.append(box(f"lamp_{side}", (0.10, 0.3, 0.14), lamp, _WHITE, kind))
        for axle, x in (("front", 1.6), ("rear", -1.5)):
            tyre = Pose3D((x, sign * (width / 2.0 - 0.1), 0.34), _ALONG_Y)
            hub = Pose3D((x, sign * (width / 2.0 + 0.005), 0.34), _ALONG_Y)
            parts.append(Part(f"wheel_{axle}_{side}", Cylinder(0.34, 0.22), tyre, RUBBER, kind))
            parts.append(Part(f"hub_{axle}_{side}", Cylinder(0.17, 0.03), hub, STEEL, kind))
    return parts


def container(rng: np.random.Generator) -> list[Part]:
    """Return a 20-foot container with ribs along its sides and doors at its front."""
    length, width, height = CONTAINER_SIZE
    red, green, blue, _ = color = _CONTAINERS[rng.integers(len(_CONTAINERS))]
    dark = (0.75 * red, 0.75 * green, 0.75 * blue, 1.0)
    parts = [box("body", (length - 0.1, width - 0.1, height), (0.0, 0.0, height / 2.0), color, "container")]
    ribs = 11
    for side, sign in (("left", 1.0), ("right", -1.0)):
        for index in range(ribs):
            x = (index - (ribs - 1) / 2.0) * (length - 0.5) / (ribs - 1)
            centre = (x, sign * (width / 2.0 - 0.025), height / 2.0)
            parts.append(box(f"rib_{side}_{index + 1}", (0.2, 0.05, height - 0.3), centre, dark, "container"))
        door = (length / 2.0 - 0.025, sign * width / 4.0, height / 2.0)
        parts.append(box(f"door_{side}", (0.05, width / 2.0 - 0.14, height - 0.24), door, dark, "container"))
        bar = Pose3D((length / 2.0 + 0.015, sign * 0.28, height / 2.0))
        parts.append(Part(f"bar_{side}", Cylinder(0.02, height - 0.3), bar, STEEL, "container"))
    return parts


def lamp_post(height: float = 4.5) -> list[Part]:
    """Return a lamp post of a height [m] whose arm points along x."""
    return [
        Part("foot", Cylinder(0.16, 0.45), Pose3D((0.0, 0.0, 0.225)), CHARCOAL, "lamp"),
        Part("post", Cylinder(0.06, height - 0.45), Pose3D((0.0, 0.0, (height + 0.45) / 2.0)), STEEL, "lamp"),
        box("arm", (1.1, 0.08, 0.08), (0.5, 0.0, height), STEEL, "lamp"),
        box("light", (0.5, 0.22, 0.07), (0.85, 0.0, height - 0.07), (0.98, 0.95, 0.82, 1.0), "lamp"),
    ]


def cone(*, low_objects: bool = True) -> list[Part]:
    """Return a traffic cone on a base 11 cm high, so that it shows in a low robot's map; else a bollard."""
    if not low_objects:
        return [
            Part("post", Cylinder(0.16, 0.62), Pose3D((0.0, 0.0, 0.31)), _CONE, "cone"),
            Part("stripe", Cylinder(0.165, 0.10), Pose3D((0.0, 0.0, 0.54)), _WHITE, "cone"),
        ]
    return [
        box("foot", (0.26, 0.26, 0.11), (0.0, 0.0, 0.055), CHARCOAL, "cone"),
        Part("lower", Cylinder(0.12, 0.20), Pose3D((0.0, 0.0, 0.21)), _CONE, "cone"),
        Part("stripe", Cylinder(0.095, 0.14), Pose3D((0.0, 0.0, 0.38)), _WHITE, "cone"),
        Part("upper", Cylinder(0.07, 0.16), Pose3D((0.0, 0.0, 0.53)), _CONE, "cone"),
        Part("tip", Cylinder(0.045, 0.12), Pose3D((0.0, 0.0, 0.67)), _CONE, "cone"),
    ]


def tree(rng: np.random.Generator) -> list[Part]:
    """Return a small tree."""
    parts = [Part("trunk", Cylinder(0.12, 1.9), Pose3D((0.0, 0.0, 0.95)), DARK_WOOD, "tree")]
    crown = ((0.0, 0.0, 2.7, 0.85), (0.45, 0.2, 2.25, 0.6), (-0.35, 0.35, 2.3, 0.62), (-0.1, -0.45, 2.25, 0.6))
    turn = float(rng.uniform(0.0, 2.0 * math.pi))
    cos, sin = math.cos(turn), math.sin(turn)
    for index, (x, y, z, radius) in enumerate(crown):
        pose = Pose3D((cos * x - sin * y, sin * x + cos * y, z))
        color = LEAVES[int(rng.integers(len(LEAVES)))]
        parts.append(Part(f"leaves_{index + 1}", Sphere(radius), pose, color, "tree"))
    return parts
