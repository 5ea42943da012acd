"""Convex hulls, through SciPy's Qhull."""

from __future__ import annotations

import numpy as np

from trundle.errors import MissingExtraError
from trundle.geometry import FloatArray
from trundle.geometry.solids import Mesh


def convex_hull(points: FloatArray) -> Mesh | None:
    """The convex hull of points [m], shape (N, 3), as a closed mesh with its faces outwards.

    Coplanar points give a flat mesh without thickness; collinear points give None.

    Raises:
        MissingExtraError: If SciPy is not installed.
    """
    try:
        from scipy.spatial import ConvexHull, QhullError
    except ImportError as error:
        raise MissingExtraError("a convex hull", "SciPy", 'pip install "trundle[usd]"') from error
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
