"""What the raster of solids is held against: bodies by manifold3d, cells by shapely.

manifold3d makes the bodies and cuts them to the band; shapely tells which cells, made smaller by 1 µm, what is left
meets from above. Cells within 10 nm of that decision are left out and counted.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import shapely
from manifold3d import CrossSection, Manifold

from trundle.geometry import Pose3D
from trundle.geometry.solids import Mesh, Solid
from trundle.maps.rasterise import DEPTH, HeightBand, SolidRaster

RESOLUTION = 0.05
ORIGIN = (-1.313, -1.287)
SHAPE = (52, 54)
BAND = HeightBand(0.1, 0.62)
CLOSE = 1e-8


def mesh_of(*bodies: Manifold) -> Mesh:
    """One mesh of one or more shells, with a vertex for each corner of each face."""
    parts = [body.to_mesh64() for body in bodies]
    corners = np.concatenate([part.vert_properties[:, :3][part.tri_verts.astype(int)] for part in parts])
    return Mesh(corners.reshape(-1, 3), np.arange(corners.size // 3).reshape(-1, 3))


def flipped(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes)])
    faces = [mesh.faces + start for mesh, start in zip(meshes, starts[:-1], strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def raster(*solids: Solid, centre: bool = False) -> np.ndarray:
    cells = np.full(SHAPE, -1, dtype=np.int8)
    marked = SolidRaster(cells, RESOLUTION, ORIGIN, BAND, centre=centre)
    marked.add(solids)
    assert marked.open_meshes == []
    assert set(np.unique(cells)) <= {-1, 100}
    return cells == 100


def seen_from_above(body: Manifold, pose: Pose3D) -> np.ndarray:
    """Triangles, seen from above, that cover the part of a body in the band."""
    transform = np.column_stack([pose.rotation(), pose.position])
    part = body.transform(transform).trim_by_plane((0, 0, 1), BAND.inner_low)
    cut = part.trim_by_plane((0, 0, -1), -BAND.inner_high).to_mesh64()
    return shapely.polygons(cut.vert_properties[:, :2][cut.tri_verts.astype(int)])


def reached(parts: np.ndarray, shrink: float) -> np.ndarray:
    rows, cols = np.indices(SHAPE)
    x, y = ORIGIN[0] + cols * RESOLUTION, ORIGIN[1] + rows * RESOLUTION
    boxes = shapely.box(x + shrink, y + shrink, x + RESOLUTION - shrink, y + RESOLUTION - shrink)
    found = np.zeros(boxes.size, dtype=bool)
    if len(parts):
        found[np.unique(shapely.STRtree(parts).query(boxes.ravel(), predicate="intersects")[0])] = True
    return found.reshape(SHAPE)


class Comparison(NamedTuple):
    """Numbers of cells: missed by the raster, extra in it, and left out as too near to a decision."""

    missed: int
    extra: int
    left_out: int


def compare(cells: np.ndarray, parts: np.ndarray, outer: np.ndarray | None = None) -> Comparison:
    """Compare with the parts that bodies are seen as; with `outer`, those are inside the true, these outside."""
    surely, maybe = reached(parts, DEPTH + CLOSE), reached(parts if outer is None else outer, DEPTH - CLOSE)
    return Comparison(*(int(found.sum()) for found in (surely & ~cells, cells & ~maybe, maybe & ~surely)))


def random_body(generator: np.random.Generator) -> Manifold:
    """A concave body of about 1 m: rings, angles and boxes with bites taken out of them."""
    kind = generator.integers(4)
    if kind == 0:
        ring = CrossSection.circle(generator.uniform(0.03, 0.15), 12).translate((generator.uniform(0.3, 0.7), 0.0))
        return ring.revolve(int(generator.integers(5, 40)))
    if kind == 1:
        t = generator.uniform(0.01, 0.2)
        angle = [(0, 0), (1, 0), (1, t), (t, t), (t, 0.8), (0, 0.8)]
        return CrossSection([angle]).extrude(generator.uniform(0.05, 1.0)).translate((-0.4, -0.4, -0.3))
    body = Manifold.cube(generator.uniform(0.05, 1.2, 3), center=True)
    for _ in range(3):
        place = generator.uniform(-0.5, 0.5, 3)
        other = Manifold.sphere(generator.uniform(0.1, 0.5), 16).translate(place)
        body = body - other if kind == 2 else body + other
    return body


def random_pose(generator: np.random.Generator) -> Pose3D:
    position = (*generator.uniform(-1.0, 1.0, 2), generator.uniform(-0.3, 1.0))
    return Pose3D(position, tuple(generator.normal(size=4)))
