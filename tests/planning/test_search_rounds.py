"""Which search of poses has its turn when, and how far it goes."""

import math

import numpy as np
import pytest

from support.swept import costmap_of, room
from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import NoPathError, PlanningError, PlanningStoppedError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import Cancellation, create_planner
from trundle.planning.cancellation import Patience
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import Query, cell_at
from trundle.planning.search_rounds import (
    CLOSED_OFF,
    FOUND,
    SPENT,
    UNREACHABLE,
    Answer,
    Enclosure,
    find_enclosure,
    search_in_rounds,
)
from trundle.robots import Robot
from trundle.worlds import World

START, GOAL = Pose2D(10.6328, 4.1583, 0.7029), Pose2D(-3.4528, 5.7269, -0.6368)
PATIENCE = Patience(None, None, "no path found yet")
PATH = Path([(0, 0, 0), (1, 0, 0)], cost=1.0, planner="hybrid_astar")


def make_query(*blocks):
    costmap = costmap_of(room(10, 10, *blocks))
    start, goal = (End(pose, costmap.world_to_cell(pose.x, pose.y)) for pose in (Pose2D(2, 5), Pose2D(8, 5)))
    return Query(costmap, start, goal, start, goal, yaw_free=False)


class Search:
    """Answers as is given, and keeps the most expansions of each finer search."""

    def __init__(self, *statuses, max_expansions=200_000):
        self.statuses, self.max_expansions, self.limits = list(statuses), max_expansions, []

    def _answer(self):
        status = self.statuses.pop(0)
        return Answer(status, PATH if status == FOUND else None, 10)

    def search(self, _query, _patience):
        return self._answer()

    def search_finely(self, _query, _patience, most):
        self.limits.append(most)
        return self._answer()


def test_the_second_search_has_its_turn_before_the_first_one_goes_far():
    first, second = Search(UNREACHABLE, SPENT), Search(UNREACHABLE, FOUND)
    index, answer = search_in_rounds([first, second], make_query(), PATIENCE)
    assert (index, answer.path, answer.expansions) == (1, PATH, 20)
    assert (first.limits, second.limits) == ([20_000], [20_000])


def test_those_that_were_spent_go_farther_then():
    first, second = Search(UNREACHABLE, SPENT, FOUND), Search(UNREACHABLE, UNREACHABLE)
    index, answer = search_in_rounds([first, second], make_query(), PATIENCE)
    assert (index, answer.path, answer.expansions) == (0, PATH, 30)
    assert (first.limits, second.limits) == ([20_000, 100_000], [20_000])


def test_one_whose_first_run_is_spent_has_no_finer_one():
    first, second = Search(SPENT), Search(UNREACHABLE, UNREACHABLE)
    index, answer = search_in_rounds([first, second], make_query(), PATIENCE)
    assert (index, answer.status) == (1, UNREACHABLE)
    assert first.limits == []


def test_none_is_repeated_with_the_same_limit():
    search = Search(UNREACHABLE, SPENT, max_expansions=15_000)
    assert search_in_rounds([search], make_query(), PATIENCE)[1].status == SPENT
    assert search.limits == [15_000]


def test_what_is_closed_off_for_one_is_for_all():
    second = Search()
    assert search_in_rounds([Search(CLOSED_OFF), second], make_query(), PATIENCE)[0] == 0
    assert second.limits == []


def test_where_an_end_is_enclosed_there_is_no_finer_search():
    searches = [Search(UNREACHABLE), Search(UNREACHABLE)]
    shut = make_query((1.2, 4.5, 2.6, 4.6), (1.2, 5.4, 2.6, 5.5), (1.2, 4.5, 1.3, 5.5), (2.5, 4.5, 2.6, 5.5))
    answer = search_in_rounds(searches, shut, PATIENCE)[1]
    assert answer.enclosure is not None
    assert [search.limits for search in searches] == [[], []]


def test_the_default_planner_finds_a_tight_end_in_an_office_in_the_first_round(monkeypatch):
    """Without turns in place a path takes 13,000 expansions; with them 100,000 find none."""
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid.from_world(World.generate("office", seed=3), z_range=robot.z_range)
    planner, limits = create_planner("auto"), []
    for search in planner._searches:
        monkeypatch.setattr(search, "search_finely", keep_limit(search.search_finely, limits))
    costmap = Costmap.from_grid(grid, robot)
    path = planner.plan(costmap, START, GOAL)
    assert path.planner == "hybrid_astar"
    assert max(limits) == 20_000


def keep_limit(search_finely, limits):
    def search_and_keep(query, patience, most):
        limits.append(most)
        return search_finely(query, patience, most)

    return search_and_keep


@pytest.mark.parametrize("yaw", [0.0, math.pi])
def test_an_open_room_needs_no_finer_search(monkeypatch, yaw):
    planner = create_planner("hybrid_astar")
    monkeypatch.setattr(planner, "search_finely", lambda *_: pytest.fail("no finer search is needed"))
    assert planner.plan(make_query().costmap, Pose2D(2, 5), Pose2D(8, 5, yaw)).planner == "hybrid_astar"


OUTSIDE, INSIDE = Pose2D(2, 2, 1.0), Pose2D(10.2, 6.0, 0.0)


def chamber(gap: float) -> Costmap:
    """A chamber of 1.6 x 1 m in a large room, with a gap in its left wall that is this wide."""
    low, high = 6.0 - gap / 2, 6.0 + gap / 2
    walls = ((9, 5.2, 11.2, 5.5), (9, 6.5, 11.2, 6.8), (10.9, 5.2, 11.2, 6.8))
    return costmap_of(room(16, 12, *walls, (9, 5.2, 9.3, low), (9, high, 9.3, 6.8)))


def enclosed(costmap: Costmap, start: Pose2D, goal: Pose2D, *, any_yaw: bool = False) -> Enclosure | None:
    first, last = (End(pose, cell_at(costmap, pose.x, pose.y)) for pose in (start, goal))
    return find_enclosure(Query(costmap, first, last, first, last, any_yaw), Patience(None, None, "no path"))


@pytest.mark.parametrize("any_yaw", [False, True])
def test_a_chamber_with_too_narrow_a_door_encloses_what_is_inside(any_yaw):
    # The footprint needs 0.5 m.
    enclosure = enclosed(chamber(0.4), OUTSIDE, INSIDE, any_yaw=any_yaw)
    assert enclosure is not None
    assert (enclosure.end.pose, enclosure.is_start) == (INSIDE, False)
    enclosure = enclosed(chamber(0.4), INSIDE, OUTSIDE, any_yaw=any_yaw)
    assert enclosure is not None
    assert (enclosure.end.pose, enclosure.is_start) == (INSIDE, True)


@pytest.mark.parametrize("gap", [0.5, 0.6])
def test_one_whose_door_the_footprint_just_fits_does_not(gap):
    assert enclosed(chamber(gap), OUTSIDE, INSIDE) is None


def test_the_error_names_the_end_and_the_steps_in_which_all_poses_were_tried():
    with pytest.raises(NoPathError, match=r"from nowhere but close by, .* in steps of 25\.0 mm and 3\.1°") as caught:
        HybridAStarPlanner().plan(chamber(0.4), OUTSIDE, INSIDE)
    assert caught.value.pose == INSIDE.as_tuple()
    with pytest.raises(NoPathError, match="cannot get away from the start") as caught:
        HybridAStarPlanner().plan(chamber(0.4), INSIDE, OUTSIDE)
    assert caught.value.pose == INSIDE.as_tuple()


def clutter(seed: int) -> tuple[Costmap, Pose2D, Pose2D]:
    """A walled room of 2.5 m with 3 % of its cells blocked at random, and two poses in it that are free by 1 cm."""
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((50, 50)) < 0.03, 100, 0).astype(np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05), Robot.load("turtlebot3_burger"))
    poses = np.column_stack([rng.uniform(0, 2.5, 4000), rng.uniform(0, 2.5, 4000), rng.uniform(-3.14, 3.14, 4000)])
    poses = poses[costmap.clearance(poses, cap=0.3) > 0.01]
    farthest = np.argsort(-np.hypot(*(poses - poses[0])[:, :2].T))
    return costmap, Pose2D(*poses[0]), Pose2D(*poses[farthest[len(poses) // 3]])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 112))
def test_ends_of_a_path_are_never_enclosed(seed):
    costmap, start, goal = clutter(seed)
    try:
        path = HybridAStarPlanner(in_place=True).plan(costmap, start, goal)
    except PlanningError:
        return
    assert enclosed(costmap, path.start, path.goal) is None
    assert enclosed(costmap, path.goal, path.start) is None


@pytest.mark.slow
@pytest.mark.parametrize("planner", ["auto", "hybrid_astar"])
def test_a_path_with_2_mm_of_room_is_not_called_missing(planner):
    costmap, start, goal = clutter(130)
    with pytest.raises(PlanningStoppedError, match="none found within") as caught:
        create_planner(planner).plan(costmap, start, goal)
    assert caught.value.status == "exhausted"


def office() -> Costmap:
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid.from_world(World.generate("office", seed=3), z_range=robot.z_range)
    return Costmap.from_grid(grid, robot)


@pytest.mark.slow
def test_the_default_planner_goes_on_where_the_closer_look_with_turns_stops_early():
    costmap, start, goal = office(), Pose2D(-6.4031, -0.2111, 1.3298), Pose2D(-3.761, 5.914, -1.703)
    # The search without turns has fewer motions to try, and gets there.
    assert create_planner("auto").plan(costmap, start, goal).goal == goal


@pytest.mark.slow
def test_a_robot_that_only_drives_forward_has_no_path_only_once_all_was_tried():
    alley = costmap_of(room(16, 12, (9, 0, 16, 5.6), (9, 6.4, 16, 12)))
    nose_in = Pose2D(15.0, 6.0, 0.0)
    assert enclosed(alley, nose_in, OUTSIDE) is None
    with pytest.raises(PlanningStoppedError, match="none found within 3000 expansions"):
        HybridAStarPlanner(motion_model="dubins", max_expansions=3_000).plan(alley, nose_in, OUTSIDE)
    with pytest.raises(NoPathError, match="driving forward only"):
        HybridAStarPlanner(motion_model="dubins").plan(alley, nose_in, OUTSIDE)


def test_floods_stop_when_they_are_cancelled_or_late():
    cancel = Cancellation()
    cancel.cancel()
    first, last = (End(pose, cell_at(chamber(0.6), pose.x, pose.y)) for pose in (OUTSIDE, INSIDE))
    query = Query(chamber(0.6), first, last, first, last, yaw_free=False)
    for patience, status in ((Patience(None, cancel, "none"), "cancelled"), (Patience(1e-9, None, "none"), "timeout")):
        with pytest.raises(PlanningStoppedError) as caught:
            find_enclosure(query, patience)
        assert caught.value.status == status


def flood(costs, start, goal, *, outline=None, most=10**6, headings=8):
    outline = np.array([(0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1)]) if outline is None else outline
    return _core.flood_poses(
        costs, 1.0, outline, np.array(start), False, np.array(goal), False, 0.5, headings, most, None, None
    )


def test_the_kernel_fills_every_box_up_to_the_walls():
    costs = np.zeros((6, 9), np.uint8)
    costs[:, 4] = 254
    # Four of nine columns, two boxes a cell, eight headings.
    assert flood(costs, (1.0, 1.0, 0.0), (7.0, 1.0, 0.0)) == (0, 8 * 12 * 8)
    assert flood(costs, (7.0, 1.0, 0.0), (1.0, 1.0, 0.0)) == (0, 8 * 12 * 8)
    assert flood(costs, (1.0, 1.0, 0.0), (3.0, 5.0, 3.0))[0] == 1
    assert flood(costs, (1.0, 1.0, 0.0), (7.0, 1.0, 0.0), most=100)[0] == 2
    costs[3, 4] = 0
    assert flood(costs, (1.0, 1.0, 0.0), (7.0, 1.0, 0.0))[0] == 1


def test_headings_meet_behind_the_robot():
    # A bar of 0.2 x 1.8 m in a corridor 1 m wide fills only yaws near 0; from -0.2 to 0.2 rad it need not turn round.
    costs = np.full((3, 9), 254, np.uint8)
    costs[1] = 0
    bar = np.array([(0.9, 0.1), (-0.9, 0.1), (-0.9, -0.1), (0.9, -0.1)])
    assert flood(costs, (2.0, 1.5, 0.1), (7.0, 1.5, -0.1), outline=bar, headings=60)[0] == 1
    assert flood(costs, (2.0, 1.5, 0.1), (7.0, 1.5, 3.1), outline=bar, headings=60)[0] == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"start": (9.5, 1.0, 0.0)}, "lie on the grid"),
        ({"start": (1.0, np.nan, 0.0)}, "lie on the grid"),
        ({"start": (1.0, 1.0)}, "three numbers"),
        ({"outline": np.zeros((2, 2))}, "shape"),
        ({"headings": 0}, "headings"),
    ],
)
def test_the_kernel_refuses_what_it_cannot_take(change, message):
    arguments = {"start": (1.0, 1.0, 0.0), "goal": (7.0, 1.0, 0.0)} | change
    with pytest.raises(ValueError, match=message):
        flood(np.zeros((6, 9), np.uint8), **arguments)
