"""Shapes of other formats converted to trundle's: capsules exactly, ellipsoids and height fields as meshes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Color, Cylinder, Mesh, Shape, Solid, Sphere
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
