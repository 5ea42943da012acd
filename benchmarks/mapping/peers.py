"""Other methods to map a world, with MuJoCo's queries: the distance of a box, and rays."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere, solids_bounds
from trundle.maps import OccupancyGrid
from trundle.worlds import World

_DEPTH = 1e-6  # As deep [m] a solid must reach into a cell; what trundle asks for.


class Peers:
    """A world in MuJoCo, and a grid of cells in a band of heights to query.

    Each method takes the indices of its queries, so that a sample can be timed where all would take minutes, and gives
    the cells that it found occupied, as indices into the flat grid.
    """

    def __init__(self, world: World, grid: OccupancyGrid, band: tuple[float, float]) -> None:
        self._low, self._high = band
        self._edge = grid.resolution
        spec = mujoco.MjSpec()
        for solid in world.solids:
            _add(spec, solid)
        half = self._edge / 2.0
        spec.worldbody.add_geom(
            name="cell", type=mujoco.mjtGeom.mjGEOM_BOX, size=(half, half, (self._high - self._low) / 2.0), group=5
        )
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        self._cell = self._model.ngeom - 1
        self._groups = np.array([1, 1, 1, 1, 1, 0], dtype=np.uint8)
        rows, cols = (index.ravel() for index in np.indices(grid.shape))
        self._centres = np.stack([*grid.cell_to_world(rows, cols), np.full(rows.size, 0.5 * sum(band))], axis=1)
        self._pair_geom, self._pair_cell = self._find_pairs(world, grid)

    @property
    def cells(self) -> npt.NDArray[np.int64]:
        """All cells: the queries of the two methods with rays."""
        return np.arange(len(self._centres))

    @property
    def pairs(self) -> npt.NDArray[np.int64]:
        """All pairs of a solid and a cell inside its bounding box: the queries of the method with distances."""
        return np.arange(len(self._pair_geom))

    def _find_pairs(self, world: World, grid: OccupancyGrid) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        lows, highs = solids_bounds(world.solids)
        corner = np.array([grid.origin.x, grid.origin.y])
        first = np.clip(np.floor((lows[:, :2] - corner) / self._edge).astype(int), 0, grid.shape[::-1])
        end = np.clip(np.ceil((highs[:, :2] - corner) / self._edge).astype(int), 0, grid.shape[::-1])
        geoms, cells = [], []
        for index in np.nonzero((lows[:, 2] < self._high) & (highs[:, 2] > self._low))[0]:
            rows, cols = np.mgrid[first[index, 1] : end[index, 1], first[index, 0] : end[index, 0]]
            cells.append((rows * grid.shape[1] + cols).ravel())
            geoms.append(np.full(rows.size, index))
        return np.concatenate(geoms), np.concatenate(cells)

    def distances(self, pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """A box of the cell's size against each solid whose bounding box reaches into the cell (mj_geomDistance)."""
        place = self._data.geom_xpos[self._cell]
        query = mujoco.mj_geomDistance
        found = []
        for geom, cell in zip(self._pair_geom[pairs].tolist(), self._pair_cell[pairs].tolist(), strict=True):
            place[:] = self._centres[cell]
            if query(self._model, self._data, geom, self._cell, 0.01, None) < -_DEPTH:
                found.append(cell)
        return np.unique(np.array(found, dtype=np.int64))

    def rays_down(self, cells: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """A ray down each cell's middle; a hit inside the band counts, and any that leaves a solid (mj_ray)."""
        geom, normal, down = np.zeros(1, np.int32), np.zeros(3), np.array([0.0, 0.0, -1.0])
        found = []
        for cell in cells.tolist():
            start = self._centres[cell].copy()
            start[2] = self._high
            hit = mujoco.mj_ray(self._model, self._data, start, down, self._groups, True, -1, geom, normal)
            if hit >= 0.0 and (hit <= self._high - self._low or normal[2] < 0.0):
                found.append(cell)
        return np.array(found, dtype=np.int64)

    def rays_across(self, cells: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Four rays from each cell's middle to its sides, half-way up the band (mj_multiRay), counted as those down."""
        directions = np.array([(1.0, 0, 0), (-1.0, 0, 0), (0, 1.0, 0), (0, -1.0, 0)])
        flat, half = directions.ravel(), self._edge / 2.0
        geoms, hits, normals = np.zeros(4, np.int32), np.zeros(4), np.zeros(12)
        found = []
        for cell in cells.tolist():
            start = self._centres[cell]
            mujoco.mj_multiRay(
                self._model, self._data, start, flat, self._groups, True, -1, geoms, hits, normals, 4, half
            )
            there = hits >= 0.0
            if there.any():
                leaving = (normals.reshape(4, 3) * directions).sum(axis=1) > 0.0
                if (there & ((hits < half - _DEPTH) | leaving)).any():
                    found.append(cell)
        return np.array(found, dtype=np.int64)

    def methods(
        self,
    ) -> dict[str, tuple[Callable[[npt.NDArray[np.int64]], npt.NDArray[np.int64]], npt.NDArray[np.int64]]]:
        """Each method by name, with all its queries."""
        return {
            "distance of a box, mj_geomDistance": (self.distances, self.pairs),
            "a ray down each cell, mj_ray": (self.rays_down, self.cells),
            "four rays across each cell, mj_multiRay": (self.rays_across, self.cells),
        }


def _add(spec: mujoco.MjSpec, solid: Solid) -> None:
    place = {"name": solid.name, "pos": solid.pose.position, "quat": solid.pose.quaternion}
    match solid.shape:
        case Box(size):
            kind, sizes = mujoco.mjtGeom.mjGEOM_BOX, tuple(edge / 2.0 for edge in size)
        case Cylinder(radius, length):
            kind, sizes = mujoco.mjtGeom.mjGEOM_CYLINDER, (radius, length / 2.0, 0.0)
        case Sphere(radius):
            kind, sizes = mujoco.mjtGeom.mjGEOM_SPHERE, (radius, 0.0, 0.0)
        case Mesh(vertices, faces):
            spec.add_mesh(name=solid.name, uservert=vertices.ravel(), userface=faces.ravel())
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=solid.name, **place)
            return
        case _:
            raise SystemExit(f"{solid.name}: the peers get boxes, cylinders, spheres and meshes")
    spec.worldbody.add_geom(type=kind, size=sizes, **place)
