"""Triangle meshes of primitive shapes, of polygons and of points.

Primitive shapes come out as closed meshes that enclose them. Round ones are at most 0.5 % larger, never smaller, so
that a map made from them misses nothing. All loaders and exporters tessellate here; `viewer.triangles` uses inscribed
meshes, `maps.over_floor` finer circumscribed ones.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import numpy.typing as npt

from trundle.extras import missing_extra
from trundle.geometry import FloatArray
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps.rasterise import BOX_FACES, CORNERS

AROUND = 64
"""Sides of a circle: enough that a circumscribed one is 0.12 % larger."""

_RINGS = 32  # of a sphere, half as many, so that its faces are about square at the equator


IntArray = npt.NDArray[np.int64]


def box_mesh(size: tuple[float, float, float]) -> Mesh:
    """Return a box about the origin of full extent `size` [m]."""
    return Mesh(CORNERS * 0.5 * size, BOX_FACES)


def rectangle_mesh(width: float, length: float) -> Mesh:
    """Return a rectangle of `width` along x and `length` along y [m] about the origin, facing along z."""
    corners = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    return Mesh(corners * (width / 2.0, length / 2.0, 1.0), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32))


def cylinder_mesh(radius: float, length: float) -> Mesh:
    """Return a cylinder along z about the origin, of full `length` [m]."""
    return frustum_mesh(radius, radius, length)


def cone_mesh(radius: float, length: float) -> Mesh:
    """Return a cone along z about the origin, with its point at z = length / 2 [m]."""
    return frustum_mesh(radius, 0.0, length)


def frustum_mesh(bottom: float, top: float, length: float) -> Mesh:
    """Return a truncated cone along z about the origin: radii at the bottom and the top, full `length` [m]."""
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
    """Return a sphere about the origin."""
    vertices, faces = _unit_ball()
    return Mesh(vertices * radius, faces)


def capsule_mesh(radius: float, length: float) -> Mesh:
    """Return a capsule along z about the origin; `length` [m] is that of the part between the two hemispheres."""
    vertices, faces = _unit_ball()
    upper = vertices[:, 2] > 0.0
    vertices = vertices * radius
    vertices[:, 2] += np.where(upper, length / 2.0, -length / 2.0)
    return Mesh(vertices, faces)


@cache
def _unit_ball() -> tuple[FloatArray, npt.NDArray[np.int32]]:
    """Return a unit sphere without vertices on the equator: a capsule is a sphere stretched there."""
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


def as_mesh(shape: Box | Cylinder | Sphere | Mesh) -> Mesh:
    """Return a shape's surface as triangles; round ones as circumscribed polyhedra."""
    match shape:
        case Box(size):
            return box_mesh(size)
        case Cylinder(radius, length):
            return cylinder_mesh(radius, length)
        case Sphere(radius):
            return sphere_mesh(radius)
        case Mesh():
            return shape


def solid_triangles(solid: Solid) -> FloatArray:
    """Return the surface of a solid as triangles [m], map frame, shape (N, 3, 3); blocked cells have none."""
    if isinstance(solid.shape, OccupancyCells):
        return np.zeros((0, 3, 3))
    mesh = as_mesh(solid.shape)
    return solid.pose.transform_points(mesh.vertices)[mesh.faces]


def _closed(vertices: FloatArray, faces: npt.NDArray[np.int64]) -> Mesh:
    """Return a mesh with equal vertices merged, and without the triangles that a radius of 0 leaves without area."""
    places, index = np.unique(vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return Mesh(places, faces[whole].astype(np.int32))


def triangulate(points: FloatArray, counts: IntArray, indices: IntArray) -> tuple[IntArray, IntArray]:
    """Cut polygons into triangles that keep their winding: convex ones as fans, others by earcut.

    Args:
        points: Shape (V, 3).
        counts: Corners of each polygon, shape (P,); polygons with fewer than 3 are skipped.
        indices: Corners of all polygons one after the other, into `points`, shape (sum of counts,).

    Returns:
        Triangles, shape (T, 3), and the polygon of each, shape (T,). Triangles that use a vertex twice are dropped.
    """
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else np.zeros(0, dtype=np.int64)
    triangles: list[IntArray] = [np.zeros((0, 3), dtype=np.int64)]
    owners: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    for corners in np.unique(counts[counts >= 3]):
        owner = np.flatnonzero(counts == corners)
        polygons = indices[starts[owner][:, None] + np.arange(corners)]
        fans = _fans(polygons)
        folded = _folded(points, polygons, fans)
        triangles.append(fans[~folded].reshape(-1, 3))
        owners.append(np.repeat(owner[~folded], corners - 2))
        for row in np.flatnonzero(folded):
            triangles.append(_cut_by_earcut(points, polygons[row]))
            owners.append(np.full(len(triangles[-1]), owner[row]))
    faces, owner = np.concatenate(triangles), np.concatenate(owners)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    order = np.argsort(owner[whole], kind="stable")
    return faces[whole][order], owner[whole][order]


def _fans(polygons: IntArray) -> IntArray:
    """Return triangles from each polygon's first corner, shape (P, corners − 2, 3).

    Vectorized: fifty times as fast as a call of earcut for each polygon.
    """
    first = np.broadcast_to(polygons[:, :1], (len(polygons), polygons.shape[1] - 2))
    return np.stack([first, polygons[:, 1:-1], polygons[:, 2:]], axis=-1)


def _folded(points: FloatArray, polygons: IntArray, fans: IntArray) -> npt.NDArray[np.bool_]:
    """Return which fans have a triangle that faces against its polygon."""
    if polygons.shape[1] == 3:
        return np.zeros(len(polygons), dtype=np.bool_)
    corners = points[fans]
    areas = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    whole = areas.sum(axis=1, keepdims=True)
    return ((areas * whole).sum(axis=-1) < -1e-12 * (whole**2).sum(axis=-1)).any(axis=1)


def _cut_by_earcut(points: FloatArray, polygon: IntArray) -> IntArray:
    """Return triangles of one polygon, shape (T, 3), cut in the projection along its normal."""
    from mapbox_earcut import triangulate_float64

    corners = points[polygon] - points[polygon[0]]
    normal = np.cross(corners[1:-1], corners[2:]).sum(axis=0)
    drop = int(np.abs(normal).argmax())
    flat = np.ascontiguousarray(np.delete(corners, drop, axis=1))
    faces = triangulate_float64(flat, np.array([len(polygon)], dtype=np.uint32)).reshape(-1, 3)
    cut = flat[faces]
    first, second = cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0]
    area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum()
    # Without y, (x, z) is seen from behind.
    faces_up = (area > 0.0) != (drop == 1)
    return polygon[faces if faces_up == (normal[drop] > 0.0) else faces[:, ::-1]]


def convex_hull(points: FloatArray) -> Mesh | None:
    """Return the convex hull of points [m], shape (N, 3), as a closed mesh with its faces outwards.

    Coplanar points give a flat mesh without thickness; collinear points give None.

    Raises:
        MissingExtraError: If SciPy is not installed.
    """
    try:
        from scipy.spatial import ConvexHull, QhullError
    except ImportError as error:
        raise missing_extra("a convex hull", "SciPy", "usd") from error
    centre = points.mean(axis=0)
    _, extents, axes = np.linalg.svd(points - centre, full_matrices=False)
    if len(extents) < 2 or extents[1] <= 1e-9 * extents[0]:
        return None
    if len(extents) < 3 or extents[2] <= 1e-9 * extents[0]:
        flat = ConvexHull((points - centre) @ axes[:2].T)
        ring = flat.vertices
        fan = [(0, step, step + 1) for step in range(1, len(ring) - 1)]
        return Mesh(points[ring], np.array(fan, dtype=np.int32))
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    corners = points[hull.simplices]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normals * hull.equations[:, :3]).sum(axis=1) < 0.0
    faces = np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)
    used, index = np.unique(faces, return_inverse=True)
    return Mesh(points[used], index.reshape(-1, 3).astype(np.int32))
