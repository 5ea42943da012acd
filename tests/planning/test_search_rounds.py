"""Which search of poses has its turn when, and how far it goes."""

import math

import pytest

from support.swept import costmap_of, room
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import create_planner
from trundle.planning.cancellation import Patience
from trundle.planning.queries.ends import End
from trundle.planning.queries.query import Query
from trundle.planning.search_rounds import CLOSED_OFF, FOUND, SPENT, UNREACHABLE, Answer, search_in_rounds
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
