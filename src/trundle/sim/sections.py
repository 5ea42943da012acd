"""Solids in the plane: their extent between two heights, and their outline at one height."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry import FloatArray, convex_hull
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.sim.convex import Piece, mesh_edges

_SIDES = 128
"""A lying or leaning cylinder becomes a prism of this many sides, which is 0.03 % of the radius too small."""


@dataclass(frozen=True, slots=True)
class Polygon:
    """A convex polygon: corners [m] in the map frame, counter-clockwise, shape (N, 2), N ≥ 3."""

    corners: FloatArray


@dataclass(frozen=True, slots=True)
class Disc:
    """A disc: centre and radius [m] in the map frame."""

    x: float
    y: float
    radius: float


IndexArray: TypeAlias = npt.NDArray[np.integer]
Section: TypeAlias = Polygon | Disc


def slab_section(solid: Solid, low: float, high: float) -> Section | None:
    """Return the extent, seen from above, of the part of a solid between two heights [m]; None if there is none.

    A mesh counts as its convex hull: see `trundle.sim.convex` for those that are not convex. Blocked cells are not
    a convex shape: see `trundle.sim.footprint.CellField`.
    """
    x, y, z = solid.pose.position
    match solid.shape:
        case Sphere(radius):
            height = min(max(z, low), high) - z
            reach = math.sqrt(radius * radius - height * height) if abs(height) < radius else 0.0
            return Disc(x, y, reach) if reach > 0.0 else None
        case Cylinder(radius, length) if solid.pose.is_upright():
            return Disc(x, y, radius) if z - length / 2.0 < high and z + length / 2.0 > low else None
        case Box(size) if solid.pose.is_upright():
            if not (z - size[2] / 2.0 <= high and z + size[2] / 2.0 >= low):
                return None
            axes = solid.pose.rotation()[:2, :2]
            ahead, left = axes[:, 0] * (size[0] / 2.0), axes[:, 1] * (size[1] / 2.0)
            return Polygon(np.array([ahead + left, left - ahead, -ahead - left, ahead - left]) + np.array([x, y]))
        case OccupancyCells():
            raise WorldError(f"blocked cells {solid.name!r} have no convex section")
        case shape:
            corners, edges = _polyhedron(shape)
            return _cut(solid.pose.transform_points(corners), edges, low, high)


def piece_section(piece: Piece, low: float, high: float) -> Polygon | None:
    """Return the extent, from above, of a convex piece between two heights [m]; None if nothing of it is there."""
    return _cut(piece.corners, piece.edges, low, high)


def cut_triangles(triangles: FloatArray, low: float, high: float) -> FloatArray:
    """Return the parts of triangles between two heights [m], seen from above.

    Args:
        triangles: Corners [m], shape (T, 3, 3).
        low: Lowest height [m].
        high: Highest height [m].

    Returns:
        Convex polygons of nine corners, some of them repeated, of those that have such a part; shape (K, 9, 2). An
        upright triangle's corners are on one line.
    """
    heights = triangles[:, :, 2]
    triangles = triangles[(heights.min(axis=1) <= high) & (heights.max(axis=1) >= low)]
    start, end = triangles, np.roll(triangles, -1, axis=1)
    rise = end[..., 2] - start[..., 2]
    points = np.repeat(start[:, :, None], 3, axis=2)  # Of each edge: its start, and where it enters and leaves.
    valid = np.zeros(points.shape[:3], dtype=bool)
    valid[:, :, 0] = (start[..., 2] >= low) & (start[..., 2] <= high)
    upward = rise > 0.0
    for place, planes in ((1, np.where(upward, low, high)), (2, np.where(upward, high, low))):
        with np.errstate(divide="ignore", invalid="ignore"):
            share = (planes - start[..., 2]) / rise
        crosses = (share > 0.0) & (share < 1.0)
        along = np.where(crosses, share, 0.0)[..., None]
        points[:, :, place] = start + along * (end - start)
        valid[:, :, place] = crosses
    points, valid = points.reshape(len(triangles), 9, 3), valid.reshape(len(triangles), 9)
    points, valid = points[valid.any(axis=1)], valid[valid.any(axis=1)]
    # A missing corner repeats the one before it; before the first comes the last.
    slots = np.where(valid, np.arange(9), -1)
    slots = np.maximum.accumulate(slots, axis=1)
    slots = np.where(slots < 0, slots[:, -1:], slots)
    return np.take_along_axis(points, slots[..., None], axis=1)[..., :2]


def outline_segments(solid: Solid, height: float) -> FloatArray:
    """Return the outline of a solid's cut at one height [m], as segments (x0, y0, x1, y1) [m], shape (N, 4).

    For shapes with straight edges; spheres and upright cylinders are discs, see `slab_section`.
    """
    if isinstance(solid.shape, Mesh):
        return _mesh_segments(solid.pose.transform_points(solid.shape.vertices), solid.shape.faces, height)
    section = slab_section(solid, height, height)
    if not isinstance(section, Polygon):
        return np.empty((0, 4))
    return np.hstack([section.corners, np.roll(section.corners, -1, axis=0)])


def _polyhedron(shape: Box | Cylinder | Mesh) -> tuple[FloatArray, IndexArray]:
    """Return corners (N, 3) in the shape's frame and edges (M, 2) as pairs of their indices."""
    match shape:
        case Box(size):
            signs = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)]) - 0.5
            edges = [(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit]
            return signs * np.asarray(size), np.array(edges)
        case Cylinder(radius, length):
            angles = np.arange(_SIDES) * (2.0 * np.pi / _SIDES)
            ring = np.c_[radius * np.cos(angles), radius * np.sin(angles)]
            corners = np.vstack([np.c_[ring, np.full(_SIDES, sign * length / 2.0)] for sign in (-1.0, 1.0)])
            index = np.arange(_SIDES)
            around = np.c_[index, np.roll(index, -1)]
            return corners, np.vstack([around, around + _SIDES, np.c_[index, index + _SIDES]])
        case Mesh(vertices, faces):
            return vertices, mesh_edges(faces)


def _cut(points: FloatArray, edges: IndexArray, low: float, high: float) -> Polygon | None:
    heights = points[:, 2]
    kept = [points[(heights >= low) & (heights <= high), :2]]
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    for plane in {low, high}:
        above, below = start[:, 2] - plane, end[:, 2] - plane
        crossing = above * below < 0.0
        along = (above[crossing] / (above[crossing] - below[crossing]))[:, None]
        kept.append(start[crossing, :2] + along * (end[crossing, :2] - start[crossing, :2]))
    hull = convex_hull(np.vstack(kept))
    return Polygon(hull) if len(hull) >= 3 else None


def _mesh_segments(points: FloatArray, faces: IndexArray, height: float) -> FloatArray:
    """Return where triangles meet a plane. A corner in the plane counts as above, so that none is found twice."""
    corners = points[faces]
    above = corners[:, :, 2] >= height
    mixed = above.any(axis=1) & ~above.all(axis=1)
    corners, above = corners[mixed], above[mixed]
    segments = np.empty((len(corners), 2, 2))
    found = np.zeros(len(corners), dtype=int)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        crosses = np.flatnonzero(above[:, first] != above[:, second])
        a, b = corners[crosses, first], corners[crosses, second]
        along = ((height - a[:, 2]) / (b[:, 2] - a[:, 2]))[:, None]
        segments[crosses, found[crosses]] = a[:, :2] + along * (b[:, :2] - a[:, :2])
        found[crosses] += 1
    return segments.reshape(-1, 4)
