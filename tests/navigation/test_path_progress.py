"""A robot that drives and gets nowhere recovers, and gives up in the end; one whose path gets longer drives on."""

import math

import numpy as np
import pytest

from support.walled_rooms import walled_room
from trundle.control import create_controller
from trundle.geometry import Pose2D, Twist2D
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.path import Path
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
ROOM = walled_room(width=24.0, depth=8.0)
DRIVING, BLOCKED = NavigationStatus.DRIVING, NavigationStatus.BLOCKED


def drive(navigator, pose, *, seconds=400.0, watch=lambda navigator, pose: None):
    """Drive ideally within the limits until the navigator is done; return the last pose and the distance driven [m]."""
    twist, time, driven = Twist2D(), 0.0, 0.0
    while time < seconds:
        watch(navigator, pose)
        command = navigator.update(pose, twist, time=time)
        if navigator.status not in (DRIVING, BLOCKED):
            break
        twist = navigator.robot.limits.approach(twist, command, navigator.dt)
        pose, time = twist.integrate(pose, navigator.dt), time + navigator.dt
        driven += abs(twist.v) * navigator.dt
    return pose, driven


class ToAndFro:
    """Follows its path for a while, and then drives to and fro, or turns."""

    def __init__(self, *, from_x=8.0, turns=False):
        self.inner, self.from_x, self.turns, self.speed = (
            create_controller("regulated_pure_pursuit", CARTER),
            from_x,
            turns,
            0.6,
        )

    def set_path(self, path):
        self.inner.set_path(path)

    def compute_velocity(self, pose, twist, costmap, dt):
        if pose.x < self.from_x - 2.0 and self.speed > 0.0:
            return self.inner.compute_velocity(pose, twist, costmap, dt)
        if self.turns:
            self.speed = -0.01
            return Twist2D(0.0, 0.6)
        if pose.x > self.from_x:
            self.speed = -0.6
        if self.speed < 0.0 and pose.x < self.from_x - 2.0:
            self.speed = 0.6
        return Twist2D(self.speed, 0.0)


@pytest.mark.parametrize("turns", [False, True])
@pytest.mark.parametrize("recovery", ["replan,back_up", ()])
def test_a_robot_that_moves_and_gets_nowhere_gives_up(recovery, turns):
    settings = NavigatorSettings(recovery=recovery)
    navigator = Navigator(ROOM, CARTER, controller=ToAndFro(turns=turns), settings=settings)
    navigator.set_goal(20.0, 4.0)
    _, driven = drive(navigator, Pose2D(2.0, 4.0))
    assert navigator.status is NavigationStatus.STUCK
    assert navigator.message == "no progress along the path"
    assert {ran.reason for ran in navigator.behavior_runs} == ({navigator.message} if recovery else set())
    assert driven < 75.0


def test_it_gives_up_on_a_given_path_too():
    navigator = Navigator(ROOM, CARTER, controller=ToAndFro())
    navigator.follow(Path([(2.0, 4.0, 0.0), (20.0, 4.0, 0.0)]))
    _, driven = drive(navigator, Pose2D(2.0, 4.0))
    assert navigator.status is NavigationStatus.STUCK
    assert driven < 20.0


def test_a_path_that_gets_longer_again_and_again_is_no_reason_to_give_up():
    # Ten walls, each with a gap at the other end, each seen once the robot stands before it: 60 m instead of 19.
    navigator = Navigator(ROOM, CARTER)
    walls = [(2.0 + 2.0 * k, k % 2) for k in range(1, 10)]

    def build(navigator, pose):
        while walls and pose.x > walls[0][0] - 1.1:
            x, at_top = walls.pop(0)
            rows = slice(26, 160) if at_top else slice(0, 134)
            cols = slice(round(x / 0.05), round(x / 0.05) + 2)
            navigator.static_costmap = navigator.static_costmap.update(rows, cols, 100)

    navigator.set_goal(22.5, 4.0)
    _, driven = drive(navigator, Pose2D(1.5, 4.0), watch=build)
    assert navigator.status is NavigationStatus.ARRIVED
    assert not walls
    assert driven > 50.0
    assert navigator.behavior_runs == ()


class Flicker:
    """Blocks the one passage, and then the other, whenever the robot comes near."""

    def __init__(self, costmap):
        middle, rest = slice(239, 241), [slice(0, 20), slice(60, 100), slice(140, 160)]
        for rows in rest:
            costmap = costmap.update(rows, middle, 100)
        self.views = [costmap.update(slice(20, 60), middle, 100), costmap.update(slice(100, 140), middle, 100)]

    def __call__(self, navigator, pose):
        if not self.views or pose.x < 10.5:
            return
        low = pose.y < 4.0
        if navigator.static_costmap is not self.views[1 - low]:
            navigator.static_costmap = self.views[1 - low]


def test_a_robot_that_is_sent_from_one_passage_to_the_other_gives_up():
    navigator = Navigator(ROOM, CARTER)
    flicker = Flicker(navigator.static_costmap)
    navigator.static_costmap = flicker.views[0]
    navigator.set_goal(22.0, 4.0)
    _, driven = drive(navigator, Pose2D(2.0, 4.0), seconds=3000.0, watch=flicker)
    assert navigator.status is NavigationStatus.STUCK
    assert navigator.message == "no progress along the path"
    assert driven < 500.0


@pytest.mark.parametrize(
    ("controller", "at_least"),
    [("regulated_pure_pursuit", 25.0), ("lookahead", 25.0), ("mppi", 15.0)],  # mppi takes its own course
)
def test_a_path_that_crosses_itself_is_driven_to_its_end(controller, at_least):
    angles = np.linspace(0.4, 2.0 * math.pi - 0.4, 181)
    loop = np.column_stack([12.0 + 6.0 * np.sin(angles), 4.0 + 2.4 * np.sin(2.0 * angles)])
    yaws = np.arctan2(*np.gradient(loop, axis=0).T[::-1])
    poses = np.column_stack([loop, yaws])
    navigator = Navigator(ROOM, CARTER, controller=controller)
    navigator.follow(Path(poses))
    _, driven = drive(navigator, Pose2D(*poses[0]))
    assert navigator.status is NavigationStatus.ARRIVED
    assert driven > at_least
    assert navigator.behavior_runs == ()
