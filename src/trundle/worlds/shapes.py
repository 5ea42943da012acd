"""Shapes of other formats, made of ours: capsules exactly, ellipsoids and cones as meshes; names that stay unique."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray, Pose3D
from trundle.solids import Color, Cylinder, Mesh, Shape, Solid, Sphere

SIDES = 48
"""Of round things that become meshes: a circle of 1 m radius is then off by at most 2.2 mm, inwards."""


class Names:
    """Gives out names that are unique: a second `table` becomes `table#2`."""

    def __init__(self) -> None:
        self._count: dict[str, int] = {}
        self._taken: set[str] = set()

    def take(self, name: str) -> str:
        """Take a name, or the first free one with a number behind it."""
        number = self._count.get(name, 0)
        while True:
            number += 1
            given = name if number == 1 else f"{name}#{number}"
            if given not in self._taken:
                self._count[name] = number
                self._taken.add(given)
                return given


class Part(NamedTuple):
    """One of the shapes that a thing of another format is made of.

    Attributes:
        shape: What it is.
        suffix: Of its name, behind that of the thing.
        pose: In the thing's frame.
        color: As the file says, or none.
    """

    shape: Shape
    suffix: str = ""
    pose: Pose3D = Pose3D()
    color: Color | None = None


def capsule_parts(radius: float, length: float) -> list[Part]:
    """A capsule along z, centred, whose straight part is `length` [m] long: a cylinder and two balls.

    Together they are exactly the capsule.
    """
    if length <= 0.0:
        return [Part(Sphere(radius))]
    ends = (("low", -length / 2.0), ("high", length / 2.0))
    balls = [Part(Sphere(radius), f":{end}", Pose3D((0.0, 0.0, z))) for end, z in ends]
    return [Part(Cylinder(radius, length)), *balls]


def ellipsoid_mesh(radii: tuple[float, float, float]) -> Mesh:
    """An ellipsoid of three radii [m] along the axes, as a closed mesh whose corners lie on it."""
    rings = SIDES // 2
    down = np.linspace(0.0, math.pi, rings + 1)[1:-1]
    ring = _circle()
    middle = np.concatenate([np.c_[math.sin(a) * ring, np.full(SIDES, math.cos(a))] for a in down])
    unit = np.vstack([[[0.0, 0.0, 1.0]], middle, [[0.0, 0.0, -1.0]]])
    bands = [_band(1 + band * SIDES, 1 + (band + 1) * SIDES) for band in range(rings - 2)]
    ends = [_fan(0, 1, up=True), _fan(len(unit) - 1, 1 + (rings - 2) * SIDES, up=False)]
    return Mesh(unit * np.asarray(radii), np.vstack([*bands, *ends]))


def cone_mesh(radius: float, length: float) -> Mesh:
    """A cone along z with its tip up, centred, as a closed mesh; `radius` of its base and full `length` [m]."""
    ring = np.c_[radius * _circle(), np.full(SIDES, -length / 2.0)]
    vertices = np.vstack([[[0.0, 0.0, length / 2.0]], ring, [[0.0, 0.0, -length / 2.0]]])
    return Mesh(vertices, np.vstack([_fan(0, 1, up=True), _fan(SIDES + 1, 1, up=False)]))


def height_field_mesh(heights: FloatArray, size: tuple[float, float], floor: float) -> Mesh:
    """A height field as a closed mesh: its surface, walls around it and a base.

    Args:
        heights: [m] above the field's frame at its points, shape (rows, cols), row 0 at the smallest y.
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
    """Solids of one named thing at a pose; `color` goes before the parts' own. The first has the plain name."""
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


def _circle() -> FloatArray:
    angles = np.arange(SIDES, dtype=np.int32) * (2.0 * math.pi / SIDES)
    return np.c_[np.cos(angles), np.sin(angles)]


def _fan(tip: int, first: int, *, up: bool) -> npt.NDArray[np.int32]:
    here = first + np.arange(SIDES, dtype=np.int32)
    following = first + (np.arange(SIDES, dtype=np.int32) + 1) % SIDES
    ends = (here, following) if up else (following, here)
    return np.c_[np.full(SIDES, tip, dtype=np.int32), ends[0], ends[1]]


def _band(upper: int, lower: int) -> npt.NDArray[np.int32]:
    here = np.arange(SIDES, dtype=np.int32)
    following = (here + 1) % SIDES
    a, b, c, d = upper + here, lower + here, lower + following, upper + following
    return np.vstack([np.c_[a, b, c], np.c_[a, c, d]])
