import math
import threading

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from support.hybrid_queries import KINDS, WALLS
from support.swept import CARTER, along_legs, costmap_of, densely, penalised_length, room, swept_area_blocked
from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import (
    NoPathError,
    PlanningStoppedError,
)
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import Planner, create_planner
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.testing import check_planner

LONG = ((1.0, 0.2), (-0.4, 0.2), (-0.4, -0.2), (1.0, -0.2))


def assert_drivable(costmap, path, start, goal, *, radius=0.4, in_place=False, forward_only=False):
    assert path.poses[0] == pytest.approx(start.as_tuple(), abs=1e-12)
    assert path.poses[-1] == pytest.approx(goal.as_tuple(), abs=1e-12)
    # Where an end leaves no padding, poses are looked at every 5 mm, and a corner may graze between two.
    assert swept_area_blocked(costmap, path) < 1e-6
    steps = np.diff(path.poses, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    turns = np.remainder(steps[:, 2] + np.pi, 2 * np.pi) - np.pi
    moving = lengths > 1e-6
    if not in_place:
        assert np.abs(turns[~moving]).max(initial=0.0) < 1e-6
    # An arc of radius r that turns by a has a chord of 2 r sin(a / 2), in the direction of its middle.
    if radius > 0.0:
        assert (np.abs(np.sin(turns[moving] / 2)) <= lengths[moving] / (2 * radius) + 1e-7).all()
    chord = np.arctan2(steps[moving, 1], steps[moving, 0])
    ahead = path.poses[:-1][moving, 2] + turns[moving] / 2 + np.where(path.backward[moving], np.pi, 0.0)
    askew = np.abs(np.remainder(chord - ahead + np.pi, 2 * np.pi) - np.pi)
    # The goal is given exactly; rounding along the path shows as an angle where the last leg is short.
    assert ((askew < 1e-4) | (askew * lengths[moving] < 2e-6)).all()
    assert not path.backward[~moving].any()
    if forward_only:
        assert not path.backward.any()


@pytest.mark.parametrize("options", KINDS, ids=str)
def test_every_kind_keeps_the_promises_of_the_seam(options):
    check_planner(lambda: create_planner("hybrid_astar", **options))
    assert isinstance(create_planner("hybrid_astar"), Planner)


def test_in_the_open_the_path_is_the_shortest_curve():
    costmap = costmap_of(room(20, 20), footprint=LONG)
    rng = np.random.default_rng(1)
    for _ in range(30):
        start, goal = (Pose2D(*rng.uniform((8, 8, -3), (12, 12, 3))) for _ in range(2))
        ends = np.array([start.as_tuple()]), np.array([goal.as_tuple()])
        for reverse, model in ((False, "dubins"), (True, "reeds_shepp")):
            planner = HybridAStarPlanner(
                motion_model=model, minimum_turning_radius=0.8, reverse_penalty=1.0, change_penalty=0.0
            )
            path = planner.plan(costmap, start, goal)
            shortest = np.abs(_core.shortest_curves(*ends, 0.8, reverse)[0, :, 0]).sum()
            assert path.cost == pytest.approx(shortest)
            assert path.length == pytest.approx(shortest, rel=1e-3)


def test_a_robot_that_turns_in_place_turns_and_drives_straight():
    costmap = costmap_of(room(20, 20))
    start, goal = Pose2D(5, 5, 1.0), Pose2D(15, 5, -1.0)
    path = HybridAStarPlanner(in_place=True, minimum_turning_radius=0.0, turn_penalty=0.5).plan(costmap, start, goal)
    assert path.length == pytest.approx(10.0)
    assert path.cost == pytest.approx(10.0 + 0.5 * 2.0)


@pytest.mark.parametrize("options", KINDS, ids=str)
@pytest.mark.parametrize("footprint", [CARTER, LONG], ids=["carter", "long"])
def test_paths_round_walls_are_free_drivable_and_end_where_asked(options, footprint):
    costmap = costmap_of(WALLS, footprint)
    radius = options.get("minimum_turning_radius", 0.4)
    for start, goal in (
        (Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0)),
        (Pose2D(8.5, 1.5, 0.0), Pose2D(1.5, 4.5, 3.0)),
        (Pose2D(5.4, 3.0, 1.57), Pose2D(5.4, 3.5, -1.57)),
    ):
        path = HybridAStarPlanner(**options).plan(costmap, start, goal)
        assert_drivable(
            costmap,
            path,
            start,
            goal,
            radius=radius,
            in_place=options.get("in_place", False),
            forward_only=options.get("motion_model") == "dubins",
        )
        assert path.length <= path.cost + 1e-9 or radius == 0.0


@given(
    seed=st.integers(0, 10_000),
    density=st.floats(0.0, 0.02),
    kind=st.sampled_from(KINDS),
    yaw=st.floats(-3.0, 3.0),
)
@example(seed=228, density=0.01953125, kind={}, yaw=1.0)  # a piece of a curve of 18 nm, driven backwards
@example(seed=1851, density=0.0078125, kind={"motion_model": "dubins", "in_place": True}, yaw=-0.015625)  # 0.5 mm
@settings(deadline=None, max_examples=40)
def test_paths_among_random_blocks_are_free_and_drivable(seed, density, kind, yaw):
    rng = np.random.default_rng(seed)
    data = room(4, 4)
    data[rng.random(data.shape) < density] = 100
    costmap = costmap_of(data, ((0.2, 0.12), (-0.3, 0.12), (-0.3, -0.12), (0.2, -0.12)), origin=Pose2D(3.0, -2.0, yaw))
    ends = [costmap.origin @ Pose2D(*rng.uniform((0.5, 0.5, -3), (3.5, 3.5, 3))) for _ in range(2)]
    if costmap.footprint_collides([end.as_tuple() for end in ends]).any():
        return
    planner = HybridAStarPlanner(max_expansions=3000, **kind)
    try:
        path = planner.plan(costmap, *ends)
    except (NoPathError, PlanningStoppedError):
        return
    radius = kind.get("minimum_turning_radius", 0.4)
    assert_drivable(costmap, path, *ends, radius=radius, in_place=kind.get("in_place", False))


@pytest.mark.slow
@pytest.mark.parametrize("column", [51, 52, 58, 62])
def test_a_turn_that_begins_beside_something_touches_nothing_between_poses(column):
    # The left side is 0.1 mm from a cell, so that there is no padding that would cover what is between two poses. The
    # tail turns past another cell.
    planner = HybridAStarPlanner(in_place=True, start_tolerance=0.0, goal_tolerance=0.0)
    row = {51: 44, 52: 43}.get(column, 41)
    turned = 0
    for x in np.linspace(3.0, 3.05, 80).tolist():
        data = np.zeros((120, 120), np.int8)
        data[60, int((x - 0.5) / 0.05)] = data[row, column] = 100
        costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER)
        start, goal = Pose2D(x, 3.0 - 0.25 - 1e-4, 0.0), Pose2D(x, 3.0 - 0.25 - 1e-4, math.pi / 2)
        path = planner.plan(costmap, start, goal)
        turned += path.length == 0.0
        poses = along_legs(path.poses[:-1], path.poses[1:], 1e-3, 2e-4)
        assert not costmap.footprint_collides(poses).any()
    assert turned > 0


@pytest.mark.parametrize("options", [{}, {"in_place": True}, {"motion_model": "dubins"}], ids=str)
def test_it_drives_through_a_corridor_too_narrow_for_the_circumscribed_circle(options):
    # 0.8 m wide and with a bend, for a robot that needs 1.31 m to turn in place.
    costmap = costmap_of(room(10, 6, (3, 0, 7, 2.0), (3, 2.8, 7, 6)))
    assert 2 * costmap.circumscribed_radius > 1.3
    start, goal = Pose2D(1.5, 1.5, 2.0), Pose2D(8.5, 4.5, 1.0)
    path = HybridAStarPlanner(**options).plan(costmap, start, goal)
    assert_drivable(costmap, path, start, goal, in_place=options.get("in_place", False))
    assert (costmap.clearance(densely(path)) < 0.2).any()


@pytest.mark.slow
def test_it_backs_out_of_a_dead_end_where_nothing_can_turn():
    costmap = costmap_of(room(8, 5, (4, 0, 8, 2.0), (4, 2.7, 8, 5)))
    start, goal = Pose2D(7.0, 2.35, 0.0), Pose2D(1.5, 2.5, 0.0)
    path = HybridAStarPlanner(in_place=True).plan(costmap, start, goal)
    assert path.backward[:20].all()
    assert_drivable(costmap, path, start, goal, in_place=True)
    with pytest.raises(NoPathError, match="driving forward only"):
        HybridAStarPlanner(motion_model="dubins").plan(costmap, start, goal)


def test_it_parks_parallel_to_a_wall_beside_where_it_stands():
    costmap = costmap_of(room(6, 2.2))
    start, goal = Pose2D(3, 0.5, 0.0), Pose2D(3, 1.6, 0.0)
    path = HybridAStarPlanner().plan(costmap, start, goal)
    assert path.backward.any()
    assert not path.backward.all()
    assert_drivable(costmap, path, start, goal)


def test_a_start_closer_to_a_wall_than_the_padding_is_left_all_the_same():
    costmap = costmap_of(room(6, 4))
    start, goal = Pose2D(0.607 + 0.004, 2.0, 0.0), Pose2D(4.0, 3.0, 1.0)
    assert 0.0 < costmap.clearance([start.as_tuple()])[0] < 0.02
    assert_drivable(costmap, HybridAStarPlanner().plan(costmap, start, goal), start, goal)


def test_where_there_is_room_the_padding_is_kept():
    costmap = costmap_of(WALLS)
    path = HybridAStarPlanner(padding=0.05).plan(costmap, Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0))
    # Poses are closer than the padding to each other, and each of those checked keeps all of it.
    assert costmap.clearance(path.poses).min() >= 0.05 / 2


def test_cells_that_cost_are_kept_away_from():
    costmap = costmap_of(room(12, 6, (4, 2.0, 8, 3.0)))
    start, goal = Pose2D(1.5, 3.4, 0.0), Pose2D(10.5, 3.4, 0.0)
    careless, careful = (HybridAStarPlanner(cost_weight=weight).plan(costmap, start, goal) for weight in (0.0, 5.0))
    assert costmap.clearance(careful.poses).min() > costmap.clearance(careless.poses).min() + 0.05
    assert careless.length < careful.length


def test_the_reverse_penalty_decides_which_way_round():
    costmap = costmap_of(room(12, 6))
    start, goal = Pose2D(6, 3, 0.0), Pose2D(3, 3, 0.0)
    assert HybridAStarPlanner(reverse_penalty=1.0).plan(costmap, start, goal).backward.all()
    assert not HybridAStarPlanner(reverse_penalty=20.0).plan(costmap, start, goal).backward.all()


@pytest.mark.parametrize("kind", [{}, {"in_place": True}, {"motion_model": "dubins"}])
def test_where_no_cell_costs_the_cost_is_the_length_with_its_penalties(kind):
    costmap = costmap_of(np.zeros((120, 130), np.int8))
    penalties = {"reverse_penalty": 3.0, "change_penalty": 0.4, "turn_penalty": 0.7}
    planner = HybridAStarPlanner(smooth=False, **kind, **penalties)
    rng, reversed_paths = np.random.default_rng(0), 0
    for _ in range(60):
        ends = np.column_stack([rng.uniform(1.0, 5.0, (2, 2)), rng.uniform(-3.1, 3.1, 2)])
        ends[1, :2] = np.clip(ends[0, :2] + rng.normal(0.0, 0.6, 2), 1.0, 5.0)
        path = planner.plan(costmap, *(Pose2D(*end) for end in ends.tolist()))
        expected = penalised_length(path, reverse=3.0, change=0.4, turn=0.7)
        assert path.cost == pytest.approx(expected, rel=1e-5, abs=1e-5)
        reversed_paths += bool(path.backward.any())
    assert reversed_paths > 10 or kind.get("motion_model") == "dubins"


def test_the_cost_of_a_smoothed_path_is_that_of_its_own_course():
    unseen = np.zeros((120, 200), np.int8)
    unseen[40:, 60:140] = -1
    costmap = Costmap.from_grid(OccupancyGrid(unseen, 0.05), CARTER, unknown="costly", unknown_cost=200)
    for weight in (2.0, 10.0):
        path = HybridAStarPlanner(cost_weight=weight).plan(costmap, Pose2D(1.2, 4.5), Pose2D(8.8, 4.5))
        ends, middles = path.poses, 0.5 * (path.poses[1:] + path.poses[:-1])
        weights = 1.0 + weight / 252.0 * costmap.cost_at(middles[:, 0], middles[:, 1])
        priced = float((np.hypot(*np.diff(ends[:, :2], axis=0).T) * weights).sum())
        assert not path.backward.any()
        assert path.cost == pytest.approx(priced, rel=2e-3)


def test_with_a_free_yaw_it_ends_as_it_arrives():
    costmap = costmap_of(WALLS)
    start, goal = Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5)
    for options in KINDS:
        path = HybridAStarPlanner(**options).plan(costmap, start, Goal(goal.x, goal.y))
        assert path.length <= HybridAStarPlanner(**options).plan(costmap, start, goal).length + 1.0
        radius = options.get("minimum_turning_radius", 0.4)
        assert_drivable(costmap, path, start, path.goal, radius=radius, in_place=options.get("in_place", False))
        assert path.goal.distance_to(goal) < 1e-9


def test_nothing_to_do_is_a_path_that_stays():
    costmap = costmap_of(room(4, 4))
    pose = Pose2D(2, 2, 0.5)
    path = HybridAStarPlanner().plan(costmap, pose, pose)
    assert path.length == path.cost == 0.0
    assert len(path) == 2


def test_the_same_question_gives_the_same_path_whatever_was_asked_before_and_beside():
    costmap, other = costmap_of(WALLS), costmap_of(room(30, 20))
    start, goal = Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0)
    fresh = HybridAStarPlanner().plan(costmap, start, goal).poses
    planner = HybridAStarPlanner()
    planner.plan(other, Pose2D(2, 2), Pose2D(28, 18, 1.0))
    found: list[np.ndarray] = []

    def ask() -> None:
        found.extend(planner.plan(costmap, start, goal).poses for _ in range(5))

    threads = [threading.Thread(target=ask) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 20
    assert all(np.array_equal(poses, fresh) for poses in found)
    assert planner.nbytes > 0
