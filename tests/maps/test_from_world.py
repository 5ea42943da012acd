from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle.errors import MapError, MapWarning
from trundle.geometry import Pose2D, Pose3D
from trundle.maps import OccupancyGrid
from trundle.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.worlds import World


@dataclass
class Room:
    """Not a `World`: anything with solids, bounds and seeds will do."""

    solids: list[Solid]
    seeds: list[tuple[float, float]] = field(default_factory=list)

    @property
    def bounds(self):
        lows, highs = zip(*(solid.bounds() for solid in self.solids), strict=True)
        return np.min(lows, axis=0), np.max(highs, axis=0)


FIELD = ((-2.0, -2.0), (2.0, 2.0))


def occupied(*shapes_and_poses, bounds=FIELD, **options) -> OccupancyGrid:
    solids = [Solid(str(i), shape, pose) for i, (shape, pose) in enumerate(shapes_and_poses)]
    return OccupancyGrid.from_world(Room(solids), bounds=bounds, **options)


def count(grid: OccupancyGrid) -> int:
    return int((grid.data == 100).sum())


def extent(grid: OccupancyGrid) -> tuple[float, float, float, float]:
    """x_min, y_min, x_max, y_max [m] of the occupied cells."""
    rows, cols = np.nonzero(grid.data == 100)
    low = np.array([cols.min(), rows.min()]) * grid.resolution + (grid.origin.x, grid.origin.y)
    high = np.array([cols.max() + 1, rows.max() + 1]) * grid.resolution + (grid.origin.x, grid.origin.y)
    return tuple(round(float(number), 9) for number in (*low, *high))


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


def cube_mesh(edge: float) -> Mesh:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * edge / 2
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]))


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


WALLS = [
    Solid("south", Box((4.0, 0.1, 1.0)), Pose3D.planar(0.0, -1.95, 0.5)),
    Solid("north", Box((4.0, 0.1, 1.0)), Pose3D.planar(0.0, 1.95, 0.5)),
    Solid("west", Box((0.1, 4.0, 1.0)), Pose3D.planar(-1.95, 0.0, 0.5)),
    Solid("east", Box((0.1, 4.0, 1.0)), Pose3D.planar(1.95, 0.0, 0.5)),
    Solid("middle", Box((0.1, 4.0, 1.0)), Pose3D.planar(0.55, 0.0, 0.5)),
]


def test_free_is_what_the_seeds_reach():
    west, east = (slice(2, 78), slice(2, 50)), (slice(2, 78), slice(52, 78))
    for seeds, free in (
        (None, [west]),
        ([(-1.0, 0.0)], [west]),
        ([(1.0, 0.0)], [east]),
        ([(1.0, 0.0), (-1.0, 0.0), (-1.2, 0.0)], [west, east]),
    ):
        grid = OccupancyGrid.from_world(Room(WALLS), seeds=seeds)
        assert grid.shape == (80, 80)
        expected = np.full((80, 80), -1)
        for area in free:
            expected[area] = 0
        expected[(np.arange(80) < 2) | (np.arange(80) > 77)] = 100
        expected[:, [0, 1, 50, 51, 78, 79]] = 100
        assert np.array_equal(grid.data, expected)
    assert np.array_equal(OccupancyGrid.from_world(Room(WALLS, [(1.0, 0.0)])).data[east], np.zeros((76, 26)))


def test_the_worlds_own_seeds_outside_given_bounds_are_left_out():
    room = Room(WALLS, [(1.0, 0.0)])
    grid = OccupancyGrid.from_world(room, bounds=((-1.9, -1.9), (0.55, 1.9)))
    assert (grid.data[:, :-1] == 0).all()
    assert (grid.data[:, -1] == 100).all()


def test_a_diagonal_gap_does_not_leak():
    blocked = np.eye(20, dtype=bool)
    grid = occupied((OccupancyCells(blocked, 0.05, 1.0), Pose3D()), bounds=((0, 0), (1, 1)), seeds=[(0.9, 0.1)])
    assert np.array_equal(grid.data, np.where(blocked, 100, np.where(np.tri(20, dtype=bool).T, 0, -1)))


@pytest.mark.parametrize(
    ("seeds", "message"),
    [
        ([(3.0, 0.0)], r"seed \(3, 0\) lies outside the map: x -2 to 2, y -2 to 2"),
        ([(-1.0, 0.0), (0.55, 0.0)], r"seed \(0.55, 0\) lies in a cell of .* part of an obstacle"),
        ([(math.nan, 0.0)], "finite"),
    ],
)
def test_seeds_that_cannot_be_are_refused(seeds, message):
    with pytest.raises(MapError, match=message):
        OccupancyGrid.from_world(Room(WALLS), seeds=seeds)


@pytest.mark.filterwarnings("ignore:no cell of the map is free")
def test_bounds_are_the_worlds_moved_out_to_whole_cells():
    room = Room([Solid("box", Box((0.9, 0.3, 1.0)), Pose3D.planar(0.17, -3.02, 0.5))])
    grid = OccupancyGrid.from_world(room)
    assert (grid.origin, grid.shape) == (Pose2D(-0.3, -3.2, 0.0), (7, 19))
    wide = OccupancyGrid.from_world(room, margin=0.5)
    assert (wide.origin, wide.shape) == (Pose2D(-0.8, -3.7, 0.0), (27, 39))
    assert (wide.data[10:17, 10:29] == 100).sum() == count(wide)


def test_given_bounds_keep_their_lower_corner():
    grid = OccupancyGrid.from_world(Room(WALLS), bounds=((-0.123, -0.456), (1.0, 1.0)), resolution=0.1)
    assert (grid.origin, grid.shape) == (Pose2D(-0.123, -0.456, 0.0), (15, 12))


def test_solids_that_cross_the_bounds_are_cut_off():
    big = (Box((100.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5, 0.3))
    far = (Box((1.0, 1.0, 1.0)), Pose3D.planar(1e9, -1e9, 0.5))
    round_one = (Cylinder(50.0, 1.0), Pose3D.planar(51.0, 0.0, 0.5))
    whole = occupied(big, far, round_one, bounds=((-3.0, -3.0), (3.0, 3.0)))
    part = occupied(big, far, round_one)
    assert np.array_equal(part.data == 100, whole.data[20:100, 20:100] == 100)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"resolution": 0.0}, "resolution must be the edge of a cell"),
        ({"resolution": math.nan}, "resolution must be the edge of a cell"),
        ({"resolution": 1e-4}, "more than 400000000 cells"),
        ({"max_cells": 100}, "more than 100 cells"),
        ({"bounds": ((0, 0), (1e300, 1))}, "more than 400000000 cells"),
        ({"z_range": (0.62, 0.1)}, "z_range"),
        ({"z_range": (0.1, 0.1)}, "z_range"),
        ({"z_range": (0.1, math.inf)}, "z_range"),
        ({"bounds": ((1, 1), (0, 2))}, "bounds must be"),
        ({"bounds": ((0, 0), (math.nan, 2))}, "bounds must be"),
        ({"bounds": (0, 0, 1, 1)}, "bounds must be"),
        ({"coverage": "half"}, "coverage is 'half'"),
        ({"margin": -1.0}, "margin"),
        ({"style": "ros"}, "style is 'ros'"),
        ({"style": "isaac", "coverage": "centre"}, "leave coverage"),
        ({"floor_z": math.nan}, "floor_z"),
    ],
)
def test_arguments_that_cannot_be_are_refused(options, message):
    with pytest.raises(MapError, match=message):
        OccupancyGrid.from_world(Room(WALLS), **options)


def test_a_world_without_solids_or_without_any_in_the_band_is_reported():
    with pytest.raises(MapError, match="the world has no solids"):
        OccupancyGrid.from_world(World("empty", ()))
    with pytest.warns(MapWarning, match="the world has no solids"):
        grid = OccupancyGrid.from_world(World("empty", ()), bounds=FIELD)
    assert (grid.data == 0).all()
    with pytest.warns(MapWarning, match=r"heights 2 to 3 m \(the solids span heights 0 to 1 m\)") as caught:
        OccupancyGrid.from_world(World("walls", tuple(WALLS)), z_range=(2.0, 3.0))
    assert caught[0].filename == __file__


def test_a_map_without_a_free_cell_is_reported():
    with pytest.warns(MapWarning, match="no cell of the map is free"):
        grid = occupied((Box((9.0, 9.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5)))
    assert (grid.data == 100).all()


def test_the_floor_may_lie_elsewhere():
    walls = [Solid(w.name, w.shape, Pose3D((*w.pose.position[:2], w.pose.position[2] - 7.3))) for w in WALLS]
    ground, below = OccupancyGrid.from_world(Room(WALLS)), OccupancyGrid.from_world(Room(walls), floor_z=-7.3)
    assert np.array_equal(ground.data, below.data)


def test_the_style_of_isaac_sim():
    box = (Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5))
    assert count(occupied(box, style="isaac")) == 22 * 22
    # Its box for a cell is half a cell higher than the band, so 0.02 m above it still counts.
    beam = (Box((1.0, 1.0, 0.1)), Pose3D.planar(0.0, 0.0, 0.62 + 0.02 + 0.05))
    assert count(occupied(beam, style="isaac")) == 22 * 22
    with pytest.warns(MapWarning, match="no obstacle"):
        assert count(occupied(beam)) == 0
    hollow = occupied((cube_mesh(1.02), Pose3D.planar(0.0, 0.0, 0.5)), style="isaac")
    assert count(hollow) == 22 * 22 - 20 * 20


def test_the_half_cell_origin_is_the_centre_of_the_corner_cell():
    plain, shifted = (OccupancyGrid.from_world(Room(WALLS), half_cell_origin=half) for half in (False, True))
    assert plain.origin == Pose2D(-2.0, -2.0)
    assert shifted.origin == Pose2D(-1.975, -1.975)
    assert np.array_equal(plain.data, shifted.data)


def test_a_solid_far_away_by_mistake_is_named():
    lost = [*WALLS, Solid("lost", Box((1.0, 1.0, 1.0)), Pose3D.planar(10_000.0, 1.0, 0.5))]
    with pytest.raises(MapError, match=r"more than 400000000 cells.*'lost' reaches farthest, x 9999.5 to 10000.5"):
        OccupancyGrid.from_world(Room([*lost, Solid("far", Box((1.0, 1.0, 1.0)), Pose3D.planar(0.0, 9_000.0, 0.5))]))
    with pytest.warns(MapWarning, match="10002 x 4 m: 'lost' reaches farthest"):
        OccupancyGrid.from_world(Room(lost), resolution=0.5)


def test_the_warehouse_has_a_map():
    world = World.generate("warehouse", seed=3)
    grid = OccupancyGrid.from_world(world)
    assert {-1, 0, 100} == set(np.unique(grid.data))
    row, col = grid.world_to_cell(*np.transpose(world.seeds))
    assert (grid.data[row, col] == 0).all()
