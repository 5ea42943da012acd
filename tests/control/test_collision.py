"""The way that a robot takes to stop, against the kinematic simulator."""

import math

import numpy as np
import pytest

from trundle.control.collision import stopping_poses
from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

DT = 0.05


@pytest.mark.parametrize("robot", ["nova_carter", "jackal", "turtlebot3_waffle"])
@pytest.mark.parametrize("share", [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.6, -1.0), (0.0, 1.0)])
def test_the_way_to_a_stop_is_as_long_as_it_is_driven(robot, share):
    robot = Robot.load(robot)
    limits = robot.limits
    command = Twist2D(share[0] * limits.linear_speed, share[1] * limits.angular_speed)
    with simulate(World("free", ()), robot, backend="kinematic") as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        for _ in range(40):  # to its top speed, straight
            state = sim.step(Twist2D(limits.linear_speed, 0.0), DT)
        expected = stopping_poses(state.pose, state.twist, command, limits, DT)
        driven = []
        state = sim.step(command, DT)
        driven.append(state.pose.as_tuple())
        while abs(state.twist.v) > 1e-9 or abs(state.twist.w) > 1e-9:
            state = sim.step(Twist2D(), DT)
            driven.append(state.pose.as_tuple())
    assert len(driven) == len(expected)
    apart = np.array(driven) - np.array(expected)
    # Where speeds level off within a step, their mean is taken for all of it; the simulator has steps of 5 ms.
    slack = 0.5 * limits.linear_acceleration * DT**2
    assert np.hypot(apart[:, 0], apart[:, 1]).max() < slack + 4e-3
    assert abs(apart[:, 2]).max() < 0.5 * limits.angular_acceleration * DT**2 + 2e-3
    stop = math.dist(expected[-1][:2], (0.0, 0.0)) - math.dist(driven[-1][:2], (0.0, 0.0))
    assert stop > -4e-3
