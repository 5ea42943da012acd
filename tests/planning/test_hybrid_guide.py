"""Searches that their guide would lead astray: gaps for the inscribed circle alone, and goals among furniture."""

import pytest

from support.swept import costmap_of, room, swept_area_blocked
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.planning.hybrid_astar import HybridAStarPlanner
from trundle.robots import Robot
from trundle.worlds import World

KINDS = [{}, {"in_place": True}, {"motion_model": "dubins"}]
FEW = 10_000
"""Expansions; more than 200,000 did not find these paths by the guide alone."""


@pytest.mark.parametrize("kind", KINDS, ids=str)
@pytest.mark.parametrize("gaps", [(2.0,), (2.0, 4.0, 6.0, 8.0)], ids=len)
def test_gaps_that_only_the_inscribed_circle_fits_do_not_keep_the_search_before_them(kind, gaps):
    # The inscribed circle needs 0.28 m, the footprint 0.5; the door at the far end is 1.2 m wide.
    ends = [0.0, *(y for gap in gaps for y in (gap - 0.2, gap + 0.2)), 10.5, 11.7, 12.0]
    costmap = costmap_of(room(16, 12, *((8, low, 8.2, high) for low, high in zip(ends[::2], ends[1::2], strict=True))))
    path = HybridAStarPlanner(max_expansions=FEW, **kind).plan(costmap, Pose2D(6, 2, 0.0), Pose2D(10, 2, 0.0))
    assert swept_area_blocked(costmap, path) < 1e-6
    assert path.length > 17.0


def test_the_same_query_has_the_same_path_again():
    costmap = costmap_of(room(16, 12, (8, 0, 8.2, 1.8), (8, 2.2, 8.2, 10.5), (8, 11.7, 8.2, 12)))
    planner = HybridAStarPlanner(max_expansions=FEW)
    ends = Pose2D(6, 2, 0.0), Pose2D(10, 2, 0.0)
    first, again = planner.plan(costmap, *ends), planner.plan(costmap, *ends)
    other = HybridAStarPlanner(max_expansions=FEW).plan(costmap, *ends)
    assert first.poses.tobytes() == again.poses.tobytes() == other.poses.tobytes()


@pytest.mark.parametrize(
    ("size", "seed", "start", "goal"),
    [
        ((75.0, 65.0), 2, (17.33977, -17.12196, -0.369947), (-30.440593, -12.897962, -2.572008)),
        ((75.0, 65.0), 2, (-23.885296, 13.81992, -1.400391), (30.628845, 20.418049, 0.174798)),
    ],
)
def test_a_goal_among_furniture_is_reached_by_the_motions_that_lead_away_from_it(size, seed, start, goal):
    world = World.generate("office", seed=seed, size=size)
    costmap = Costmap.from_grid(OccupancyGrid.from_world(world, resolution=0.05), Robot.load("nova_carter"))
    path = HybridAStarPlanner(max_expansions=FEW).plan(costmap, Pose2D(*start), Pose2D(*goal))
    assert swept_area_blocked(costmap, path) < 1e-6
    assert path.goal == Pose2D(*goal)


def test_a_robot_that_drives_forward_only_comes_into_a_room_as_it_can_come_out_of_it_backwards():
    world = World.generate("office", seed=2, size=(75.0, 65.0))
    costmap = Costmap.from_grid(OccupancyGrid.from_world(world, resolution=0.05), Robot.load("nova_carter"))
    start, goal = Pose2D(36.05936, -7.52515, 2.426409), Pose2D(-12.608307, 26.440072, 1.659764)
    path = HybridAStarPlanner(motion_model="dubins", max_expansions=100_000).plan(costmap, start, goal)
    assert swept_area_blocked(costmap, path) < 1e-6
    assert not path.backward.any()
