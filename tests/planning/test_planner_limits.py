"""Deadlines, cancelling and partial paths, for every planner."""

import itertools
import math
import threading
import time

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, NoPathError, OutsideMapError, PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.planning import Cancellation, create_planner, planner_names
from trundle.planning.grid_planners.footprint_planner import FootprintOptions, FootprintPlanner
from trundle.planning.motions import sample

NAMES = [name for name in planner_names() if name != "straight_line"]
GRID_NAMES = [name for name in NAMES if name != "hybrid_astar"]
LONG = ((0.5, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.5, -0.2))


def costmap_of(data, footprint=LONG):
    return Costmap.from_grid(OccupancyGrid(np.asarray(data, np.int8), 0.05), footprint)


def rooms(door=0):
    """8 × 4 m: two rooms, with a wall between them that has a door of so many cells."""
    data = np.zeros((80, 160), np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[:, 80:83] = 100
    data[40 - door // 2 : 40 + door - door // 2, 80:83] = 0
    return data


START, GOAL = Pose2D(1.0, 2.0, 0.0), Pose2D(7.0, 2.3, 1.0)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("wrong", [0, 0.0, -1.0, math.nan, "1", True, None.__class__])
def test_a_deadline_must_be_a_positive_number(name, wrong):
    with pytest.raises(InputError, match="deadline_s"):
        create_planner(name, deadline_s=wrong)
    with pytest.raises(InputError, match="deadline_s"):
        create_planner(name).plan(costmap_of(rooms(30)), START, GOAL, deadline_s=wrong)


@pytest.mark.parametrize("name", NAMES)
def test_a_plan_stops_at_its_deadline_and_when_it_is_cancelled(name):
    costmap = costmap_of(rooms(30))
    for options, call in (
        ({"deadline_s": 1e-9}, {}),
        ({}, {"deadline_s": 1e-9}),
        ({"deadline_s": 60}, {"deadline_s": 1e-9}),
    ):
        with pytest.raises(PlanningStoppedError, match="deadline of 1e-09 s") as caught:
            create_planner(name, **options).plan(costmap, START, GOAL, **call)
        assert caught.value.status == "timeout"
        assert caught.value.pose == GOAL.as_tuple()
        assert caught.value.cell == tuple(int(index) for index in costmap.world_to_cell(GOAL.x, GOAL.y))
    cancel = Cancellation()
    planner = create_planner(name)
    assert planner.plan(costmap, START, GOAL, cancel=cancel, deadline_s=60.0).status == "found"
    cancel.cancel()
    with pytest.raises(PlanningStoppedError, match="cancelled") as caught:
        planner.plan(costmap, START, GOAL, cancel=cancel)
    assert caught.value.status == "cancelled"
    with pytest.raises(InputError, match="must be a Cancellation"):
        planner.plan(costmap, START, GOAL, cancel=1)


def comb(size):
    """Rooms in a row with doors at alternate ends: a long path, and much to search."""
    data = np.zeros((size, size), np.int8)
    for k, col in enumerate(range(40, size - 40, 40)):
        data[:, col] = 100
        data[(2, -2 - 30)[k % 2] : (2 + 30, size - 2)[k % 2], col] = 0
    return data


@pytest.mark.parametrize("name", ["astar", "least_cost", "manhattan_astar", "any_angle"])
def test_a_search_in_another_thread_is_cancelled_in_the_middle(name):
    costmap = costmap_of(comb(1600), ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)))
    start, goal = Pose2D(1.0, 40.0), Pose2D(79.0, 40.0)
    cancel, planner, raised = (
        Cancellation(),
        create_planner(name, max_replans=0) if name != "manhattan_astar" else create_planner(name),
        [],
    )

    def plan():
        while not raised:
            try:
                planner.plan(costmap, start, goal, cancel=cancel)
            except PlanningStoppedError as error:
                if error.status != "exhausted":  # it was done before it was cancelled
                    raised.append(error.status)

    thread = threading.Thread(target=plan)
    thread.start()
    time.sleep(0.05)
    cancel.cancel()
    thread.join(timeout=60.0)
    assert raised == ["cancelled"]


def test_one_deadline_holds_for_all_attempts_together(monkeypatch):
    seconds = itertools.count()
    monkeypatch.setattr("trundle.planning.cancellation.time.monotonic", lambda: float(next(seconds)))
    attempts = []

    def collide_each_time(costmap, motions):
        attempts.append(motions)
        poses, owners, _ = sample(motions, 0.025, 0.1)
        index = int(np.argmin(np.abs(poses[:, 0] - 2.5)))
        return motions, poses[index : index + 1], [int(owners[index])]

    monkeypatch.setattr("trundle.planning.grid_planners.footprint_planner.fit_motions", collide_each_time)
    with pytest.raises(PlanningStoppedError, match="the deadline of 50 s passed"):
        create_planner("astar", max_replans=1000).plan(costmap_of(rooms(30)), START, GOAL, deadline_s=50.0)
    assert 2 <= len(attempts) <= 25


@pytest.mark.parametrize("name", NAMES)
def test_a_path_says_that_it_was_found(name):
    path = create_planner(name).plan(costmap_of(rooms(40)), START, GOAL)
    assert (path.status, path.remaining_m) == ("found", 0.0)
    assert path.cost > 0.0


@pytest.mark.parametrize("name", GRID_NAMES)
@pytest.mark.parametrize("goal", [GOAL, Pose2D(4.08, 2.0, 0.0), Pose2D(4.0, 0.02, 0.0)], ids=["beyond", "wall", "edge"])
def test_a_partial_path_leads_near_to_a_goal_that_cannot_be_reached(name, goal):
    costmap = costmap_of(rooms())
    with pytest.raises((NoPathError, BlockedPoseError)):
        create_planner(name).plan(costmap, START, goal)
    path = create_planner(name, allow_partial=True).plan(costmap, START, goal)
    assert path.status == "partial"
    assert path.planner in (("least_cost", "hybrid_astar") if name == "auto" else (name,))
    assert path.start == START
    assert path.remaining_m == pytest.approx(path.goal.distance_to(goal))
    # The nearest place for a point, and by how much the robot may reach beyond its inscribed circle.
    free = np.argwhere(costmap.data[:, :80] < (254 if name == "manhattan_astar" else 253))
    x, y = costmap.cell_to_world(free[:, 0], free[:, 1])
    least = np.hypot(x - goal.x, y - goal.y).min()
    overhang = 0.0 if name == "manhattan_astar" else costmap.circumscribed_radius - costmap.inscribed_radius
    assert least - 0.05 <= path.remaining_m <= least + overhang + 0.1
    if name != "manhattan_astar":
        assert not costmap.footprint_collides(path.poses).any()
        assert path.cost >= path.length - 1e-9


@pytest.mark.parametrize("name", GRID_NAMES)
def test_with_allow_partial_a_planner_still_reaches_the_goal_where_it_can(name):
    costmap = costmap_of(rooms(40))
    whole = create_planner(name, allow_partial=True).plan(costmap, START, GOAL)
    assert whole.status == "found"
    assert np.array_equal(whole.poses, create_planner(name).plan(costmap, START, GOAL).poses)
    with pytest.raises(OutsideMapError):
        create_planner(name, allow_partial=True).plan(costmap, START, Pose2D(-3.0, 1.0))


@pytest.mark.parametrize("name", [name for name in GRID_NAMES if name != "manhattan_astar"])
def test_where_the_yaw_alone_does_not_fit_a_partial_path_ends_at_the_goal_with_another(name):
    data = rooms()
    data[:34, 1:80] = data[46:, 1:80] = 100  # an alley of 0.6 m
    costmap = costmap_of(data)
    goal = Pose2D(3.0, 2.0, math.pi / 2)
    with pytest.raises(BlockedPoseError):
        create_planner(name, goal_tolerance=0.05).plan(costmap, START, goal)
    path = create_planner(name, goal_tolerance=0.05, allow_partial=True).plan(costmap, START, goal)
    assert (path.status, path.remaining_m) == ("partial", 0.0)
    assert path.goal.yaw == pytest.approx(0.0)


@pytest.mark.parametrize("name", GRID_NAMES)
def test_a_robot_that_is_as_near_as_it_gets_stays(name):
    costmap = costmap_of(rooms(), ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)))
    first = create_planner(name, allow_partial=True).plan(costmap, START, GOAL)
    again = create_planner(name, allow_partial=True).plan(costmap, first.goal, GOAL)
    assert again.status == "partial"
    assert again.length <= 0.05
    assert again.remaining_m == pytest.approx(first.remaining_m, abs=0.05)


def test_the_options_for_signatures_are_those_of_the_planner():
    options = {name for name, value in FootprintPlanner.__init__.__annotations__.items() if name != "return"}
    assert options == set(FootprintOptions.__annotations__)


@pytest.mark.parametrize("name", [name for name in GRID_NAMES if name != "manhattan_astar"])
@pytest.mark.parametrize(
    "options",
    [
        {"spacing": 0.0},
        {"spacing": "0.1"},
        {"max_replans": -1},
        {"max_replans": None},
        {"start_tolerance": math.nan},
        {"goal_tolerance": math.inf},
        {"allow_partial": 1},
        {"fast": True},
    ],
    ids=str,
)
def test_bad_options_are_refused(name, options):
    with pytest.raises(InputError, match=next(iter(options))):
        create_planner(name, **options)


def test_hybrid_astar_leads_to_the_pose_nearest_to_a_goal_beyond_a_wall():
    costmap = costmap_of(rooms())
    for goal in (GOAL, Pose2D(4.08, 2.0, 0.0)):
        path = create_planner("hybrid_astar", allow_partial=True).plan(costmap, START, goal)
        assert (path.status, path.start) == ("partial", START)
        assert path.remaining_m == pytest.approx(path.goal.distance_to(goal))
        free = np.argwhere(costmap.data[:, :80] < 253)
        x, y = costmap.cell_to_world(free[:, 0], free[:, 1])
        overhang = costmap.circumscribed_radius - costmap.inscribed_radius
        assert path.remaining_m <= np.hypot(x - goal.x, y - goal.y).min() + overhang + 0.15
        assert not costmap.footprint_collides(path.poses).any()


def test_hybrid_astar_leads_as_near_as_it_could_try_to_get():
    data = rooms(40)
    data[:30, 1:80] = data[50:, 1:80] = 100  # an alley of 1 m: too narrow to turn in, and it is to go back
    costmap = costmap_of(data)
    planner = {"motion_model": "dubins", "minimum_turning_radius": 1.0, "max_expansions": 3000}
    start, goal = Pose2D(2.0, 2.0, 0.0), Pose2D(1.0, 2.0, 0.0)
    with pytest.raises((NoPathError, PlanningStoppedError)):
        create_planner("hybrid_astar", **planner).plan(costmap, start, goal)
    path = create_planner("hybrid_astar", **planner, allow_partial=True).plan(costmap, start, goal)
    assert path.status == "partial"
    assert path.remaining_m == pytest.approx(path.goal.distance_to(goal))
    assert path.remaining_m <= 1.0 + 1e-9
    few = {**planner, "max_expansions": 5}
    question = costmap_of(comb(400)), Pose2D(1.0, 2.0), Pose2D(19.0, 2.0)
    with pytest.raises(PlanningStoppedError) as caught:
        create_planner("hybrid_astar", **few).plan(*question)
    assert caught.value.status == "exhausted"
    assert create_planner("hybrid_astar", **few, allow_partial=True).plan(*question).status == "partial"
