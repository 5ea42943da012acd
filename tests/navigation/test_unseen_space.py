import numpy as np
import pytest

from trundle.control.collision import stopping_poses
from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.command_check import slow_down_in_unseen
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
FRONT = float(CARTER.outline[:, 0].max())
HERE, DT = Pose2D(3.0, 3.0), 0.05
SLOW = CARTER.limits.model_copy(update={"linear_acceleration": 0.3})


def seen_up_to(distance, unknown="costly"):
    """An open floor of which nothing was seen that is farther than `distance` [m] ahead of the robot."""
    cells = np.zeros((120, 200), np.int8)
    cells[:, round((HERE.x + FRONT + distance) / 0.05) :] = -1
    return Costmap.from_grid(OccupancyGrid(cells, 0.05), CARTER, unknown=unknown)


def slowed(costmap, command, limits=SLOW, twist=None):
    return slow_down_in_unseen(
        costmap, limits, HERE, command if twist is None else twist, command, DT, padded=CARTER.outline
    )


def test_a_command_that_stops_in_seen_space_passes():
    assert slowed(seen_up_to(3.0), Twist2D(0.8, 0.1)) == Twist2D(0.8, 0.1)


@pytest.mark.parametrize("distance", [0.1, 0.3, 0.6])
def test_a_command_is_slowed_until_it_stops_in_seen_space(distance):
    command = slowed(seen_up_to(distance), Twist2D(0.8, 0.0), twist=Twist2D())
    assert 0.0 < command.v <= 0.8
    reached = stopping_poses(HERE, Twist2D(), command, SLOW, DT)[:, 0].max() + FRONT
    assert reached <= HERE.x + FRONT + distance + 1e-9


def test_beside_unseen_space_it_creeps_on():
    command = slowed(seen_up_to(-0.02), Twist2D(0.8, 0.4))
    assert 0.0 < command.v <= 0.05
    assert command.w == pytest.approx(0.5 * command.v)


def test_blocked_unknown_space_is_left_to_the_controller():
    assert slowed(seen_up_to(0.1, unknown="blocked"), Twist2D(0.8, 0.0)) == Twist2D(0.8, 0.0)


def test_where_it_stands_it_has_seen_enough_to_drive_on():
    # Everything was seen from a lidar at the front but the rear, and the cells that the robot itself hides.
    cells = np.zeros((120, 200), np.int8)
    rear, side = HERE.x + float(CARTER.outline[:, 0].min()), float(CARTER.outline[:, 1].max())
    cells[:, : round(rear / 0.05)] = -1
    cells[round((HERE.y - side) / 0.05) - 1 : round((HERE.y + side) / 0.05) + 1, : round((HERE.x - 0.2) / 0.05)] = -1
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), CARTER, unknown="costly")
    padded = CARTER.planar.padded(0.01).outline
    command = slow_down_in_unseen(costmap, CARTER.limits, HERE, Twist2D(), Twist2D(0.8, 0.0), DT, padded=padded)
    assert command == Twist2D(0.8, 0.0)
