"""The stopping distance of a robot, against the kinematic simulator."""

import math

import numpy as np
import pytest

from trundle.control.collision import can_stop, stopping_poses
from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

DT = 0.05


@pytest.mark.parametrize("robot", ["nova_carter", "jackal", "turtlebot3_waffle"])
@pytest.mark.parametrize("share", [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.6, -1.0), (0.0, 1.0)])
def test_the_stopping_distance_is_the_one_driven(robot, share):
    robot = Robot.load(robot)
    limits = robot.limits
    command = Twist2D(share[0] * limits.linear_speed, share[1] * limits.angular_speed)
    with simulate(World("free", ()), robot, backend="kinematic") as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        for _ in range(40):  # to its top speed, straight
            state = sim.step(Twist2D(limits.linear_speed, 0.0), DT)
        _, *expected = stopping_poses(state.pose, state.twist, command, limits, DT).tolist()
        driven = []
        state = sim.step(command, DT)
        driven.append(state.pose.as_tuple())
        while abs(state.twist.v) > 1e-9 or abs(state.twist.w) > 1e-9:
            state = sim.step(Twist2D(), DT)
            driven.append(state.pose.as_tuple())
    assert len(driven) == len(expected)
    apart = np.array(driven) - np.array(expected)
    # Where speeds level off within a step, their mean is used for all of it; the simulator has steps of 5 ms.
    slack = 0.5 * limits.linear_acceleration * DT**2
    assert np.hypot(apart[:, 0], apart[:, 1]).max() < slack + 4e-3
    assert abs(apart[:, 2]).max() < 0.5 * limits.angular_acceleration * DT**2 + 2e-3
    stop = math.dist(expected[-1][:2], (0.0, 0.0)) - math.dist(driven[-1][:2], (0.0, 0.0))
    assert stop > -4e-3


def test_a_fast_turn_is_tested_between_its_steps():
    robot = Robot.load("turtlebot3_burger")
    grid = OccupancyGrid(np.zeros((80, 80), np.int8), 0.05)
    corner = math.atan2(0.105, -0.105)
    radius = math.hypot(0.105, 0.105)
    command = Twist2D(0.0, robot.limits.angular_speed)
    yaw = -math.pi / 2 - 3.5 * 0.05 * command.w
    _, *poses = stopping_poses(Pose2D(0.0, 0.0, yaw), command, command, robot.limits, 1.0).tolist()
    step = poses[0][2] - yaw
    assert step == pytest.approx(math.radians(8.14), abs=1e-3)
    finer = stopping_poses(Pose2D(0.0, 0.0, yaw), command, command, robot.limits, 1.0, turn_step=math.radians(2))
    assert finer[-1] == pytest.approx(poses[-1])
    assert np.diff(finer[:, 2]).max() <= math.radians(2) + 1e-12
    # A tail's corner points to the cell's corner at (2, 2) halfway between two of the coarse poses.
    meets = yaw + 3.5 * step
    costmap = Costmap.from_grid(grid, robot).update(slice(40, 41), slice(40, 41), 100)
    for apart, free in ((radius + 1e-4, True), (radius - 1e-4, False)):
        toward = meets + corner
        x, y = 2.0 - apart * math.cos(toward), 2.0 - apart * math.sin(toward)
        pose = Pose2D(x, y, yaw)
        placed = [(px + x, py + y, angle) for px, py, angle in poses]
        assert not costmap.footprint_collides([pose.as_tuple(), *placed]).any()
        assert can_stop(costmap, robot.limits, pose, command, command, 1.0, padded=robot.outline) == free


def test_a_robot_may_drive_off_what_it_touches():
    robot = Robot.load("nova_carter")
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((80, 80), np.int8), 0.05), robot)
    costmap = costmap.update(slice(40, 41), slice(40, 41), 100)
    pose = Pose2D(2.0 + 0.05 + 0.607 - 1e-3, 2.025, 0.0)
    assert costmap.footprint_collides([pose.as_tuple()])[0]
    assert can_stop(costmap, robot.limits, pose, Twist2D(0.2, 0.0), Twist2D(0.2, 0.0), 0.05, padded=robot.outline)
    assert not can_stop(costmap, robot.limits, pose, Twist2D(-0.2, 0.0), Twist2D(-0.2, 0.0), 0.05, padded=robot.outline)


@pytest.mark.parametrize("depth", [0.03, 0.07, 0.13])
def test_a_robot_that_was_pushed_against_something_may_leave_it_but_not_press_on(depth):
    robot = Robot.load("nova_carter")
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((80, 80), np.int8), 0.05), robot)
    costmap = costmap.update(slice(20, 60), slice(40, 41), 100)  # a wall at x = 2, behind the robot
    pose = Pose2D(2.05 + 0.607 - depth, 2.025, 0.0)
    assert costmap.clearance(pose.as_tuple())[0] == 0.0

    def passes(v, w):
        return can_stop(costmap, robot.limits, pose, Twist2D(), Twist2D(v, w), 0.05, padded=robot.outline)

    assert passes(0.2, 0.0)
    assert not passes(-0.2, 0.0)
    assert not passes(0.0, 0.5)
