import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, MapError, NoPathError, UnknownNameError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.navigation import Choice, NavigationStatus, Navigator, NavigatorSettings
from trundle.path import Path
from trundle.planning.constrained_smoother import ConstrainedSmoother
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")


def room(*boxes, size=10.0):
    """A free square room around the origin with walls, and boxes (x0, y0, x1, y1) [m] in it."""
    cells = round(size / 0.05)
    data = np.zeros((cells, cells), dtype=np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    grid = OccupancyGrid(data, 0.05, Pose2D(-size / 2, -size / 2))
    for x0, y0, x1, y1 in boxes:
        (row0, row1), (col0, col1) = grid.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
        data[row0 : row1 + 1, col0 : col1 + 1] = 100
    return OccupancyGrid(data, 0.05, grid.origin)


def drive(navigator, pose, *, seconds=120.0):
    """Drive ideally within the robot's limits until the navigator is done; return the poses."""
    twist, poses = Twist2D(), [pose]
    for _ in range(round(seconds / navigator.dt)):
        command = navigator.update(pose, twist)
        for _ in range(10):
            twist = navigator.robot.limits.approach(twist, command, navigator.dt / 10)
            pose = twist.integrate(pose, navigator.dt / 10)
        poses.append(pose)
        if navigator.status not in (NavigationStatus.DRIVING, NavigationStatus.BLOCKED):
            break
    return poses


def touches(navigator, poses):
    return navigator.costmap.footprint_collides(np.array([pose.as_tuple() for pose in poses])).any()


def test_it_drives_around_a_wall_and_arrives_in_position_and_yaw():
    navigator = Navigator(room((-0.2, -5, 0.2, 2.5)), "nova_carter")
    navigator.set_goal(3.0, -3.0, math.pi / 2)
    poses = drive(navigator, Pose2D(-3, -3, math.pi))
    assert navigator.status is NavigationStatus.ARRIVED
    assert poses[-1].distance_to(Pose2D(3, -3)) < 0.1
    assert abs(wrap_angle(poses[-1].yaw - math.pi / 2)) < 0.1
    assert not touches(navigator, poses)
    assert navigator.planning_time_s > 0.0


def test_a_goal_without_a_yaw_is_reached_in_any():
    navigator = Navigator(room(), "nova_carter")
    navigator.set_goal((3.0, 0.0))
    poses = drive(navigator, Pose2D(-3, 0, 0))
    assert navigator.status is NavigationStatus.ARRIVED
    assert abs(poses[-1].yaw) < 0.05


@pytest.mark.parametrize("goal", [(1.0, 2.0, 0.5), [1.0, 2.0, 0.5], Pose2D(1.0, 2.0, 0.5)])
def test_a_goal_may_be_a_pose_or_a_sequence(goal):
    navigator = Navigator(room(), CARTER)
    navigator.set_goal(goal)
    assert navigator.goal == Pose2D(1.0, 2.0, 0.5)
    navigator.set_goal(1.0, 2.0, 0.5)
    assert navigator.goal == Pose2D(1.0, 2.0, 0.5)


@pytest.mark.parametrize("goal", [(1.0,), (1, 2, 3, 4), (math.nan, 0.0)])
def test_what_is_no_goal_is_refused(goal):
    with pytest.raises(InputError):
        Navigator(room(), CARTER).set_goal(goal)


def test_without_a_goal_it_stands_idle():
    navigator = Navigator(room(), CARTER)
    assert navigator.update((0, 0, 0)) == Twist2D()
    assert navigator.status is NavigationStatus.IDLE
    with pytest.raises(InputError, match="set_goal"):
        navigator.plan((0, 0, 0))


def test_a_goal_without_a_yaw_needs_no_room_to_turn():
    # A dead end that is too narrow to turn in; yaw 0 means to turn round before it, and to drive in backwards.
    navigator = Navigator(room((-4.9, 0.35, 0.0, 4.9), (-4.9, -4.9, 0.0, -0.35)), "nova_carter")
    navigator.set_goal(-4.0, 0.0)
    drive(navigator, Pose2D(2, 0, 0))
    assert navigator.status is NavigationStatus.ARRIVED
    navigator.set_goal(-4.0, 0.0, 0.0)
    navigator.update(Pose2D(2, 0, 0))
    assert navigator.path.planner == "hybrid_astar"
    assert navigator.path.backward[-1]


def test_no_path_is_a_status_of_update_and_an_error_of_plan():
    navigator = Navigator(room((-0.2, -5, 0.2, 5)), CARTER)
    navigator.set_goal(3, 0)
    assert navigator.update((-3, 0, 0)) == Twist2D()
    assert navigator.status is NavigationStatus.NO_PATH
    assert isinstance(navigator.error, NoPathError)
    assert navigator.path is None
    with pytest.raises(NoPathError):
        navigator.plan((-3, 0, 0))


def test_a_new_goal_starts_afresh():
    navigator = Navigator(room((-0.2, -5, 0.2, 5)), CARTER)
    navigator.set_goal(3, 0)
    navigator.update((-3, 0, 0))
    navigator.set_goal(-3, 3)
    drive(navigator, Pose2D(-3, 0, 0))
    assert navigator.status is NavigationStatus.ARRIVED
    assert navigator.error is None


class StraightPlanner:
    """Plans the straight line, whatever stands there, and counts how often it is asked."""

    def __init__(self):
        self.calls = 0

    def plan(self, costmap, start, goal):
        self.calls += 1
        yaw = math.atan2(goal.y - start.y, goal.x - start.x)
        return Path(np.array([start.as_tuple(), [start.x, start.y, yaw], [goal.x, goal.y, yaw], goal.as_tuple()]))


def test_a_blocked_robot_replans_backs_up_and_at_last_gives_up_without_touching():
    planner = StraightPlanner()
    navigator = Navigator(room((1.0, -1.0, 1.2, 1.0)), CARTER, planner=planner)
    navigator.set_goal(3, 0, 0)
    poses = drive(navigator, Pose2D(-3, 0, 0))
    assert navigator.status is NavigationStatus.STUCK
    assert planner.calls > 2
    assert navigator.replans == planner.calls - 1
    assert not touches(navigator, poses)
    driven = np.array([pose.x for pose in poses])
    assert (np.maximum.accumulate(driven) - driven).max() > 0.2


def test_a_robot_whose_wheels_slip_is_stuck_after_the_allowance():
    navigator = Navigator(room(), CARTER, settings=NavigatorSettings(movement_time_allowance=2.0))
    navigator.set_goal(3, 0)
    for _ in range(60):
        navigator.update((0, 0, 0), Twist2D(0.3, 0.0))
    assert navigator.status is NavigationStatus.STUCK


def test_somebody_elses_loop_may_give_the_time_and_leave_out_the_twist():
    navigator = Navigator(room(), "nova_carter")
    navigator.set_goal(2.0, 0.0)
    pose, time = Pose2D(0, 0, 0), 100.0
    while navigator.status is NavigationStatus.DRIVING and time < 120.0:
        twist = navigator.update(pose, time=time)
        left, right = navigator.robot.wheel_speeds(twist)
        assert left == pytest.approx(right, abs=0.5)
        pose, time = twist.integrate(pose, 0.05), time + 0.05
    assert navigator.status is NavigationStatus.ARRIVED


def test_a_costmap_is_taken_as_it_is_and_a_missing_map_is_named():
    costmap = Costmap.from_grid(room(), CARTER.outline)
    assert Navigator(costmap, CARTER).costmap is costmap
    with pytest.raises(MapError, match=r"nowhere\.yaml"):
        Navigator("nowhere.yaml", CARTER)


def test_unknown_names_and_options_are_refused():
    with pytest.raises(UnknownNameError, match="least_cost"):
        Navigator(room(), CARTER, planner="least_cst")
    with pytest.raises(UnknownNameError, match="regulated_pure_pursuit"):
        Navigator(room(), CARTER, controller="pursuit")
    with pytest.raises(InputError, match="lookahead"):
        Navigator(room(), CARTER, controller=Choice.of("regulated_pure_pursuit", lookahead=1))
    for option in ("control_frequency", "replan_interval_s", "replan_margin"):
        for value in (-1, math.nan, "one"):
            with pytest.raises(InputError, match=option):
                NavigatorSettings(**{option: value})
    for option in ("keepout", "speed_mask"):
        with pytest.raises(InputError, match="mask is loaded from the path"):
            Navigator(room(), CARTER, **{option: room()})


def test_the_lookahead_follower_drives_the_same_path_but_turns_to_no_yaw():
    navigator = Navigator(room(), CARTER, controller="lookahead", planner="manhattan_astar")
    navigator.set_goal(3, 2)
    drive(navigator, Pose2D(-3, 0, 0))
    assert navigator.status is NavigationStatus.ARRIVED


def test_it_drives_what_hybrid_astar_plans_out_of_a_dead_end():
    # The aisle is 0.8 m wide, and the robot needs 1.31 m to turn round.
    navigator = Navigator(room((0, -5, 5, -0.4), (0, 0.4, 5, 5)), "nova_carter", planner="hybrid_astar")
    navigator.set_goal(-3.0, 2.0, math.pi / 2)
    poses = drive(navigator, Pose2D(3.0, 0.0, 0.0))
    assert navigator.status is NavigationStatus.ARRIVED
    assert poses[-1].distance_to(Pose2D(-3, 2)) < 0.1
    assert not touches(navigator, poses)
    inside = [pose for pose in poses if pose.x > 0.8]
    assert max(abs(pose.yaw) for pose in inside) < 0.3  # it came out backwards


def test_a_smoother_takes_the_stops_out_of_a_path():
    grid = room((-0.2, -5, 0.2, 2.5))
    standing = {}
    for smoother in (None, "constrained"):
        navigator = Navigator(grid, "nova_carter", planner="astar", smoother=smoother)
        navigator.set_goal(3.0, -3.0, -math.pi / 2)
        poses = np.array([pose.as_tuple() for pose in drive(navigator, Pose2D(-3, -3, math.pi / 2))])
        standing[smoother] = np.count_nonzero(np.hypot(*np.diff(poses[:, :2], axis=0).T) < 1e-3)
        assert navigator.status is NavigationStatus.ARRIVED
        assert navigator.path is not None
        assert navigator.planned is not None
        assert np.array_equal(navigator.path.poses, navigator.planned.poses) == (smoother is None)
    assert standing["constrained"] < 0.7 * standing[None]


def test_the_smoother_takes_its_options_and_says_why_a_path_cannot_be_smoothed():
    grid = room((-0.2, -5, 0.2, 2.5))
    options = {"minimum_turning_radius": 1.0}
    assert Navigator(grid, "nova_carter", smoother=Choice(name="constrained", options=options)).smoother.settings == (
        ConstrainedSmoother(**options).settings
    )
    navigator = Navigator(grid, "nova_carter", planner="manhattan_astar", smoother="constrained")
    navigator.set_goal(0.8, -4.5)
    navigator.update(Pose2D(-0.8, -4.5))
    assert navigator.status is NavigationStatus.NO_PATH
    assert isinstance(navigator.error, BlockedPoseError)
