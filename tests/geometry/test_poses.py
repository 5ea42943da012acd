import copy
import math
import pickle

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import AngleWarning, InputError
from trundle.geometry import (
    Goal,
    Pose2D,
    Pose3D,
    Twist2D,
    arc_lengths,
    convex_hull,
    integrate_twist,
    pad_outline,
    path_length,
    shrink_outline,
    wrap_angle,
    wrap_angles,
)
from trundle.geometry.poses import is_in_degrees, parse_angle

coordinates = st.floats(-1e4, 1e4)
angles = st.floats(-50.0, 50.0)
poses = st.builds(Pose2D, coordinates, coordinates, st.floats(-math.tau, math.tau))


def test_a_yaw_beyond_a_whole_turn_is_warned_of_where_the_pose_is_made():
    with pytest.warns(AngleWarning, match="yaw 90 is more than one turn, and angles are in radians") as caught:
        pose = Pose2D(1.0, 2.0, 90)
    assert caught[0].filename == __file__
    assert pose.yaw == wrap_angle(90.0)


def test_two_numbers_are_a_goal_with_any_yaw_and_three_or_a_pose_one_with_its_own():
    for value in ((1, 2), [1.0, 2.0], np.array([1.0, 2.0])):
        goal = Goal.of(value)
        assert (goal, goal.yaw_free, goal.pose) == ((1.0, 2.0), True, Pose2D(1.0, 2.0))
    for value in ((1, 2, 0), Pose2D(1.0, 2.0), Goal(1, 2, 0)):
        goal = Goal.of(value)
        assert (goal, goal.yaw_free, goal.pose) == ((1.0, 2.0, 0.0), False, Pose2D(1.0, 2.0))
    assert (goal.x, goal.y) == (1.0, 2.0)
    assert Goal.of(goal) is goal
    assert Pose2D.of(Goal(3.0, 4.0)) == Pose2D(3.0, 4.0)


@pytest.mark.parametrize("goal", [Goal(1.0, 2.0), Goal(1.0, 2.0, 0.5)])
def test_code_for_a_pose_can_read_a_goal(goal):
    pose = goal.pose
    assert (goal.x, goal.y, goal.yaw) == goal.as_tuple() == pose.as_tuple()
    assert goal.distance_to(Pose2D(4.0, 6.0)) == Pose2D(4.0, 6.0).distance_to(goal) == pytest.approx(5.0)
    there = Pose2D(3.0, 1.0, 0.3)
    assert there.inverse() @ goal == there.inverse() @ pose


@pytest.mark.parametrize("goal", [Goal(1.0, 2.0), Goal(1.0, 2.0, 0.5)])
def test_a_goal_survives_pickle_and_copy(goal):
    for again in (pickle.loads(pickle.dumps(goal)), copy.copy(goal), copy.deepcopy(goal)):
        assert (type(again), again, again.yaw_free) == (Goal, goal, goal.yaw_free)
    assert repr(goal).startswith("Goal(x=1.0, y=2.0")


@pytest.mark.parametrize("value", [(1.0,), (1, 2, 3, 4), 5.0, None, (math.nan, 0.0), (0.0, 0.0, math.inf), ("a", 1)])
def test_what_is_no_goal_is_refused(value):
    with pytest.raises(InputError):
        Goal.of(value)


def test_the_yaw_of_a_goal_is_wrapped_and_degrees_are_warned_of_where_it_is_made():
    assert Goal(0.0, 0.0, 4.0) == (0.0, 0.0, wrap_angle(4.0))
    with pytest.warns(AngleWarning, match="yaw 90 is more than one turn") as caught:
        Goal(1.0, 2.0, 90)
    assert [warning.filename for warning in caught] == [__file__]


def test_turning_for_long_is_no_yaw_in_degrees():
    assert Twist2D(0.0, 1.0).integrate(Pose2D(0.0, 0.0), 90.0).yaw == wrap_angle(90.0)


@given(angles)
def test_a_wrapped_angle_lies_in_the_half_open_circle_and_points_the_same_way(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-12)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-12)


def test_half_a_turn_wraps_to_plus_pi_either_way():
    assert wrap_angle(-math.pi) == math.pi
    assert wrap_angles([-math.pi, math.pi]).tolist() == [math.pi, math.pi]


@given(poses)
def test_a_pose_times_its_inverse_is_the_origin(pose):
    identity = pose @ pose.inverse()
    assert identity.x == pytest.approx(0.0, abs=1e-8)
    assert identity.y == pytest.approx(0.0, abs=1e-8)
    assert math.cos(identity.yaw) == pytest.approx(1.0)


def test_the_distance_between_poses_is_that_of_their_positions():
    assert Pose2D(1.0, 2.0, 0.3).distance_to(Pose2D(4.0, 6.0, -2.0)) == pytest.approx(5.0)


@given(poses, poses, coordinates, coordinates)
def test_composition_is_transforming_twice(a, b, x, y):
    once = (a @ b).transform_points([[x, y]])
    twice = a.transform_points(b.transform_points([[x, y]]))
    np.testing.assert_allclose(once, twice, atol=1e-6)


def test_a_pose_refuses_nan_and_the_wrong_number_of_numbers():
    with pytest.raises(InputError, match="finite"):
        Pose2D(math.nan, 0.0)
    with pytest.raises(InputError, match="got 4 numbers"):
        Pose2D.of((1, 2, 3, 4))
    with pytest.raises(InputError, match="finite"):
        Twist2D(0.0, math.inf)


def test_a_quarter_circle_ends_a_radius_ahead_and_a_radius_to_the_left():
    pose = Twist2D(1.0, 0.5).integrate(Pose2D(0.0, 0.0, 0.0), math.pi)
    assert pose.as_tuple() == pytest.approx((2.0, 2.0, math.pi / 2))


@given(st.floats(-2, 2), st.floats(-2e-6, 2e-6), st.floats(0.01, 5))
def test_nearly_straight_arcs_join_the_straight_line_smoothly(v, w, dt):
    x, y, yaw = integrate_twist(0.0, 0.0, 0.0, v, w, dt)
    assert x == pytest.approx(v * dt, abs=1e-9)
    assert y == pytest.approx(v * w * dt * dt / 2, abs=1e-9)
    assert yaw == w * dt


@given(st.floats(-2, 2), st.floats(-3, 3), st.floats(0.01, 3), st.floats(0.01, 3))
def test_driving_twice_is_driving_once_for_the_sum(v, w, first, second):
    halfway = integrate_twist(0.3, -0.2, 0.7, v, w, first)
    np.testing.assert_allclose(
        integrate_twist(*halfway, v, w, second), integrate_twist(0.3, -0.2, 0.7, v, w, first + second), atol=1e-9
    )


def test_a_planar_pose_in_space_turns_about_z():
    pose = Pose3D.planar(1.0, 2.0, 3.0, yaw=math.pi / 2)
    np.testing.assert_allclose(pose.transform_points([[1.0, 0.0, 0.0]]), [[1.0, 3.0, 3.0]], atol=1e-12)
    assert pose.is_upright()
    assert pose.yaw() == pytest.approx(math.pi / 2)
    assert not Pose3D((0, 0, 0), (1, 0.1, 0, 0)).is_upright()


def test_a_pose_in_space_refuses_a_zero_quaternion():
    with pytest.raises(InputError):
        Pose3D((0, 0, 0), (0, 0, 0, 0))


def test_path_length_adds_up_the_legs():
    assert path_length([[0, 0], [3, 4], [3, 5]]) == 6.0
    assert path_length([[1, 1]]) == 0.0


def test_arc_lengths_are_the_path_lengths_up_to_each_point():
    assert arc_lengths([[0, 0, 9], [3, 4, 9], [3, 5, 9]]).tolist() == [0.0, 5.0, 6.0]
    assert arc_lengths([[1, 1]]).tolist() == [0.0]


def test_padding_a_square_moves_every_edge_outwards():
    square = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    np.testing.assert_allclose(pad_outline(square, 0.1), square * 1.1)


@given(st.integers(3, 12), st.floats(0.01, 0.5))
def test_padding_a_polygon_widens_its_inscribed_circle_by_the_padding(corners, padding):
    turn = np.arange(corners) * 2 * np.pi / corners
    outline = np.column_stack([np.cos(turn), np.sin(turn)])
    grown = pad_outline(outline, padding)
    assert np.hypot(*grown.T).min() * np.cos(np.pi / corners) == pytest.approx(np.cos(np.pi / corners) + padding)


def test_shrinking_a_rectangle_leaves_a_smaller_one_or_nothing():
    rectangle = np.array([[2.0, 1.0], [-2.0, 1.0], [-2.0, -1.0], [2.0, -1.0]])
    left = shrink_outline(rectangle, 0.9)
    assert left is not None
    assert sorted(map(tuple, np.abs(left).round(12))) == [(1.1, 0.1)] * 4
    assert shrink_outline(rectangle, 1.0) is None


@given(st.integers(0, 10_000), st.floats(0.001, 0.6))
def test_shrinking_an_outline_is_what_shapely_does_by_a_mitred_buffer(seed, margin):
    outline = convex_hull(np.random.default_rng(seed).normal(size=(12, 2)))
    left = shrink_outline(outline, margin)
    expected = shapely.Polygon(outline).buffer(-margin, join_style="mitre", mitre_limit=1e6)
    if left is None:
        assert expected.area < 1e-9
    else:
        assert shapely.Polygon(left).symmetric_difference(expected).area < 1e-9


@given(st.lists(st.floats(-3.0, 3.0), min_size=12, max_size=12))
def test_poses_in_space_compose_and_invert_as_their_matrices_do(numbers):
    first = Pose3D.from_rpy(numbers[:3], numbers[3:6])
    second = Pose3D.from_rpy(numbers[6:9], numbers[9:])
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 0.5, 0.0]])
    np.testing.assert_allclose(
        (first @ second).transform_points(points), first.transform_points(second.transform_points(points)), atol=1e-9
    )
    np.testing.assert_allclose((first.inverse() @ first).transform_points(points), points, atol=1e-9)
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = first.rotation(), first.position
    np.testing.assert_allclose(Pose3D.from_matrix(matrix).rotation(), first.rotation(), atol=1e-9)


def test_roll_pitch_yaw_turn_about_fixed_axes_in_this_order():
    pose = Pose3D.from_rpy((0.0, 0.0, 0.0), (math.pi / 2, 0.0, math.pi / 2))
    np.testing.assert_allclose(pose.transform_points([[0.0, 1.0, 0.0]]), [[0.0, 0.0, 1.0]], atol=1e-12)
    np.testing.assert_allclose(pose.transform_points([[1.0, 0.0, 0.0]]), [[0.0, 1.0, 0.0]], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("1.57", 1.57),
        ("90deg", math.pi / 2.0),
        ("-90 deg", -math.pi / 2.0),
        ("180°", math.pi),
        ("1.5rad", 1.5),
        ("1e1deg", math.radians(10.0)),
        (".5", 0.5),
    ],
)
def test_angles_are_radians_unless_they_have_another_unit(text, angle):
    assert parse_angle(text) == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("text", ["", "north", "deg", "90degrees", "nan", "infdeg", "1e999deg", "90 grad"])
def test_what_is_no_angle_is_refused(text):
    with pytest.raises(ValueError, match=r".*"):
        parse_angle(text)


def test_more_than_a_whole_turn_is_in_degrees():
    assert not is_in_degrees(math.tau)
    assert not is_in_degrees(-math.tau)
    assert is_in_degrees(7.0)
    assert is_in_degrees(-90.0)
