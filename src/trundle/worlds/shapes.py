"""Shapes of other formats converted to trundle's, and level planes: which one is the ground, and the others."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Color, Cylinder, Mesh, Shape, Solid, Sphere, solids_bounds
from trundle.worlds.tessellate import sphere_mesh


class Names:
    """Makes names unique: a second `table` becomes `table#2`."""

    def __init__(self) -> None:
        self._count: dict[str, int] = {}
        self._taken: set[str] = set()

    def take(self, name: str) -> str:
        """Return the name if it is free, else with the first free number appended."""
        number = self._count.get(name, 0)
        while True:
            number += 1
            given = name if number == 1 else f"{name}#{number}"
            if given not in self._taken:
                self._count[name] = number
                self._taken.add(given)
                return given


class Part(NamedTuple):
    """One of the shapes that make up an object of another format.

    Attributes:
        shape: Its shape.
        suffix: Appended to the object's name.
        pose: Pose in the object's frame.
        color: Colour from the file, or None.
    """

    shape: Shape
    suffix: str = ""
    pose: Pose3D = Pose3D()
    color: Color | None = None


def capsule_parts(radius: float, length: float) -> list[Part]:
    """Return a capsule along z, centred, whose straight part is `length` [m] long: a cylinder and two spheres.

    Together they form the exact capsule.
    """
    if length <= 0.0:
        return [Part(Sphere(radius))]
    ends = (("low", -length / 2.0), ("high", length / 2.0))
    balls = [Part(Sphere(radius), f":{end}", Pose3D((0.0, 0.0, z))) for end, z in ends]
    return [Part(Cylinder(radius, length)), *balls]


def ellipsoid_mesh(radii: tuple[float, float, float]) -> Mesh:
    """Return an ellipsoid of three radii [m] as a closed mesh that encloses it and is at most 0.5 % larger."""
    ball = sphere_mesh(1.0)
    return Mesh(ball.vertices * np.asarray(radii), ball.faces)


def height_field_mesh(heights: FloatArray, size: tuple[float, float], floor: float) -> Mesh:
    """Return a height field as a closed mesh: its surface, walls around it and a base.

    Args:
        heights: Heights [m] above the field's frame at its points, shape (rows, cols), row 0 at the smallest y.
        size: Half extents along x and y [m].
        floor: Height of the base [m], below all of `heights`.
    """
    rows, cols = heights.shape
    x, y = np.meshgrid(np.linspace(-size[0], size[0], cols), np.linspace(-size[1], size[1], rows))
    top = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    bottom = top.copy()
    bottom[:, 2] = floor
    index = np.arange(rows * cols, dtype=np.int32).reshape(rows, cols)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    surface = np.vstack([np.c_[a, b, c], np.c_[a, c, d]])
    under = surface[:, ::-1] + len(top)
    rim = np.concatenate([index[0, :-1], index[:-1, -1], index[-1, :0:-1], index[:0:-1, 0]])
    following = np.roll(rim, -1)
    walls = np.vstack([np.c_[rim, rim + len(top), following], np.c_[following, rim + len(top), following + len(top)]])
    return Mesh(np.vstack([top, bottom]), np.vstack([surface, under, walls]))


def make_solids(
    names: Names, name: str, parts: Iterable[Part], pose: Pose3D, *, color: Color | None, kind: str
) -> list[Solid]:
    """Make the solids of one named object at a pose; `color` overrides the parts' own. The first has the plain name."""
    solids: list[Solid] = []
    for part in parts:
        shade = color or part.color
        given = names.take(name + part.suffix)
        placed = pose @ part.pose
        solids.append(
            Solid(given, part.shape, placed, kind=kind)
            if shade is None
            else Solid(given, part.shape, placed, shade, kind)
        )
    return solids


LARGE = 10.0
"""Minimum area [m²] of a floor: a smaller level surface may be a table top, a pallet or a landing."""

NEAR_ZERO = 0.01
"""A plane this near to z = 0 [m] is the ground whatever its size; surfaces this little above it belong to it."""

ENDLESS = math.inf
"""Area of a plane that collides: in physics it is infinite, whatever size it is drawn with."""


class LevelPlane(NamedTuple):
    """A level plane that faces up.

    Attributes:
        height: Height of the plane [m].
        area: Area of the plane [m²]; `ENDLESS` for one that collides.
    """

    height: float
    area: float


def is_level(normal_z: float) -> bool:
    """Return whether a plane whose unit normal has this third component is level and faces up."""
    return normal_z > 1.0 - 1e-9


def find_ground(planes: Iterable[LevelPlane], solids: Sequence[Solid]) -> float | None:
    """Return the height [m] of the ground that a file declares, or None.

    It is the highest plane at or below z = 0, which hides the others. Without one it is the lowest large plane above
    z = 0, unless a solid ends below that: then the plane is a deck or a roof.
    """
    wide = sorted(plane.height for plane in planes if plane.area >= LARGE or abs(plane.height) <= NEAR_ZERO)
    low = [height for height in wide if height <= NEAR_ZERO]
    if low:
        return low[-1]
    if not wide:
        return None
    ends_below = len(solids) > 0 and bool((solids_bounds(solids)[1][:, 2] <= wide[0] + NEAR_ZERO).any())
    return None if ends_below else wide[0]


def is_ground(plane: LevelPlane, ground: float | None) -> bool:
    """Return whether a plane is the ground or hidden by it, and so makes no rectangle."""
    return ground is not None and plane.height <= ground + NEAR_ZERO


@dataclass(slots=True)
class LevelPlanes:
    """Level planes of a file, kept until all solids are known, which determine the ground."""

    _put_aside: list[tuple[LevelPlane, str, Sequence[Part], Pose3D, Color | None]] = field(
        default_factory=list[tuple[LevelPlane, str, Sequence[Part], Pose3D, Color | None]]
    )

    def take(self, name: str, parts: Sequence[Part], pose: Pose3D, area: float, color: Color | None) -> bool:
        """Keep a plane for later if it is level and faces up; return whether it was kept.

        Args:
            name: Name of its solid, if it is not the ground.
            parts: Its rectangle; empty for a plane without a size.
            pose: Pose of its parts' frame, whose z is the normal.
            area: Area of the plane [m²].
            color: Colour of the solid.
        """
        if not is_level(float(pose.rotation()[2, 2])):
            return False
        self._put_aside.append((LevelPlane(pose.position[2], area), name, parts, pose, color))
        return True

    def settle(self, solids: Sequence[Solid], names: Names) -> tuple[float | None, list[Solid], list[str]]:
        """Return the ground's height [m] or None, rectangles of the other planes, and names of those without a size."""
        ground = find_ground((plane for plane, *_ in self._put_aside), solids)
        rectangles: list[Solid] = []
        endless: list[str] = []
        for plane, name, parts, pose, color in self._put_aside:
            if is_ground(plane, ground):
                continue
            endless += [] if parts else [name]
            rectangles += make_solids(names, name, parts, pose, color=color, kind="model")
        return ground, rectangles, endless
