"""A robot that stands closer to something than it is to keep gets away, and recovery obeys the same rule."""

import numpy as np
import pytest

from trundle.control.collision import FOOTPRINT_PADDING_M
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, run
from trundle.navigation import NavigationStatus, Navigator
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
REAR, FRONT = float(CARTER.outline[:, 0].min()), float(CARTER.outline[:, 0].max())


def room(*boxes):
    """10 x 10 m with its lower-left corner at (0, 0), and boxes (x0, y0, x1, y1) [m] in it."""
    data = np.zeros((200, 200), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    for x0, y0, x1, y1 in boxes:
        data[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = 100
    return OccupancyGrid(data, 0.05)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
@pytest.mark.parametrize("goal", [(8.0, 5.0, 0.0), (8.0, 8.0, 1.5)])
def test_a_robot_whose_tail_is_next_to_a_corner_drives_away(backend, goal):
    grid = room((3.0, 5.0, 4.0, 6.0))
    start = Pose2D(4.0 - REAR + 0.0016, 5.0, 0.0)
    with simulate(World.from_map(grid), CARTER, backend=backend) as sim:
        episode = run(sim, Navigator(grid, CARTER), start, goal)
    assert episode.outcome is Outcome.ARRIVED
    assert not episode.metrics.contacts


class Standing:
    """A controller that never drives."""

    def set_path(self, path): ...

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D()


def back_up(grid, pose):
    """How far a robot drives back before something that its controller does not pass, and its clearances."""
    navigator = Navigator(grid, CARTER, controller=Standing())
    navigator.set_goal(8.0, 5.0)
    start, twist, poses = pose, Twist2D(), [pose.as_tuple()]
    for _ in range(400):
        command = navigator.update(pose, twist)
        for _ in range(10):
            twist = CARTER.limits.approach(twist, command, navigator.dt / 10)
            pose = twist.integrate(pose, navigator.dt / 10)
        poses.append(pose.as_tuple())
        if navigator.status is NavigationStatus.STUCK:
            break
    return start.distance_to(pose), navigator.costmap.clearance(np.array(poses), cap=0.5)


def test_backing_up_keeps_the_padding_behind():
    gap = 0.1
    driven, clearances = back_up(room((3.0, 4.0, 4.0, 6.0)), Pose2D(4.0 - REAR + gap, 5.0, 0.0))
    assert 0.0 < driven < gap
    assert clearances.min() >= FOOTPRINT_PADDING_M - 1e-6


def test_it_stays_where_the_tail_is_within_the_padding():
    driven, clearances = back_up(room((3.0, 4.0, 4.0, 6.0)), Pose2D(4.0 - REAR + 0.004, 5.0, 0.0))
    assert driven == 0.0
    assert clearances.min() == pytest.approx(0.004, abs=1e-6)


def test_it_backs_up_where_the_nose_is():
    driven, clearances = back_up(room((6.0, 4.0, 7.0, 6.0)), Pose2D(6.0 - FRONT - 0.004, 5.0, 0.0))
    assert driven > 0.25
    assert np.all(np.diff(clearances) >= -1e-6)
