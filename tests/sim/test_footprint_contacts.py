import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Point, Polygon, box

from trundle.errors import WorldError
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, OccupancyCells, Solid, Sphere
from trundle.robots import Robot
from trundle.sim.footprint import FootprintChecker, polygon_depth
from trundle.worlds import World

ROBOT = Robot.load("nova_carter")
OUTLINE = Polygon(ROBOT.outline)


def names(world, *poses):
    return sorted(contact.other for contact in FootprintChecker(world, ROBOT).find(np.array(poses, dtype=float)))


def placed(pose):
    x, y, yaw = pose
    return affinity.translate(affinity.rotate(OUTLINE, yaw, origin=(0, 0), use_radians=True), x, y)


coordinates = st.floats(-1.5, 1.5)
angles = st.floats(-math.pi, math.pi)


@settings(max_examples=150)
@given(x=coordinates, y=coordinates, yaw=angles, bx=coordinates, by=coordinates, turn=angles)
def test_a_box_is_touched_where_shapely_says(x, y, yaw, bx, by, turn):
    obstacle = affinity.translate(
        affinity.rotate(box(-0.4, -0.1, 0.4, 0.1), turn, origin=(0, 0), use_radians=True), bx, by
    )
    shared = placed((x, y, yaw)).intersection(obstacle).area
    world = World("w", (Solid("b", Box((0.8, 0.2, 1.0)), Pose3D.planar(bx, by, 0.5, turn)),))
    touched = bool(names(world, (x, y, yaw)))
    if shared > 1e-6:
        assert touched
    if placed((x, y, yaw)).distance(obstacle) > 1e-6:
        assert not touched


@settings(max_examples=150)
@given(x=coordinates, y=coordinates, yaw=angles, radius=st.floats(0.01, 1.0))
def test_a_cylinder_is_touched_where_shapely_says(x, y, yaw, radius):
    distance = placed((x, y, yaw)).distance(Point(0.0, 0.0))
    world = World("w", (Solid("c", Cylinder(radius, 1.0), Pose3D((0.0, 0.0, 0.5))),))
    if abs(distance - radius) > 1e-6:
        assert bool(names(world, (x, y, yaw))) == (distance < radius)


def test_only_what_stands_in_the_robots_height_counts():
    solids = (
        Solid("mat", Box((1.0, 1.0, 0.05)), Pose3D((0.0, 0.0, 0.025))),
        Solid("bridge", Box((1.0, 1.0, 0.2)), Pose3D((0.0, 0.0, 0.8))),
        Solid("ball", Sphere(0.3), Pose3D((0.0, 0.0, 0.8))),
    )
    assert names(World("w", solids), (0.0, 0.0, 0.0)) == ["ball"]


def test_touching_between_two_free_ends_counts():
    world = World("w", (Solid("post", Cylinder(0.02, 1.0), Pose3D((0.3, 0.0, 0.5))),))
    ends = [(-0.5, 0.0, 0.0), (1.2, 0.0, 0.0)]
    assert names(world, *ends) == []
    assert names(world, ends[0], (0.3, 0.0, 0.0), ends[1]) == ["post"]


def test_a_contact_lies_where_both_are():
    world = World("w", (Solid("wall", Box((0.1, 4.0, 1.0)), Pose3D((0.18, 0.0, 0.5))),))
    (contact,) = FootprintChecker(world, ROBOT).find(np.zeros((1, 3)))
    assert (contact.x, contact.y) == pytest.approx((0.135, 0.0))
    assert contact.part == "chassis"


def test_cells_are_named_and_turned_with_their_grid():
    blocked = np.zeros((40, 60), dtype=bool)
    blocked[7, 11] = True
    solid = Solid("map", OccupancyCells(blocked, 0.1, 1.0), Pose3D.planar(2.0, 1.0, 0.0, 0.6))
    x, y, _ = solid.pose.transform_points([[1.15, 0.75, 0.0]])[0]
    assert names(World("w", (solid,)), (x, y, 0.3)) == ["map[7,11]"]
    assert names(World("w", (solid,)), (x + 0.5, y, 0.0)) == ["map[7,11]"]
    assert names(World("w", (solid,)), (x + 0.8, y, 0.0)) == []


def test_all_cells_under_the_footprint_are_reported_the_deepest_first():
    solid = Solid("map", OccupancyCells(np.ones((40, 40), dtype=bool), 0.1, 1.0), Pose3D((-2.0, -2.0, 0.0)))
    touched = [each.other for each in FootprintChecker(World("w", (solid,)), ROBOT).find(np.zeros((1, 3)))]
    # The footprint reaches from x = -0.607 to 0.14 m, and 0.25 m to both sides.
    assert set(touched) == {f"map[{row},{col}]" for row in range(17, 23) for col in range(13, 22)}
    assert len(touched) == 6 * 9
    assert {name.partition(",")[2] for name in touched[-6:]} == {"13]"}


def test_cells_above_the_robot_do_not_count():
    solid = Solid("map", OccupancyCells(np.ones((4, 4), dtype=bool), 0.5, 1.0), Pose3D((-1.0, -1.0, 0.7)))
    assert names(World("w", (solid,)), (0.0, 0.0, 0.0)) == []


def test_tilted_cells_are_refused():
    solid = Solid("map", OccupancyCells(np.ones((4, 4), dtype=bool), 0.5, 1.0), Pose3D((0, 0, 0), (0.9, 0.1, 0, 0)))
    with pytest.raises(WorldError, match="must be level"):
        FootprintChecker(World("w", (solid,)), ROBOT)


def test_depth_of_two_squares():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    depth = polygon_depth(square[None], np.stack([square + np.array(by) for by in ((0.75, 0.1), (1.25, 0.0))]))
    assert depth[0] == pytest.approx([0.25, -0.25])
