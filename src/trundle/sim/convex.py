"""Meshes as convex pieces, for engines that collide only convex bodies.

A mesh is split into its connected parts. Then

- a part that is closed and convex is one piece, its hull;
- any other part, concave or open (a room, a bowl, a sheet), becomes plates: every triangle is one, 1 mm thick, behind
  its face. The surface is then exact from the front, 1 mm out from the back, and nothing is filled that is hollow;
- where that would be more than `MOST_PLATES`, or `MOST_TOGETHER` in a world, the other parts of the meshes with most
  triangles become boxes instead: they are cut into layers of `LAYER`, each is rasterised as a map is, and the cells are
  merged. The boxes enclose the mesh and are up to a cell larger; a warning names it, with both volumes.

Parts above the given ceiling (out of the robot's reach), or that end at the floor, are left out. A log line of level
INFO says which meshes became plates.
"""

from __future__ import annotations

import logging
import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldWarning
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Mesh, Solid
from trundle.maps.rasterise import HeightBand, SolidRaster
from trundle.values import first_names
from trundle.worlds.walls import merge_cells

logger = logging.getLogger(__name__)

MOST_PLATES = 2_000
"""Limit for one mesh."""

MOST_TOGETHER = 10_000
"""Limit on the plates of a world: MuJoCo runs 8,200 steps/s with this many geoms, and 1,000 with nine times that."""

MOST_BOXES = 4_000
"""Limit for one mesh; cells are enlarged to stay within it."""

THICKNESS = 1e-3
"""Thickness of a plate [m]."""

LAYER = 0.1
"""Height of the boxes [m]."""

CELL = 0.05
"""Smallest edge of the boxes' cells [m]."""

FLOOR_TOP = 1e-3
"""Parts that reach no higher than this [m] are floor, not obstacles."""

_FLAT = 1e-4
"""How far [m] corners of a convex part may stick out of its faces, and how thin a triangle may be."""

_MOST_TESTS = 8_000_000
_MOST_CELLS = 2_000_000

IntArray = npt.NDArray[np.int64]

_PRISM_EDGES: IntArray = np.array([(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)])
_BOX_CORNERS: IntArray = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
_BOX_EDGES: IntArray = np.array([(i, i | bit) for i in range(8) for bit in (1, 2, 4) if not i & bit])


class Piece(NamedTuple):
    """A convex body: the hull of its corners.

    Attributes:
        corners: [m], map frame, shape (N, 3), N ≥ 4.
        edges: Pairs of corners, all edges of the hull among them, shape (M, 2).
    """

    corners: FloatArray
    edges: IntArray


@dataclass(frozen=True, slots=True)
class Pieces:
    """A mesh as convex pieces.

    Attributes:
        hulls: The pieces.
        boxes: Number of pieces, at the end, that are upright boxes around the original parts.
        whole: Whether the mesh is convex, and its hull the one piece.
    """

    hulls: list[Piece]
    boxes: int = 0
    whole: bool = False


@dataclass(frozen=True, slots=True)
class _Parts:
    """A welded mesh: the hulls of its convex parts, and the faces of all others."""

    points: FloatArray
    hulls: list[Piece]
    faces: IntArray


def take_apart(solids: Iterable[Solid], *, ceiling: float) -> dict[str, Pieces]:
    """Split the meshes among solids into convex pieces; see the module's docstring.

    Args:
        solids: Solids of a world.
        ceiling: Height [m] above which nothing counts.

    Returns:
        Pieces by the solid's name; nothing for a solid that is not a mesh.

    Warns:
        WorldWarning: If meshes become boxes.
    """
    found = {solid.name: _split(solid, solid.shape, ceiling) for solid in solids if isinstance(solid.shape, Mesh)}
    exact: set[str] = set()
    plates = 0
    for name, parts in sorted(found.items(), key=lambda item: len(item[1].faces)):
        plates += len(parts.faces)
        if len(parts.faces) <= MOST_PLATES and plates <= MOST_TOGETHER:
            exact.add(name)
    _log_plates({name: len(found[name].faces) for name in exact})
    pieces: dict[str, Pieces] = {}
    for name, parts in found.items():
        if name in exact:
            hulls = _in_reach(parts.hulls + _plates(parts.points, parts.faces), ceiling)
            whole = len(parts.faces) == 0 and len(parts.hulls) == 1 and len(hulls) == 1
            pieces[name] = Pieces(hulls, whole=whole)
            continue
        boxes, cell = _layered_boxes(parts.points, parts.faces, ceiling)
        warnings.warn(
            f"the mesh {name!r} is not convex and has {len(parts.faces)} triangles: it collides as {len(boxes)} boxes "
            f"of cells of {cell:.3g} m, which hold {_boxes_volume(boxes):.3g} m³; its faces enclose "
            f"{abs(_volume(parts.points, parts.faces)):.3g} m³. Its map and lidar scans are exact; a mesh of fewer "
            "triangles, or of convex parts, collides exactly too",
            WorldWarning,
            stacklevel=2,
        )
        pieces[name] = Pieces(_in_reach(parts.hulls, ceiling) + boxes, boxes=len(boxes))
    return pieces


def _log_plates(plates: dict[str, int]) -> None:
    concave = sorted(name for name, count in plates.items() if count)
    if concave:
        logger.info(
            "meshes that are not convex collide as they are, each triangle a plate of %g mm: %s, %d plates in all",
            1e3 * THICKNESS,
            first_names([repr(name) for name in concave], 3),
            sum(plates.values()),
        )


def _split(solid: Solid, mesh: Mesh, ceiling: float) -> _Parts:
    points, faces = _weld(solid.pose.transform_points(mesh.vertices), mesh.faces)
    hulls: list[Piece] = []
    rest: list[IntArray] = [np.zeros((0, 3), dtype=np.int64)]
    for part in _connected(faces, len(points)):
        corners = _sort_distinct(part)
        if _is_convex(points, part, corners):
            hulls.append(Piece(points[corners], np.searchsorted(corners, mesh_edges(part))))
        else:
            rest.append(part)
    others = np.vstack(rest)
    heights = points[:, 2][others]
    reached = (heights.min(axis=1) < ceiling) & (heights.max(axis=1) > FLOOR_TOP)
    return _Parts(points, hulls, others[reached])


def _in_reach(hulls: list[Piece], ceiling: float) -> list[Piece]:
    return [hull for hull in hulls if hull.corners[:, 2].min() < ceiling and hull.corners[:, 2].max() > FLOOR_TOP]


def _boxes_volume(boxes: list[Piece]) -> float:
    return float(sum(np.prod(np.ptp(box.corners, axis=0)) for box in boxes))


def _volume(points: FloatArray, faces: npt.NDArray[np.integer]) -> float:
    """Return the volume [m³] of a mesh that is closed and whose faces point outwards."""
    a, b, c = (points[faces[:, corner]] - points.mean(axis=0) for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def _weld(points: FloatArray, faces: npt.NDArray[np.integer]) -> tuple[FloatArray, IntArray]:
    """Merge equal vertices, and drop triangles that collapse to lines."""
    places, index = np.unique(points, axis=0, return_inverse=True)
    joined = index.reshape(-1)[faces].astype(np.int64)
    whole = (joined[:, 0] != joined[:, 1]) & (joined[:, 1] != joined[:, 2]) & (joined[:, 2] != joined[:, 0])
    return places, joined[whole]


def mesh_edges(faces: npt.NDArray[np.integer]) -> IntArray:
    """Return edges of triangles as pairs of their corners, each once and sorted, shape (N, 2)."""
    ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64), axis=1)
    base = int(ends.max()) + 1
    keys = _sort_distinct(ends[:, 0] * base + ends[:, 1])
    return np.column_stack([keys // base, keys % base])


def _sort_distinct(numbers: IntArray) -> IntArray:
    """Return each number once, sorted; np.unique would import numpy.ma on its first call, 15 to 40 ms."""
    ordered = np.sort(numbers, axis=None)
    return ordered[np.concatenate([[True], ordered[1:] != ordered[:-1]])]


def _connected(faces: IntArray, count: int) -> list[IntArray]:
    """Return the faces of each part that is connected by its vertices."""
    if len(faces) == 0:
        return []
    label = np.arange(count)
    while True:
        least = label[faces].min(axis=1)
        before = label.copy()
        for corner in range(3):
            np.minimum.at(label, faces[:, corner], least)
        label = label[label]
        if np.array_equal(label, before):
            break
    of_face = label[faces[:, 0]]
    order = np.argsort(of_face, kind="stable")
    starts = np.flatnonzero(np.diff(of_face[order])) + 1
    return [faces[part] for part in np.split(order, starts)]


def _is_convex(points: FloatArray, faces: IntArray, corners: IntArray) -> bool:
    """Return whether a connected part is closed, has outward faces, and has no vertex in front of a face."""
    if len(corners) < 4:
        return False
    edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = edges[:, 0] * len(points) + edges[:, 1]
    turned = edges[:, 1] * len(points) + edges[:, 0]
    if len(_sort_distinct(keys)) != len(keys) or not np.array_equal(np.sort(keys), np.sort(turned)):
        return False
    triangles = points[faces]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    kept = lengths > 1e-12
    normals, anchors = normals[kept] / lengths[kept, None], triangles[kept, 0]
    # Tests every face against every vertex; for a large part only a sample of the faces.
    stride = max(1, math.ceil(len(normals) * len(corners) / _MOST_TESTS))
    cloud = points[corners]
    allowed = max(_FLAT, 1e-5 * float(np.ptp(cloud, axis=0).max()))
    for start in range(0, len(normals), 256 * stride):
        chosen = slice(start, start + 256 * stride, stride)
        reach = normals[chosen] @ cloud.T - (normals[chosen] * anchors[chosen]).sum(axis=1)[:, None]
        if float(reach.max()) > allowed:
            return False
    return _volume(points, faces) > 0.0


def _plates(points: FloatArray, faces: IntArray) -> list[Piece]:
    triangles = points[faces]
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    doubled = np.linalg.norm(normals, axis=1)
    longest = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    kept = doubled > _FLAT * longest
    triangles, normals = triangles[kept], normals[kept] / doubled[kept, None]
    prisms = np.concatenate([triangles, triangles - THICKNESS * normals[:, None, :]], axis=1)
    return [Piece(prism, _PRISM_EDGES) for prism in prisms]


def _layered_boxes(points: FloatArray, faces: IntArray, ceiling: float) -> tuple[list[Piece], float]:
    used, index = np.unique(faces, return_inverse=True)
    solid = Solid("part", Mesh(points[used], index.reshape(-1, 3).astype(np.int32)), Pose3D())
    low, high = solid.bounds()
    top = min(float(high[2]), ceiling)
    heights = np.arange(max(0.0, math.floor(float(low[2]) / LAYER) * LAYER), top, LAYER)
    extent = high[:2] - low[:2]
    cell = max(CELL, math.sqrt(float(np.prod(extent + CELL)) / _MOST_CELLS))
    while True:
        boxes = [box for height in heights.tolist() for box in _layer(solid, height, cell, low, extent)]
        if len(boxes) <= MOST_BOXES:
            return boxes, cell
        cell *= 1.5


def _layer(solid: Solid, height: float, cell: float, low: FloatArray, extent: FloatArray) -> list[Piece]:
    cols, rows = (math.ceil(float(edge) / cell) + 1 for edge in extent)
    cells = np.zeros((rows, cols), dtype=np.int8)
    SolidRaster(cells, cell, (float(low[0]), float(low[1])), HeightBand(height, height + LAYER)).add([solid])
    merged = merge_cells((cells > 0).astype(np.uint8), most=rows * cols)
    if merged is None:
        return []
    corners = np.stack(
        [
            np.stack([merged.col_begin, merged.row_begin, np.zeros_like(merged.row_begin)], axis=-1),
            np.stack([merged.col_end, merged.row_end, np.ones_like(merged.row_begin)], axis=-1),
        ],
        axis=1,
    ) * (cell, cell, LAYER) + (low[0], low[1], height)
    boxes = np.stack([corners[:, _BOX_CORNERS[:, axis], axis] for axis in range(3)], axis=-1)
    return [Piece(box, _BOX_EDGES) for box in boxes]
