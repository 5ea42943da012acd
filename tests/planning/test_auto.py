"""The default planner: least cost where that does, and a search of poses where it does not."""

import math

import numpy as np
import pytest

from support.swept import costmap_of, room, swept_area_blocked
from trundle.costmap import INSCRIBED, Costmap
from trundle.errors import BlockedPoseError, InputError, NoPathError, PlanningError, PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Navigator
from trundle.planning import Cancellation, PathCheck, create_planner
from trundle.planning.auto import AutoPlanner
from trundle.planning.search_rounds import SPENT, Answer
from trundle.robots import Robot
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
ALLEY = ((0, 4.3, 3, 4.6), (0, 5.4, 3, 5.7))
"""Along x up to 3 m, 0.8 m wide: too narrow for Nova Carter to turn round in."""
NOSE_IN = Pose2D(0.6, 5.0, math.pi)


def alley(*blocks):
    return costmap_of(room(10, 10, *ALLEY, *blocks))


def tight_ends(costmap, seed, count):
    """Pairs of poses at least 5 m apart, each 0.03 to 0.25 m from an obstacle."""
    rng = np.random.default_rng(seed)
    rows, cols = np.nonzero(costmap.data < INSCRIBED)
    found = []
    while len(found) < 2 * count:
        k = int(rng.integers(len(rows)))
        x, y = costmap.cell_to_world(rows[k], cols[k])
        pose = Pose2D(float(x), float(y), float(rng.uniform(-math.pi, math.pi)))
        far = len(found) % 2 == 0 or pose.distance_to(found[-1]) >= 5.0
        if far and 0.03 <= costmap.clearance([pose.as_tuple()], cap=0.5)[0] <= 0.25:
            found.append(pose)
    return list(zip(found[::2], found[1::2], strict=True))


def attempt(planner, costmap, start, goal):
    try:
        return planner.plan(costmap, start, goal)
    except PlanningError as error:
        return error


def test_it_backs_out_of_where_the_robot_cannot_turn():
    costmap, goal = alley(), Pose2D(8, 8, 1.0)
    with pytest.raises(PlanningStoppedError, match="none found within"):
        create_planner("least_cost").plan(costmap, NOSE_IN, goal)
    path = create_planner("auto").plan(costmap, NOSE_IN, goal)
    assert path.planner == "hybrid_astar"
    assert path.backward[0]
    assert (path.start, path.goal) == (NOSE_IN, goal)
    assert swept_area_blocked(costmap, path) < 1e-6


def test_it_backs_into_where_the_robot_cannot_turn():
    goal = Pose2D(0.8, 5.0, 0.0)
    path = create_planner("auto").plan(alley(), Pose2D(8, 8, 1.0), goal)
    assert path.planner == "hybrid_astar"
    assert path.backward[-1]
    assert path.goal == goal


def test_where_least_cost_finds_a_path_it_is_that_one():
    costmap = alley()
    for start, goal in ((Pose2D(5, 1), Pose2D(8, 8, 1.0)), (Pose2D(8, 8, 1.0), NOSE_IN)):
        path, plain = (create_planner(name).plan(costmap, start, goal) for name in ("auto", "least_cost"))
        assert path.planner == "least_cost"
        assert np.array_equal(path.poses, plain.poses)
        assert path.cost == plain.cost


@pytest.mark.parametrize(("kind", "seed"), [("office", 3), ("warehouse", 3), ("lot", 3)])
def test_between_tight_ends_it_finds_what_any_of_its_planners_finds(kind, seed):
    grid = OccupancyGrid.from_world(World.generate(kind, seed=seed), z_range=CARTER.z_range)
    costmap = Navigator(grid, CARTER).costmap
    by = [create_planner("least_cost"), create_planner("hybrid_astar", in_place=True)]
    planned = 0
    for start, goal in tight_ends(costmap, seed=seed, count=6):
        path = attempt(create_planner("auto"), costmap, start, goal)
        assert isinstance(path, PlanningError) == all(
            isinstance(attempt(planner, costmap, start, goal), PlanningError) for planner in by
        )
        if not isinstance(path, PlanningError):
            planned += 1
            assert not costmap.footprint_collides(path.poses).any()
    assert planned >= 4


def test_a_planner_chosen_by_name_is_never_replaced():
    for name in ("least_cost", "astar"):
        navigator = Navigator(alley(), CARTER, planner=name)
        navigator.set_goal(8, 8, 1.0)
        with pytest.raises(PlanningStoppedError, match="planner auto or hybrid_astar"):
            navigator.plan(NOSE_IN)


def test_it_is_the_default_of_a_navigator():
    navigator = Navigator(alley(), CARTER)
    navigator.set_goal(8, 8, 1.0)
    assert isinstance(navigator.planner, AutoPlanner)
    assert navigator.planner_name == "auto"
    assert navigator.plan(NOSE_IN).planner == "hybrid_astar"


def test_a_goal_is_moved_only_where_no_planner_gets_to_it_as_it_is():
    costmap, goal = alley(), Pose2D(2.65, 5.0, 0.0)  # a little farther out there is room to turn
    moved = create_planner("least_cost", goal_tolerance=1.0).plan(costmap, Pose2D(8, 8, 1.0), goal)
    assert moved.goal_snapped_m > 0.0
    path = create_planner("auto", goal_tolerance=1.0).plan(costmap, Pose2D(8, 8, 1.0), goal)
    assert (path.goal, path.goal_snapped_m) == (goal, 0.0)


def test_there_is_no_path_only_after_a_search_that_was_complete():
    # A plug that is narrower than the robot is long: the inscribed circle passes it, the footprint nowhere.
    shut = alley((3.0, 4.3, 3.3, 4.8), (3.0, 5.2, 3.3, 5.7))
    with pytest.raises(NoPathError, match=r"away from the start|none of \d+ poses"):
        create_planner("auto").plan(shut, NOSE_IN, Pose2D(8, 8))
    with pytest.raises(NoPathError, match="separated"):
        create_planner("auto").plan(alley((3.0, 4.3, 3.3, 5.7)), NOSE_IN, Pose2D(8, 8))


def test_least_cost_never_says_that_there_is_none_because_its_footprint_collides():
    with pytest.raises(PlanningStoppedError, match="none found within") as caught:
        create_planner("least_cost", max_replans=3).plan(alley(), NOSE_IN, Pose2D(8, 8))
    assert caught.value.status == "exhausted"
    assert alley().footprint_collides([caught.value.pose])[0]


def test_a_partial_path_gets_closer_where_the_robot_must_back_out_first():
    costmap = alley((6, 0, 6.3, 10))
    goal = Pose2D(8, 5)
    plain = create_planner("least_cost", allow_partial=True).plan(costmap, NOSE_IN, goal)
    path = create_planner("auto", allow_partial=True).plan(costmap, NOSE_IN, goal)
    assert path.status == "partial"
    assert path.length > 3.0
    assert path.remaining_m == pytest.approx(path.goal.distance_to(goal))
    assert path.remaining_m < min(plain.remaining_m, NOSE_IN.distance_to(goal)) - 3.0
    assert swept_area_blocked(costmap, path) < 1e-6


def test_one_deadline_and_one_cancellation_hold_for_all_searches():
    for limits, status in (({"deadline_s": 1e-9}, "timeout"), ({"cancel": cancelled()}, "cancelled")):
        with pytest.raises(PlanningStoppedError) as caught:
            create_planner("auto").plan(alley(), NOSE_IN, Pose2D(8, 8), **limits)
        assert caught.value.status == status


def cancelled():
    stop = Cancellation()
    stop.cancel()
    return stop


def test_a_cancellation_during_the_second_search_ends_the_plan(monkeypatch):
    stop, planner = Cancellation(), create_planner("auto")
    first, second = planner._searches[0], planner._searches[1]
    search = first.search

    def cancel_first(*args):
        stop.cancel()
        return search(*args)

    monkeypatch.setattr(first, "search", cancel_first)
    monkeypatch.setattr(second, "search", lambda *_: pytest.fail("it went on after it was cancelled"))
    with pytest.raises(PlanningStoppedError) as caught:
        planner.plan(alley(), NOSE_IN, Pose2D(8, 8), cancel=stop)
    assert caught.value.status == "cancelled"


def test_blocked_ends_are_errors_as_of_every_planner():
    with pytest.raises(BlockedPoseError, match="goal"):
        create_planner("auto", goal_tolerance=0.05).plan(alley(), Pose2D(8, 8), Pose2D(1, 4.45))


@pytest.mark.parametrize("wrong", [{"allow_partial": 1}, {"goal_tolerance": -1}, {"max_replans": 1.5}, {"spacing": 0}])
def test_its_options_are_checked(wrong):
    with pytest.raises(InputError, match=next(iter(wrong))):
        create_planner("auto", **wrong)


def test_its_options_hold_for_the_search_of_poses_too():
    path = create_planner("auto", spacing=0.02).plan(alley(), NOSE_IN, Pose2D(8, 8))
    assert path.planner == "hybrid_astar"
    assert np.hypot(*np.diff(path.poses[:, :2], axis=0).T).max() <= 0.02 + 1e-9


def test_where_least_cost_turns_close_to_something_a_path_that_keeps_more_is_taken():
    grid = OccupancyGrid.from_world(World.generate("warehouse", seed=3), z_range=CARTER.z_range)
    costmap = Navigator(grid, CARTER).costmap
    start, goal = Pose2D(4.0564, 3.3563, 0.0891), Pose2D(4.7337, -4.0617, -2.9673)
    plain = create_planner("least_cost").plan(costmap, start, goal)
    assert costmap.clearance(PathCheck(plain).poses).min() < 0.01
    path = create_planner("auto").plan(costmap, start, goal)
    assert path.planner == "hybrid_astar"
    assert costmap.clearance(PathCheck(path).poses).min() > 0.015


def test_a_close_turn_of_least_cost_is_kept_where_no_other_path_keeps_more(monkeypatch):
    grid = OccupancyGrid.from_world(World.generate("warehouse", seed=3), z_range=CARTER.z_range)
    costmap = Navigator(grid, CARTER).costmap
    start, goal = Pose2D(4.0564, 3.3563, 0.0891), Pose2D(4.7337, -4.0617, -2.9673)
    plain = create_planner("least_cost").plan(costmap, start, goal)
    planner = create_planner("auto")
    for search in planner._searches:
        monkeypatch.setattr(search, "_plan_to", lambda *_: plain)
    assert planner.plan(costmap, start, goal).planner == "least_cost"


def test_a_deadline_that_passes_while_it_looks_for_a_better_path_gives_the_one_that_it_has(monkeypatch):
    costmap, goal = alley(), Pose2D(2.65, 5.0, 0.0)
    planner = create_planner("auto", goal_tolerance=1.0)
    monkeypatch.setattr(planner._searches[0], "_plan_to", lambda _query, _goal, patience: stop(patience, "timeout"))
    assert planner.plan(costmap, Pose2D(8, 8, 1.0), goal, deadline_s=60.0).planner == "least_cost"
    monkeypatch.setattr(planner._searches[0], "_plan_to", lambda _query, _goal, patience: stop(patience, "cancelled"))
    with pytest.raises(PlanningStoppedError, match="cancelled"):
        planner.plan(costmap, Pose2D(8, 8, 1.0), goal, deadline_s=60.0)


def stop(patience, why):
    raise patience.stopped(why)


def clutter(seed, size, density):
    """A walled room with a share of its cells blocked at random, and two poses in it that are free by 1 cm."""
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((size, size)) < density, 100, 0).astype(np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), Robot.load("turtlebot3_burger"))
    side = 0.05 * size
    poses = np.column_stack([rng.uniform(0, side, 4000), rng.uniform(0, side, 4000), rng.uniform(-3.14, 3.14, 4000)])
    poses = poses[costmap.clearance(poses, cap=0.3) > 0.01]
    start, farthest = poses[0], np.argsort(-np.hypot(*(poses - poses[0])[:, :2].T))
    return costmap, Pose2D(*start), Pose2D(*poses[farthest[len(poses) // 3]])


@pytest.mark.parametrize(("seed", "size", "density"), [(37, 60, 0.025), (105, 50, 0.03), (139, 50, 0.03)])
def test_a_small_robot_gets_through_gaps_that_are_narrower_than_the_cells_of_the_search(seed, size, density):
    costmap, start, goal = clutter(seed, size, density)
    path = create_planner("auto").plan(costmap, start, goal)
    assert path.goal == goal
    assert swept_area_blocked(costmap, path) < 1e-6


def test_once_a_search_with_turns_has_tried_all_poses_none_without_them_follows(monkeypatch):
    planner = create_planner("auto")
    monkeypatch.setattr(planner._searches[1], "search_finely", lambda *_: pytest.fail("it cannot find anything"))
    shut = alley((3.0, 4.3, 3.3, 4.8), (3.0, 5.2, 3.3, 5.7))
    with pytest.raises(NoPathError, match=r"away from the start|none of \d+ poses"):
        planner.plan(shut, NOSE_IN, Pose2D(8, 8))


def test_where_the_search_with_turns_gives_up_the_one_without_them_follows(monkeypatch):
    planner = create_planner("auto")

    monkeypatch.setattr(planner._searches[0], "search", lambda *_: Answer(SPENT, None, 1))
    assert planner.plan(alley(), NOSE_IN, Pose2D(8, 8, 1.0)).goal == Pose2D(8, 8, 1.0)


def test_a_deadline_that_passes_in_a_search_of_poses_leaves_the_partial_path_of_least_cost(monkeypatch):
    costmap, goal = alley(), Pose2D(8, 8, 1.0)
    plain = create_planner("least_cost", allow_partial=True).plan(costmap, NOSE_IN, goal)
    planner = create_planner("auto", allow_partial=True)
    for search in (*planner._searches, planner._nearing):
        for method in ("search", "_plan_near"):
            monkeypatch.setattr(search, method, lambda *args: stop(args[-1], "timeout"))
    path = planner.plan(costmap, NOSE_IN, goal, deadline_s=60.0)
    assert (path.status, path.remaining_m) == ("partial", plain.remaining_m)
    for search in (*planner._searches, planner._nearing):
        monkeypatch.setattr(search, "search", lambda *args: stop(args[-1], "cancelled"))
        monkeypatch.setattr(search, "_plan_near", lambda *args: stop(args[-1], "cancelled"))
    with pytest.raises(PlanningStoppedError, match="cancelled"):
        planner.plan(costmap, NOSE_IN, goal, deadline_s=60.0)
