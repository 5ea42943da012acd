"""A MuJoCo model's geoms as triangles."""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.maps.rasterise import find_runs

_AROUND = 32  # sides of a cylinder
_DOWN = 16  # bands of a sphere


@dataclass(frozen=True, slots=True)
class Triangles:
    """Triangles, each belonging to a geom.

    Attributes:
        corners: In the geom's frame [m], shape (N, 3, 3).
        geoms: Index of each triangle's geom, shape (N,).
    """

    corners: FloatArray
    geoms: npt.NDArray[np.int32]

    def placed(self, data: mujoco.MjData) -> FloatArray:
        """Return corners in the map frame [m], shape (N, 3, 3)."""
        rotations = data.geom_xmat.reshape(-1, 3, 3)[self.geoms]
        return np.einsum("nij,nkj->nki", rotations, self.corners) + data.geom_xpos[self.geoms][:, None, :]


def model_triangles(model: mujoco.MjModel, groups: npt.NDArray[np.bool_]) -> Triangles:
    """Return triangles of all geoms of the given groups except planes, which are infinite."""
    parts: list[FloatArray] = [np.zeros((0, 3, 3))]
    geoms: list[npt.NDArray[np.int32]] = [np.zeros(0, dtype=np.int32)]
    for geom in np.flatnonzero(groups[model.geom_group]):
        corners = _geom_triangles(model, int(geom))
        parts.append(corners)
        geoms.append(np.full(len(corners), geom, dtype=np.int32))
    return Triangles(np.concatenate(parts), np.concatenate(geoms))


def _geom_triangles(model: mujoco.MjModel, geom: int) -> FloatArray:
    size, kind = model.geom_size[geom], mujoco.mjtGeom(int(model.geom_type[geom]))
    match kind:
        case mujoco.mjtGeom.mjGEOM_BOX:
            return _BOX * size
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return _SPHERE * size[0]
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return _SPHERE * size
        case mujoco.mjtGeom.mjGEOM_CYLINDER:
            return _CYLINDER * (size[0], size[0], size[1])
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            ball = _SPHERE * size[0]
            ball[..., 2] += np.where(_SPHERE[..., 2].mean(axis=1, keepdims=True) > 0.0, size[1], -size[1])
            return np.concatenate([ball, _CYLINDER[: 2 * _AROUND] * (size[0], size[0], size[1])])
        case mujoco.mjtGeom.mjGEOM_MESH:
            return _mesh(model, int(model.geom_dataid[geom]))
        case mujoco.mjtGeom.mjGEOM_HFIELD:
            return _cells(model, int(model.geom_dataid[geom]))
        case _:
            return np.zeros((0, 3, 3))


def _mesh(model: mujoco.MjModel, mesh: int) -> FloatArray:
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    face, faces = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    return model.mesh_vert[first : first + count][model.mesh_face[face : face + faces]].astype(np.float64)


def _cells(model: mujoco.MjModel, field: int) -> FloatArray:
    """Return a height field of blocked cells (`world_parts.cell_heights`) as the walls with flat tops that it is."""
    rows, cols = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
    first = model.hfield_adr[field]
    blocked = model.hfield_data[first : first + rows * cols].reshape(rows, cols) > 0.5
    half_x, half_y, high, _ = (float(number) for number in model.hfield_size[field])
    low = high / 2.0
    step_x, step_y = 2.0 * half_x / (cols - 1), 2.0 * half_y / (rows - 1)
    left, bottom = -half_x - step_x / 2.0, -half_y - step_y / 2.0

    row, start, end = find_runs(blocked)
    x0, x1 = left + start * step_x, left + end * step_x
    y0, y1 = bottom + row * step_y, bottom + (row + 1) * step_y
    quads = [_quads((x0, y0, high), (x1, y0, high), (x1, y1, high), (x0, y1, high))]
    row, start, end = find_runs(_turns(blocked))
    x0, x1, y = left + start * step_x, left + end * step_x, bottom + row * step_y
    quads.append(_quads((x0, y, low), (x1, y, low), (x1, y, high), (x0, y, high)))
    col, start, end = find_runs(_turns(blocked.T))
    y0, y1, x = bottom + start * step_y, bottom + end * step_y, left + col * step_x
    quads.append(_quads((x, y0, low), (x, y1, low), (x, y1, high), (x, y0, high)))
    return np.concatenate(quads)


def _turns(cells: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return where a cell differs from the one before it in its column, shape (rows + 1, cols)."""
    padded = np.pad(cells, ((1, 1), (0, 0)))
    return padded[1:] != padded[:-1]


def _quads(*corners: tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]) -> FloatArray:
    """Return two triangles for each quadrilateral; a corner's coordinates are arrays of shape (N,) or numbers."""
    a, b, c, d = (np.stack(np.broadcast_arrays(*corner), axis=-1).astype(np.float64) for corner in corners)
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _unit_box() -> FloatArray:
    sides = []
    for axis in range(3):
        across, up = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1.0, 1.0):
            quad = np.zeros((4, 3))
            quad[:, axis] = side
            quad[:, across] = (-1.0, 1.0, 1.0, -1.0)
            quad[:, up] = (-1.0, -1.0, 1.0, 1.0)
            sides += [quad[[0, 1, 2]], quad[[0, 2, 3]]] if side > 0.0 else [quad[[0, 2, 1]], quad[[0, 3, 2]]]
    return np.array(sides)


def _circle(count: int) -> tuple[FloatArray, FloatArray]:
    turns = np.linspace(0.0, 2.0 * math.pi, count + 1)
    return np.cos(turns), np.sin(turns)


def _unit_cylinder() -> FloatArray:
    """Return the side (2 × `_AROUND` triangles), then both ends."""
    x, y = _circle(_AROUND)
    here, there = (x[:-1], y[:-1]), (x[1:], y[1:])
    side = _quads((*here, -1.0), (*there, -1.0), (*there, 1.0), (*here, 1.0))
    ends = []
    for z, first, second in ((-1.0, there, here), (1.0, here, there)):
        middle = (np.zeros(_AROUND), np.zeros(_AROUND))
        corners = [np.stack([*place, np.full(_AROUND, z)], axis=-1) for place in (middle, first, second)]
        ends.append(np.stack(corners, axis=1))
    return np.concatenate([side, *ends])


def _unit_sphere() -> FloatArray:
    x, y = _circle(_AROUND)
    parts = []
    for band in range(_DOWN):
        upper, lower = (math.pi * (band + offset) / _DOWN for offset in (0, 1))
        (r0, z0), (r1, z1) = ((math.sin(angle), math.cos(angle)) for angle in (upper, lower))
        parts.append(
            _quads(
                (r1 * x[:-1], r1 * y[:-1], z1),
                (r1 * x[1:], r1 * y[1:], z1),
                (r0 * x[1:], r0 * y[1:], z0),
                (r0 * x[:-1], r0 * y[:-1], z0),
            )
        )
    return np.concatenate(parts)


_BOX, _CYLINDER, _SPHERE = _unit_box(), _unit_cylinder(), _unit_sphere()
