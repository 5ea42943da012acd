"""Solids as cells: bodies by manifold3d and by plain cuts, cells by shapely; over a level floor as without one."""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable
from typing import Any

import numpy as np
import shapely
from manifold3d import Manifold

from fuzz.loop import NUMBERS, attempt, rng_of, spoil
from support import mesh_oracle, raster_oracle
from support.raster_oracle import RESOLUTION, check, cut_hull, prism, random_pose, raster
from trundle import _core
from trundle.geometry.solids import Box, Cylinder, Mesh, Solid, Sphere


def check_boxes(generator: random.Random) -> None:
    rng = rng_of(generator)
    size = tuple(np.exp(rng.uniform(math.log(0.002), math.log(2.0), 3)).tolist())
    solid = Solid("box", Box(size), random_pose(rng, upright=generator.random() < 0.5))
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size
    assert (
        check(
            raster([solid]), cut_hull(solid.pose.transform_points(corners), list(itertools.combinations(range(8), 2)))
        )
        <= 2
    )


def check_cylinders(generator: random.Random) -> None:
    rng = rng_of(generator)
    pose = random_pose(rng)
    cylinder = Cylinder(*np.exp(rng.uniform(math.log(0.02), math.log(0.8), 2)).tolist())
    inside, outside = prism(cylinder, pose, 2_000, 1.0), prism(cylinder, pose, 2_000, 1.0 / math.cos(math.pi / 2_000))
    assert check(raster([Solid("cylinder", cylinder, pose)]), inside, outside) <= 8


def check_discs(generator: random.Random) -> None:
    rng = rng_of(generator)
    pose, radius = random_pose(rng, upright=True), float(np.exp(rng.uniform(math.log(0.005), math.log(1.0))))
    off = max(raster_oracle.BAND.inner_low - pose.position[2], pose.position[2] - raster_oracle.BAND.inner_high, 0.0)
    disc = math.sqrt(max(0.0, radius**2 - off**2))
    distance = shapely.distance(raster_oracle.cell_boxes(raster_oracle.DEPTH), shapely.Point(*pose.position[:2]))
    sure = np.abs(distance - disc) > raster_oracle.CLOSE
    found = raster([Solid("sphere", Sphere(radius), pose)])
    assert np.array_equal(found[sure], ((off < radius) & (distance < disc))[sure])


def make_body(rng: np.random.Generator) -> Manifold:
    """A body of which the others taken out of it left something."""
    body = mesh_oracle.random_body(rng)
    while body.is_empty():
        body = mesh_oracle.random_body(rng)
    return body


def check_meshes(generator: random.Random) -> None:
    rng = rng_of(generator)
    body, pose = make_body(rng), mesh_oracle.random_pose(rng)
    found = mesh_oracle.compare(
        mesh_oracle.raster(Solid("body", mesh_oracle.mesh_of(body), pose)), mesh_oracle.seen_from_above(body, pose)
    )
    assert (found.missed, found.extra) == (0, 0)


def make_arguments(generator: random.Random) -> tuple[tuple[Any, ...], tuple[Any, ...], tuple[float, ...]]:
    """Cells, a mesh of any triangles or of a body in place, and heights, resolution and depth."""
    rng = rng_of(generator)
    cells = np.full((generator.choice((1, 5, 30)), generator.choice((1, 7, 40))), -1, dtype=np.int8)
    if generator.random() < 0.5:
        mesh: Mesh = mesh_oracle.mesh_of(make_body(rng))
    else:
        vertices = rng.uniform(-1, 1, (generator.choice((3, 9)), 3)) * generator.choice((1e-6, 1.0, 100.0))
        mesh = Mesh(np.round(vertices, generator.choice((1, 12))), rng.integers(0, len(vertices), (4, 3)))
    pose = mesh_oracle.random_pose(rng)
    transform = np.column_stack([pose.rotation(), pose.position])
    return (cells,), (mesh.vertices, mesh.faces, transform), (0.1, 0.6, generator.choice((0.05, 0.5)), 1e-6)


def level_floor(cells: np.ndarray, resolution: float) -> np.ndarray:
    heights = np.zeros((2, 2))
    size = float(max(cells.shape) + 2)
    return _core.floor_planes(heights, size, -1.0, -1.0, resolution, *cells.shape)


def check_level_floor(generator: random.Random) -> None:
    """Over a level floor at height 0 a mesh has the cells that it has without one."""
    (cells,), mesh, band = make_arguments(generator)
    centre = generator.random() < 0.3
    over, planes = cells.copy(), level_floor(cells, band[2])
    closed, _, _ = _core.raster_mesh(cells, *mesh, *band, centre, True)
    closed_over, _, _ = _core.raster_mesh_over_floor(over, planes, *mesh, *band, centre)
    assert closed_over == closed
    # A corner of a face may lie on a cell's edge to the last bit, or a face in the plane of a height.
    assert (over != cells).sum() <= 2


def call_hostile(generator: random.Random) -> None:
    """Every kernel, with one argument spoiled: marked or refused."""
    (cells,), mesh, band = make_arguments(generator)
    rng, centre = rng_of(generator), generator.random() < 0.3
    planes = level_floor(cells, band[2])
    if generator.random() < 0.5:
        planes = planes + rng.normal(0.0, generator.choice((0.0, 0.1, 1e3)), planes.shape)
    cylinders = np.column_stack(
        [rng.uniform(-1, 1, (2, 3)), [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]], rng.uniform(0.05, 1, (2, 2))]
    )
    thin = (mesh[0], mesh[1][:2].copy(), mesh[2])
    calls: tuple[tuple[Callable[..., Any], tuple[Any, ...]], ...] = (
        (_core.raster_mesh, (cells, *mesh, *band, centre, True)),
        (_core.raster_thin_faces, (cells, *thin, *band)),
        (_core.raster_mesh_over_floor, (cells, planes, *mesh, *band, centre)),
        (_core.raster_thin_faces_over_floor, (cells, planes, *thin, *band)),
        (_core.raster_hexahedra, (cells, rng.uniform(-1, 3, (3, 8, 3)), *band, centre)),
        (_core.raster_discs, (cells, rng.uniform(-1, 3, (3, 3)), *band[2:], centre)),
        (_core.raster_cylinders, (cells, cylinders, *band, centre)),
        (_core.floor_planes, (rng.uniform(-1, 1, (4, 5)), 3.0, 0.5, -0.5, RESOLUTION, 6, 7)),
    )
    function, arguments = generator.choice(calls)
    numbers = (
        NUMBERS if function is not _core.floor_planes else (0, -1, 1e-300, 1e300, math.nan, math.inf, 2**62, None, "1")
    )
    attempt(function, spoil(generator, arguments, numbers))


def one_round(generator: random.Random) -> None:
    checks = (check_boxes, check_cylinders, check_discs, check_meshes, check_level_floor)
    generator.choice((*checks, *[call_hostile] * 5))(generator)
