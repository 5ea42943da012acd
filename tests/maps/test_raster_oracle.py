"""The raster against shapely on random scenes: 0 missed, 0 extra.

The oracle cuts each solid by another method (all pairs of corners, fine prisms for cylinders) and asks shapely which
cells, made smaller by 1 µm, it meets. Cells within 1 nm of that decision are left out and counted (for tilted
cylinders: those between a prism inside and one outside of the cylinder).
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import shapely

from support.raster_oracle import (
    BAND,
    CLOSE,
    ORIGIN,
    RESOLUTION,
    SHAPE,
    cell_boxes,
    check,
    cut_hull,
    prism,
    random_pose,
    raster,
    reached,
)
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere
from trundle.maps.rasterise import DEPTH


@pytest.mark.parametrize("seed", range(60))
def test_boxes_at_any_orientation(seed):
    generator = np.random.default_rng(seed)
    solids, parts = [], []
    for number in range(4):
        size = tuple(np.exp(generator.uniform(math.log(0.002), math.log(1.5), 3)))
        solid = Solid(str(number), Box(size), random_pose(generator, upright=number % 2 == 0))
        corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size
        solids.append(solid)
        parts.append(cut_hull(solid.pose.transform_points(corners), list(itertools.combinations(range(8), 2))))
    assert check(raster(solids), shapely.union_all(parts)) <= 1


@pytest.mark.parametrize("seed", range(20))
def test_centres_of_boxes(seed):
    generator = np.random.default_rng(seed)
    size = tuple(generator.uniform(0.05, 1.0, 3))
    solid = Solid("box", Box(size), random_pose(generator))
    corners = solid.pose.transform_points(np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size)
    shape = cut_hull(corners, list(itertools.combinations(range(8), 2)))
    rows, cols = np.indices(SHAPE)
    centres = shapely.points(ORIGIN[0] + (cols + 0.5) * RESOLUTION, ORIGIN[1] + (rows + 0.5) * RESOLUTION)
    far = ~(shapely.distance(shapely.boundary(shape), centres) < 1e-5)  # There is no distance to an empty shape.
    inside = shapely.contains(shape, centres)
    assert np.array_equal(raster([solid], centre=True) & far, inside & far)
    assert far.mean() > 0.99


@pytest.mark.parametrize("seed", range(20))
def test_discs_of_cylinders_and_spheres(seed):
    generator = np.random.default_rng(seed)
    for number in range(4):
        pose = random_pose(generator, upright=True)
        radius = float(np.exp(generator.uniform(math.log(0.005), math.log(1.0))))
        x, y, z = pose.position
        off = max(BAND.low + DEPTH - z, z - BAND.high + DEPTH, 0.0)
        if number % 2:
            solid, there, disc = Solid("a", Sphere(radius), pose), off < radius, math.sqrt(max(0.0, radius**2 - off**2))
        else:
            solid, there, disc = Solid("a", Cylinder(radius, 0.8), pose), off < 0.4, radius
        boxes = cell_boxes(DEPTH)
        distance = shapely.distance(boxes, shapely.Point(x, y))
        assert not there or np.abs(distance - disc).min() > CLOSE
        assert np.array_equal(raster([solid]), there & (distance < disc))


@pytest.mark.parametrize("seed", range(16))
def test_tilted_cylinders(seed):
    generator = np.random.default_rng(seed)
    pose = random_pose(generator)
    if seed % 4 == 0:  # Nearly upright or nearly lying: the sections become long.
        tilt = float(10.0 ** generator.uniform(-8, -1)) + (math.pi / 2 if seed % 8 else 0.0)
        pose = Pose3D(pose.position, (math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0))
    cylinder = Cylinder(*np.exp(generator.uniform(math.log(0.02), math.log(0.8), 2)).tolist())
    corners = 5_000
    inside = prism(cylinder, pose, corners, 1.0)
    outside = prism(cylinder, pose, corners, 1.0 / math.cos(math.pi / corners))
    assert check(raster([Solid("a", cylinder, pose)]), inside, outside) <= 3


@pytest.mark.parametrize("seed", range(12))
def test_centres_inside_tilted_cylinders(seed):
    generator = np.random.default_rng(seed)
    pose = random_pose(generator)
    cylinder = Cylinder(*np.exp(generator.uniform(math.log(0.05), math.log(0.8), 2)).tolist())
    shape = prism(cylinder, pose, 5_000, 1.0)
    rows, cols = np.indices(SHAPE)
    centres = shapely.points(ORIGIN[0] + (cols + 0.5) * RESOLUTION, ORIGIN[1] + (rows + 0.5) * RESOLUTION)
    far = ~(shapely.distance(shapely.boundary(shape), centres) < 1e-5)
    cells = raster([Solid("a", cylinder, pose)], centre=True)
    assert np.array_equal(cells & far, shapely.contains(shape, centres) & far)


@pytest.mark.parametrize("turn", [0.0, math.pi / 2])
@pytest.mark.parametrize("grown", [-2e-6, 0.0, 2e-6])
def test_a_lying_cylinder_along_the_cells_has_those_of_its_bounding_box(turn, grown):
    # Its outline runs along the edges of cells: no coarser outline can tell which are reached.
    place = (ORIGIN[0] + 20 * RESOLUTION, ORIGIN[1] + 20 * RESOLUTION, 0.36)
    lying = Pose3D(place, (math.cos(turn / 2) / math.sqrt(2), *_lying_axis(turn)))
    cylinder = Cylinder(4 * RESOLUTION + grown, 20 * RESOLUTION + 2 * grown)
    cells = raster([Solid("a", cylinder, lying)])
    box = Box((cylinder.length, 2 * cylinder.radius, 0.5))
    assert np.array_equal(cells, raster([Solid("b", box, Pose3D.planar(*place, turn))]))
    assert cells.sum() == (10 * 22 if grown > 1e-6 else 8 * 20)


def _lying_axis(turn: float) -> tuple[float, float, float]:
    """Of the quaternion that lays z along x, then turns it about z: its x, y and z."""
    c, s = math.cos(turn / 2) / math.sqrt(2), math.sin(turn / 2) / math.sqrt(2)
    return (-s, c, s)


@pytest.mark.parametrize("seed", range(20))
def test_triangles_count_where_they_touch(seed):
    generator = np.random.default_rng(seed)
    vertices = generator.uniform((-1.2, -1.2, -0.3), (1.2, 1.2, 1.0), (12, 3))
    vertices[3:6, 2] = 0.3  # A flat one.
    vertices[6:9, 0] = 0.5 * vertices[6:9, 1]  # An upright one.
    faces = np.arange(12).reshape(-1, 3)
    pose = random_pose(generator, upright=True)
    placed = pose.transform_points(vertices)
    parts = [cut_hull(placed[face], [(0, 1), (1, 2), (2, 0)]) for face in faces]
    shape = shapely.GeometryCollection([part for part in parts if not part.is_empty])
    cells = raster([Solid("mesh", Mesh(vertices, faces), pose)])
    surely, maybe = reached(shape, CLOSE), reached(shapely.buffer(shape, 3 * CLOSE), 0.0)
    assert not (surely & ~cells).any()
    assert not (cells & ~maybe).any()


def test_many_large_faces_have_the_cells_of_each_alone():
    # Where many lie over each other, those in full places are passed over.
    generator = np.random.default_rng(0)
    vertices = generator.uniform((-1.2, -1.2, 0.2), (0.3, 0.9, 0.5), (1_200, 3, 3))
    vertices[::2, :, 0] = 0.8 + 0.1 * vertices[::2, :, 1]  # Half of them upright, in one slanted wall.
    faces = np.arange(3_600).reshape(-1, 3)
    together = raster([Solid("all", Mesh(vertices.reshape(-1, 3), faces), Pose3D())])
    alone = raster([Solid(str(i), Mesh(corners, [(0, 1, 2)]), Pose3D()) for i, corners in enumerate(vertices)])
    assert np.array_equal(together, alone)
    assert 0.3 < together.mean() < 0.9
