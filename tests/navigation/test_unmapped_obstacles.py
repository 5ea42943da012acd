"""Drives with a lidar among obstacles that are not on the map, or without a map."""

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, block, grid_of, room
from support.sensed_runs import Run
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.observation import Scan
from trundle.worlds import World
from trundle.worlds.movers import Mover, Waypoints, person_body


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_it_drives_round_a_box_that_is_not_on_the_map(backend):
    navigator = Navigator(grid_of(room()), ROBOT)
    run = Run(room(block("box", 4.6, 2.5, 5.4, 3.5)), navigator, backend=backend)
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert navigator.replans >= 1
    assert any(message.startswith("blocked: obstacle ahead at (4.") for message in run.messages)
    assert navigator.message == ""


def test_it_takes_another_aisle_where_one_is_closed():
    shelf = block("shelf", 3.0, 2.2, 7.0, 3.8)
    navigator = Navigator(grid_of(room(shelf)), ROBOT)
    run = Run(room(shelf, block("pallet", 5.0, 0.3, 5.5, 2.0)), navigator, Pose2D(1.5, 1.2), Pose2D(8.5, 1.2))
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert max(pose.y for pose in run.poses) > 4.0


def test_without_a_path_it_gives_up_after_its_patience():
    settings = NavigatorSettings(patience_s=4.0, wait_s=0.5)
    navigator = Navigator(grid_of(room()), ROBOT, settings=settings)
    run = Run(room(block("closed", 5.0, 0.1, 5.4, 5.9)), navigator)
    assert (navigator.status, run.contact) == (NavigationStatus.NO_PATH, "")
    assert NavigationStatus.BLOCKED in run.statuses
    assert navigator.error is not None
    assert run.time < 60.0


def test_it_drives_without_a_map():
    shelf = block("shelf", 3.0, 1.5, 4.0, 6.0)
    other = block("other", 6.0, 0.0, 7.0, 4.5)
    navigator = Navigator(None, ROBOT)
    run = Run(room(shelf, other), navigator, Pose2D(1.5, 4.5), Pose2D(8.5, 2.0))
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert navigator.grid is None
    assert navigator.costmap.unknown == "costly"


def test_a_goal_that_something_stands_on_is_reached_within_its_tolerance():
    settings = NavigatorSettings(goal_tolerance=0.8)
    navigator = Navigator(grid_of(room()), ROBOT, settings=settings)
    run = Run(room(block("box", 8.35, 2.85, 8.65, 3.15)), navigator)
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert run.pose.distance_to(GOAL) <= 0.8


def test_a_goal_that_cannot_be_reached_within_its_tolerance_is_given_up_with_the_reason():
    navigator = Navigator(grid_of(room()), ROBOT, settings=NavigatorSettings(patience_s=3.0))
    run = Run(room(block("crate", 8.1, 2.6, 8.9, 3.4)), navigator)
    assert (navigator.status, run.contact) == (NavigationStatus.NO_PATH, "")
    assert "the goal (8.50, 3.00) is occupied by something that is not on the map" in str(navigator.error)
    assert any("is occupied by something" in message for message in run.messages)


def visitor(seconds):
    """A person who walks to the goal, and away from it after so many seconds."""
    there = Waypoints([(0.0, 8.5, 5.2), (4.0, 8.5, 3.0), (4.0 + seconds, 8.5, 3.0), (8.0 + seconds, 8.5, 5.2)])
    return Mover("visitor", person_body(), there)


@pytest.mark.parametrize(("stays_s", "status"), [(12.0, NavigationStatus.ARRIVED), (60.0, NavigationStatus.NO_PATH)])
def test_it_waits_for_what_was_seen_to_move_to_leave_the_goal(stays_s, status):
    settings = NavigatorSettings(patience_s=3.0, mover_patience_s=20.0)
    navigator = Navigator(grid_of(room()), ROBOT, settings=settings)
    world = World("room", room().solids, movers=(visitor(stays_s + 4.0),))
    run = Run(world, navigator, Pose2D(4.0, 3.0))
    assert (navigator.status, run.contact) == (status, "")
    assert navigator.standing_reasons["goal occupied"] > 20
    assert run.time > stays_s if status is NavigationStatus.ARRIVED else run.time < 60.0


AISLE = (block("south_shelf", 2.0, 0.1, 8.0, 2.0), block("north_shelf", 2.0, 4.0, 8.0, 5.9))
CART = (Solid("cart", Box((0.6, 1.6, 1.0)), Pose3D.planar(0.0, 0.0, 0.5, 0.0)),)
REACH = 0.3 + max(x for x, _ in ROBOT.planar.outline)


def test_it_leaves_room_to_what_moves_and_blocks_the_aisle():
    """A cart drives out of an aisle only while nothing stands right before it."""
    there = Waypoints([(0.0, 7.0, 3.0), (4.0, 5.0, 3.0), (24.0, 5.0, 3.0), (32.0, 11.5, 3.0), (35.0, 11.5, 4.5)])
    world = World("aisle", room(*AISLE, width=13.0).solids, movers=(Mover("cart", CART, there),))
    navigator = Navigator(grid_of(room(*AISLE, width=13.0)), ROBOT)
    run = Run(world, navigator)
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert NavigationStatus.BLOCKED in run.statuses
    waiting = [5.0 - pose.x - REACH for pose, time in run.timed if 9.0 < time < 14.0]
    assert min(waiting) > 1.0
    assert max(waiting) < 1.6


def test_it_backs_up_from_what_stopped_right_before_it():
    stops = [(0.0, 9.0, 3.0), (4.0, 6.5, 3.0), (10.0, 6.5, 3.0), (12.0, 5.8, 3.0), (30.0, 5.8, 3.0)]
    there = Waypoints([*stops, (37.0, 11.5, 3.0), (40.0, 11.5, 4.5)])
    world = World("aisle", room(*AISLE, width=13.0).solids, movers=(Mover("cart", CART, there),))
    navigator = Navigator(grid_of(room(*AISLE, width=13.0)), ROBOT)
    run = Run(world, navigator, Pose2D(3.0, 3.0))
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert "back_up" in [behavior.behavior for behavior in navigator.behavior_runs]
    assert next(5.8 - pose.x - REACH for pose, time in run.timed if time > 25.0) > 0.9


def test_before_it_gives_up_it_forgets_what_closed_another_aisle():
    """Of two aisles one is closed; the other one was when it was last seen."""
    shelf = block("shelf", 3.0, 2.2, 13.0, 3.8)
    closed = block("closed", 10.0, 0.1, 10.4, 2.1)
    cart = (Solid("cart", Box((0.5, 2.0, 1.0)), Pose3D.planar(0.0, 0.0, 0.5, 0.0)),)
    leaves = Waypoints([(0.0, 5.0, 4.9), (12.0, 5.0, 4.9), (18.0, 15.0, 4.9)])
    near = ROBOT.lidars["front"].model_copy(update={"range_max": 4.0})
    robot = ROBOT.model_copy(update={"lidars": {"front": near}})
    world = World("aisles", room(shelf, closed, width=16.0).solids, movers=(Mover("cart", cart, leaves),))
    navigator = Navigator(grid_of(room(shelf, width=16.0)), robot, settings=NavigatorSettings(patience_s=3.0))
    run = Run(world, navigator, Pose2D(1.5, 4.8), Pose2D(14.4, 2.0), seconds=150.0, robot=robot)
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert max(pose.x for pose in run.poses if pose.y < 2.2 and pose.x < 10.0) > 5.0


class Ghost:
    """Adds what a lidar at the front would see of a wall across the room, for some seconds."""

    def __init__(self, x, until):
        self.x, self.until = x, until

    def __call__(self, state):
        if state.time > self.until:
            return state.scans
        return tuple(self.see(scan, state.pose @ scan.mount) for scan in state.scans)

    def see(self, scan, sensor):
        ahead = np.cos(scan.angles + sensor.yaw)
        with np.errstate(divide="ignore"):
            ranges = np.where(ahead > 0.0, (self.x - sensor.x) / ahead, np.inf)
        ranges = np.minimum(np.where(ranges > 0.0, ranges, np.inf), scan.ranges)
        return Scan(scan.lidar, scan.time, scan.mount, scan.height, scan.angles, ranges, scan.range_min, scan.range_max)


def test_a_false_obstacle_that_vanishes_only_delays_it():
    navigator = Navigator(grid_of(room()), ROBOT, settings=NavigatorSettings(planning_deadline_s=None))
    run = Run(room(), navigator, change=Ghost(5.0, until=8.0))
    assert (navigator.status, run.contact) == (NavigationStatus.ARRIVED, "")
    assert NavigationStatus.BLOCKED in run.statuses
    assert 8.0 < run.time < 30.0
    assert max(abs(pose.y - 3.0) for pose in run.poses) < 1.0


def test_it_waits_for_what_may_move_where_the_detour_is_long():
    shelf = block("shelf", 2.0, 2.2, 18.0, 3.8)
    world = room(shelf, width=20.0)
    navigator = Navigator(grid_of(world), ROBOT, settings=NavigatorSettings(wait_s=6.0))
    start, goal = Pose2D(4.0, 1.2), Pose2D(16.0, 1.2)
    run = Run(world, navigator, start, goal, change=Ghost(7.0, until=5.0))
    assert navigator.status is NavigationStatus.ARRIVED
    assert max(pose.y for pose in run.poses) < 2.2
    patient = run.time
    navigator = Navigator(grid_of(world), ROBOT, settings=NavigatorSettings(wait_s=0.0))
    run = Run(world, navigator, start, goal, change=Ghost(7.0, until=5.0), seconds=20.0)
    assert min(pose.x for pose in run.poses) < 3.9 or run.time > patient
