import functools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from trundle.costmap import Costmap
from trundle.errors import (
    BlockedPoseError,
    InputError,
    NoPathError,
    OutsideMapError,
    PlanningError,
    PlanningStoppedError,
    UnknownNameError,
)
from trundle.geometry import Goal, Pose2D, pad_outline
from trundle.maps.grid import OccupancyGrid
from trundle.planning import Planner, create_planner, planner_names
from trundle.planning.grid_planners.binary_planner import AStarPlanner
from trundle.planning.grid_planners.least_cost import LeastCostPlanner
from trundle.robots import Robot

CARTER = Robot.load("nova_carter").outline
SMALL = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))


def room(width, height, resolution=0.05):
    """A room with walls of one cell; its inside begins at (0, 0)."""
    data = np.zeros((round(height / resolution) + 2, round(width / resolution) + 2), np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    return data


def costmap_of(data, footprint=CARTER, resolution=0.05, **options):
    return Costmap.from_grid(OccupancyGrid(data, resolution, Pose2D(-resolution, -resolution)), footprint, **options)


def block(data, x0, y0, x1, y1, resolution=0.05, value=100):
    """Fill a rectangle [m] of a room's inside."""
    data[
        round(y0 / resolution) + 1 : round(y1 / resolution) + 1, round(x0 / resolution) + 1 : round(x1 / resolution) + 1
    ] = value


def dense(path, step=0.01):
    """Poses along a path, with the shorter turn between two poses at one place."""
    pieces = []
    for a, b in zip(path.poses[:-1], path.poses[1:], strict=True):
        turn = math.remainder(b[2] - a[2], 2 * math.pi)
        n = 2 + int(max(math.dist(a[:2], b[:2]) / step, abs(turn) / 0.02))
        t = np.linspace(0, 1, n)[:, None]
        pieces.append(a + t * np.array([b[0] - a[0], b[1] - a[1], turn]))
    return np.concatenate(pieces)


def assert_drivable(costmap, path, start, goal):
    assert path.poses[0] == pytest.approx(start.as_tuple())
    assert path.poses[-1] == pytest.approx(goal.as_tuple())
    assert costmap.clearance(dense(path)).min() >= 0.0
    # Checked every 0.025 m and 2°: between two checks a corner moves by half a step at most.
    deep = np.asarray(costmap.footprint) * 0.97
    assert not costmap.footprint_collides(dense(path), outline=deep).any()
    moving = np.hypot(*np.diff(path.poses[:, :2], axis=0).T) > 1e-9
    headings = np.arctan2(*np.diff(path.poses[:, :2], axis=0).T[::-1])
    off = np.abs(np.remainder(headings - path.poses[1:, 2] + np.pi, 2 * np.pi) - np.pi)
    assert off[moving].max(initial=0.0) < 1e-6


def test_an_empty_room_is_crossed_in_a_straight_line():
    costmap = costmap_of(room(10, 8))
    start, goal = Pose2D(2.0, 2.0, 0.0), Pose2D(7.0, 5.0, math.pi / 2)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert path.length == pytest.approx(math.hypot(5, 3))
    assert path.cost == pytest.approx(50 * path.length)
    assert path.planner == "least_cost"
    assert (path.replans, path.start_snapped_m, path.goal_snapped_m) == (0, 0.0, 0.0)
    assert_drivable(costmap, path, start, goal)
    steps = np.hypot(*np.diff(path.poses[:, :2], axis=0).T)
    assert steps.max() <= 0.1 + 1e-9


def test_the_ends_are_kept_exactly():
    costmap = costmap_of(room(6, 6), SMALL)
    start, goal = Pose2D(1.0123456, 1.07654321, 0.3), Pose2D(4.44444, 4.999, -2.0)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert path.start == start
    assert path.goal == goal


def test_cost_keeps_the_path_off_the_walls_and_astar_goes_straight():
    data = room(10, 6)
    block(data, 4.0, 0.0, 6.0, 3.0)
    costmap = costmap_of(data)
    start, goal = Pose2D(1.5, 1.5), Pose2D(8.5, 1.5)
    cheap = LeastCostPlanner().plan(costmap, start, goal)
    short = AStarPlanner().plan(costmap, start, goal)
    assert short.length < cheap.length
    assert short.cost == pytest.approx(short.length)
    assert costmap.clearance(cheap.poses).min() > costmap.clearance(short.poses).min()
    assert_drivable(costmap, cheap, start, goal)
    assert_drivable(costmap, short, start, goal)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), name=st.sampled_from(["least_cost", "astar"]), small=st.booleans())
@example(seed=96902, name="least_cost", small=False)
def test_every_path_is_drivable_or_refused(seed, name, small):
    rng = np.random.default_rng(seed)
    data = room(9, 7)
    for _ in range(6):
        x, y = rng.uniform(0, 8), rng.uniform(0, 6)
        block(data, x, y, x + rng.uniform(0.1, 1.0), y + rng.uniform(0.1, 1.0), value=rng.choice([100, -1]))
    costmap = costmap_of(data, SMALL if small else CARTER)
    start, goal = (Pose2D(rng.uniform(0.8, 8.2), rng.uniform(0.8, 6.2), rng.uniform(-3, 3)) for _ in range(2))
    planner = create_planner(name, start_tolerance=0.0, goal_tolerance=0.0)
    path, error = attempt(planner, costmap, start, goal)
    if path is None:
        check_refusal(costmap, error)
        return
    assert_drivable(costmap, path, start, goal)
    again = planner.plan(costmap, start, goal)
    assert np.array_equal(path.poses, again.poses)
    back, _ = attempt(planner, costmap, goal, start)
    if back is not None and path.replans == back.replans == 0:
        assert back.length == pytest.approx(path.length)
        assert back.cost == path.cost


def attempt(planner, costmap, start, goal):
    """The path, or the error."""
    try:
        return planner.plan(costmap, start, goal), None
    except PlanningError as error:
        return None, error


def check_refusal(costmap, error):
    """A refusal names what it is about."""
    if isinstance(error, BlockedPoseError):
        assert error.nearest_free_m is None or error.nearest_free_m > 0.0
        assert costmap.footprint_collides([error.pose])[0]
    elif isinstance(error, PlanningStoppedError):
        # Between two poses that are free, the place is given to within 0.01 mm.
        wider = pad_outline(costmap.footprint, 2e-5)
        assert costmap.footprint_collides([error.pose], outline=wider)[0]
    else:
        assert error.pose is not None


def test_end_turns_go_the_long_way_where_the_short_way_is_blocked():
    data = room(8, 6)
    # Beside the robot's left rear: a turn to the right by 90° would swing the tail into it.
    start, goal = Pose2D(4.0, 3.0, 0.0), Pose2D(4.0, 1.0, -math.pi / 2)
    block(data, 3.5, 3.35, 3.7, 3.5)
    costmap = costmap_of(data)
    assert not costmap.footprint_collides([start.as_tuple(), (4.0, 3.0, -math.pi / 2)]).any()
    assert costmap.footprint_collides([(4.0, 3.0, -math.pi / 4), (4.0, 3.0, math.pi / 4)]).any()
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal)


def test_a_long_turn_is_given_in_pieces():
    data = room(8, 6)
    block(data, 3.35, 3.4, 3.6, 3.6)
    costmap = costmap_of(data)
    start = Pose2D(4.0, 3.0, 0.0)
    goal = Pose2D(4.0, 3.0, -math.pi / 2)
    path = LeastCostPlanner().plan(costmap, start, goal)
    turns = np.remainder(np.diff(path.poses[:, 2]) + np.pi, 2 * np.pi) - np.pi
    assert path.length == 0.0
    assert turns.sum() == pytest.approx(1.5 * math.pi)
    assert (turns < 2.2).all()
    assert_drivable(costmap, path, start, goal)


def test_a_tight_corner_is_planned_again_with_the_footprint():
    data = room(8, 8)
    # A gap that the inscribed circle (0.28 m across) fits and the robot (0.5 m across) does not, and a wide detour.
    block(data, 0.0, 3.9, 3.0, 4.1)
    block(data, 3.4, 3.9, 6.0, 4.1)
    costmap = costmap_of(data, cost_scaling_factor=20.0)
    start, goal = Pose2D(3.2, 2.0, 0.0), Pose2D(3.2, 6.0, 0.0)
    path = AStarPlanner().plan(costmap, start, goal)
    assert path.replans > 0
    assert path.length > 5.0
    assert_drivable(costmap, path, start, goal)


def test_when_planning_again_does_not_help_the_error_names_the_pose():
    data = room(8, 8)
    block(data, 0.0, 3.9, 3.0, 4.1)
    block(data, 3.4, 3.9, 6.0, 4.1)
    costmap = costmap_of(data, cost_scaling_factor=20.0)
    with pytest.raises(PlanningStoppedError, match="none found within 1 plan;") as caught:
        AStarPlanner(max_replans=0).plan(costmap, Pose2D(3.2, 2.0), Pose2D(3.2, 6.0))
    assert costmap.footprint_collides([caught.value.pose])[0]
    assert caught.value.cell == tuple(int(i) for i in costmap.world_to_cell(*caught.value.pose[:2]))


def test_a_door_wide_enough_is_used():
    data = room(8, 8)
    block(data, 0.0, 3.9, 3.6, 4.1)
    block(data, 4.4, 3.9, 8.0, 4.1)
    costmap = costmap_of(data)
    start, goal = Pose2D(1.5, 2.0, 0.0), Pose2D(6.5, 6.0, 3.0)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal)


def test_a_door_too_narrow_for_the_inscribed_circle_is_named():
    data = room(8, 8)
    block(data, 0.0, 3.9, 3.9, 4.1)
    block(data, 4.1, 3.9, 8.0, 4.1)
    with pytest.raises(NoPathError, match="too wide for it at") as caught:
        LeastCostPlanner().plan(costmap_of(data), Pose2D(2.0, 2.0), Pose2D(6.0, 6.0))
    assert caught.value.pose[:2] == pytest.approx((4.0, 4.0), abs=0.1)


def test_a_door_too_narrow_for_the_footprint_is_named():
    data = room(8, 8)
    block(data, 0.0, 3.9, 3.8, 4.1)
    block(data, 4.2, 3.9, 8.0, 4.1)
    costmap = costmap_of(data)
    with pytest.raises(PlanningError, match="footprint") as caught:
        LeastCostPlanner().plan(costmap, Pose2D(2.0, 2.0), Pose2D(6.0, 6.0))
    assert caught.value.pose[:2] == pytest.approx((4.0, 4.0), abs=1.2)
    assert costmap.footprint_collides([caught.value.pose])[0]


def test_separated_rooms_have_no_path():
    data = room(8, 8)
    block(data, 0.0, 3.9, 8.0, 4.1)
    with pytest.raises(NoPathError, match="no robot could get there"):
        LeastCostPlanner().plan(costmap_of(data), Pose2D(2.0, 2.0), Pose2D(6.0, 6.0))


def test_outside_the_map():
    with pytest.raises(OutsideMapError, match="goal"):
        LeastCostPlanner().plan(costmap_of(room(6, 6)), Pose2D(2, 2), Pose2D(20, 2))
    with pytest.raises(OutsideMapError, match="start"):
        LeastCostPlanner().plan(costmap_of(room(6, 6)), Pose2D(2, -2), Pose2D(2, 2))


def test_a_blocked_goal_says_how_far_the_nearest_place_is():
    data = room(8, 8)
    block(data, 3.0, 3.0, 5.0, 5.0)
    costmap = costmap_of(data, SMALL)
    with pytest.raises(BlockedPoseError, match="in an obstacle") as caught:
        LeastCostPlanner().plan(costmap, Pose2D(1, 1), Pose2D(4.0, 3.3, 0.0))
    assert caught.value.nearest_free_m == pytest.approx(0.3 + 0.1, abs=0.06)
    block(data, 3.0, 3.0, 5.0, 5.0, value=-1)
    with pytest.raises(BlockedPoseError, match="in unknown space"):
        LeastCostPlanner().plan(costmap_of(data, SMALL), Pose2D(4.0, 4.0), Pose2D(1, 1))


def test_a_goal_just_inside_something_is_moved_and_it_says_so():
    data = room(8, 8)
    block(data, 3.0, 3.0, 5.0, 5.0)
    costmap = costmap_of(data, SMALL)
    goal = Pose2D(4.0, 2.95, 1.0)
    path = LeastCostPlanner().plan(costmap, Pose2D(1, 1), goal)
    assert 0.0 < path.goal_snapped_m <= 0.25
    assert path.goal.distance_to(goal) == pytest.approx(path.goal_snapped_m)
    assert path.goal.yaw == goal.yaw
    assert not costmap.footprint_collides([path.goal.as_tuple()])[0]
    with pytest.raises(BlockedPoseError, match="at most"):
        LeastCostPlanner(goal_tolerance=0.0).plan(costmap, Pose2D(1, 1), goal)


def test_a_start_is_moved_only_within_its_tolerance():
    costmap = costmap_of(room(8, 8), SMALL)
    inside = Pose2D(0.095, 4.0, 0.0)
    path = LeastCostPlanner().plan(costmap, inside, Pose2D(5, 5))
    assert 0.0 < path.start_snapped_m <= 0.05
    with pytest.raises(BlockedPoseError, match="start"):
        LeastCostPlanner().plan(costmap, Pose2D(0.0, 4.0, 0.0), Pose2D(5, 5))


def test_a_robot_with_its_tail_at_a_wall_can_leave():
    costmap = costmap_of(room(8, 8))
    start, goal = Pose2D(4.0, 0.61, math.pi / 2), Pose2D(4.0, 4.0, 0.0)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal)


def test_for_a_robot_with_its_nose_at_a_wall_the_error_says_that_it_cannot_turn():
    costmap = costmap_of(room(8, 8))
    start = Pose2D(4.0, 8.0 - 0.1401, math.pi / 2)
    with pytest.raises(PlanningError, match="footprint") as caught:
        LeastCostPlanner().plan(costmap, start, Pose2D(4.0, 4.0, 0.0))
    assert caught.value.pose[:2] == pytest.approx((start.x, start.y))


def test_a_footprint_that_fits_is_in_a_cell_below_253():
    rng = np.random.default_rng(3)
    data = room(4, 4)
    for _ in range(12):
        x, y = rng.uniform(0, 3.9, 2)
        block(data, x, y, x + 0.1, y + 0.1)
    costmap = costmap_of(data, SMALL)
    poses = np.column_stack([rng.uniform(0, 4, (20_000, 2)), rng.uniform(-4, 4, 20_000)])
    free = poses[~costmap.footprint_collides(poses)]
    assert len(free) > 1000
    assert costmap.cost_at(free[:, 0], free[:, 1]).max() < 253


def test_out_of_a_blind_alley_and_into_one_straight_on():
    data = room(9, 9)
    # Two alleys of 0.7 m, too narrow to turn in; the robot looks out of one and shall look into the other.
    for x in (2.0, 6.0):
        block(data, x - 0.55, 0.0, x - 0.35, 3.0)
        block(data, x + 0.35, 0.0, x + 0.55, 3.0)
    costmap = costmap_of(data)
    start, goal = Pose2D(2.0, 1.0, math.pi / 2), Pose2D(6.0, 1.0, -math.pi / 2)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal)


def test_a_robot_that_cannot_turn_drives_on_to_where_it_can():
    data = room(12, 4)
    # An alley of 0.8 m from x = 0 to 8 with the goal behind the robot; it can turn in the open part only.
    block(data, 0.0, 0.0, 8.0, 1.6)
    block(data, 0.0, 2.4, 8.0, 4.0)
    costmap = costmap_of(data)
    start, goal = Pose2D(7.0, 2.0, 0.0), Pose2D(3.0, 2.0, math.pi)
    path = LeastCostPlanner().plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal)
    assert path.poses[:, 0].max() > 8.5
    assert path.length > 6.0
    with pytest.raises(PlanningError, match="footprint"):
        LeastCostPlanner().plan(costmap, Pose2D(4.0, 2.0, 0.0), goal)


def test_a_free_goal_yaw_is_the_yaw_of_arrival():
    costmap = costmap_of(room(8, 8))
    path = LeastCostPlanner().plan(costmap, Pose2D(2, 2, 0.0), Goal(5, 5))
    assert path.goal.yaw == pytest.approx(math.pi / 4)
    still = LeastCostPlanner().plan(costmap, Pose2D(2, 2, 0.7), Goal(2, 2))
    assert still.poses.tolist() == [[2, 2, 0.7], [2, 2, 0.7]]


def test_a_map_that_is_turned_gives_the_turned_path():
    data = room(8, 6)
    block(data, 3.0, 0.0, 3.5, 4.0)
    plain = Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER)
    frame = Pose2D(3.0, -2.0, 0.8)
    turned = Costmap.from_grid(OccupancyGrid(data, 0.05, frame), CARTER)
    start, goal = Pose2D(1.02, 1.02, 0.0), Pose2D(6.02, 1.02, 1.0)
    path = LeastCostPlanner().plan(plain, start, goal)
    other = LeastCostPlanner().plan(turned, frame @ start, frame @ goal)
    assert other.length == pytest.approx(path.length, abs=1e-6)
    assert_drivable(turned, other, frame @ start, frame @ goal)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"neutral_cost": 0.0}, "neutral_cost"),
        ({"cost_weight": -1.0}, "cost_weight"),
        ({"cost_weight": math.nan}, "cost_weight"),
        ({"cost_weight": 1e6}, "cost_weight"),
        ({"start_tolerance": -0.1}, "start_tolerance"),
        ({"goal_tolerance": math.inf}, "goal_tolerance"),
        ({"max_replans": -1}, "max_replans"),
        ({"spacing": 0.0}, "spacing"),
        ({"no_such_option": 1}, "no_such_option"),
    ],
)
def test_bad_options_are_named(options, message):
    with pytest.raises(InputError, match=message):
        create_planner("least_cost", **options)


def test_planners_by_name():
    assert {"least_cost", "astar", "manhattan_astar"} <= set(planner_names())
    with pytest.raises(UnknownNameError, match="least_cost"):
        create_planner("least_costs")
    for name in ("least_cost", "astar", "manhattan_astar"):
        assert isinstance(create_planner(name), Planner)
    own = functools.partial(create_planner, "astar")()
    assert create_planner(own) is own


def test_a_diagonal_slit_too_narrow_for_the_robot_is_named():
    data = np.full((9, 9), 100, np.int8)
    data[1:4, 1:4] = data[5:8, 5:8] = 0
    data[[3, 4, 4, 5], [4, 4, 3, 4]] = 0
    data[[4, 4], [4, 5]] = 0
    slim = ((0.02, 0.02), (-0.02, 0.02), (-0.02, -0.02), (0.02, -0.02))
    costmap = costmap_of(data, slim)
    path = LeastCostPlanner().plan(costmap, Pose2D(0.05, 0.05), Pose2D(0.25, 0.25))
    assert path.length > 0.28
    wide = ((0.06, 0.06), (-0.06, 0.06), (-0.06, -0.06), (0.06, -0.06))
    with pytest.raises(NoPathError, match="too wide"):
        LeastCostPlanner().plan(costmap_of(data, wide), Pose2D(0.075, 0.075), Pose2D(0.275, 0.275))
