"""The controller as a whole, driven ideally within the robot's limits."""

import math

import numpy as np
import pytest

from support.mppi_runs import CARTER, DT, FEW, STRAIGHT, arrives, as_array, costmap_with, follow, scaled, walker
from trundle.control import create_controller
from trundle.control.mppi import MppiController
from trundle.control.mppi import controller as mppi_controller
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import Pose2D, Twist2D
from trundle.path import Path
from trundle.robots import Robot
from trundle.testing import check_controller


@pytest.mark.parametrize("name", ["nova_carter", "turtlebot3_burger"])
def test_it_meets_the_contract_of_controllers(name):
    check_controller(lambda robot: create_controller("mppi", robot, samples=256), robot=Robot.load(name))


def test_a_straight_is_driven_at_full_speed_to_its_end():
    poses, twists, _ = follow(MppiController(CARTER, **FEW), STRAIGHT, costmap_with())
    assert arrives(poses, STRAIGHT.goal)
    assert max(abs(pose.y) for pose in poses) < 0.15
    assert max(twist.v for twist in twists) == pytest.approx(0.8, abs=1e-3)


def test_between_obstacles_it_is_nearly_as_fast_as_in_the_open():
    jackal = Robot.load("jackal")
    left = [(-4.2 + 2.8 * i, -1.2, -4.0 + 2.8 * i, -0.45) for i in range(4)]
    right = [(-2.8 + 2.8 * i, 0.45, -2.6 + 2.8 * i, 1.2) for i in range(3)]
    path = Path(np.array([[-6.0, 0.0, 0.0], [6.0, 0.0, 0.0]]))
    costmap = costmap_with(*left, *right, robot=jackal, size=14.0)
    poses, _, _ = follow(MppiController(jackal, **FEW), path, costmap, robot=jackal, seconds=10.0)
    shortest_s = 11.0 / 2.0 + 2.0 / (2.0 * 3.0)
    assert next(tick for tick, pose in enumerate(poses) if pose.x > 5.0) * DT < 1.03 * shortest_s
    assert costmap.clearance(as_array(poses)).min() > 0.1


def test_where_the_best_command_is_refused_it_first_slows_down_in_the_same_turn(monkeypatch):
    seen = []

    def refuse_the_first(costmap, limits, pose, twist, command, dt, *, padded):
        seen.append(command)
        return len(seen) == 2

    monkeypatch.setattr(mppi_controller, "can_stop", refuse_the_first)
    controller = MppiController(CARTER, **FEW)
    controller.set_path(STRAIGHT)
    start, moves = Pose2D(-3.0, 0.2, 0.3), Twist2D(0.6, -0.3)
    command = controller.compute_velocity(start, moves, costmap_with(), DT)
    assert command == seen[1] == Twist2D(0.5 * seen[0].v, seen[0].w)
    assert abs(command.w) > 0.1


@pytest.mark.parametrize("yaw", [0.0, 0.6, 2.0])
def test_it_drives_round_what_stands_on_the_path(yaw):
    turn = Pose2D(0.0, 0.0, yaw)
    costmap = costmap_with((-0.2, -0.6, 0.2, 0.4), yaw=yaw)
    path = Path(np.array([(turn @ Pose2D(*pose)).as_tuple() for pose in STRAIGHT.poses.tolist()]))
    poses, _, _ = follow(MppiController(CARTER, **FEW), path, costmap)
    assert arrives(poses, path.goal)
    assert costmap.clearance(as_array(poses)).min() > 0.05


@pytest.mark.parametrize("bearing", [2.2, math.pi, -2.6])
def test_a_robot_that_faces_away_turns_round(bearing):
    poses, _, _ = follow(MppiController(CARTER, **FEW), STRAIGHT, costmap_with(), start=Pose2D(-3.0, 0.0, bearing))
    assert arrives(poses, STRAIGHT.goal)


def test_it_turns_to_the_yaw_of_the_goal():
    path = Path(np.array([[-2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, -2.5]]))
    poses, _, _ = follow(MppiController(CARTER, **FEW), path, costmap_with())
    assert arrives(poses, path.goal)


def test_stretches_that_are_planned_backwards_are_driven_backwards():
    path = Path(
        np.array([[-1.5, 0.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, 0.0, 1.57], [-1.0, 2.5, 1.57]]),
        backward=np.array([False, True, False, False]),
    )
    poses, twists, _ = follow(MppiController(CARTER, **FEW), path, costmap_with())
    assert arrives(poses, path.goal)
    assert max(pose.x for pose in poses) > 0.9
    assert sum(-twist.v for twist in twists if twist.v < 0.0) * DT == pytest.approx(2.0, abs=0.2)


def test_a_gap_that_only_the_outline_fits_is_driven_as_planned():
    # Carter is 0.50 m wide; its discs need 0.58 m.
    costmap = costmap_with((-1.0, 0.31, 1.0, 4.9), (-1.0, -4.9, 1.0, -0.31))
    poses, _, _ = follow(MppiController(CARTER, **FEW), STRAIGHT, costmap)
    assert arrives(poses, STRAIGHT.goal)
    assert not costmap.footprint_collides(as_array(poses)).any()


def test_low_accelerations_are_kept_within_the_model():
    limits = CARTER.limits.model_copy(update={"linear_acceleration": 0.3, "angular_acceleration": 0.5})
    slow = CARTER.model_copy(update={"limits": limits})
    costmap = costmap_with((3.4, -1.0, 3.6, 1.0))
    poses, twists, _ = follow(MppiController(slow, **FEW), STRAIGHT, costmap, robot=slow, seconds=60.0)
    assert arrives(poses, STRAIGHT.goal, 0.15)
    assert max(twist.v for twist in twists) > 0.7
    assert not costmap.footprint_collides(as_array(poses)).any()


@pytest.mark.parametrize("scale", [0.3, 3.0])
def test_robots_from_a_fifth_of_a_metre_to_two(scale):
    robot = scaled(scale)
    size = 10.0 * max(1.0, scale)
    path = Path(STRAIGHT.poses * (scale, scale, 1.0))
    box = (-0.2 * scale, -0.6 * scale, 0.2 * scale, 0.4 * scale)
    costmap = costmap_with(box, robot=robot, size=size)
    poses, _, _ = follow(MppiController(robot, **FEW), path, costmap, robot=robot)
    assert arrives(poses, path.goal)
    assert not costmap.footprint_collides(as_array(poses)).any()


def test_a_speed_limit_holds():
    controller = MppiController(CARTER, **FEW)
    controller.set_speed_limit(0.3)
    _, twists, _ = follow(controller, STRAIGHT, costmap_with())
    assert max(twist.v for twist in twists) == pytest.approx(0.3, abs=1e-3)


def test_the_same_seed_gives_the_same_commands():
    runs = [follow(MppiController(CARTER, **FEW), STRAIGHT, costmap_with((0, -0.3, 0.2, 0.4)))[0] for _ in range(2)]
    assert runs[0] == runs[1]
    other = MppiController(CARTER, **FEW)
    other.reset(seed=7)
    assert follow(other, STRAIGHT, costmap_with((0, -0.3, 0.2, 0.4)))[0] != runs[0]


def test_nothing_is_commanded_without_a_path_and_it_says_so():
    controller = MppiController(CARTER, **FEW)
    assert controller.compute_velocity(Pose2D(0, 0), Twist2D(), costmap_with(), DT) == Twist2D()
    assert controller.reason == "no path yet"
    assert controller.rollouts() is None


def test_a_costmap_without_the_robot_is_an_error_with_its_reason():
    controller = MppiController(CARTER, **FEW)
    controller.set_path(STRAIGHT)
    with pytest.raises(NoValidControlError, match="outside of the costmap"):
        controller.compute_velocity(Pose2D(30.0, 0.0), Twist2D(), costmap_with(), DT)
    assert controller.reason == "outside of the costmap"


def test_a_path_that_is_blocked_all_across_is_an_error_with_its_reason():
    costmap = costmap_with((0.0, -4.9, 0.2, 4.9))
    controller = MppiController(CARTER, **FEW)
    poses, _, reasons = follow(controller, STRAIGHT, costmap, seconds=10.0)
    assert poses[-1].x < 0.0
    assert all(reasons[-20:])
    with pytest.raises(NoValidControlError):
        controller.compute_velocity(poses[-1], Twist2D(), costmap, DT)


def test_it_keeps_out_of_the_way_of_what_moves():
    controller = MppiController(CARTER, **FEW)
    nearest = []
    where = {}

    def each(time):
        where["track"] = walker(0.0, -3.0 + time, 0.0, 1.0, time)
        controller.set_tracks([where["track"]])

    controller.set_path(STRAIGHT)
    costmap, pose, twist = costmap_with(), STRAIGHT.start, Twist2D()
    for tick in range(240):
        each(tick * DT)
        command = controller.compute_velocity(pose, twist, costmap, DT)
        twist = CARTER.limits.approach(twist, command, DT)
        pose = twist.integrate(pose, DT)
        corners = CARTER.planar.at_poses(np.array([pose.as_tuple()]))[0]
        nearest.append(np.hypot(corners[:, 0] - where["track"].x, corners[:, 1] - where["track"].y).min())
    assert min(nearest) > 0.3
    assert pose.distance_to(STRAIGHT.goal) < 0.3


def test_it_passes_behind_what_moves_through_the_marks_that_it_has_just_left():
    # A walker of 0.3 m at 2 m/s: where it was in the last 0.25 s, no scans have cleared its marks yet.
    controller = MppiController(CARTER, **FEW)
    controller.set_path(STRAIGHT)
    controller.set_tracks([walker(0.4, 0.7, 0.0, 2.0)])
    costmap = costmap_with((0.1, -0.1, 0.7, 1.0))
    controller.compute_velocity(Pose2D(-1.2, 0.0, 0.0), Twist2D(1.2, 0.0), costmap, DT)
    x, y, _ = controller.rollouts(1).poses[0].T
    assert x[-1] > 1.0
    assert np.abs(y).max() < 0.15


def test_standing_for_something_that_moves_has_a_reason():
    # A wall of walkers that stand in a corridor: nothing to do but wait.
    costmap = costmap_with((-4.9, 0.8, 4.9, 1.0), (-4.9, -1.0, 4.9, -0.8))
    controller = MppiController(CARTER, **FEW)
    crowd = [walker(0.5, y, 0.0, 1e-3) for y in (-0.6, 0.0, 0.6)]
    poses, _, reasons = follow(
        controller, STRAIGHT, costmap, seconds=12.0, each=lambda time: controller.set_tracks(crowd)
    )
    assert poses[-1].x < 0.1
    assert all(reasons[-20:])


def test_the_best_samples_can_be_shown():
    controller = MppiController(CARTER, **FEW)
    controller.set_path(STRAIGHT)
    controller.compute_velocity(Pose2D(-3.0, 0.0, 0.0), Twist2D(), costmap_with(yaw=0.5), DT)
    shown = controller.rollouts(12)
    assert shown.poses.shape == (12, 57, 3)
    assert shown.poses[:, 0] == pytest.approx(np.tile([-3.0, 0.0, 0.0], (12, 1)), abs=1e-4)
    assert (np.diff(shown.costs) >= 0.0).all()
    assert shown.poses[0, -1, 0] > -2.0


@pytest.mark.parametrize(
    "settings",
    [
        {"samples": 0},
        {"samples": 10**9},
        {"horizon": 0.0},
        {"horizon": math.inf},
        {"horizon": 20.0, "model_dt": 0.01},
        {"collision_cost": -1.0},
        {"repulsion_weight": math.nan},
        {"goal_weight": 1e9},
        {"knot_steps": 0},
        {"horizon": 0.2, "model_dt": 0.5},
        {"best_share": 0.0},
        {"no_such_setting": 1.0},
    ],
)
def test_settings_out_of_range_are_refused(settings):
    with pytest.raises(InputError):
        create_controller("mppi", CARTER, **settings)


def test_a_robot_that_cannot_move_is_refused():
    limits = CARTER.limits.model_construct(**{**CARTER.limits.model_dump(), "linear_speed": 0.0})
    with pytest.raises(InputError, match="linear_speed"):
        MppiController(CARTER.model_copy(update={"limits": limits}))


@pytest.mark.parametrize("dt", [0.0, -0.1, math.nan, math.inf])
def test_a_control_period_that_is_none_is_refused(dt):
    controller = MppiController(CARTER, **FEW)
    controller.set_path(STRAIGHT)
    with pytest.raises(InputError):
        controller.compute_velocity(Pose2D(0, 0), Twist2D(), costmap_with(), dt)
