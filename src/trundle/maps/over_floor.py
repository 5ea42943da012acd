"""Solids to cells over an uneven floor: the height band follows a `HeightField`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import floor_planes, raster_mesh_over_floor, raster_thin_faces_over_floor
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.height_field import HeightField
from trundle.maps.rasterise import BOX_FACES, CORNERS, HeightBand, mark_pending, run_corners

ROUND = 1e-4
"""Largest excess of cylinders and spheres, as a fraction of their radius and in metres; they are never too small."""

_CELLS_AT_ONCE = 1_000_000  # whose planes take 48 MB


@dataclass(frozen=True, slots=True)
class _Part:
    """Triangles and their pose; the name, if they are one solid's mesh."""

    vertices: FloatArray
    faces: npt.NDArray[np.int32]
    pose: Pose3D
    y_range: tuple[float, float]
    name: str = ""

    def transform(self, corner: tuple[float, float]) -> FloatArray:
        """Return the transform from its own frame to that of a block of cells, shape (3, 4)."""
        place = np.asarray(self.pose.position) - (*corner, 0.0)
        return np.ascontiguousarray(np.column_stack([self.pose.rotation(), place]))


@dataclass(frozen=True, slots=True)
class FloorMarks:
    """Results of `mark_over_floor` besides the marked obstacles.

    Attributes:
        no_floor: Cells where the floor is unknown, bool, shape (rows, cols).
        steep: Cells where it is steeper than the limit, bool, shape (rows, cols).
        open_meshes: Names of the meshes in the band that are not closed; only their surface is marked.
    """

    no_floor: npt.NDArray[np.bool_]
    steep: npt.NDArray[np.bool_]
    open_meshes: list[str]


def mark_over_floor(
    cells: npt.NDArray[np.int8],
    solids: Sequence[Solid],
    floor: HeightField,
    *,
    resolution: float,
    origin: tuple[float, float],
    band: HeightBand,
    max_slope: float,
    centre: bool = False,
) -> FloorMarks:
    """Mark obstacles in a band above a floor, and where the floor is too steep; see `OccupancyGrid.from_world`.

    Args:
        cells: int8, shape (rows, cols), written to: 100 where there is a solid or a slope, −1 where there is no floor.
        solids: The world's solids.
        floor: The floor.
        resolution: Edge of a cell [m].
        origin: Lower-left corner (x, y) [m] of cell (0, 0).
        band: The range of heights above the floor.
        max_slope: The steepest drivable floor [rad].
        centre: Mark only cells whose centre is inside a solid.
    """
    parts = _triangulate(solids)
    rows, cols = cells.shape
    no_floor, steep = np.zeros(cells.shape, dtype=np.bool_), np.zeros(cells.shape, dtype=np.bool_)
    opened: set[str] = set()
    step = max(1, _CELLS_AT_ONCE // cols)
    for begin in range(0, rows, step):
        # One row more on each side: faces between two blocks are seen from both.
        first, end = max(0, begin - 1), min(rows, begin + step + 1)
        corner = (origin[0], origin[1] + first * resolution)
        planes = floor_planes(
            floor.heights,
            floor.resolution / resolution,
            (floor.origin[0] - corner[0]) / resolution,
            (floor.origin[1] - corner[1]) / resolution,
            resolution,
            end - first,
            cols,
        )
        no_floor[first:end] = np.isnan(planes[:, :, 0])
        # A slope right at the limit is allowed, whatever the last digit of its tangent.
        steep[first:end] = planes[:, :, 5] > math.tan(max_slope) * (1.0 + 1e-9) + 1e-12
        low, high = corner[1] - resolution, corner[1] + (end - first + 1) * resolution
        near = [part for part in parts if part.y_range[0] <= high and part.y_range[1] >= low]
        opened |= _mark_block(cells[first:end], near, planes, resolution, corner, band, centre=centre)
    cells[steep] = OCCUPIED
    cells[no_floor] = UNKNOWN
    return FloorMarks(no_floor, steep, [part.name for part in parts if part.name in opened])


def _mark_block(
    cells: npt.NDArray[np.int8],
    parts: Sequence[_Part],
    planes: FloatArray,
    resolution: float,
    corner: tuple[float, float],
    band: HeightBand,
    *,
    centre: bool,
) -> set[str]:
    """Mark parts in a block of rows; return the names of the meshes that are not closed."""
    numbers = (band.inner_low, band.inner_high, resolution, band.depth)
    opened: set[str] = set()
    thin: list[tuple[_Part, npt.NDArray[np.int32]]] = []
    for part in parts:
        closed, there, between = raster_mesh_over_floor(
            cells, planes, part.vertices, part.faces, part.transform(corner), *numbers, centre
        )
        if there and not closed:
            opened.add(part.name)
        if len(between):
            thin.append((part, part.faces[between]))
    for part, faces in thin:
        raster_thin_faces_over_floor(cells, planes, part.vertices, faces, part.transform(corner), *numbers)
    mark_pending(cells)
    return opened


def _triangulate(solids: Sequence[Solid]) -> list[_Part]:
    """Return the meshes, and all other solids as one."""
    parts: list[_Part] = []
    plain: list[tuple[FloatArray, npt.NDArray[np.int32]]] = []
    for solid in solids:
        if isinstance(solid.shape, Mesh):
            low, high = solid.bounds()
            mesh = solid.shape
            parts.append(_Part(mesh.vertices, mesh.faces, solid.pose, (float(low[1]), float(high[1])), solid.name))
        else:
            points, faces = _surface(solid.shape)
            plain.append((solid.pose.transform_points(points), faces))
    plain = [part for part in plain if len(part[0])]
    if plain:
        starts = np.cumsum([0, *(len(points) for points, _ in plain[:-1])])
        faces = np.concatenate([faces + start for (_, faces), start in zip(plain, starts, strict=True)])
        points = np.concatenate([points for points, _ in plain])
        y_range = float(points[:, 1].min()), float(points[:, 1].max())
        parts.append(_Part(points, faces.astype(np.int32), Pose3D(), y_range))
    return parts


def _surface(shape: Box | Cylinder | Sphere | OccupancyCells) -> tuple[FloatArray, npt.NDArray[np.int32]]:
    """Return vertices [m] and faces that enclose a shape."""
    match shape:
        case Box(size):
            return CORNERS * (np.asarray(size) / 2.0), BOX_FACES
        case Cylinder(radius, length):
            return _cylinder(radius, length)
        case Sphere(radius):
            return _sphere(radius)
        case OccupancyCells():
            points = np.concatenate([np.empty((0, 8, 3)), *run_corners(shape)]).reshape(-1, 3)
            offsets = np.arange(0, len(points), 8, dtype=np.int32)
            return points, (BOX_FACES[None] + offsets[:, None, None]).reshape(-1, 3)


def _cylinder(radius: float, length: float) -> tuple[FloatArray, npt.NDArray[np.int32]]:
    half = length / 2.0
    sides = _sides(radius, 1.0)
    wide = radius / math.cos(math.pi / sides)
    return _revolve(np.array([[0.0, -half], [wide, -half], [wide, half], [0.0, half]]), sides)


def _sphere(radius: float) -> tuple[FloatArray, npt.NDArray[np.int32]]:
    sides = _sides(radius, 0.5)
    rings = sides // 2
    # The profile is half a circle around the sphere, rotated in polygons around the circle.
    angles = (np.arange(rings) + 0.5) * (math.pi / rings) - math.pi / 2.0
    wide = radius / math.cos(math.pi / rings / 2.0)
    inner = np.column_stack([np.cos(angles) * wide / math.cos(math.pi / sides), np.sin(angles) * wide])
    return _revolve(np.vstack([[0.0, inner[0, 1]], inner, [0.0, inner[-1, 1]]]), sides)


def _sides(radius: float, share: float) -> int:
    """Return the number of sides, even, of a polygon around a circle that exceeds it by at most `share` of `ROUND`."""
    return 2 * math.ceil(math.pi / 2.0 / math.acos(1.0 / (1.0 + share * ROUND * max(1.0, 1.0 / radius))))


def _revolve(profile: FloatArray, sides: int) -> tuple[FloatArray, npt.NDArray[np.int32]]:
    """Return a surface of revolution: a profile (distance from the z axis, z), upwards, with both ends on the axis."""
    angles = np.arange(sides) * (2.0 * math.pi / sides)
    rings = profile[1:-1]
    vertices = np.column_stack(
        [
            np.outer(rings[:, 0], np.cos(angles)).ravel(),
            np.outer(rings[:, 0], np.sin(angles)).ravel(),
            np.repeat(rings[:, 1], sides),
        ]
    )
    here = np.arange(sides)
    following = np.roll(here, -1)
    below = (np.arange(len(rings) - 1) * sides)[:, None]
    low, low_next, high, high_next = (
        (below + index).ravel() for index in (here, following, here + sides, following + sides)
    )
    bottom, top, last = len(vertices), len(vertices) + 1, (len(rings) - 1) * sides
    faces = np.vstack(
        [
            np.column_stack([low, low_next, high_next]),
            np.column_stack([low, high_next, high]),
            np.column_stack([np.full(sides, bottom), following, here]),
            np.column_stack([np.full(sides, top), here + last, following + last]),
        ]
    )
    return np.vstack([vertices, [[0.0, 0.0, profile[0, 1]], [0.0, 0.0, profile[-1, 1]]]]), faces.astype(np.int32)
