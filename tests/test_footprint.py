import dataclasses

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.footprint import Footprint
from trundle.geometry import pad_outline
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
        assert np.array_equal(costmap.footprint, robot.outline)
        radii = robot.inscribed_radius, robot.circumscribed_radius
        assert (costmap.inscribed_radius, costmap.circumscribed_radius) == radii
