from __future__ import annotations

import math

import numpy as np
import pytest

from support.solid_maps import FIELD, Room, count, cube_mesh, occupied
from trundle.errors import MapError, MapWarning
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, OccupancyCells, Solid
from trundle.maps import OccupancyGrid
from trundle.worlds import World

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
