"""Maps over floors that are not level.

The oracle is a shear: what stands on a plane ramp is the map over z = 0 of the same solids, as meshes, whose heights
are taken from the ramp's.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from support.mesh_oracle import mesh_of, random_body
from trundle._core import floor_planes
from trundle.errors import MapError, MapWarning
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import HeightField, OccupancyGrid
from trundle.worlds import World

FIELD = ((-2.0, -2.0), (2.0, 2.0))
AROUND = ((-3.0, -3.0), (3.0, 3.0))
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2.0
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
FACES = np.array([t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))])


def box_mesh(*size: float) -> Mesh:
    return Mesh(CUBE * size, FACES)


def plane(a: float, b: float, c: float, *, resolution: float = 0.25) -> HeightField:
    return HeightField.from_function(lambda x, y: a * x + b * y + c, AROUND, resolution=resolution)


def build(*solids: Solid, bounds=FIELD, **options) -> OccupancyGrid:
    return OccupancyGrid.from_world(World("scene", solids), bounds=bounds, **options)


def ramp(slope: float, *, length: float = 2.0, width: float = 1.0, x: float = -1.0) -> Solid:
    """A wedge whose top rises along x from z = 0 at `x`."""
    top = length * slope
    corners = [[0, -1, 0], [1, -1, 0], [1, 1, 0], [0, 1, 0], [1, -1, 1], [1, 1, 1]]
    faces = [[0, 2, 1], [0, 3, 2], [0, 1, 4], [3, 5, 2], [1, 2, 5], [1, 5, 4], [0, 4, 5], [0, 5, 3]]
    return Solid("ramp", Mesh(np.array(corners) * (length, width / 2.0, top) + (x, 0.0, 0.0), faces))


def random_scene(generator: np.random.Generator) -> tuple[list[Solid], list[Solid]]:
    """Boxes and concave meshes at any orientation; and again as meshes with their poses applied."""
    solids, meshes = [], []
    for index in range(6):
        pose = Pose3D((*generator.uniform(-1.5, 1.5, 2), generator.uniform(-1.0, 1.2)), tuple(generator.normal(size=4)))
        if index % 2:
            size = tuple(generator.uniform(0.01, 1.0, 3))
            shape, mesh = Box(size), box_mesh(*size)
        else:
            shape = mesh = mesh_of(random_body(generator))
        solids.append(Solid(str(index), shape, pose))
        # One row for each place: a corner that several faces have comes out the same for all of them.
        places, back = np.unique(mesh.vertices, axis=0, return_inverse=True)
        meshes.append(Solid(str(index), Mesh(pose.transform_points(places), back.ravel()[mesh.faces])))
    return solids, meshes


def sheared(solids: list[Solid], a: float, b: float, c: float) -> list[Solid]:
    moved = []
    for solid in solids:
        points = np.array(solid.shape.vertices)
        points[:, 2] -= a * points[:, 0] + b * points[:, 1] + c
        moved.append(Solid(solid.name, Mesh(points, solid.shape.faces)))
    return moved


@pytest.mark.parametrize("coverage", ["any", "centre"])
@pytest.mark.parametrize("seed", range(12))
def test_a_plane_ramp_is_as_exact_as_a_level_floor(seed, coverage):
    generator = np.random.default_rng(seed)
    solids, meshes = random_scene(generator)
    a, b, c = *generator.uniform(-0.5, 0.5, 2), generator.uniform(-1.0, 1.0)
    # A field whose samples lie nowhere near the cells' edges.
    floor = plane(a, b, c, resolution=generator.uniform(0.03, 0.7))
    found = build(*solids, floor=floor, max_slope=1.0, coverage=coverage, seeds=())
    expected = build(*sheared(meshes, a, b, c), coverage=coverage, seeds=())
    assert np.array_equal(found.data, expected.data)
    assert (found.data == 100).any()


@pytest.mark.parametrize("coverage", ["any", "centre"])
@pytest.mark.parametrize("seed", range(6))
def test_a_level_field_is_a_floor_at_that_height(seed, coverage):
    solids, _ = random_scene(np.random.default_rng(100 + seed))
    blocked = np.random.default_rng(seed).random((12, 9)) < 0.3
    solids.append(Solid("cells", OccupancyCells(blocked, 0.07, 0.9), Pose3D.planar(-1.0, 0.3, 0.0, 0.4)))
    found = build(*solids, floor=plane(0.0, 0.0, 0.3), coverage=coverage, seeds=())
    assert np.array_equal(found.data, build(*solids, floor_z=0.3, coverage=coverage, seeds=()).data)


@pytest.mark.parametrize("seed", range(6))
def test_round_solids_are_at_most_a_tenth_of_a_millimetre_too_large(seed):
    generator = np.random.default_rng(seed)
    near, true, wide = [], [], []
    for index in range(8):
        pose = Pose3D((*generator.uniform(-1.5, 1.5, 2), generator.uniform(-0.5, 1.2)), tuple(generator.normal(size=4)))
        radius, length = generator.uniform(0.05, 0.6, 2)
        for solids, more in ((near, 0.0), (true, 0.0), (wide, 1.01e-4)):
            shape = Sphere(radius + more) if index % 2 else Cylinder(radius + more, length)
            solids.append(Solid(str(index), shape, pose))
    found = build(*near, floor=plane(0.0, 0.0, 0.0), seeds=()).data == 100
    exact, larger = (build(*solids, seeds=()).data == 100 for solids in (true, wide))
    assert not (exact & ~found).any()
    assert not (found & ~larger).any()


def test_a_ramps_own_mesh_is_no_obstacle_and_what_stands_on_it_is():
    slope = math.tan(math.radians(8.0))
    top = 2.0 * slope
    floor = HeightField.from_function(lambda x, y: np.clip(slope * (x + 1.0), 0.0, top), AROUND, resolution=0.05)
    landing = Solid("landing", Box((1.0, 4.0, top)), Pose3D.planar(1.5, 0.0, top / 2.0))
    post = Solid("post", Box((0.2, 0.2, 0.3)), Pose3D.planar(0.6, 0.1, 1.6 * slope + 0.15))
    beam = Solid("beam", Box((0.2, 0.2, 0.2)), Pose3D.planar(-0.2, 0.1, 0.8 * slope + 0.62 + 0.15))
    wide = ramp(slope, width=4.0)
    grid = build(wide, landing, post, beam, floor=floor)
    assert (grid.data == 100).sum() == 16  # The post: the beam is above the band, ramp and landing are floor.
    assert (grid.data == 0).sum() == 80 * 80 - 16
    plain = build(wide, landing, post, beam)
    assert (plain.data[:, 50:] != 0).all()  # Without a field the ramp is an obstacle once it reaches the band.


@pytest.mark.parametrize(("degrees", "limit", "steep"), [(9.9, None, False), (10.1, None, True), (20.0, 20.0, False)])
def test_a_slope_over_the_limit_is_an_obstacle(degrees, limit, steep):
    slope = math.tan(math.radians(degrees))
    floor = HeightField.from_function(lambda x, y: np.clip(slope * x, 0.0, 1.0 * slope), AROUND, resolution=0.05)
    wall = Solid("wall", Box((0.1, 4.0, 9.0)), Pose3D.planar(-1.95, 0.0, 0.0))
    limits = {} if limit is None else {"max_slope": math.radians(limit)}
    grid = build(wall, floor=floor, **limits)
    assert (grid.data[:, :2] == 100).all()
    assert (grid.data[:, 2:40] == 0).all()
    assert (grid.data[:, 40:60] == (100 if steep else 0)).all()
    assert (grid.data[:, 60:] == (-1 if steep else 0)).all()  # Behind a steep ramp nothing is reached.


def test_a_slope_across_the_axes_counts_by_its_steepest_direction():
    rise = math.tan(math.radians(9.0))
    for turn in np.linspace(0.0, math.pi, 9):
        floor = plane(rise * math.cos(turn), rise * math.sin(turn), 0.0)
        wall = Solid("wall", Box((0.1, 4.0, 9.0)), Pose3D.planar(-1.95, 0.0, 0.0))
        assert (build(wall, floor=floor, max_slope=math.radians(9.0)).data[:, 2:] == 0).all()
        with pytest.warns(MapWarning, match="steeper than 0.155"):
            steep = build(wall, floor=floor, max_slope=math.radians(8.9), seeds=())
        assert (steep.data == 100).all()


@pytest.mark.parametrize("height", [0.02, 0.5, -0.5])
def test_a_step_in_the_field_is_a_slope(height):
    floor = HeightField.from_function(lambda x, y: np.where(x < 0.51, 0.0, height), AROUND, resolution=0.05)
    # With nothing else in the world: the edge of a dock has no solid in the band of its upper side.
    grid = build(floor=floor, seeds=[(-1.0, 0.0)])
    assert np.array_equal(np.unique(np.nonzero(grid.data == 100)[1]), [50])
    assert (grid.data[:, :50] == 0).all()
    assert (grid.data[:, 51:] == -1).all()


def test_no_obstacle_is_missed_over_a_bent_floor():
    generator = np.random.default_rng(5)
    heights = generator.normal(scale=0.05, size=(25, 25))
    floor = HeightField(heights, 0.25, (-3.0, -3.0))
    solids, _ = random_scene(generator)
    found = build(*solids, floor=floor, max_slope=1.5, seeds=(), resolution=0.1).data == 100
    # Small cells see a floor that is nearly plane; an obstacle there is one in the large cell too.
    fine = build(*solids, floor=floor, max_slope=1.5, seeds=(), resolution=0.0125).data == 100
    assert not (fine.reshape(40, 8, 40, 8).any(axis=(1, 3)) & ~found).any()
    # And points of the solids' surfaces in the band, by the field's own heights.
    for solid in solids:
        vertices = solid.pose.transform_points(
            box_mesh(*solid.shape.size).vertices if isinstance(solid.shape, Box) else solid.shape.vertices
        )
        faces = FACES if isinstance(solid.shape, Box) else solid.shape.faces
        share = generator.dirichlet((1.0, 1.0, 1.0), size=(len(faces), 200))
        points = np.einsum("fnc,fcd->fnd", share, vertices[faces]).reshape(-1, 3)
        above = points[:, 2] - floor.height_at(points[:, 0], points[:, 1])
        there = points[(above > 0.1001) & (above < 0.6199) & (np.abs(points[:, :2]) < 1.999).all(axis=1)]
        row, col = np.floor((there[:, [1, 0]] + 2.0) / 0.1).astype(int).T
        assert found[row, col].all()


def test_where_the_floor_is_not_known_the_map_is_unknown_and_stops_the_flood():
    def height(x, y):
        return np.where((x > 0.41) & (x < 0.59), np.nan, 0.0)

    floor = HeightField.from_function(height, AROUND, resolution=0.1)
    crate = Solid("crate", Box((0.4, 0.4, 0.4)), Pose3D.planar(0.5, 1.0, 0.2))
    with pytest.warns(MapWarning, match=r"unknown in \d+ of 6400 cells.*spans x -3 to 3, y -3 to 3 m"):
        grid = build(crate, floor=floor, seeds=[(-1.0, 0.0)])
    assert (grid.data[:50, :48] == 0).all()
    assert (grid.data[:, 48:52] == -1).all()  # The crate there too.
    assert (grid.data[56:64, 46:48] == 100).all()
    assert (grid.data[:, 52:] != 0).all()
    with pytest.raises(MapError, match=r"seed \(0.5, 0\) lies where the floor's height is unknown"):
        build(crate, floor=floor, seeds=[(0.5, 0.0)])


def test_a_field_that_does_not_cover_the_world_is_reported():
    crate = Solid("crate", Box((0.4, 0.4, 0.4)), Pose3D.planar(-1.0, 0.0, 0.2))
    half = HeightField(np.zeros((5, 3)), 1.0, (-2.0, -2.0))
    with pytest.warns(MapWarning, match=r"3200 of 6400 cells.*spans x -2 to 0, y -2 to 2 m and the map x -2 to 2"):
        grid = build(crate, floor=half)
    assert (grid.data[:, :40] >= 0).all()
    assert (grid.data[:, 40:] == -1).all()
    elsewhere = HeightField(np.zeros((5, 5)), 1.0, (100.0, -2.0))
    with pytest.raises(MapError, match=r"unknown in every cell of the map.*spans x 100 to 104"):
        build(crate, floor=elsewhere)


def test_open_meshes_and_empty_bands_are_reported_over_a_floor_too():
    opened = Mesh(box_mesh(1.0, 1.0, 1.0).vertices, FACES[:-1])
    with pytest.warns(MapWarning, match="not watertight.*: 'crate'"):
        grid = build(Solid("crate", opened, Pose3D.planar(0.01, 0.01, 0.5)), floor=plane(0.0, 0.0, 0.0), seeds=())
    assert grid.data[40, 40] == -1
    with pytest.warns(MapWarning, match=r"no obstacle.*0.1 to 0.62 m above the floor \(the solids span heights 0 to 1"):
        build(Solid("crate", Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5)), floor=plane(0.0, 0.0, 5.0))


@pytest.mark.parametrize("turn", [0.0, math.pi / 2, math.pi, 0.3])
@pytest.mark.parametrize("size", [(1e-7, 2.0, 1.0), (2.0, 1e-7, 1.0), (1e-7, 1e-7, 1.0)])
def test_thin_walls_between_two_cells_are_not_lost_on_a_ramp(size, turn):
    pose = Pose3D.planar(0.0, 0.0, 0.5, turn)
    found = build(Solid("wall", box_mesh(*size), pose), floor=plane(0.1, -0.05, 0.0), seeds=())
    assert np.array_equal(found.data, build(Solid("wall", box_mesh(*size), pose), seeds=()).data)


def test_a_wall_on_a_cells_edge_adds_no_cell_on_a_ramp():
    grid = build(Solid("box", Box((1.0, 1.0, 2.0)), Pose3D.planar(0.0, 0.0, 0.0)), floor=plane(0.1, 0.0, 0.0))
    assert (grid.data == 100).sum() == 20 * 20
    room = Mesh(CUBE * (3.0, 3.0, 4.0), FACES[:, ::-1])
    inside = build(Solid("room", room), floor=plane(0.1, 0.0, 0.0), seeds=[(0.0, 0.0)])
    assert (inside.data == 0).sum() == 58 * 58
    assert inside.data[0, 0] == -1


def test_blocks_of_rows_fit_together(monkeypatch):
    solids, _ = random_scene(np.random.default_rng(8))
    walls = [
        Solid("sheet", box_mesh(3.0, 1e-7, 2.0), Pose3D.planar(0.0, 0.5, 0.5)),
        Solid("ball", Sphere(0.4), Pose3D.planar(-1.0, -1.0, 0.4)),
    ]
    whole = build(*solids, *walls, floor=plane(0.2, 0.1, 0.0), max_slope=0.5, seeds=())
    monkeypatch.setattr("trundle.maps.over_floor._CELLS_AT_ONCE", 85 * 7)
    assert np.array_equal(build(*solids, *walls, floor=plane(0.2, 0.1, 0.0), max_slope=0.5, seeds=()).data, whole.data)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"max_slope": 0.2, "floor": None}, "give floor"),
        ({"max_slope": 10.0}, "radians.*10 degrees are 0.1745"),
        ({"max_slope": -0.1}, "max_slope"),
        ({"max_slope": math.nan}, "max_slope"),
        ({"style": "isaac"}, "supports only a level floor"),
        ({"floor_z": 1.0}, "the field has the heights"),
    ],
)
def test_options_that_do_not_fit_a_floor_are_refused(options, message):
    with pytest.raises(MapError, match=message):
        build(Solid("box", Box((1.0, 1.0, 1.0))), **({"floor": plane(0.0, 0.0, 0.0)} | options))


def test_samples_that_are_far_apart_or_far_away_are_no_trouble():
    box = Solid("box", Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5))
    huge = HeightField(np.zeros((2, 2)), 4e8, (-2e8, -2e8))
    assert (build(box, floor=huge).data == 100).sum() == 20 * 20
    fine = HeightField(np.zeros((2001, 2001)), 0.003, (-3.0, -3.0))
    assert (build(box, floor=fine, resolution=0.5).data == 100).sum() == 4


def test_a_floor_of_more_cells_than_can_be_is_refused():
    for rows, cols in ((2**62, 7), (2**32, 2**32), (0, 4)):
        with pytest.raises(ValueError, match="cells"):
            floor_planes(np.zeros((2, 2)), 1.0, 0.0, 0.0, 0.05, rows, cols)
