"""Planners, controllers, agents and localizers as users write them, and every way to give them."""

import math
from pathlib import Path as FilePath

import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus
from trundle.path import Path
from trundle.planning import create_planner
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
START, GOAL = Pose2D(2.0, 2.0, 0.0), Pose2D(5.0, 3.0, 0.5)


def room() -> OccupancyGrid:
    data = np.zeros((100, 140), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    return OccupancyGrid(data, 0.05)


# What users write -----------------------------------------------------------------------------------------------------


def plan_points(costmap, start, goal):
    """Points of a straight line, or what a planner of ours finds."""
    points = np.linspace((start.x, start.y), (goal.x, goal.y), 200)
    yaw = math.atan2(goal.y - start.y, goal.x - start.x)
    if costmap.footprint_collides(np.column_stack([points, np.full(200, yaw)])).any():
        return create_planner("least_cost").plan(costmap, start, goal)
    return points


class PointsPlanner:
    """With the robot, the map and an option, and with no keyword of the protocol."""

    def __init__(self, robot, map, count=200):
        self.robot, self.map, self.count = robot, map, count

    def plan(self, costmap, start, goal):
        return plan_points(costmap, start, goal)


def aim(pose, path, robot, gain):
    """Turn to the end of the path, and drive there."""
    limits, goal = robot.limits, path.goal
    distance = math.hypot(goal.x - pose.x, goal.y - pose.y)
    if distance < 0.1:
        error = wrap_angle(goal.yaw - pose.yaw)
        return Twist2D(0.0, max(-0.5, min(0.5, gain * error)) if abs(error) > 0.02 else 0.0)
    error = wrap_angle(math.atan2(goal.y - pose.y, goal.x - pose.x) - pose.yaw)
    v = min(0.5 * limits.linear_speed, distance) if abs(error) < 0.1 else 0.0
    return Twist2D(v, max(-0.5, min(0.5, gain * error)))


def aim_controller(pose, twist, costmap, dt, path, *, robot, gain=2.0):
    return aim(pose, path, robot, gain)


class AimController:
    """With the methods alone that it must have."""

    def __init__(self, robot, gain=2.0):
        self.robot, self.gain, self.path = robot, gain, None

    def set_path(self, path):
        self.path = path

    def compute_velocity(self, pose, twist, costmap, dt):
        return Twist2D() if self.path is None else aim(pose, self.path, self.robot, self.gain)


def aim_agent(observation, estimate, goal, *, robot, gain=2.0):
    return aim(estimate.pose, Path(np.array([goal.pose.as_tuple()])), robot, gain)


class AimAgent:
    def __init__(self, robot, gain=2.0):
        self.robot, self.gain, self.status, self.goal = robot, gain, NavigationStatus.IDLE, None

    def reset(self, *, seed=0):
        self.goal, self.status = None, NavigationStatus.IDLE

    def set_goal(self, goal):
        self.goal, self.status = goal, NavigationStatus.DRIVING

    def update(self, observation, estimate):
        command = aim_agent(observation, estimate, self.goal, robot=self.robot, gain=self.gain)
        if estimate.pose.distance_to(self.goal.pose) < 0.1 and command == Twist2D():
            self.status = NavigationStatus.ARRIVED
        return command


def believe_odometry(observation):
    """In a simulation the odometry begins at the start pose."""
    return observation.odometry


class BelieveOdometry:
    def __init__(self, map, robot, shift=0.0):
        self.map, self.shift = map, shift

    def reset(self, pose):
        self.start, self.first = pose, None

    def update(self, observation):
        self.first = self.first or self.start @ observation.odometry.inverse()
        return self.first @ observation.odometry


def ways():
    """Every way to give each kind, with objects of their own for each test."""
    return {
        "planner": [PointsPlanner, plan_points, PointsPlanner(CARTER, None), lambda: PointsPlanner(CARTER, None)],
        "controller": [AimController, aim_controller, AimController(CARTER), lambda robot: AimController(robot)],
        "agent": [AimAgent, aim_agent, AimAgent(CARTER), lambda robot: AimAgent(robot)],
        "localizer": [BelieveOdometry, believe_odometry, BelieveOdometry(None, CARTER)],
    }


NAMES = {
    "planner": ["PointsPlanner", "plan_points"],
    "controller": ["AimController", "aim_controller"],
    "agent": ["AimAgent", "aim_agent"],
    "localizer": ["BelieveOdometry", "believe_odometry"],
}
HERE = FilePath(__file__)


def label(value):
    text = value if isinstance(value, str) else getattr(value, "__name__", f"a {type(value).__name__}")
    return text.rpartition("/")[2]


def every_way(test):
    given = [(kind, way) for kind, several in ways().items() for way in several]
    given += [(kind, f"{place}:{name}") for kind in NAMES for name in NAMES[kind] for place in (__name__, HERE)]
    return pytest.mark.parametrize(("kind", "given"), given, ids=label)(test)
