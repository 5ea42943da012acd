"""The raster of closed meshes against manifold3d on random scenes, concave ones included: 0 missed, 0 extra."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from manifold3d import Manifold

from support.mesh_oracle import (
    ORIGIN,
    RESOLUTION,
    SHAPE,
    compare,
    flipped,
    joined,
    mesh_of,
    random_body,
    random_pose,
    raster,
    seen_from_above,
)
from trundle.geometry import Pose3D
from trundle.geometry.solids import Mesh, Solid


def check(cells: np.ndarray, parts: np.ndarray) -> int:
    """Nothing is missed and nothing extra; return how many cells are left out."""
    found = compare(cells, parts)
    assert (found.missed, found.extra) == (0, 0)
    return found.left_out


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
