"""What a robot may do that is closer to something than it is to keep: whatever leads away."""

import math

import numpy as np
import pytest

from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop, stopping_poses
from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D, pad_outline
from trundle.maps import OccupancyGrid
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
PADDED = pad_outline(CARTER.outline, FOOTPRINT_PADDING_M)
REAR = float(CARTER.outline[:, 0].min())
DT = 0.05


def room(*boxes):
    """10 x 10 m with its lower-left corner at (0, 0), and boxes (x0, y0, x1, y1) [m] in it."""
    data = np.zeros((200, 200), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    for x0, y0, x1, y1 in boxes:
        data[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER.outline)


BOX_BEHIND = room((3.0, 5.0, 4.0, 6.0))
TAIL_AT_A_CORNER = Pose2D(4.0 - REAR + 0.0016, 5.0, 0.0)


def may(costmap, pose, command, twist=Twist2D()):
    return can_stop(costmap, CARTER.limits, pose, twist, command, DT, padded=PADDED)


def test_away_from_what_is_within_the_padding_is_free():
    assert BOX_BEHIND.clearance([TAIL_AT_A_CORNER.as_tuple()])[0] == pytest.approx(0.0016, abs=1e-6)
    assert may(BOX_BEHIND, TAIL_AT_A_CORNER, Twist2D(0.8, 0.0))
    assert may(BOX_BEHIND, TAIL_AT_A_CORNER, Twist2D(0.1, 0.0))


def test_towards_it_is_not():
    assert not may(BOX_BEHIND, TAIL_AT_A_CORNER, Twist2D(-0.1, 0.0))
    # The left rear corner swings to the right and back, the right one to the box.
    assert not may(BOX_BEHIND, TAIL_AT_A_CORNER, Twist2D(0.0, -0.5))


def test_nor_on_while_it_still_rolls_towards_it():
    assert not may(BOX_BEHIND, TAIL_AT_A_CORNER, Twist2D(0.8, 0.0), Twist2D(-0.2, 0.0))


def test_what_leads_away_here_and_touches_something_there_is_not_free():
    ahead = TAIL_AT_A_CORNER.x + float(CARTER.outline[:, 0].max()) + 0.05
    costmap = room((3.0, 5.0, 4.0, 6.0), (math.ceil(ahead / 0.05) * 0.05, 4.5, 9.0, 5.5))
    assert may(costmap, TAIL_AT_A_CORNER, Twist2D(0.1, 0.0))
    assert not may(costmap, TAIL_AT_A_CORNER, Twist2D(0.8, 0.0), Twist2D(0.5, 0.0))


def test_a_robot_that_has_its_padding_keeps_it():
    outside = Pose2D(4.0 - REAR + FOOTPRINT_PADDING_M + 0.002, 5.0, 0.0)
    command = Twist2D(-0.02, 0.0)
    poses = stopping_poses(outside, Twist2D(-0.1, 0.0), command, CARTER.limits, DT)[1:]
    assert 0.0 < BOX_BEHIND.clearance(poses).min() < FOOTPRINT_PADDING_M
    assert not may(BOX_BEHIND, outside, command, Twist2D(-0.1, 0.0))


def test_a_robot_that_touches_something_on_the_map_may_only_leave_it():
    inside = Pose2D(TAIL_AT_A_CORNER.x - 0.01, 5.0, 0.0)
    assert may(BOX_BEHIND, inside, Twist2D(0.8, 0.0))
    assert not may(BOX_BEHIND, inside, Twist2D(-0.1, 0.0))
    assert not may(BOX_BEHIND, inside, Twist2D(0.0, -0.5))


@pytest.mark.parametrize("seed", range(5))
def test_no_command_that_is_let_through_touches_anything_or_reduces_the_clearance_within_the_padding(seed):
    rng = np.random.default_rng(seed)
    cells = rng.integers(0, 200, (60, 2))
    costmap = room(*[(0.05 * x, 0.05 * y, 0.05 * x + 0.1, 0.05 * y + 0.1) for x, y in cells])
    within = allowed = 0
    for _ in range(20_000):
        pose = Pose2D(*rng.uniform(1, 9, 2).tolist(), float(rng.uniform(-math.pi, math.pi)))
        here = costmap.clearance([pose.as_tuple()], cap=0.1)[0]
        if not 0.0 < here < FOOTPRINT_PADDING_M:
            continue
        command = Twist2D(float(rng.uniform(-0.8, 0.8)), float(rng.uniform(-1, 1)))
        within += 1
        if may(costmap, pose, command):
            allowed += 1
            poses = stopping_poses(pose, Twist2D(), command, CARTER.limits, DT)
            assert costmap.clearance(poses[1:], cap=0.1).min() >= min(here - 1e-5, FOOTPRINT_PADDING_M)
    assert 0 < allowed < within
