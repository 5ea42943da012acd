"""`Mover`: solids that move together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trundle.errors import WorldError
from trundle.geometry import FloatArray, convex_hull
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.values import check_kind
from trundle.worlds.movers.motion import Motion

_AROUND = np.arange(16) * (2.0 * np.pi / 16.0)


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
    """The parts of something that moves.

    Raises:
        WorldError: If it has no name or no parts, or two parts of one name, or one that cannot move.
    """
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
    """The convex hull of solids seen from above [m], in their frame, counter-clockwise, shape (N, 2)."""
    return convex_hull(np.vstack([_corners(part) for part in parts]))


def radius_of(parts: tuple[Solid, ...]) -> float:
    """Radius [m] of the circle around their frame's origin that contains the solids, seen from above."""
    return float(np.hypot(*outline_of(parts).T).max())


def top_of(parts: tuple[Solid, ...]) -> float:
    """Height [m] of the highest of the solids."""
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
