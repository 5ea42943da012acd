"""Pictures without OpenGL: a model's triangles in two depth buffers, the camera's and the sun's, shaded with NumPy."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
import numpy.typing as npt

from trundle._core import draw_triangles
from trundle.geometry import FloatArray
from trundle.maps.rasterise import find_runs
from trundle.viewer.cameras import Camera
from trundle.viewer.route import FloorLine

_AROUND = 32  # sides of a cylinder
_DOWN = 16  # bands of a sphere


@dataclass(frozen=True, slots=True)
class Triangles:
    """Triangles, each belonging to a geom.

    Attributes:
        corners: Corners in the geom's frame [m], shape (N, 3, 3).
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


_NEAR = 0.02  # [m]
_SKY_HIGH, _SKY_LOW = np.array([0.60, 0.73, 0.88]), np.array([0.90, 0.93, 0.96])
_FLOOR = np.array([0.70, 0.71, 0.72])
_LINE_DARK, _LINE_WIDTH = 0.15, 0.014  # the floor's metre lines: darkening, and width [m]
_FOG_AT = 160.0  # [m]
_BLOCK = 200_000  # pixels shaded per batch
_SOFT = ((-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5))  # sample offsets at a shadow's edge, in its pixels


@dataclass(frozen=True, slots=True)
class _Shadows:
    """The shadow map: the scene from the sun.

    Attributes:
        axes: Right, up and forward of the sun's view, one per row.
        middle: Centre of the view [m], map frame.
        scale: Pixels per metre.
        depths: [m] along `forward` from `middle`, infinite where it is empty; a single one without shadows.
    """

    axes: FloatArray
    middle: FloatArray
    scale: float
    depths: FloatArray

    def lit(self, points: FloatArray, normals: FloatArray) -> FloatArray:
        """Return sunlight on points [m] of surfaces, 0 to 1, shape (N,)."""
        strength = np.clip(-normals @ self.axes[2], 0.0, 1.0)
        size = len(self.depths)
        if size == 1:
            return strength
        right, up, forward = self.axes @ (points - self.middle).T
        slack = (1.5 + 1.5 * np.sqrt(1.0 - strength**2) / np.maximum(strength, 0.15)) / self.scale
        open_sky = np.zeros(len(points))
        for dx, dy in _SOFT:
            cols = np.floor(size / 2.0 + right * self.scale + dx).astype(np.int64)
            rows = np.floor(size / 2.0 - up * self.scale + dy).astype(np.int64)
            inside = (cols >= 0) & (cols < size) & (rows >= 0) & (rows < size)
            seen = self.depths[np.where(inside, rows, 0), np.where(inside, cols, 0)]
            open_sky += ~inside | (forward <= seen + slack)
        return strength * (0.12 + 0.88 * open_sky / len(_SOFT))


class SoftwarePainter:
    """Draws without OpenGL.

    Args:
        model: The model to draw; its first light is the sun, its planes are floors.
        size: Width and height of the pictures, in pixels.
        groups: Which geom groups are shown, 1 or 0 each.
        samples: Samples per pixel: 4 or more draw at twice the size and average.
        shadow_size: Edge of the shadow map, in pixels; 0 draws no shadows.
    """

    kind: Literal["software"] = "software"

    def __init__(
        self, model: mujoco.MjModel, size: tuple[int, int], groups: Sequence[int], *, samples: int, shadow_size: int
    ) -> None:
        self._model = model
        self._size = size
        self._finer = 2 if samples >= 4 else 1
        self._shadow_size = shadow_size
        shown = np.array(groups, dtype=np.bool_)
        self._triangles = model_triangles(model, shown)
        is_plane = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE.value
        self._planes = np.flatnonzero(is_plane & shown[model.geom_group])
        self._base_colors = model.geom_rgba[:, :3].astype(np.float64)
        materials = model.geom_matid
        self._glow = np.zeros(model.ngeom)
        self._glow[materials >= 0] = model.mat_emission[materials[materials >= 0]]
        for plane in self._planes:
            material = materials[plane]
            self._base_colors[plane] = _FLOOR * (model.mat_rgba[material, :3] if material >= 0 else 1.0)

    def paint(self, data: mujoco.MjData, camera: Camera, lines: Sequence[FloorLine] = ()) -> npt.NDArray[np.uint8]:
        """Draw one picture, shape (height, width, 3), without lines: the videos that have them need OpenGL."""
        width, height = (edge * self._finer for edge in self._size)
        visible = self._model.geom_rgba[self._triangles.geoms, 3] > 0.0
        corners, geoms = self._triangles.placed(data)[visible], self._triangles.geoms[visible]
        eye, axes = np.asarray(camera.eye, dtype=np.float64), camera.axes()
        scale = height / 2.0 / np.tan(np.radians(camera.fovy_deg) / 2.0)
        seen, depths = draw_triangles((corners - eye) @ axes.T, width, height, float(scale), _NEAR, True)
        shadows = self._cast_shadows(corners, camera)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
        wanted, mixed = _samples(seen, self._finer)
        colors = np.zeros((height * width, 3))
        for first in range(0, len(wanted), _BLOCK):
            pixels = wanted[first : first + _BLOCK]
            across, down = pixels % width + 0.5 - width / 2.0, pixels // width + 0.5 - height / 2.0
            rays = axes[2] + (across / scale)[:, None] * axes[0] - (down / scale)[:, None] * axes[1]
            faces, depth = seen.ravel()[pixels], depths.ravel()[pixels]
            surface = np.where(faces >= 0, geoms[faces] if len(geoms) else -1, -1)
            normal = normals[faces] if len(normals) else np.zeros((len(pixels), 3))
            self._meet_planes(data, eye, rays, surface, depth, normal)
            colors[pixels] = self._shade(eye, rays, surface, depth, normal, shadows, 1.0 / scale)
        picture = colors.reshape(self._size[1], self._finer, self._size[0], self._finer, 3)
        averaged = np.where(mixed[..., None], picture.mean(axis=(1, 3)), picture[:, 0, :, 0])
        return (np.clip(averaged, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)

    def close(self) -> None:
        """Do nothing: there is nothing to release."""

    def _cast_shadows(self, corners: FloatArray, camera: Camera) -> _Shadows:
        """Draw the shadow map around the camera's target."""
        model = self._model
        forward = model.light_dir[0] if model.nlight else np.array([0.3, 0.2, -1.0])
        forward = forward / np.linalg.norm(forward)
        right = np.cross(forward, (0.0, 1.0, 0.0))
        right /= np.linalg.norm(right)
        axes = np.array([right, np.cross(right, forward), forward])
        middle = np.asarray(camera.target, dtype=np.float64)
        size = self._shadow_size
        scale = size / (2.0 * (1.6 * camera.distance + 2.0))
        if size == 0:
            return _Shadows(axes, middle, 1.0, np.full((1, 1), np.inf))
        _, depths = draw_triangles((corners - middle) @ axes.T, size, size, scale, _NEAR, False)
        return _Shadows(axes, middle, scale, depths)

    def _meet_planes(
        self,
        data: mujoco.MjData,
        eye: FloatArray,
        rays: FloatArray,
        surface: npt.NDArray[np.int32],
        depth: FloatArray,
        normal: FloatArray,
    ) -> None:
        """Draw planes, which have no triangles, where they are nearest; changes the arrays."""
        for plane in self._planes:
            axes = data.geom_xmat[plane].reshape(3, 3)
            towards = rays @ axes[:, 2]
            meets = np.flatnonzero(towards < -1e-9)
            reach = (data.geom_xpos[plane] - eye) @ axes[:, 2] / towards[meets]
            nearer = (reach > _NEAR) & (reach < depth[meets])
            meets, reach = meets[nearer], reach[nearer]
            half = self._model.geom_size[plane, :2]
            if half.min() > 0.0:
                local = (eye + rays[meets] * reach[:, None] - data.geom_xpos[plane]) @ axes[:, :2]
                within = (np.abs(local) <= half).all(axis=1)
                meets, reach = meets[within], reach[within]
            surface[meets], depth[meets], normal[meets] = plane, reach, axes[:, 2]

    def _shade(
        self,
        eye: FloatArray,
        rays: FloatArray,
        surface: npt.NDArray[np.int32],
        depth: FloatArray,
        normal: FloatArray,
        shadows: _Shadows,
        pixel: float,
    ) -> FloatArray:
        """Return colours (N, 3) at the intersections of rays."""
        lengths = np.linalg.norm(rays, axis=1)
        rise = np.clip(rays[:, 2] / lengths * 1.6, 0.0, 1.0) ** 0.7
        colors = _SKY_LOW + rise[:, None] * (_SKY_HIGH - _SKY_LOW)
        hit = np.flatnonzero(surface >= 0)
        points = eye + rays[hit] * depth[hit, None]
        facing = (normal[hit] * rays[hit]).sum(axis=1) / lengths[hit]
        normals = np.where(facing[:, None] > 0.0, -normal[hit], normal[hit])
        base = self._base_colors[surface[hit]]
        floor = np.isin(surface[hit], self._planes)
        # At a grazing angle a pixel covers more of the floor; how much depends on the line's direction.
        covered = depth[hit][floor] * pixel / np.sqrt(np.maximum(np.abs(facing[floor]), 0.02))
        base[floor] *= _floor_lines(points[floor], covered)[:, None]
        light = 0.46 + 0.10 * normals[:, 2] + 0.14 * np.abs(facing) + 0.46 * shadows.lit(points, normals)
        light += self._glow[surface[hit]]
        fog = np.clip(depth[hit] / _FOG_AT, 0.0, 1.0)[:, None] ** 2
        colors[hit] = base * light[:, None] * (1.0 - fog) + _SKY_LOW * fog
        return colors


def _samples(seen: npt.NDArray[np.int32], finer: int) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.bool_]]:
    """Return which samples to shade (flat indices), and which pixels show several triangles, so need all of theirs."""
    rows, cols = seen.shape[0] // finer, seen.shape[1] // finer
    samples = seen.reshape(rows, finer, cols, finer)
    mixed = (samples != samples[:, :1, :, :1]).any(axis=(1, 3))
    wanted = np.zeros(samples.shape, dtype=np.bool_)
    wanted[:, 0, :, 0] = True
    wanted |= mixed[:, None, :, None]
    return np.flatnonzero(wanted), mixed


def _floor_lines(points: FloatArray, pixels: FloatArray) -> FloatArray:
    """Return the brightness of a floor at points [m]; its lines, every metre, fade where they are below a pixel [m]."""
    to_line = np.abs(points[:, :2] - np.round(points[:, :2])).min(axis=1)
    blur = np.maximum(_LINE_WIDTH, pixels)
    return 1.0 - _LINE_DARK * np.clip(1.5 - to_line / blur, 0.0, 1.0) * _LINE_WIDTH / blur
