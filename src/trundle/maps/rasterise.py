"""Solids to cells: each shape as convex pieces or discs, cut to a height band, marked by the C++ raster."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle._core import raster_discs, raster_hexahedra, raster_hulls, raster_triangles
from trundle.geometry import FloatArray, Pose3D
from trundle.maps.cylinder import TOLERANCE, slice_cylinder
from trundle.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere

DEPTH = 1e-6
"""A solid must reach deeper than this into a cell [m]: float noise makes 20, 21 or 22 cells of a 1 m box otherwise."""

_TOUCH = -1e-9  # A surface has no depth: it counts in every cell that it touches.
_RUNS_AT_ONCE = 200_000
# Corners of a box by the bits of their index: x, y, z.
_CORNERS = np.array([[(i >> axis & 1) * 2 - 1 for axis in range(3)] for i in range(8)], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class HeightBand:
    """Heights [m] in which solids count; only what reaches deeper than `DEPTH` into it."""

    low: float
    high: float

    @property
    def inner_low(self) -> float:
        """Lowest height that counts [m]."""
        return self.low + DEPTH

    @property
    def inner_high(self) -> float:
        """Highest height that counts [m]."""
        return self.high - DEPTH


class SolidRaster:
    """Marks solids in a grid that is aligned with the axes.

    Args:
        cells: int8, shape (rows, cols), written to: 100 where there is a solid.
        resolution: Edge of a cell [m].
        origin: Lower-left corner (x, y) [m] of cell (0, 0).
        band: The heights that count.
        centre: Mark only cells whose centre is inside a solid.
    """

    def __init__(
        self,
        cells: npt.NDArray[np.int8],
        resolution: float,
        origin: tuple[float, float],
        band: HeightBand,
        *,
        centre: bool = False,
    ) -> None:
        self._cells = cells
        self._resolution = resolution
        self._shift = np.array([origin[0], origin[1], 0.0])
        self._band = band
        self._centre = centre

    def add(self, solids: Sequence[Solid]) -> None:
        """Mark solids of all kinds."""
        self._add_boxes([(solid.pose, solid.shape) for solid in solids if isinstance(solid.shape, Box)])
        discs: list[tuple[float, float, float]] = []
        for solid in solids:
            match solid.shape:
                case Cylinder() as shape:
                    self._add_cylinder(shape, solid.pose, discs)
                case Sphere(radius):
                    self._add_sphere(radius, solid.pose, discs)
                case Mesh() as shape:
                    self._add_mesh(shape, solid.pose)
                case OccupancyCells() as shape:
                    self._add_cells(shape, solid.pose)
                case Box():
                    pass
        if discs:
            centres = np.array(discs)
            centres[:, :2] -= self._shift[:2]
            raster_discs(self._cells, centres, self._resolution, DEPTH, self._centre)

    def _add_boxes(self, boxes: list[tuple[Pose3D, Box]]) -> None:
        if not boxes:
            return
        centres = np.array([pose.position for pose, _ in boxes])
        rotations = _rotations(np.array([pose.quaternion for pose, _ in boxes]))
        halves = np.array([box.size for _, box in boxes]) / 2.0
        corners = (_CORNERS * halves[:, None, :]) @ rotations.transpose(0, 2, 1) + centres[:, None, :]
        self._add_hexahedra(corners)

    def _add_hexahedra(self, corners: FloatArray) -> None:
        raster_hexahedra(
            self._cells,
            np.ascontiguousarray(corners - self._shift),
            self._band.inner_low,
            self._band.inner_high,
            self._resolution,
            DEPTH,
            self._centre,
        )

    def _add_cylinder(self, shape: Cylinder, pose: Pose3D, discs: list[tuple[float, float, float]]) -> None:
        axis = pose.rotation()[:, 2]
        x, y, z = pose.position
        if math.hypot(axis[0], axis[1]) * shape.length <= TOLERANCE:
            if z - shape.length / 2.0 < self._band.inner_high and z + shape.length / 2.0 > self._band.inner_low:
                discs.append((x, y, shape.radius))
            return
        points = slice_cylinder(shape, pose, self._band.inner_low, self._band.inner_high)
        self._add_hulls(points - self._shift[:2], np.array([0, len(points)]), DEPTH - TOLERANCE)

    def _add_sphere(self, radius: float, pose: Pose3D, discs: list[tuple[float, float, float]]) -> None:
        x, y, z = pose.position
        off = max(self._band.inner_low - z, z - self._band.inner_high, 0.0)
        if off < radius:
            discs.append((x, y, math.sqrt((radius - off) * (radius + off))))

    def _add_hulls(self, points: FloatArray, starts: npt.NDArray[np.int64], depth: float) -> None:
        raster_hulls(self._cells, np.ascontiguousarray(points), starts, self._resolution, depth, self._centre)

    def _add_mesh(self, mesh: Mesh, pose: Pose3D) -> None:
        vertices = pose.transform_points(mesh.vertices) - self._shift
        raster_triangles(
            self._cells,
            np.ascontiguousarray(vertices),
            mesh.faces,
            self._band.inner_low,
            self._band.inner_high,
            self._resolution,
            _TOUCH,
        )

    def _add_cells(self, shape: OccupancyCells, pose: Pose3D) -> None:
        rows, firsts, ends = _find_runs(shape.blocked)
        for start in range(0, len(rows), _RUNS_AT_ONCE):
            part = slice(start, start + _RUNS_AT_ONCE)
            low = np.stack([firsts[part], rows[part], np.zeros_like(rows[part])], axis=-1) * shape.resolution
            high = np.stack([ends[part], rows[part] + 1, np.zeros_like(rows[part])], axis=-1) * shape.resolution
            high[:, 2] = shape.height
            corners = np.where(_CORNERS > 0.0, high[:, None, :], low[:, None, :])
            self._add_hexahedra(pose.transform_points(corners.reshape(-1, 3)).reshape(-1, 8, 3))


def _rotations(quaternions: FloatArray) -> FloatArray:
    """Rotation matrices, shape (N, 3, 3), of unit quaternions (w, x, y, z), shape (N, 4)."""
    w, x, y, z = quaternions.T
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.moveaxis(np.array(rows), -1, 0)


def _find_runs(
    blocked: npt.NDArray[np.bool_],
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Row, first column and end column of each unbroken run of blocked cells."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, firsts = np.nonzero(edges == 1)
    _, ends = np.nonzero(edges == -1)
    return rows, firsts, ends
