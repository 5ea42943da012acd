"""Which level of a world a robot stands on."""

import math

import numpy as np
import pytest

from trundle.errors import WorldError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.floors import find_common_floor, find_floor, lower_world
from trundle.worlds.tessellate import box_mesh, rectangle_mesh

CARTER = Robot.load("nova_carter")
BURGER = Robot.load("turtlebot3_burger")
HERE = Pose2D(0.0, 0.0)


def slab(name, top, size=(10.0, 10.0), thickness=0.1, at=(0.0, 0.0)):
    return Solid(name, Box((*size, thickness)), Pose3D((*at, top - thickness / 2.0)))


WALL = Solid("wall", Box((0.2, 10.0, 2.0)), Pose3D((5.0, 0.0, 1.0)))


def test_a_world_without_a_floor_of_its_own_has_one_at_zero():
    assert find_floor(World("w", ()), CARTER, HERE) == 0.0
    assert find_floor(World("w", (WALL,)), CARTER, HERE) == 0.0
    assert find_common_floor(World("w", ()), CARTER) == 0.0
    assert find_common_floor(World("w", (WALL,)), CARTER) == 0.0


@pytest.mark.parametrize("top", [0.034, 0.5, -0.4])
def test_the_top_of_a_slab_is_the_floor(top):
    world = World("w", (slab("slab", top), WALL))
    assert find_floor(world, CARTER, HERE) == pytest.approx(top)
    assert find_common_floor(world, CARTER) == pytest.approx(top)


@pytest.mark.parametrize(
    "shape",
    [Cylinder(6.0, 0.1), box_mesh((10.0, 10.0, 0.1)), rectangle_mesh(10.0, 10.0)],
    ids=["cylinder", "mesh", "sheet"],
)
def test_a_slab_of_any_shape_is_a_floor(shape):
    middle = 0.034 if isinstance(shape, Mesh) and len(shape.faces) == 2 else 0.034 - 0.05
    world = World("w", (Solid("slab", shape, Pose3D((0.0, 0.0, middle))),))
    assert find_floor(world, CARTER, HERE) == pytest.approx(0.034)


def test_tiles_side_by_side_are_one_floor():
    tiles = [slab(f"tile_{i}", 0.034, (0.3, 8.0), at=(-3.0 + 0.3 * i, 0.0)) for i in range(20)]
    assert find_floor(World("w", tuple(tiles)), CARTER, HERE) == pytest.approx(0.034)


def test_what_is_not_level_or_faces_down_is_no_floor():
    tilted = Solid("ramp", Box((10.0, 10.0, 0.1)), Pose3D.from_rpy((0.0, 0.0, -2.0), (0.0, 0.1, 0.0)))
    assert find_floor(World("w", (tilted,)), CARTER, HERE) == 0.0
    sheet = rectangle_mesh(10.0, 10.0)
    down = Solid("sheet", Mesh(sheet.vertices, sheet.faces[:, ::-1]), Pose3D((0.0, 0.0, -0.3)))
    assert find_floor(World("w", (down,)), CARTER, HERE) == 0.0


def test_a_slab_that_is_not_under_the_whole_footprint_is_no_floor():
    plate = slab("plate", -0.2, (0.7, 0.4))
    assert find_floor(World("w", (plate,)), CARTER, HERE) == 0.0
    assert find_floor(World("w", (plate,)), BURGER, HERE) == pytest.approx(-0.2)


def test_a_slab_without_the_height_of_the_robot_above_is_no_floor():
    upper = slab("upper", 0.6, thickness=0.1)
    world = World("w", (slab("lower", 0.034), upper))
    assert find_floor(world, CARTER, HERE) == pytest.approx(0.6)
    with pytest.raises(WorldError, match=r"0\.034, 0\.600 m.*--floor-z"):
        find_floor(world, BURGER, HERE)


@pytest.mark.parametrize("above", [(), (Solid("chair", Box((0.5, 0.5, 1.0)), Pose3D((3.0, 3.0, 3.6))),)])
def test_a_roof_is_no_floor_and_a_storey_is(above):
    world = World("w", (slab("floor", 0.034), slab("upper", 3.1), *above))
    if not above:
        assert find_floor(world, CARTER, HERE) == pytest.approx(0.034)
        return
    with pytest.raises(WorldError, match=r"0\.034, 3\.100 m.*--floor-z"):
        find_floor(world, CARTER, HERE)


def test_a_table_over_the_robot_is_no_floor():
    table = slab("table", 0.75, (2.0, 1.0), thickness=0.05)
    assert find_floor(World("w", (table,)), BURGER, HERE) == 0.0


@pytest.mark.parametrize(
    "crate",
    [
        Solid("crate", Box((0.4, 0.4, 2.0)), Pose3D((0.1, 0.2, 1.0))),
        Solid("crate", OccupancyCells(np.ones((8, 8), bool), 0.05, 2.0), Pose3D((-0.1, 0.0, 0.0))),
    ],
    ids=["box", "cells"],
)
def test_a_blocked_start_is_on_the_floor_that_is_freest(crate):
    world = World("w", (slab("slab", 0.034), crate))
    assert find_floor(world, CARTER, HERE) == pytest.approx(0.034)


def test_a_start_within_a_thick_body_is_not_free():
    block = Solid("block", Box((4.0, 4.0, 4.0)), Pose3D((0.0, 0.0, -1.5)))
    assert find_floor(World("w", (block,)), CARTER, HERE) == pytest.approx(0.5)


def test_a_lowered_world_has_its_floor_at_zero():
    world = World("w", (slab("slab", 0.034), WALL), seeds=((1.0, 1.0),))
    lowered = lower_world(world, 0.034)
    assert [solid.pose.position[2] for solid in lowered.solids] == pytest.approx([-0.05, 0.966])
    assert lowered.seeds == world.seeds
    assert lower_world(world, 0.0) is world
    with pytest.raises(WorldError, match="floor_z"):
        lower_world(world, math.nan)


def test_tops_of_containers_are_not_the_floor_of_a_world():
    containers = [Solid(f"container_{i}", Box((6.0, 2.4, 2.6)), Pose3D((0.0, 2.5 * i, 1.3))) for i in range(8)]
    assert find_common_floor(World("w", tuple(containers)), CARTER) == 0.0


@pytest.mark.parametrize("above", [(), (slab("roof", 3.1),)], ids=["open", "roofed"])
def test_a_start_within_a_shelf_is_on_the_floor_and_not_on_the_shelf(above):
    shelf = Solid("shelf", Box((2.0, 1.0, 2.0)), Pose3D((0.0, 0.0, 1.0)))
    assert find_floor(World("w", (slab("slab", 0.034), shelf, *above)), CARTER, HERE) == pytest.approx(0.034)
    assert find_floor(World("w", (shelf, *above), ground_z=0.0), CARTER, HERE) == 0.0
