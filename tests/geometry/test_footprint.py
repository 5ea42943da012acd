import dataclasses
import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Footprint, pad_outline
from trundle.maps import OccupancyGrid
from trundle.robots import Robot

CORNERS = ((0.3, 0.2), (-0.1, 0.2), (-0.1, -0.2), (0.3, -0.2))


def test_its_radii_are_those_of_the_nearest_edge_and_the_farthest_corner():
    footprint = Footprint(np.array(CORNERS))
    assert footprint.inscribed_radius == pytest.approx(0.1)
    assert footprint.circumscribed_radius == pytest.approx(np.hypot(0.3, 0.2))


def test_corners_become_counter_clockwise_and_read_only_and_are_copied():
    given = np.array(CORNERS[::-1])
    footprint = Footprint(given)
    given[:] = 0.0
    assert footprint.outline.tolist() == [list(corner) for corner in CORNERS]
    with pytest.raises(ValueError, match="read-only"):
        footprint.outline[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        footprint.inscribed_radius = 1.0


def test_padding_moves_every_edge_outwards():
    padded = Footprint(np.array(CORNERS)).padded(0.05)
    assert np.array_equal(padded.outline, pad_outline(np.array(CORNERS), 0.05))
    assert padded.inscribed_radius == pytest.approx(0.15)


def test_a_padding_below_zero_is_refused():
    with pytest.raises(InputError, match=r"0 m or more, got -0\.01"):
        Footprint(np.array(CORNERS)).padded(-0.01)


def test_a_padded_footprint_equals_one_made_of_its_corners():
    padded = Footprint(np.array(CORNERS)).padded(0.05)
    again = Footprint(padded.outline)
    assert np.array_equal(padded.outline, again.outline)
    assert padded.inscribed_radius == again.inscribed_radius
    assert padded.circumscribed_radius == again.circumscribed_radius
    with pytest.raises(ValueError, match="read-only"):
        padded.outline[0, 0] = 1.0


def test_shrinking_may_leave_base_link_outside_or_nothing():
    footprint = Footprint(np.array(CORNERS))
    left = footprint.shrink(0.15)
    assert left is not None
    np.testing.assert_allclose([left.min(axis=0), left.max(axis=0)], [(0.05, -0.05), (0.15, 0.05)])
    assert footprint.shrink(0.2) is None


def test_its_size_and_its_corners_at_poses():
    footprint = Footprint(np.array(CORNERS))
    assert footprint.size == pytest.approx((0.4, 0.4))
    poses = np.array([[1.0, 2.0, 0.0], [1.0, 2.0, np.pi / 2.0]])
    placed = footprint.at_poses(poses)
    assert placed.shape == (2, 4, 2)
    np.testing.assert_allclose(placed[0, 0], (1.3, 2.2))
    np.testing.assert_allclose(placed[1, 0], (0.8, 2.3))


def test_an_updated_costmap_keeps_the_footprint():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((40, 40), np.int8), 0.05), CORNERS)
    assert costmap.update(slice(3, 4), slice(3, 4), 100).planar is costmap.planar


@pytest.mark.parametrize(
    ("corners", "words"),
    [
        (CORNERS[:2], "at least 3 finite corners"),
        (((0.3, 0.2), (-0.1, 0.2), (-0.1, float("nan"))), "at least 3 finite corners"),
        ("corners", "a robot or corners of shape"),
        ((*CORNERS, (0.3, 0.0)), "convex outline"),
        ((*CORNERS, CORNERS[0]), "convex outline"),
        ([(np.cos(t), np.sin(t)) for t in np.arange(5) * 4.0 * np.pi / 5.0], "once round a convex outline"),
        ([(x + 1.0, y) for x, y in CORNERS], "must lie inside the footprint"),
    ],
)
def test_what_is_no_footprint_is_refused(corners, words):
    with pytest.raises(InputError, match=words):
        Footprint(corners)


def test_a_robot_and_its_costmap_have_one_footprint():
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid(np.zeros((40, 40), np.int8), 0.05)
    for given in (robot, robot.planar, robot.outline):
        costmap = Costmap.from_grid(grid, given)
        assert (costmap.planar is robot.planar) == (given is not robot.outline)
        assert np.array_equal(costmap.footprint, robot.outline)
        radii = robot.inscribed_radius, robot.circumscribed_radius
        assert (costmap.inscribed_radius, costmap.circumscribed_radius) == radii


def test_the_least_width_is_that_of_the_narrowest_gap_wherever_base_link_is():
    for turn in (0.0, 0.3, 1.2):
        cos, sin = math.cos(turn), math.sin(turn)
        corners = np.array([(-0.1, -0.3), (0.7, -0.3), (0.7, 0.2), (-0.1, 0.2)]) @ ((cos, sin), (-sin, cos))
        assert Footprint(corners).least_width == pytest.approx(0.5)
        assert Footprint(corners).inscribed_radius == pytest.approx(0.1)
    side = 2.0  # the width of a triangle is its height
    triangle = [(-1.0, -0.5), (1.0, -0.5), (0.0, side * math.sqrt(0.75) - 0.5)]
    assert Footprint(triangle).least_width == pytest.approx(side * math.sqrt(0.75))
