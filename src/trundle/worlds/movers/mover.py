"""`Mover`: solids that move together, and the bodies of people and forklifts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trundle.errors import UnknownNameError, WorldError
from trundle.geometry import FloatArray, Pose3D, convex_hull
from trundle.geometry.solids import Box, Color, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.values import check_kind
from trundle.worlds.movers.motion import Motion

_AROUND = np.arange(16) * (2.0 * np.pi / 16.0)

PERSON_RADIUS, PERSON_HEIGHT = 0.3, 1.75  # [m]
FORK_LOW, FORK_HIGH = 0.14, 0.20  # of the forks above the floor [m]: below the lidars of many robots

_CLOTHES: Color = (0.95, 0.45, 0.10, 1.0)
_SKIN: Color = (0.78, 0.60, 0.46, 1.0)
_YELLOW: Color = (0.95, 0.74, 0.10, 1.0)
_DARK: Color = (0.16, 0.17, 0.19, 1.0)
_WOOD: Color = (0.70, 0.52, 0.32, 1.0)
_STEEL: Color = (0.42, 0.44, 0.47, 1.0)
_HEAD = 0.125  # radius [m]


@dataclass(frozen=True, slots=True)
class Mover:
    """An obstacle of one or more solids whose motion is a function of time.

    Attributes:
        name: Unique in its world; contacts are reported under it.
        parts: Its solids in its own frame: origin on the floor, x forward. Their names are unique in it.
        motion: Where its frame is at a time: `Waypoints`, `AlongPath`, or any `Motion`.
        kind: Everyday name of the object ("person", "forklift", …).
        may_cross: Whether it may leave the world and pass through solids; simulators warn of it otherwise.

    Raises:
        WorldError: If it has no name or no parts, or two parts of one name, or one that cannot move.
    """

    name: str
    parts: tuple[Solid, ...]
    motion: Motion
    kind: str = ""
    may_cross: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "parts", check_parts(self.name, self.parts))
        check_kind(self.motion, Motion, f"the motion of the mover {self.name!r}", "Waypoints and AlongPath are motions")


def check_parts(name: str, parts: tuple[Solid, ...]) -> tuple[Solid, ...]:
    """Return the parts of something that moves as a tuple, or raise `WorldError` as `Mover` does."""
    if not name:
        raise WorldError("a mover needs a name")
    parts = tuple(parts)
    if not parts:
        raise WorldError(f"the mover {name!r} needs at least one solid")
    if len({part.name for part in parts}) < len(parts):
        raise WorldError(f"the mover {name!r} has two parts of one name")
    for part in parts:
        if isinstance(part.shape, OccupancyCells):
            raise WorldError(f"the part {part.name!r} of the mover {name!r} is the cells of a map, which cannot move")
    return parts


def outline_of(parts: tuple[Solid, ...]) -> FloatArray:
    """Return the convex hull of solids seen from above [m], in their frame, counter-clockwise, shape (N, 2)."""
    return convex_hull(np.vstack([_corners(part) for part in parts]))


def radius_of(parts: tuple[Solid, ...]) -> float:
    """Return the radius [m] of the circle around their frame's origin that contains the solids, seen from above."""
    return float(np.hypot(*outline_of(parts).T).max())


def top_of(parts: tuple[Solid, ...]) -> float:
    """Return the height [m] of the highest of the solids."""
    return max(float(part.bounds()[1][2]) for part in parts)


def _corners(solid: Solid) -> FloatArray:
    match solid.shape:
        case Box(size):
            signs = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)]) - 0.5
            points = signs * np.asarray(size)
        case Cylinder(radius, length):
            ring = np.c_[radius * np.cos(_AROUND), radius * np.sin(_AROUND)]
            points = np.vstack([np.c_[ring, np.full(16, end * length / 2.0)] for end in (-1.0, 1.0)])
        case Sphere(radius):
            points = np.c_[radius * np.cos(_AROUND), radius * np.sin(_AROUND), np.zeros(16)]
            return points[:, :2] + np.asarray(solid.pose.position)[:2]
        case Mesh(vertices, _):
            points = vertices
        case _:
            raise WorldError(f"the cells of a map cannot move: {solid.name!r}")
    return solid.pose.transform_points(points)[:, :2]


def person_body(*, radius: float = PERSON_RADIUS, height: float = PERSON_HEIGHT) -> tuple[Solid, ...]:
    """Return a person: a cylinder with a head.

    Args:
        radius: Radius of the cylinder [m].
        height: Height of the top of the head [m]; 0.5 or more.
    """
    shoulders = height - 2.0 * _HEAD
    return (
        Solid("body", Cylinder(radius, shoulders), Pose3D((0.0, 0.0, shoulders / 2.0)), _CLOTHES, "person"),
        Solid("head", Sphere(_HEAD), Pose3D((0.0, 0.0, height - _HEAD)), _SKIN, "person"),
    )


def forklift_body(*, loaded: bool = False) -> tuple[Solid, ...]:
    """Return a compact forklift, 2.0 m long with its forks and 0.9 m wide, its origin in the middle.

    The forks are from 0.14 to 0.20 m above the floor, and reach 0.8 m beyond what is higher.

    Args:
        loaded: Whether it carries a crate that covers the forks, from just above the floor to a height of 1.1 m.
    """
    fork = (FORK_LOW + FORK_HIGH) / 2.0
    thick = FORK_HIGH - FORK_LOW
    crate = (_box("crate", (0.80, 0.80, 1.05), (0.60, 0.0, 0.575), _WOOD),) if loaded else ()
    return (
        *crate,
        _box("body", (1.08, 0.90, 1.00), (-0.46, 0.0, 0.56), _YELLOW),
        _box("mast", (0.12, 0.80, 1.90), (0.14, 0.0, 1.05), _STEEL),
        _box("roof", (1.00, 0.86, 0.06), (-0.46, 0.0, 2.05), _DARK),
        _box("post_left", (0.06, 0.06, 0.96), (-0.90, 0.38, 1.54), _DARK),
        _box("post_right", (0.06, 0.06, 0.96), (-0.90, -0.38, 1.54), _DARK),
        _box("fork_left", (0.80, 0.12, thick), (0.60, 0.25, fork), _STEEL),
        _box("fork_right", (0.80, 0.12, thick), (0.60, -0.25, fork), _STEEL),
    )


def _box(name: str, size: tuple[float, float, float], at: tuple[float, float, float], color: Color) -> Solid:
    return Solid(name, Box(size), Pose3D(at), color, "forklift")


BODIES: dict[str, Callable[[], tuple[Solid, ...]]] = {"forklift": forklift_body, "person": person_body}


def body_named(name: str) -> tuple[Solid, ...]:
    """Return the solids of a body by name: "person" or "forklift".

    Raises:
        UnknownNameError: If there is none of that name.
    """
    if name not in BODIES:
        raise UnknownNameError("body of a mover", name, list(BODIES))
    return BODIES[name]()
