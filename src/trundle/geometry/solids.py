"""Solid shapes with a pose and a colour, from which worlds, maps and collision models are built."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Self, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose3D, rotation_matrices
from trundle.values import as_array, is_finite_number, show_value

Color: TypeAlias = tuple[float, float, float, float]
"""Red, green, blue and opacity, each 0 to 1."""

_VERTICES_AT_ONCE = 1 << 14  # Few enough to stay in the processor's cache.


def _check_positive(what: str, *values: float) -> None:
    for value in values:
        if not (is_finite_number(value) and value > 0.0):
            raise WorldError(f"{what} must be a positive number of metres, got {show_value(value)}")


@dataclass(frozen=True, slots=True)
class Box:
    """A box, centred on its pose. `size` is its full extent (x, y, z) [m]."""

    size: tuple[float, float, float]

    def __post_init__(self) -> None:
        _check_positive("a box's size", *self.size)


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder along its pose's z axis, centred on it. `radius` and full `length` [m]."""

    radius: float
    length: float

    def __post_init__(self) -> None:
        _check_positive("a cylinder's radius and length", self.radius, self.length)


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere of `radius` [m], centred on its pose."""

    radius: float

    def __post_init__(self) -> None:
        _check_positive("a sphere's radius", self.radius)


@dataclass(frozen=True, slots=True)
class Mesh:
    """A triangle mesh in its pose's frame.

    Attributes:
        vertices: [m], shape (V, 3), read-only.
        faces: Indices into `vertices`, counter-clockwise seen from outside, shape (F, 3), read-only.
    """

    vertices: FloatArray
    faces: npt.NDArray[np.int32]

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} faces)"

    def __post_init__(self) -> None:
        vertices = as_array(self.vertices, np.float64, "the vertices of a mesh", WorldError)
        faces = as_array(self.faces, np.int32, "the faces of a mesh", WorldError)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise WorldError(f"a mesh needs finite vertices of shape (V, 3), got {vertices.shape}")
        if faces.ndim != 2 or faces.shape[1] != 3 or len(faces) == 0:
            raise WorldError(f"a mesh needs faces of shape (F, 3) with F ≥ 1, got {faces.shape}")
        if faces.min() < 0 or faces.max() >= len(vertices):
            raise WorldError(f"a mesh's faces name vertices outside 0..{len(vertices) - 1}")
        vertices.flags.writeable = False
        faces.flags.writeable = False
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)


@dataclass(frozen=True, slots=True)
class OccupancyCells:
    """Blocked cells of a grid as walls of equal height: the solid form of a large map.

    The shape uses the grid's frame: its origin is the lower-left corner of cell (0, 0), x along the columns, y along
    the rows, z up from the floor.

    Attributes:
        blocked: Which cells are solid, bool, shape (rows, cols), read-only; row 0 at the bottom.
        resolution: Edge of a cell [m].
        height: Height of the walls [m].
    """

    blocked: npt.NDArray[np.bool_]
    resolution: float
    height: float

    def __repr__(self) -> str:
        rows, cols = self.blocked.shape
        return f"OccupancyCells({cols} x {rows} cells of {self.resolution:g} m, {self.height:g} m high)"

    def __post_init__(self) -> None:
        blocked = as_array(self.blocked, np.bool_, "blocked cells", WorldError)
        if blocked.ndim != 2 or blocked.size == 0:
            raise WorldError(f"blocked cells need shape (rows, cols), got {blocked.shape}")
        _check_positive("the resolution and height of blocked cells", self.resolution, self.height)
        blocked.flags.writeable = False
        object.__setattr__(self, "blocked", blocked)


Shape: TypeAlias = Box | Cylinder | Sphere | Mesh | OccupancyCells
"""The shapes that a `Solid` can have."""


@dataclass(frozen=True, slots=True)
class Solid:
    """A named shape at a pose in the world.

    Attributes:
        name: Unique in its world; contacts are reported under it.
        shape: Its geometry.
        pose: Its pose in the map frame.
        color: Red, green, blue, alpha, each 0..1.
        kind: Everyday name of the object ("wall", "rack", "pallet", …), for pictures and filters.
    """

    name: str
    shape: Shape
    pose: Pose3D = Pose3D()
    color: Color = (0.6, 0.6, 0.62, 1.0)
    kind: str = ""

    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Return axis-aligned bounds (low, high) [m] in the map frame, each of shape (3,)."""
        centre = np.asarray(self.pose.position)
        rotation = self.pose.rotation()
        match self.shape:
            case Box(size):
                reach = np.abs(rotation) @ (np.asarray(size) / 2.0)
            case Cylinder(radius, length):
                axis = rotation[:, 2]
                reach = np.abs(axis) * length / 2.0 + radius * np.sqrt(np.maximum(0.0, 1.0 - axis**2))
            case Sphere(radius):
                reach = np.full(3, radius)
            case Mesh(vertices, _):
                low, high = np.full(3, np.inf), np.full(3, -np.inf)
                for start in range(0, len(vertices), _VERTICES_AT_ONCE):
                    turned = rotation @ vertices[start : start + _VERTICES_AT_ONCE].T
                    low, high = np.minimum(low, turned.min(axis=1)), np.maximum(high, turned.max(axis=1))
                return centre + low, centre + high
            case OccupancyCells(blocked, resolution, height):
                rows, cols = blocked.shape
                extent = np.array([cols * resolution, rows * resolution, height])
                corners = np.array(np.meshgrid(*[(0.0, edge) for edge in extent])).reshape(3, -1).T
                points = self.pose.transform_points(corners)
                return points.min(axis=0), points.max(axis=0)
        return centre - reach, centre + reach


@dataclass(frozen=True, slots=True)
class SolidArrays:
    """Poses and sizes of N solids of one kind, for vectorised work.

    Attributes:
        positions: [m], shape (N, 3).
        rotations: Rotation matrices, shape (N, 3, 3).
        sizes: The dimensions of a box, a cylinder or a sphere in field order [m], shape (N, 3), (N, 2) or (N, 1);
            empty, (N, 0), for other shapes.
    """

    positions: FloatArray
    rotations: FloatArray
    sizes: FloatArray

    @classmethod
    def of(cls, solids: Sequence[Solid]) -> Self:
        """Gather solids of one kind."""
        numbers = [_numbers(solid.shape) for solid in solids]
        return cls(
            _table([solid.pose.position for solid in solids], 3),
            rotation_matrices(_table([solid.pose.quaternion for solid in solids], 4)),
            _table(numbers, len(numbers[0]) if numbers else 0),
        )


def _numbers(shape: Shape) -> tuple[float, ...]:
    match shape:
        case Box():
            return shape.size
        case Cylinder():
            return (shape.radius, shape.length)
        case Sphere():
            return (shape.radius,)
        case _:
            return ()


def _table(rows: Sequence[Sequence[float]], width: int) -> FloatArray:
    return np.fromiter(chain.from_iterable(rows), dtype=np.float64, count=len(rows) * width).reshape(len(rows), width)


def solids_bounds(solids: Sequence[Solid]) -> tuple[FloatArray, FloatArray]:
    """Return axis-aligned bounds (low, high) [m] of each solid, each of shape (N, 3)."""
    lows, highs = np.empty((len(solids), 3)), np.empty((len(solids), 3))
    plain: dict[type[Shape], list[int]] = {Box: [], Cylinder: [], Sphere: []}
    for index, solid in enumerate(solids):
        if type(solid.shape) in plain:
            plain[type(solid.shape)].append(index)
        else:
            lows[index], highs[index] = solid.bounds()
    for kind, indices in plain.items():
        if not indices:
            continue
        arrays = SolidArrays.of([solids[index] for index in indices])
        if kind is Box:
            reach = (np.abs(arrays.rotations) @ (arrays.sizes / 2.0)[:, :, None])[:, :, 0]
        elif kind is Cylinder:
            axis = arrays.rotations[:, :, 2]
            rim = np.sqrt(np.maximum(0.0, 1.0 - axis**2))
            reach = np.abs(axis) * arrays.sizes[:, 1:] / 2.0 + arrays.sizes[:, :1] * rim
        else:
            reach = np.broadcast_to(arrays.sizes, (len(indices), 3))
        lows[indices], highs[indices] = arrays.positions - reach, arrays.positions + reach
    return lows, highs
