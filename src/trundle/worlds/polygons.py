"""Polygons of any number of corners as triangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

IntArray = npt.NDArray[np.int64]


def triangulate(points: FloatArray, counts: IntArray, indices: IntArray) -> tuple[IntArray, IntArray]:
    """Cut polygons into triangles that keep their winding: convex ones as fans, others by clipping ears.

    Args:
        points: Shape (V, 3).
        counts: Corners of each polygon, shape (P,); below 3 there is nothing of it.
        indices: Corners of all polygons one after the other, into `points`, shape (sum of counts,).

    Returns:
        Triangles, shape (T, 3), and the polygon of each, shape (T,). Triangles that name a vertex twice are left out.
    """
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]]) if len(counts) else np.zeros(0, dtype=np.int64)
    triangles: list[IntArray] = [np.zeros((0, 3), dtype=np.int64)]
    owners: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    for corners in np.unique(counts[counts >= 3]):
        owner = np.flatnonzero(counts == corners)
        polygons = indices[starts[owner][:, None] + np.arange(corners)]
        fans = _fans(polygons)
        bad = _folded(points, polygons, fans)
        for row in np.flatnonzero(bad):
            fans[row] = _clip_ears(points, polygons[row])
        triangles.append(fans.reshape(-1, 3))
        owners.append(np.repeat(owner, corners - 2))
    faces, owner = np.concatenate(triangles), np.concatenate(owners)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    order = np.argsort(owner[whole], kind="stable")
    return faces[whole][order], owner[whole][order]


def _fans(polygons: IntArray) -> IntArray:
    """Triangles from each polygon's first corner, shape (P, corners − 2, 3)."""
    first = np.broadcast_to(polygons[:, :1], (len(polygons), polygons.shape[1] - 2))
    return np.stack([first, polygons[:, 1:-1], polygons[:, 2:]], axis=-1)


def _folded(points: FloatArray, polygons: IntArray, fans: IntArray) -> npt.NDArray[np.bool_]:
    """Which fans have a triangle that faces against its polygon."""
    if polygons.shape[1] == 3:
        return np.zeros(len(polygons), dtype=np.bool_)
    corners = points[fans]
    areas = np.cross(corners[:, :, 1] - corners[:, :, 0], corners[:, :, 2] - corners[:, :, 0])
    whole = areas.sum(axis=1, keepdims=True)
    return ((areas * whole).sum(axis=-1) < -1e-12 * (whole**2).sum(axis=-1)).any(axis=1)


def _clip_ears(points: FloatArray, polygon: IntArray) -> IntArray:
    """Triangles of one polygon, shape (corners − 2, 3), seen along its normal."""
    corners = points[polygon]
    fan = np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)
    drop = int(np.abs(fan).argmax())
    flat = np.delete(corners, drop, axis=1)
    # Dropping y leaves (x, z), which is seen from behind; so is a polygon that faces down.
    if (fan[drop] < 0.0) != (drop == 1):
        flat = flat * (-1.0, 1.0)
    left = list(range(len(polygon)))
    triangles: list[tuple[int, int, int]] = []
    while len(left) > 3:
        at = next((at for at in range(len(left)) if _is_ear(flat, left, at)), 0)
        triangles.append((left[at - 1], left[at], left[(at + 1) % len(left)]))
        del left[at]
    triangles.append((left[0], left[1], left[2]))
    return polygon[np.array(triangles)]


def _is_ear(flat: FloatArray, left: list[int], at: int) -> bool:
    before, here, after = left[at - 1], left[at], left[(at + 1) % len(left)]
    a, b, c = flat[before], flat[here], flat[after]
    if _turn(a, b, c) <= 0.0:
        return False
    for other in left:
        if other in (before, here, after):
            continue
        p = flat[other]
        # A corner that lies on one of the ear's own, where two edges of a slit meet, is no obstacle.
        meets = bool((p == a).all() or (p == b).all() or (p == c).all())
        if not meets and _turn(a, b, p) >= 0.0 and _turn(b, c, p) >= 0.0 and _turn(c, a, p) >= 0.0:
            return False
    return True


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
