"""Behaviors by themselves: what they command, when they end, and what they refuse."""

import math

import numpy as np
import pytest

from trundle.errors import AngleWarning, InputError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator
from trundle.navigation.behaviors import (
    BackUp,
    Behavior,
    ClearCostmap,
    DriveClear,
    DriveOnHeading,
    Replan,
    ReplanWith,
    Spin,
    Wait,
    behavior_names,
    create_behavior,
)
from trundle.robots import Robot
from trundle.testing import check_behavior

CARTER = Robot.load("nova_carter")
ROOM = OccupancyGrid(np.zeros((160, 160), np.int8), 0.05)


def run_alone(behavior, *, robot=CARTER, start=(4.0, 4.0, 0.5), costmap=None, seconds=60.0):
    """Run one for a robot without a goal that moves ideally within its limits; return navigator, pose and time."""
    navigator = Navigator(ROOM, robot)
    if costmap is not None:
        navigator.static_costmap = costmap(navigator.static_costmap)
    navigator.run(behavior)
    pose, twist, time = Pose2D(*start), Twist2D(), 0.0
    while navigator.status is NavigationStatus.BEHAVING and time < seconds:
        command = navigator.update(pose, twist, time=time)
        twist = robot.limits.approach(twist, command, navigator.dt)
        pose, time = twist.integrate(pose, navigator.dt), time + navigator.dt
    for _ in range(40):  # until it stands
        twist = robot.limits.approach(twist, navigator.update(pose, twist), navigator.dt)
        pose = twist.integrate(pose, navigator.dt)
    return navigator, pose, time


def weak(acceleration):
    limits = CARTER.limits.model_copy(
        update={"linear_acceleration": acceleration, "angular_acceleration": 2.0 * acceleration}
    )
    return CARTER.model_copy(update={"limits": limits})


@pytest.mark.parametrize("robot", [CARTER, weak(0.3)], ids=["carter", "weak"])
@pytest.mark.parametrize(("behavior", "along"), [(BackUp(0.4), -0.4), (DriveOnHeading(1.2, speed=0.5), 1.2)])
def test_straight_motions_end_where_they_should(robot, behavior, along):
    navigator, pose, _ = run_alone(behavior, robot=robot)
    assert navigator.status is NavigationStatus.FINISHED
    expected = Pose2D(4.0, 4.0, 0.5) @ Pose2D(along, 0.0)
    assert pose.distance_to(expected) < 0.03
    assert math.isclose(pose.yaw, 0.5)


@pytest.mark.parametrize("robot", [CARTER, weak(0.3)], ids=["carter", "weak"])
@pytest.mark.parametrize(
    ("behavior", "yaw"), [(Spin(1.57), 2.07), (Spin("-90deg"), 0.5 - math.pi / 2), (Spin(heading=-2.0), -2.0)]
)
def test_spins_end_at_the_yaw_that_was_asked_for(robot, behavior, yaw):
    navigator, pose, _ = run_alone(behavior, robot=robot)
    assert navigator.status is NavigationStatus.FINISHED
    assert math.isclose(pose.yaw, yaw, abs_tol=0.06)
    assert pose.distance_to(Pose2D(4.0, 4.0)) < 1e-9


def test_a_spin_may_turn_more_than_once():
    with pytest.warns(AngleWarning):
        behavior = Spin(4.0 * math.pi)
    navigator, _, seconds = run_alone(behavior)
    assert navigator.status is NavigationStatus.FINISHED
    assert seconds > 4.0 * math.pi / 1.0


def test_waiting_lasts_as_long_as_asked_for():
    navigator, pose, seconds = run_alone(Wait(1.5))
    assert navigator.status is NavigationStatus.FINISHED
    assert math.isclose(seconds, 1.5, abs_tol=0.11)
    assert pose == Pose2D(4.0, 4.0, 0.5)


def wall_behind(costmap):
    (row, row_end), (col, col_end) = costmap.world_to_cell(np.array([3.2, 3.25]), np.array([3.0, 5.0]))
    return costmap.update(slice(int(row), int(row_end)), slice(int(col), int(col_end) + 1), 100)


def test_a_behavior_stops_before_it_touches_something_and_says_where():
    navigator, pose, _ = run_alone(BackUp(2.0, speed=0.5), start=(4.0, 4.0, 0.0), costmap=wall_behind)
    assert navigator.status is NavigationStatus.STUCK
    assert not navigator.costmap.footprint_collides(pose.as_tuple())[0]
    assert pose.x < 4.0
    assert "back_up" in navigator.message
    assert "blocked at (" in navigator.message
    (ran,) = navigator.behavior_runs
    assert (ran.behavior, ran.reason, ran.result, ran.recovery) == ("back_up", "asked for", "failed", False)


def things_at(*boxes):
    """What puts boxes (x0, y0, x1, y1) into a costmap."""

    def put(costmap):
        for x0, y0, x1, y1 in boxes:
            (row, row_end), (col, col_end) = costmap.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
            costmap = costmap.update(slice(int(row), int(row_end)), slice(int(col), int(col_end)), 100)
        return costmap

    return put


FRONT, BACK, SIDE = CARTER.outline[:, 0].max(), CARTER.outline[:, 0].min(), CARTER.outline[:, 1].max()


@pytest.mark.parametrize(
    "boxes",
    [
        [(4.0 + FRONT - 0.03, 3.0, 5.0, 5.0)],  # pushed against a wall with its front
        [(3.0, 3.0, 4.0 + BACK + 0.03, 5.0)],
        [(4.0 + FRONT + 0.01, 3.0, 5.0, 5.0), (2.0, 4.0 + SIDE + 0.01, 6.0, 5.0)],  # in a corner
    ],
)
def test_a_robot_drives_off_what_it_touches(boxes):
    navigator, pose, _ = run_alone(DriveClear(0.08), start=(4.0, 4.0, 0.0), costmap=things_at(*boxes))
    assert navigator.status is NavigationStatus.FINISHED, navigator.message
    assert navigator.costmap.clearance(pose.as_tuple())[0] >= 0.08
    assert pose.distance_to(Pose2D(4.0, 4.0)) < 1.5


def test_a_robot_that_stands_free_does_not_move_to_drive_clear():
    navigator, pose, seconds = run_alone(DriveClear())
    assert navigator.status is NavigationStatus.FINISHED
    assert (pose, seconds) == (Pose2D(4.0, 4.0, 0.5), pytest.approx(0.05))


def test_a_robot_that_is_held_on_all_sides_cannot_drive_clear():
    ahead, behind = (4.0 + FRONT - 0.03, 3.0, 5.0, 5.0), (3.0, 3.0, 4.0 + BACK + 0.03, 5.0)
    sides = (3.0, 4.0 + SIDE - 0.03, 5.0, 5.0), (3.0, 3.0, 5.0, 4.0 - SIDE + 0.03)
    navigator, pose, _ = run_alone(DriveClear(), start=(4.0, 4.0, 0.0), costmap=things_at(ahead, behind, *sides))
    assert navigator.status is NavigationStatus.STUCK
    assert "no motion takes the robot away" in navigator.message
    assert pose.distance_to(Pose2D(4.0, 4.0)) < 0.02


def test_a_motion_that_is_stopped_is_not_driven_again():
    """A monitor that sees more than the costmap has stops it."""
    navigator = Navigator(ROOM, CARTER)
    navigator.static_costmap = things_at((4.0 + FRONT + 0.06, 3.0, 5.0, 5.0), (2.0, 4.0 + SIDE + 0.3, 6.0, 5.0))(
        navigator.costmap
    )
    navigator.run(DriveClear(speed=0.1))
    pose, time, sent = Pose2D(4.0, 4.0), 0.0, set()
    while navigator.status is NavigationStatus.BEHAVING and time < 20.0:
        sent.add(navigator.update(pose, Twist2D(), time=time))
        time += navigator.dt
    assert navigator.status is NavigationStatus.STUCK
    assert len(sent - {Twist2D()}) > 2
    assert time < 15.0


def test_a_behavior_that_takes_too_long_fails():
    navigator = Navigator(ROOM, CARTER)
    navigator.run(BackUp(0.3))
    for k in range(1000):
        navigator.update((4.0, 4.0, 0.0), Twist2D(), time=0.05 * k)  # its wheels are stuck
        if navigator.status is not NavigationStatus.BEHAVING:
            break
    assert navigator.status is NavigationStatus.STUCK
    assert "longer than 9.0 s" in navigator.message


def test_a_robot_that_cannot_reverse_does_not_back_up():
    limits = CARTER.limits.model_copy(update={"reverse_speed": 0.0})
    navigator, _, _ = run_alone(BackUp(), robot=CARTER.model_copy(update={"limits": limits}))
    assert navigator.status is NavigationStatus.STUCK
    assert "cannot reverse" in navigator.message


def test_replanning_needs_a_goal():
    navigator, _, _ = run_alone(Replan())
    assert navigator.status is NavigationStatus.STUCK
    assert "there is no goal to plan to" in navigator.message


def test_clearing_where_nothing_was_sensed_is_done_at_once():
    navigator, _, seconds = run_alone(ClearCostmap())
    assert navigator.status is NavigationStatus.FINISHED
    assert seconds < 0.11


@pytest.mark.parametrize(
    "make",
    [
        lambda: BackUp(0.2),
        lambda: DriveOnHeading(0.5),
        lambda: Spin(1.0),
        lambda: Spin(heading=0.0),
        lambda: Wait(1.0),
        ClearCostmap,
        Replan,
        lambda: ReplanWith("least_cost"),
    ],
)
def test_ours_keep_their_promises(make):
    check_behavior(make)
    check_behavior(make, robot=weak(0.1))


def test_they_are_made_by_name():
    assert behavior_names() == sorted(
        ["back_up", "clear_costmap", "drive_clear", "drive_on_heading", "replan", "replan_with", "spin", "wait"]
    )
    assert create_behavior("drive_on_heading", distance=1.0).name == "drive_on_heading"
    assert create_behavior("spin", angle=1).name == "spin"
    assert create_behavior("replan_with", planner="astar").name == "replan_with"
    assert repr(create_behavior("back_up", distance=0.5)) == "BackUp(0.5, speed=0.15)"
    for name in ("back_up", "clear_costmap", "drive_on_heading", "replan", "spin", "wait"):
        assert isinstance(create_behavior(name), Behavior)
    assert repr(create_behavior("spin")) == "Spin(1.57, speed=1)"


@pytest.mark.parametrize(
    "make",
    [
        lambda: BackUp(0.0),
        lambda: BackUp(-0.3),
        lambda: BackUp(math.nan),
        lambda: BackUp(speed=math.inf),
        lambda: DriveOnHeading("far"),
        lambda: Spin(1.0, heading=1.0),
        lambda: Spin("ninety"),
        lambda: Spin(math.inf),
        lambda: Wait(-1.0),
        lambda: Wait(math.inf),
        lambda: create_behavior("back_up", length=1.0),
        lambda: create_behavior(3),
        lambda: Navigator(ROOM, CARTER).run(BackUp),
        lambda: Navigator(ROOM, CARTER).run("back_up"),
    ],
)
def test_bad_arguments_are_refused(make):
    with pytest.raises(InputError):
        make()


def test_an_unknown_name_offers_the_nearest():
    with pytest.raises(UnknownNameError, match="Did you mean 'spin'"):
        create_behavior("spinn")
    with pytest.raises(UnknownNameError, match="Did you mean 'least_cost'"):
        ReplanWith("leastcost")
