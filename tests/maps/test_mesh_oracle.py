"""The raster of closed meshes against manifold3d on random scenes, concave ones included: 0 missed, 0 extra.

manifold3d makes the bodies and cuts them to the band; shapely tells which cells, made smaller by 1 µm, what is left
meets from above. Cells within 10 nm of that decision are left out and counted.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from manifold3d import CrossSection, Manifold

from trundle.geometry import Pose3D
from trundle.maps.rasterise import DEPTH, HeightBand, SolidRaster
from trundle.solids import Mesh, Solid

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


def check(cells: np.ndarray, parts: np.ndarray) -> int:
    """Compare; return how many cells are left out."""
    surely, maybe = reached(parts, DEPTH + CLOSE), reached(parts, DEPTH - CLOSE)
    assert not (surely & ~cells).any(), f"missed {np.argwhere(surely & ~cells)}"
    assert not (cells & ~maybe).any(), f"extra {np.argwhere(cells & ~maybe)}"
    return int((maybe & ~surely).sum())


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


@pytest.mark.parametrize("seed", range(40))
def test_concave_bodies_are_solid(seed):
    generator = np.random.default_rng(seed)
    solids, parts = [], []
    for number in range(3):
        body, pose = random_body(generator), random_pose(generator)
        solids.append(Solid(str(number), mesh_of(body), pose))
        parts.append(seen_from_above(body, pose))
    assert check(raster(*solids), np.concatenate(parts)) <= 1


@pytest.mark.parametrize("seed", range(15))
def test_overlapping_shells_of_one_mesh_are_one_body(seed):
    generator = np.random.default_rng(100 + seed)
    bodies = [random_body(generator).translate(generator.uniform(-0.4, 0.4, 3)) for _ in range(3)]
    pose = random_pose(generator)
    cells = raster(Solid("shells", mesh_of(*bodies), pose))
    assert check(cells, np.concatenate([seen_from_above(body, pose) for body in bodies])) <= 1


@pytest.mark.parametrize("seed", range(15))
def test_a_hollow_body_is_empty_inside(seed):
    generator = np.random.default_rng(200 + seed)
    outer = Manifold.cube(generator.uniform(1.0, 2.0, 3), center=True)
    inner = Manifold.cube(np.array(outer.bounding_box()[3:]) * 2 - generator.uniform(0.02, 0.3, 3), center=True)
    pose = Pose3D.planar(*generator.uniform(-0.2, 0.2, 2), 0.4, generator.uniform(-3, 3))
    furniture = Manifold.sphere(0.2, 24)
    mesh = joined(mesh_of(outer), flipped(mesh_of(inner)), mesh_of(furniture))
    parts = np.concatenate([seen_from_above(outer - inner, pose), seen_from_above(furniture, pose)])
    cells = raster(Solid("room", mesh, pose))
    assert check(cells, parts) <= 1
    assert not cells.all()


@pytest.mark.parametrize("seed", range(10))
def test_centres_inside_bodies(seed):
    generator = np.random.default_rng(300 + seed)
    body, pose = random_body(generator), random_pose(generator)
    rows, cols = np.indices(SHAPE)
    centres = shapely.points(ORIGIN[0] + (cols + 0.5) * RESOLUTION, ORIGIN[1] + (rows + 0.5) * RESOLUTION)
    tree = shapely.STRtree(seen_from_above(body, pose))
    surely, maybe = np.zeros(centres.size, dtype=bool), np.zeros(centres.size, dtype=bool)
    surely[tree.query(centres.ravel(), predicate="intersects")[0]] = True
    maybe[tree.query(centres.ravel(), predicate="dwithin", distance=3e-6)[0]] = True
    cells = raster(Solid("body", mesh_of(body), pose), centre=True).ravel()
    far = surely == maybe  # Within 3 µm of the outline, anything goes.
    assert np.array_equal(cells & far, surely & far)
    assert far.mean() > 0.99


def test_the_order_of_faces_and_of_solids_does_not_matter():
    generator = np.random.default_rng(5)
    solids = [Solid(str(i), mesh_of(random_body(generator)), random_pose(generator)) for i in range(5)]
    first = raster(*solids)
    assert np.array_equal(first, raster(*solids[::-1]))
    shuffled = [
        Solid(solid.name, Mesh(solid.shape.vertices, generator.permutation(solid.shape.faces)), solid.pose)
        for solid in solids
    ]
    assert np.array_equal(first, raster(*shuffled))


def test_a_body_larger_than_the_grid_fills_it():
    assert raster(Solid("all", mesh_of(Manifold.cube((9, 9, 9), center=True)), Pose3D((0.5, 0.2, 0.3)))).all()
    ring = Manifold.cube((9, 9, 9), center=True) - Manifold.cube((8, 8, 10), center=True)
    assert not raster(Solid("around", mesh_of(ring), Pose3D())).any()


@pytest.mark.parametrize("turn", [0.0, math.pi / 2, 1.0])
def test_a_mesh_of_a_grid_aligned_box_has_the_cells_of_the_box(turn):
    pose = Pose3D.planar(ORIGIN[0] + 1.25, ORIGIN[1] + 1.25, 0.4, turn)
    cells = raster(Solid("box", mesh_of(Manifold.cube((1, 1, 1), center=True)), pose))
    assert turn == 1.0 or cells.sum() == 400
