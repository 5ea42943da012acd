import math

import numpy as np
import pytest

from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.costmap import Costmap
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import Pose2D, Twist2D, pad_outline, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.robots import Robot

DT = 0.05
CARTER = Robot.load("nova_carter")


def costmap_with(*boxes, size=10.0):
    """A free square room around the origin, with boxes (x0, y0, x1, y1) [m] in it."""
    cells = round(size / 0.05)
    data = np.zeros((cells, cells), dtype=np.int8)
    grid = OccupancyGrid(data, 0.05, Pose2D(-size / 2, -size / 2))
    for x0, y0, x1, y1 in boxes:
        (row0, row1), (col0, col1) = grid.world_to_cell(np.array([x0, x1]), np.array([y0, y1]))
        data[row0 : row1 + 1, col0 : col1 + 1] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05, grid.origin), CARTER.outline)


def follow(controller, path, costmap, *, start=None, seconds=60.0):
    """Drive ideally, within the robot's limits; return poses and twists of every control period."""
    controller.set_path(path)
    pose, twist = start or path.start, Twist2D()
    poses, twists = [pose], [twist]
    for _ in range(round(seconds / DT)):
        try:
            command = controller.compute_velocity(pose, twist, costmap, DT)
        except NoValidControlError:
            command = Twist2D()
        for _ in range(10):
            twist = CARTER.limits.approach(twist, command, DT / 10)
            pose = twist.integrate(pose, DT / 10)
        poses.append(pose)
        twists.append(twist)
        if command == Twist2D() and abs(twist.v) + abs(twist.w) < 1e-9:
            break
    return poses, twists


def as_array(poses):
    return np.array([pose.as_tuple() for pose in poses])


def test_a_straight_is_driven_straight_at_full_speed_to_its_end():
    path = Path(np.array([[-4, 0, 0], [4, 0, 0]]))
    poses, twists = follow(RegulatedPurePursuit(CARTER), path, costmap_with())
    assert poses[-1].distance_to(path.goal) < 0.02
    assert max(abs(pose.y) for pose in poses) < 1e-6
    assert max(twist.v for twist in twists) == pytest.approx(0.8)


def test_it_turns_in_place_at_a_sharp_bend_and_at_both_ends():
    path = Path(
        np.array(
            [[-3, 0, math.pi / 2], [-3, 0, 0], [0, 0, 0], [0, 0, math.pi / 2], [0, 3, math.pi / 2], [0, 3, math.pi]]
        )
    )
    poses, _ = follow(RegulatedPurePursuit(CARTER), path, costmap_with())
    assert poses[-1].distance_to(path.goal) < 0.03
    assert abs(wrap_angle(poses[-1].yaw - math.pi)) < 0.03
    at_bend = [pose for pose in poses if pose.distance_to(Pose2D(0, 0)) < 0.03]
    assert max(pose.yaw for pose in at_bend) - min(pose.yaw for pose in at_bend) > 1.4


def test_a_slight_bend_is_driven_through_without_stopping():
    path = Path(np.array([[-3, 0, 0], [0, 0, 0], [0, 0, 0.5], [3 * math.cos(0.5), 3 * math.sin(0.5), 0.5]]))
    poses, twists = follow(RegulatedPurePursuit(CARTER), path, costmap_with())
    assert poses[-1].distance_to(path.goal) < 0.05
    middle = [twist.v for pose, twist in zip(poses, twists, strict=True) if pose.distance_to(Pose2D(0, 0)) < 1.0]
    assert min(middle) > 0.2


def test_a_turn_the_long_way_round_is_driven_the_long_way_round():
    yaws = np.linspace(0.0, -1.5 * math.pi, 8)
    path = Path(np.column_stack([np.zeros(8), np.zeros(8), yaws]))
    poses, twists = follow(RegulatedPurePursuit(CARTER), path, costmap_with())
    assert sum(twist.w for twist in twists) * DT == pytest.approx(-1.5 * math.pi, abs=0.05)
    assert abs(wrap_angle(poses[-1].yaw - math.pi / 2)) < 0.03


@pytest.mark.parametrize("gap", [0.62, 0.7, 0.9])
def test_a_bend_that_the_tail_cannot_take_in_a_curve_is_taken_by_stopping(gap):
    # A slot as wide as `gap` that is entered after a bend of 40° where the inner corner stands close.
    bend = math.radians(40)
    path = Path(np.array([[-3, 0, 0], [0, 0, 0], [0, 0, bend], [2.5 * math.cos(bend), 2.5 * math.sin(bend), bend]]))
    costmap = costmap_with((-0.75, gap / 2, -0.35, gap / 2 + 0.4), (-3.5, -gap / 2 - 0.4, -0.7, -gap / 2 - 0.1))
    poses, _ = follow(RegulatedPurePursuit(CARTER), path, costmap)
    assert not costmap.footprint_collides(as_array(poses)).any()
    if not costmap.footprint_collides(path.poses, outline=pad_outline(CARTER.outline, 0.02)).any():
        assert poses[-1].distance_to(path.goal) < 0.05


@pytest.mark.parametrize("seed", range(5))
def test_whatever_the_path_no_command_leads_into_an_obstacle(seed):
    rng = np.random.default_rng(seed)
    boxes = [(x, y, x + 0.3, y + 0.3) for x, y in rng.uniform(-4, 4, (12, 2)) if math.hypot(x + 0.15, y + 0.15) > 1.2]
    costmap = costmap_with(*boxes)
    points = np.vstack([[0, 0], rng.uniform(-4, 4, (6, 2))])
    headings = np.arctan2(*np.diff(points, axis=0).T[::-1])
    poses = [[0, 0, 0]]
    for (x0, y0), (x1, y1), yaw in zip(points, points[1:], headings, strict=False):
        poses += [[x0, y0, yaw], [x1, y1, yaw]]
    driven, _ = follow(RegulatedPurePursuit(CARTER), Path(np.array(poses)), costmap, seconds=40)
    assert not costmap.footprint_collides(as_array(driven)).any()


def test_it_comes_back_onto_the_path_from_beside_it():
    path = Path(np.array([[-4, 0, 0], [4, 0, 0]]))
    poses, _ = follow(RegulatedPurePursuit(CARTER), path, costmap_with(), start=Pose2D(-4, 0.4, 1.0))
    assert poses[-1].distance_to(path.goal) < 0.03


def test_speeds_stay_within_the_robots_limits_whatever_nav2_would_turn_at():
    path = Path(np.array([[0, 0, 0], [0, 0, math.pi / 2], [0, 3, math.pi / 2]]))
    controller = RegulatedPurePursuit(CARTER)
    controller.set_path(path)
    command = controller.compute_velocity(path.start, Twist2D(), costmap_with(), DT)
    assert command.w == pytest.approx(0.7)


def test_without_a_path_it_stands():
    assert RegulatedPurePursuit(CARTER).compute_velocity(Pose2D(0, 0), Twist2D(), costmap_with(), DT) == Twist2D()


@pytest.mark.parametrize(
    "option", [{"lookahead_dist": -1.0}, {"lookahead_dist": math.nan}, {"min_lookahead_dist": 0.9}]
)
def test_settings_out_of_range_are_refused(option):
    with pytest.raises(InputError, match="regulated_pure_pursuit"):
        RegulatedPurePursuit(CARTER, **option)


def test_a_path_that_leads_back_is_driven_backwards_within_the_reverse_speed():
    limits = CARTER.limits.model_copy(update={"reverse_speed": 0.3})
    path = Path(np.array([[2, 0, 0], [-2, 0, 0]]), backward=np.array([True]))
    poses, twists = follow(RegulatedPurePursuit(CARTER.model_copy(update={"limits": limits})), path, costmap_with())
    assert poses[-1].distance_to(path.goal) < 0.02
    assert max(abs(pose.yaw) for pose in poses) < 1e-6
    assert min(twist.v for twist in twists) == pytest.approx(-0.3)


@pytest.mark.parametrize("radius", [0.6, 1.5])
def test_it_parks_along_a_planned_path_with_a_change_of_direction(radius):
    costmap = costmap_with((-5, 1.4, 5, 1.6), (-5, -1.0, 5, -0.9))
    start, goal = Pose2D(0.0, -0.4, 0.0), Pose2D(0.0, 0.9, 0.0)
    path = HybridAStarPlanner(minimum_turning_radius=radius).plan(costmap, start, goal)
    assert 0 < np.count_nonzero(path.backward) < len(path.backward)
    poses, twists = follow(RegulatedPurePursuit(CARTER), path, costmap)
    assert poses[-1].distance_to(goal) < 0.05
    assert abs(wrap_angle(poses[-1].yaw - goal.yaw)) < 0.05
    assert not costmap.footprint_collides(as_array(poses)).any()
    assert min(twist.v for twist in twists) < -0.1
    assert max(twist.v for twist in twists) > 0.1


TURN = math.radians(50.0)


def beside_swing(gap):
    """A costmap and a pose from where a turn to the left by 50° brings a rear corner so close [m] to a cell."""
    rear = CARTER.outline[np.argmin(CARTER.outline[:, 0] - 1e-3 * CARTER.outline[:, 1])]
    radius, angle = math.hypot(*rear), math.atan2(rear[1], rear[0]) + math.pi / 4
    assert math.pi < angle < 1.5 * math.pi
    # The upper right corner of the cell is at (-0.5, -0.5).
    pose = Pose2D(
        -0.5 - (radius + gap) * math.cos(angle), -0.5 - (radius + gap) * math.sin(angle), math.pi / 4 - TURN / 2
    )
    return costmap_with((-0.525, -0.525, -0.525, -0.525)), pose


@pytest.mark.parametrize("gap", [0.002, 0.006, 0.009])
def test_a_turn_that_is_planned_closer_than_the_padding_is_driven(gap):
    costmap, pose = beside_swing(gap)
    x, y, yaw = pose.as_tuple()
    end = yaw + TURN
    path = Path(np.array([(x, y, yaw), (x, y, end), (x + 2.0 * math.cos(end), y + 2.0 * math.sin(end), end)]))
    assert costmap.clearance([pose.as_tuple()])[0] > 0.02
    poses, _ = follow(RegulatedPurePursuit(CARTER), path, costmap)
    assert poses[-1].distance_to(path.goal) < 0.05
    assert not costmap.footprint_collides(as_array(poses)).any()
    poses, _ = follow(RegulatedPurePursuit(CARTER), Path(path.poses[:2]), costmap)
    assert abs(wrap_angle(poses[-1].yaw - end)) < 0.03


def test_a_turn_that_would_touch_something_is_not_begun_closer_than_the_padding():
    costmap, pose = beside_swing(-0.01)
    x, y, yaw = pose.as_tuple()
    end = yaw + TURN
    path = Path(np.array([(x, y, yaw), (x, y, end), (x + 2.0 * math.cos(end), y + 2.0 * math.sin(end), end)]))
    poses, _ = follow(RegulatedPurePursuit(CARTER), path, costmap)
    assert costmap.clearance(as_array(poses)).min() >= 0.01 - 1e-6


def test_it_says_that_it_has_no_valid_control_in_front_of_a_wall():
    controller = RegulatedPurePursuit(CARTER)
    controller.set_path(Path(np.array([[0, 0, 0], [3, 0, 0]])))
    walled = costmap_with((0.16, -3.0, 0.3, 3.0))
    with pytest.raises(NoValidControlError, match="no valid control at"):
        controller.compute_velocity(Pose2D(0, 0), Twist2D(), walled, DT)
    controller.reset()
    assert controller.compute_velocity(Pose2D(0, 0), Twist2D(), walled, DT) == Twist2D()


def test_a_path_of_one_pose_that_is_reached_already_is_done_at_once():
    controller = RegulatedPurePursuit(CARTER)
    controller.set_path(Path(np.array([[1.0, 0.0, 0.5]])))
    assert controller.compute_velocity(Pose2D(1.0, 0.0, 0.5), Twist2D(), costmap_with(), DT) == Twist2D()
    assert controller.is_done
