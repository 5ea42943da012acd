"""Primitive shapes as closed triangle meshes that enclose them.

Round shapes come out at most 0.5 % larger, never smaller, so that a map made from them misses nothing. All loaders and
exporters tessellate here; `viewer.triangles` uses inscribed meshes, `maps.over_floor` finer circumscribed ones.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.geometry.solids import Mesh

AROUND = 64
"""Sides of a circle."""

_RINGS = 32

_BOX_FACES = np.array(
    [
        [0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
        [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5],
    ],
    dtype=np.int32,
)  # fmt: skip


def box_mesh(size: tuple[float, float, float]) -> Mesh:
    """A box about the origin of full extent `size` [m]."""
    corners = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
    return Mesh(corners * size, _BOX_FACES)


def rectangle_mesh(width: float, length: float) -> Mesh:
    """A rectangle of `width` along x and `length` along y [m] about the origin, without thickness, facing along z."""
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    return Mesh(corners * (width / 2.0, length / 2.0, 1.0), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))


def cylinder_mesh(radius: float, length: float) -> Mesh:
    """A cylinder along z about the origin, of full `length` [m]."""
    return frustum_mesh(radius, radius, length)


def cone_mesh(radius: float, length: float) -> Mesh:
    """A cone along z about the origin, with its point at z = length / 2 [m]."""
    return frustum_mesh(radius, 0.0, length)


def frustum_mesh(bottom: float, top: float, length: float) -> Mesh:
    """A truncated cone along z about the origin: radii at the bottom and the top, full `length` [m]."""
    angles = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    circle = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(AROUND)]) / np.cos(np.pi / AROUND)
    half = np.array([0.0, 0.0, length / 2.0])
    vertices = np.vstack([circle * bottom - half, circle * top + half, -half, half])
    here = np.arange(AROUND)
    following = np.roll(here, -1)
    low, high = np.full(AROUND, 2 * AROUND), np.full(AROUND, 2 * AROUND + 1)
    faces = np.concatenate(
        [
            np.column_stack([here, following, following + AROUND]),
            np.column_stack([here, following + AROUND, here + AROUND]),
            np.column_stack([low, following, here]),
            np.column_stack([high, here + AROUND, following + AROUND]),
        ]
    )
    return _closed(vertices, faces)


def sphere_mesh(radius: float) -> Mesh:
    """A sphere about the origin."""
    vertices, faces = _unit_ball()
    return Mesh(vertices * radius, faces)


def capsule_mesh(radius: float, length: float) -> Mesh:
    """A capsule along z about the origin; `length` [m] is that of its middle part, between the two hemispheres."""
    vertices, faces = _unit_ball()
    upper = vertices[:, 2] > 0.0
    vertices = vertices * radius
    vertices[:, 2] += np.where(upper, length / 2.0, -length / 2.0)
    return Mesh(vertices, faces)


@cache
def _unit_ball() -> tuple[FloatArray, npt.NDArray[np.int32]]:
    """Triangles of a unit sphere with no vertex on the equator, so that a capsule is a sphere stretched there."""
    heights = np.linspace(-np.pi / 2.0, np.pi / 2.0, _RINGS + 2)[1:-1]
    angles = np.arange(AROUND) * (2.0 * np.pi / AROUND)
    rings = np.stack(
        [
            np.cos(heights)[:, None] * np.cos(angles),
            np.cos(heights)[:, None] * np.sin(angles),
            np.broadcast_to(np.sin(heights)[:, None], (len(heights), AROUND)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = np.vstack([rings, [0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
    bottom, top = len(rings), len(rings) + 1
    here = np.arange(AROUND)
    following = np.roll(here, -1)
    last = (len(heights) - 1) * AROUND
    parts = [
        np.column_stack([np.full(AROUND, bottom), following, here]),
        np.column_stack([np.full(AROUND, top), last + here, last + following]),
    ]
    for ring in range(len(heights) - 1):
        low, high = ring * AROUND, (ring + 1) * AROUND
        parts.append(np.column_stack([low + here, low + following, high + following]))
        parts.append(np.column_stack([low + here, high + following, high + here]))
    faces = np.concatenate(parts).astype(np.int32)
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    # Scaled up until the nearest face touches the sphere from outside.
    return vertices / float((normals * corners[:, 0]).sum(axis=1).min()), faces


def _closed(vertices: FloatArray, faces: npt.NDArray[np.int64]) -> Mesh:
    """A mesh with equal vertices merged, and without the triangles that a radius of 0 leaves without area."""
    places, index = np.unique(vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return Mesh(places, faces[whole].astype(np.int32))
