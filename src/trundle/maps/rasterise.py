"""Solids to cells: each shape as convex pieces, discs or triangles, cut to a height band, marked by the C++ raster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from trundle._core import raster_cylinders, raster_discs, raster_hexahedra, raster_mesh, raster_thin_faces
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, SolidArrays, Sphere

DEPTH = 1e-6
"""A solid must reach deeper than this into a cell [m]: otherwise rounding makes a 1 m box 20, 21 or 22 cells wide."""

TOUCH = -1e-9
"""The same as a negative depth: a solid this near to a cell [m] counts as touching it."""

_OCCUPIED = 100
_PENDING = 99  # Touched by a face without thickness; see raster_thin_faces.
_UPRIGHT = 2e-7  # A cylinder whose ends lie no further apart than this [m], seen from above, is a disc.
_RUNS_AT_ONCE = 200_000  # whose corners take 38 MB
CORNERS = np.array([[(i >> axis & 1) * 2 - 1 for axis in range(3)] for i in range(8)], dtype=np.float64)
"""Corners of a box of 2 m by the bits of their index: x, y, z."""

BOX_FACES = np.array(
    [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ],
    dtype=np.int32,
)  # fmt: skip
"""Faces of a box with these corners, outwards."""


@dataclass(frozen=True, slots=True)
class HeightBand:
    """The height range [m] in which solids are marked, and how deep [m] they must reach into it and into a cell."""

    low: float
    high: float
    depth: float = DEPTH

    @property
    def inner_low(self) -> float:
        """Lowest height of the band [m]."""
        return self.low + self.depth

    @property
    def inner_high(self) -> float:
        """Highest height of the band [m]."""
        return self.high - self.depth


@dataclass(slots=True)
class SolidRaster:
    """Marks solids in a grid that is aligned with the axes.

    Attributes:
        cells: int8, shape (rows, cols), written to: 100 where there is a solid.
        resolution: Edge of a cell [m].
        origin: Lower-left corner (x, y) [m] of cell (0, 0).
        band: The height range.
        centre: Mark only cells whose centre is inside a solid.
        fill: Mark the interior of closed meshes; else only their surface, as for open ones.
        open_meshes: Names of the meshes that reach into the band and are not closed; only their surface is marked.
    """

    cells: npt.NDArray[np.int8]
    resolution: float
    origin: tuple[float, float]
    band: HeightBand
    centre: bool = False
    fill: bool = True
    open_meshes: list[str] = field(default_factory=list)

    def add(self, solids: Sequence[Solid]) -> None:
        """Mark solids of all kinds; their order does not matter."""
        boxes: list[Solid] = []
        cylinders: list[Solid] = []
        spheres: list[Solid] = []
        meshes: list[tuple[Solid, Mesh]] = []
        for solid in solids:
            match solid.shape:
                case Box():
                    boxes.append(solid)
                case Cylinder():
                    cylinders.append(solid)
                case Sphere():
                    spheres.append(solid)
                case Mesh():
                    meshes.append((solid, solid.shape))
                case OccupancyCells():
                    self._add_cells(solid.shape, solid.pose)
        if boxes:
            self._add_boxes(SolidArrays.of(boxes))
        if cylinders:
            self._add_cylinders(SolidArrays.of(cylinders))
        if spheres:
            self._add_spheres(SolidArrays.of(spheres))
        if meshes:
            self._add_meshes(meshes)

    @property
    def _shift(self) -> FloatArray:
        return np.array([self.origin[0], self.origin[1], 0.0])

    def _add_boxes(self, boxes: SolidArrays) -> None:
        corners = (CORNERS * (boxes.sizes / 2.0)[:, None, :]) @ boxes.rotations.transpose(0, 2, 1)
        corners += (boxes.positions - self._shift)[:, None, :]
        self._add_hexahedra(corners)

    def _add_hexahedra(self, corners: FloatArray) -> None:
        raster_hexahedra(
            self.cells,
            np.ascontiguousarray(corners),
            self.band.inner_low,
            self.band.inner_high,
            self.resolution,
            self.band.depth,
            self.centre,
        )

    def _add_cylinders(self, cylinders: SolidArrays) -> None:
        radius, length = cylinders.sizes.T
        axis = cylinders.rotations[:, :, 2]
        upright = np.hypot(axis[:, 0], axis[:, 1]) * length <= _UPRIGHT
        z = cylinders.positions[:, 2]
        there = (z - length / 2.0 < self.band.inner_high) & (z + length / 2.0 > self.band.inner_low)
        self._add_discs(cylinders.positions[upright & there], radius[upright & there])
        tilted = np.column_stack([cylinders.positions - self._shift, axis, radius, length])[~upright]
        raster_cylinders(
            self.cells,
            np.ascontiguousarray(tilted),
            self.band.inner_low,
            self.band.inner_high,
            self.resolution,
            self.band.depth,
            self.centre,
        )

    def _add_spheres(self, spheres: SolidArrays) -> None:
        radius, z = spheres.sizes[:, 0], spheres.positions[:, 2]
        off = np.maximum(np.maximum(self.band.inner_low - z, z - self.band.inner_high), 0.0)
        there = off < radius
        half = np.sqrt((radius[there] - off[there]) * (radius[there] + off[there]))
        self._add_discs(spheres.positions[there], half)

    def _add_discs(self, positions: FloatArray, radius: FloatArray) -> None:
        discs = np.column_stack([positions[:, :2] - self._shift[:2], radius])
        raster_discs(self.cells, discs, self.resolution, self.band.depth, self.centre)

    def _add_meshes(self, solids: list[tuple[Solid, Mesh]]) -> None:
        arrays = SolidArrays.of([solid for solid, _ in solids])
        transforms = np.concatenate([arrays.rotations, (arrays.positions - self._shift)[:, :, None]], axis=2)
        band = (self.band.inner_low, self.band.inner_high, self.resolution, self.band.depth)
        thin: list[tuple[FloatArray, npt.NDArray[np.int32], FloatArray]] = []
        for (solid, mesh), transform in zip(solids, transforms, strict=True):
            closed, there, between = raster_mesh(
                self.cells, mesh.vertices, mesh.faces, transform, *band, self.centre, self.fill
            )
            if there and not closed:
                self.open_meshes.append(solid.name)
            if len(between):
                thin.append((mesh.vertices, mesh.faces[between], transform))
        # Faces without thickness come last: they depend on the solids behind them.
        for vertices, faces, transform in thin:
            raster_thin_faces(self.cells, vertices, faces, transform, *band)
        if thin:
            mark_pending(self.cells)

    def _add_cells(self, shape: OccupancyCells, pose: Pose3D) -> None:
        for corners in run_corners(shape):
            self._add_hexahedra(pose.transform_points(corners.reshape(-1, 3)).reshape(-1, 8, 3) - self._shift)


def mark_pending(cells: npt.NDArray[np.int8]) -> None:
    """Make cells occupied that a face without thickness touches."""
    cells[cells == _PENDING] = _OCCUPIED


def run_corners(shape: OccupancyCells) -> Iterator[FloatArray]:
    """Return corners of a box for each unbroken run of blocked cells in a row [m], shape (N, 8, 3), as in `CORNERS`."""
    rows, firsts, ends = find_runs(shape.blocked)
    for start in range(0, len(rows), _RUNS_AT_ONCE):
        part = slice(start, start + _RUNS_AT_ONCE)
        low = np.stack([firsts[part], rows[part], np.zeros_like(rows[part])], axis=-1) * shape.resolution
        high = np.stack([ends[part], rows[part] + 1, np.zeros_like(rows[part])], axis=-1) * shape.resolution
        high[:, 2] = shape.height
        yield np.where(CORNERS > 0.0, high[:, None, :], low[:, None, :])


def find_runs(
    blocked: npt.NDArray[np.bool_],
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return row, first column and column after the last of each unbroken run of blocked cells in a row."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, firsts = np.nonzero(edges == 1)
    _, ends = np.nonzero(edges == -1)
    return rows, firsts, ends
