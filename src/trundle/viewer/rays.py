"""Pictures without OpenGL: rays through MuJoCo's ray caster, shaded with NumPy.

A ray a pixel finds what is seen, a second one from the light finds the shadows (both sets start in one point, which is
what the caster is quick at), and pixels at edges are traced again in four places.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.viewer.cameras import Camera

_SKY_HIGH, _SKY_LOW = np.array([0.60, 0.73, 0.88]), np.array([0.90, 0.93, 0.96])
_LINE = 0.85  # how dark the floor's metre lines are
_LINE_WIDTH = 0.014  # [m]
_LIGHT_DISTANCE = 300.0  # [m]: near enough to parallel, far from any loss of digits
_SHADOW_SLACK = 0.01  # [m]
_SUB_PIXELS = ((-0.125, -0.375), (0.375, -0.125), (-0.375, 0.125), (0.125, 0.375))


class RayPainter:
    """Draws with rays.

    Args:
        model: What to draw; its first light is the sun, its planes are floors.
        size: Width and height of the pictures, in pixels.
        groups: Which geom groups are shown, 1 or 0 each.
    """

    kind: Literal["rays"] = "rays"

    def __init__(self, model: mujoco.MjModel, size: tuple[int, int], groups: Sequence[int]) -> None:
        self._model = model
        self._size = size
        self._groups = np.array(groups, dtype=np.uint8)
        self._is_floor = model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE.value
        direction = model.light_dir[0] if model.nlight else np.array([0.3, 0.2, -1.0])
        self._to_light: FloatArray = -direction / np.linalg.norm(direction)

    def paint(self, data: mujoco.MjData, camera: Camera) -> npt.NDArray[np.uint8]:
        """Draw one picture, shape (height, width, 3)."""
        width, height = self._size
        cols, rows = np.meshgrid(np.arange(0.5, width, dtype=np.float64), np.arange(0.5, height, dtype=np.float64))
        colors, geoms, normals = self._trace(data, camera, cols.ravel(), rows.ravel())
        at_edge = np.flatnonzero(_edges(geoms.reshape(height, width), normals.reshape(height, width, 3)))
        if len(at_edge):
            x, y = cols.ravel()[at_edge], rows.ravel()[at_edge]
            parts = [self._trace(data, camera, x + dx, y + dy)[0] for dx, dy in _SUB_PIXELS]
            colors[at_edge] = np.mean(parts, axis=0)
        return (np.clip(colors, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8).reshape(height, width, 3)

    def close(self) -> None:
        """Do nothing: it holds nothing."""

    def _trace(
        self, data: mujoco.MjData, camera: Camera, cols: FloatArray, rows: FloatArray
    ) -> tuple[FloatArray, npt.NDArray[np.int32], FloatArray]:
        """Colours (N, 3), geoms (N,) and normals (N, 3) seen at places of the picture, in pixels."""
        width, height = self._size
        half = np.tan(np.radians(camera.fovy_deg) / 2.0)
        right, up, forward = camera.axes()
        across = (2.0 * cols / width - 1.0) * half * width / height
        rays = forward + across[:, None] * right + ((1.0 - 2.0 * rows / height) * half)[:, None] * up
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        eye = np.asarray(camera.eye, dtype=np.float64)
        geoms, distances, normals = self._cast(data, eye, rays)
        colors = self._sky(rays)
        hit = np.flatnonzero(geoms >= 0)
        points = eye + rays[hit] * distances[hit, None]
        surface = self._surface(geoms[hit], points, distances[hit], half / height)
        lit = self._lit(data, points, normals[hit])
        facing = np.abs((normals[hit] * rays[hit]).sum(axis=1))
        light = 0.40 + 0.10 * normals[hit, 2] + 0.14 * facing + 0.50 * lit
        fog = np.clip(distances[hit] / 150.0, 0.0, 1.0)[:, None] ** 2
        colors[hit] = surface * light[:, None] * (1.0 - fog) + _SKY_LOW * fog
        return colors, geoms, normals

    def _cast(
        self, data: mujoco.MjData, origin: FloatArray, rays: FloatArray
    ) -> tuple[npt.NDArray[np.int32], FloatArray, FloatArray]:
        """First geoms (−1 none), distances [m] and normals that unit rays from one point meet."""
        count = len(rays)
        geoms, distances = np.full(count, -1, dtype=np.int32), np.zeros(count)
        normals = np.zeros(3 * count)
        if count:
            flat = np.ascontiguousarray(rays, dtype=np.float64).ravel()
            mujoco.mj_multiRay(
                self._model, data, origin, flat, self._groups, True, -1, geoms, distances, normals, count, 1e6
            )
        return geoms, distances, normals.reshape(-1, 3)

    def _lit(self, data: mujoco.MjData, points: FloatArray, normals: FloatArray) -> FloatArray:
        """How much sun falls on points, 0 to 1: rays from the sun find what stands before them."""
        strength = np.clip(normals @ self._to_light, 0.0, 1.0)
        towards = np.flatnonzero(strength > 0.0)
        if not len(towards):
            return strength
        sun = points[towards].mean(axis=0) + _LIGHT_DISTANCE * self._to_light
        rays = points[towards] - sun
        reach = np.linalg.norm(rays, axis=1)
        geoms, distances, _ = self._cast(data, sun, rays / reach[:, None])
        strength[towards[(geoms >= 0) & (distances < reach - _SHADOW_SLACK)]] *= 0.12
        return strength

    def _surface(
        self, geoms: npt.NDArray[np.int32], points: FloatArray, distances: FloatArray, pixel: float
    ) -> FloatArray:
        """Colours (N, 3) of surfaces; floors have a line every metre, faded where it is finer than a pixel."""
        model = self._model
        colors = model.geom_rgba[geoms, :3].astype(np.float64)
        floor = np.flatnonzero(self._is_floor[geoms])
        if len(floor):
            colors[floor] = (0.70, 0.71, 0.72)
            to_line = np.abs(points[floor, :2] - np.round(points[floor, :2])).min(axis=1)
            blur = np.maximum(_LINE_WIDTH, 2.0 * pixel * distances[floor])
            dark = (1.0 - _LINE) * np.clip(1.5 - to_line / blur, 0.0, 1.0) * _LINE_WIDTH / blur
            colors[floor] *= (1.0 - dark)[:, None]
        return colors

    def _sky(self, rays: FloatArray) -> FloatArray:
        height = np.clip(rays[:, 2:3] * 1.6, 0.0, 1.0) ** 0.7
        return _SKY_LOW + height * (_SKY_HIGH - _SKY_LOW)


def _edges(geoms: npt.NDArray[np.int32], normals: FloatArray) -> npt.NDArray[np.bool_]:
    """Pixels whose neighbour to the right or below shows another geom or a face at an angle, and those neighbours."""
    edges = np.zeros(geoms.shape, dtype=np.bool_)
    for axis in (0, 1):
        turned = (np.diff(normals, axis=axis) ** 2).sum(axis=2) > 0.5
        changed = (np.diff(geoms, axis=axis) != 0) | turned
        before = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        after = (slice(1, None), slice(None)) if axis == 0 else (slice(None), slice(1, None))
        edges[before] |= changed
        edges[after] |= changed
    return edges
