"""Cells that single solids mark: boxes, cylinders, spheres, cells and meshes, cut to the height band."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.solid_maps import FIELD, Room, count, cube_mesh, extent, occupied
from trundle.errors import MapWarning
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import OccupancyGrid


@pytest.mark.filterwarnings("ignore:no cell of the map is free")
@settings(max_examples=200, deadline=None)
@given(x=st.integers(-20_000, 20_000), y=st.integers(-20_000, 20_000), coverage=st.sampled_from(["any", "centre"]))
def test_a_grid_aligned_box_has_exactly_its_cells_wherever_it_is(x, y, coverage):
    room = Room([Solid("box", Box((1.0, 1.0, 1.0)), Pose3D.planar(x * 0.05, y * 0.05, 0.5))])
    grid = OccupancyGrid.from_world(room, coverage=coverage)
    assert grid.shape == (20, 20)
    assert (grid.data == 100).all()
    fixed = OccupancyGrid.from_world(
        room, coverage=coverage, bounds=((x * 0.05 - 1.0, y * 0.05 - 1.0), (x * 0.05 + 1.0, y * 0.05 + 1.0))
    )
    assert (count(fixed), fixed.shape) == (400, (40, 40))


@pytest.mark.parametrize("turns", range(8))
def test_quarter_turns_of_a_box_keep_its_cells(turns):
    grid = occupied((Box((1.0, 0.6, 1.0)), Pose3D.planar(0.0, 0.0, 0.5, turns * math.pi / 2)))
    assert extent(grid) == ((-0.5, -0.3, 0.5, 0.3) if turns % 2 == 0 else (-0.3, -0.5, 0.3, 0.5))


@pytest.mark.parametrize("axis", [1, 2, 3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_box_on_its_side(axis, sign):
    quaternion = [math.sqrt(0.5), 0.0, 0.0, 0.0]
    quaternion[axis] = sign * math.sqrt(0.5)
    grid = occupied((Box((0.2, 0.4, 0.6)), Pose3D((0.0, 0.0, 0.3), tuple(quaternion))))
    x, y = {1: (0.1, 0.3), 2: (0.3, 0.2), 3: (0.2, 0.1)}[axis]
    assert extent(grid) == (-x, -y, x, y)


def test_one_micrometre_decides():
    for reach, cells in ((0.5e-6, 400), (2e-6, 22 * 22)):
        assert count(occupied((Box((1.0 + 2 * reach, 1.0 + 2 * reach, 1.0)), Pose3D.planar(0.0, 0.0, 0.5)))) == cells
    for top, cells in ((0.1, 0), (0.1 + 0.5e-6, 0), (0.1 + 2e-6, 400)):
        box = (Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, top - 0.5))
        high = (Box((0.2, 0.2, 1.0)), Pose3D.planar(1.5, 1.5, 0.5))
        assert count(occupied(box, high)) == cells + 16
    for bottom, cells in ((0.62, 0), (0.62 - 0.5e-6, 0), (0.62 - 2e-6, 400)):
        box = (Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, bottom + 0.5))
        high = (Box((0.2, 0.2, 1.0)), Pose3D.planar(1.5, 1.5, 0.5))
        assert count(occupied(box, high)) == cells + 16


def test_thin_walls_are_never_lost():
    for x in (0.0, 0.01, 0.05, 0.0499, 1.0):
        grid = occupied((Box((1e-4, 2.0, 1.0)), Pose3D.planar(x, 0.0, 0.5)))
        assert (grid.data == 100).any(axis=1).sum() == 40


def test_a_tilted_box_counts_by_what_lies_in_the_band():
    # A ramp of 45°: its top face is z = x - 1, so the band 0.1 to 0.62 ends at x = 1.1 at the lower side.
    ramp = Pose3D((0.0, 0.0, -1.0), (math.cos(math.pi / 8), 0.0, -math.sin(math.pi / 8), 0.0))
    grid = occupied((Box((8.0, 1.0, 2e-3)), ramp), bounds=((-4.0, -2.0), (4.0, 2.0)))
    assert extent(grid) == (1.05, -0.5, 1.65, 0.5)


def test_upright_cylinders_and_spheres_are_discs():
    for shape, radius in (
        ((Cylinder(0.5, 1.0), Pose3D.planar(0.0113, 0.0237, 0.5)), 0.5),
        ((Cylinder(0.5, 1.0), Pose3D((0.0113, 0.0237, 0.5), (0.0, 1.0, 0.0, 0.0))), 0.5),
        ((Sphere(0.5), Pose3D.planar(0.0113, 0.0237, 0.3)), 0.5),
        ((Sphere(0.5), Pose3D.planar(0.0113, 0.0237, -0.2)), 0.4),
        ((Sphere(0.5), Pose3D.planar(0.0113, 0.0237, 0.92)), 0.4),
    ):
        grid = occupied(shape)
        rows, cols = np.indices(grid.shape)
        x, y = grid.cell_to_world(rows, cols)
        gap = np.hypot(np.maximum(np.abs(x - 0.0113) - 0.025, 0), np.maximum(np.abs(y - 0.0237) - 0.025, 0)) - radius
        assert np.abs(gap).min() > 3e-6
        assert np.array_equal(grid.data == 100, gap < 0)
        centres = occupied(shape, coverage="centre")
        assert np.array_equal(centres.data == 100, np.hypot(x - 0.0113, y - 0.0237) < radius)


def test_spheres_and_cylinders_outside_the_band_are_left_out():
    for shape, z in ((Sphere(0.5), -0.4), (Sphere(0.5), 1.12), (Cylinder(0.5, 1.0), -0.4), (Cylinder(0.5, 1.0), 1.12)):
        with pytest.warns(MapWarning, match="no obstacle"):
            assert count(occupied((shape, Pose3D.planar(0.0, 0.0, z)))) == 0


def test_a_lying_cylinder_is_a_rectangle_as_wide_as_its_part_in_the_band():
    lying = (math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0)
    grid = occupied((Cylinder(0.3, 2.0), Pose3D((0.0, 0.0, 0.3), lying)))
    assert extent(grid) == (-1.0, -0.3, 1.0, 0.3)
    # The band begins 0.1 m above the axis: half the chord there is √0.08 = 0.2828 m.
    grid = occupied((Cylinder(0.3, 2.0), Pose3D((0.0, 0.0, 0.0), lying)))
    assert extent(grid) == (-1.0, -0.3, 1.0, 0.3)
    grid = occupied((Cylinder(0.3, 2.0), Pose3D((0.0, 0.0, -0.1), lying)))
    assert extent(grid) == (-1.0, -0.25, 1.0, 0.25)


def test_cells_of_a_map_come_back_as_they_were():
    generator = np.random.default_rng(4)
    blocked = generator.random((37, 53)) < 0.3
    for origin in ((0.0, 0.0), (-11.975, -17.975), (0.3, 1e4)):
        pose = Pose3D.planar(*origin)
        bounds = (origin, (origin[0] + 53 * 0.05, origin[1] + 37 * 0.05))
        grid = occupied((OccupancyCells(blocked, 0.05, 1.0), pose), bounds=bounds)
        assert np.array_equal(grid.data == 100, blocked)


def test_turned_cells_of_a_map_cover_what_they_covered():
    blocked = np.zeros((10, 10), dtype=bool)
    blocked[2:8, 3:9] = True
    cells = occupied((OccupancyCells(blocked, 0.1, 1.0), Pose3D.planar(0.1, -0.2, 0.0, 0.7)))
    middle = Pose2D(0.1, -0.2, 0.7).transform_points([(0.6, 0.5)])[0]
    box = occupied((Box((0.6, 0.6, 1.0)), Pose3D.planar(*middle, 0.5, 0.7)))
    assert np.array_equal(cells.data, box.data)
    with pytest.warns(MapWarning):
        occupied((OccupancyCells(blocked, 0.1, 0.09), Pose3D.planar(0.0, 0.0)))


def turned_inwards(mesh: Mesh) -> Mesh:
    return Mesh(mesh.vertices, mesh.faces[:, ::-1])


def sheet(*corners) -> Mesh:
    """A quad without thickness."""
    return Mesh(np.array(corners), [[0, 1, 2], [0, 2, 3]])


WALL = sheet([0.0, -0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.5, 1.0], [0.0, -0.5, 1.0])


@pytest.mark.parametrize("coverage", ["any", "centre"])
def test_a_closed_mesh_is_solid(coverage):
    pose = Pose3D.planar(0.013, 0.0, 0.5, 0.3)
    mesh, box = (occupied((shape, pose), coverage=coverage) for shape in (cube_mesh(1.02), Box((1.02, 1.02, 1.02))))
    assert np.array_equal(mesh.data, box.data)
    assert {0, 100} == set(np.unique(mesh.data))


@pytest.mark.parametrize("coverage", ["any", "centre"])
def test_a_room_whose_faces_look_inward_is_empty(coverage):
    for edge, inside in ((2.02, 40 * 40), (2.0, 38 * 38)):
        grid = occupied(
            (turned_inwards(cube_mesh(edge)), Pose3D.planar(0.0, 0.0, 0.5)), coverage=coverage, seeds=[(0, 0)]
        )
        assert extent(grid) == (-1.05, -1.05, 1.05, 1.05)
        assert (grid.data == 0).sum() == inside
        assert grid.data[0, 0] == -1


def test_a_room_with_furniture_in_one_mesh_keeps_both():
    room, desk = turned_inwards(cube_mesh(3.0)), cube_mesh(0.98)
    both = Mesh(np.concatenate([room.vertices, desk.vertices]), np.concatenate([room.faces, desk.faces + 8]))
    grid = occupied((both, Pose3D.planar(0.0, 0.0, 0.5)), seeds=[(1.0, 1.0)])
    assert (grid.data[30:50, 30:50] != 0).all()
    assert (grid.data == 0).sum() == 58 * 58 - 20 * 20


def test_a_sheet_of_two_sides_between_two_cells_is_not_lost():
    two_sided = Mesh(WALL.vertices, [[0, 1, 2], [0, 2, 3], [2, 1, 0], [3, 2, 0]])
    assert extent(occupied((two_sided, Pose3D()))) == (-0.05, -0.55, 0.05, 0.55)


@pytest.mark.parametrize("turn", [0.0, math.pi / 2, math.pi])
def test_a_thin_part_of_a_thick_mesh_between_two_cells_is_not_lost(turn):
    # A cube of 0.4 m with a fin of no thickness along x = 0.
    fin = sheet([0.0, 0.0, 0.0], [0.0, 1.5, 0.0], [0.0, 1.5, 1.0], [0.0, 0.0, 1.0])
    cube, fins = cube_mesh(0.4), np.concatenate([fin.faces, fin.faces[:, ::-1]]) + 8
    mesh = Mesh(np.concatenate([cube.vertices, fin.vertices]), np.concatenate([cube.faces, fins]))
    grid = occupied((mesh, Pose3D.planar(0.0, 0.0, 0.5, turn)))
    assert count(grid) == 8 * 8 + 2 * 26
    wide = {0.0: (-0.2, -0.2, 0.2, 1.5), math.pi / 2: (-1.5, -0.2, 0.2, 0.2), math.pi: (-0.2, -1.5, 0.2, 0.2)}
    assert extent(grid) == wide[turn]


@pytest.mark.parametrize("size", [(1e-7, 2.0, 1.0), (2.0, 1e-7, 1.0), (1e-7, 1e-7, 1.0)])
def test_a_box_of_less_than_two_micrometres_between_two_cells_is_not_lost(size):
    for shape in (Box(size), Mesh(cube_mesh(1.0).vertices * size, cube_mesh(1.0).faces)):
        grid = occupied((shape, Pose3D.planar(0.0, 0.0, 0.5)), bounds=((-2.0, -2.0), (2.0, 2.0)))
        if size[0] != size[1]:
            assert (grid.data == 100).any(axis=1 if size[1] == 2.0 else 0).sum() >= 40
        else:
            assert count(grid) == 4


def test_an_open_mesh_is_a_surface_and_is_named():
    open_box = Mesh(cube_mesh(1.02).vertices, cube_mesh(1.02).faces[:-1])
    solids = [Solid("crate", open_box, Pose3D.planar(0.0, 0.0, 0.5)), Solid("high", open_box, Pose3D((0.0, 0.0, 5.0)))]
    with pytest.warns(MapWarning, match=r"not watertight.*: 'crate'\. Close") as caught:
        grid = OccupancyGrid.from_world(Room(solids), bounds=FIELD)
    assert caught[0].filename == __file__
    assert len(caught) == 1
    assert count(grid) == 22 * 22 - 20 * 20
    assert grid.data[40, 40] == -1


@pytest.mark.filterwarnings("ignore:not watertight")
@pytest.mark.parametrize("coverage", ["any", "centre"])
def test_a_surface_counts_in_every_cell_that_it_touches(coverage):
    assert extent(occupied((WALL, Pose3D()), coverage=coverage)) == (-0.05, -0.55, 0.05, 0.55)
    assert extent(occupied((WALL, Pose3D.planar(0.01, 0.01)), coverage=coverage)) == (0.0, -0.5, 0.05, 0.55)


@pytest.mark.filterwarnings("ignore:not watertight")
def test_a_mesh_is_cut_to_the_band():
    # A triangle that stands on its tip at z = 0 and is 2 m wide at z = 1.
    mesh = Mesh(np.array([[0.0, 0.01, 0.0], [-1.0, 0.01, 1.0], [1.0, 0.01, 1.0]]), [[0, 1, 2]])
    assert extent(occupied((mesh, Pose3D()))) == (-0.65, 0.0, 0.65, 0.05)
    assert extent(occupied((mesh, Pose3D()), z_range=(0.0, 0.28))) == (-0.3, 0.0, 0.3, 0.05)


def test_overhangs_and_steps_are_obstacles_where_they_reach_into_the_band():
    # A table: its top is above a low robot's band, its legs are in it. A door's lintel; a kerb; a threshold.
    table = (Box((1.0, 0.6, 0.05)), Pose3D.planar(0.0, 0.0, 0.725))
    leg = (Box((0.05, 0.05, 0.7)), Pose3D.planar(0.475, 0.275, 0.35))
    lintel = (Box((0.2, 0.9, 0.4)), Pose3D.planar(-1.5, 0.0, 2.2))
    kerb = (Box((4.0, 0.2, 0.15)), Pose3D.planar(0.0, 1.5, 0.075))
    threshold = (Box((0.1, 0.9, 0.02)), Pose3D.planar(1.5, 0.0, 0.01))
    solids = (table, leg, lintel, kerb, threshold)
    assert count(occupied(*solids, z_range=(0.1, 0.62))) == 1 + 80 * 4
    assert count(occupied(*solids, z_range=(0.1, 1.5))) == 20 * 12 + 80 * 4
    assert count(occupied(*solids, z_range=(0.1, 2.5))) == 20 * 12 + 80 * 4 + 4 * 18
    assert count(occupied(*solids, z_range=(0.16, 0.62))) == 1  # A robot that climbs kerbs.
    assert count(occupied(*solids, z_range=(0.01, 0.62))) == 1 + 80 * 4 + 2 * 18
    # At the band's edge a micrometre decides.
    assert count(occupied(table, leg, z_range=(0.1, 0.7))) == 1
    assert count(occupied(table, leg, z_range=(0.1, 0.7 + 3e-6))) == 20 * 12
