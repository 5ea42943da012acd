"""Ends that are free, but that no motions lead to, or away from; each on a map too large to try everything."""

import numpy as np
import pytest

from support.swept import costmap_of, room, swept_area_blocked
from trundle import _core
from trundle.errors import NoPathError
from trundle.geometry import Goal, Pose2D
from trundle.planning.hybrid_astar import HybridAStarPlanner

LARGE = (16, 12)
KINDS = [
    {},
    {"in_place": True},
    {"motion_model": "dubins"},
    {"motion_model": "dubins", "in_place": True},
    {"in_place": True, "minimum_turning_radius": 0.0},
]
FEW = 3_000
"""Expansions; to try every pose of the large room takes some hundred thousand."""


def niche(gap: float):
    """A chamber of 1.6 x 1 m in a large room, with a gap in its left wall that is this wide."""
    low = 6.0 - gap / 2
    walls = ((9, 5.2, 11.2, 5.5), (9, 6.5, 11.2, 6.8), (10.9, 5.2, 11.2, 6.8))
    return costmap_of(room(*LARGE, *walls, (9, 5.2, 9.3, low), (9, 6.0 + gap / 2, 9.3, 6.8)))


@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_a_goal_in_a_chamber_with_too_narrow_a_door_is_named_early(kind):
    # The inscribed circle needs 0.28 m, the footprint 0.5.
    goal = Pose2D(10.2, 6.0, 0.0)
    with pytest.raises(NoPathError, match="to the goal from nowhere but close by") as caught:
        HybridAStarPlanner(max_expansions=FEW, **kind).plan(niche(0.4), Pose2D(2, 2, 1.0), goal)
    assert caught.value.pose == goal.as_tuple()
    assert caught.value.cell == niche(0.4).world_to_cell(goal.x, goal.y)
    path = HybridAStarPlanner(**kind).plan(niche(0.7), Pose2D(2, 2, 1.0), goal)
    assert swept_area_blocked(niche(0.7), path) < 1e-6


def test_so_is_one_where_any_yaw_would_do():
    with pytest.raises(NoPathError, match="nowhere but close by"):
        HybridAStarPlanner(max_expansions=FEW).plan(niche(0.4), Pose2D(2, 2), Goal(10.2, 6.0))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS, ids=str)
def test_a_start_in_such_a_chamber_is_soon_tried_in_full(kind):
    with pytest.raises(NoPathError, match=r"none of \d+ poses|away from the start"):
        HybridAStarPlanner(max_expansions=30_000, **kind).plan(niche(0.4), Pose2D(10.2, 6.0, 0.0), Pose2D(2, 2, 1.0))


ALLEY = costmap_of(room(*LARGE, (9, 0, 16, 5.6), (9, 6.4, 16, 12)))
"""0.8 m wide and 7 m deep, where nothing can turn."""


@pytest.mark.slow
def test_a_robot_that_cannot_back_up_neither_arrives_nose_out_nor_leaves_nose_in():
    planner = HybridAStarPlanner(motion_model="dubins", max_expansions=FEW)
    nose_out, nose_in, outside = Pose2D(15.0, 6.0, np.pi), Pose2D(15.0, 6.0, 0.0), Pose2D(2, 2, 1.0)
    with pytest.raises(NoPathError, match=r"driving forward only.*nowhere but close by"):
        planner.plan(ALLEY, outside, nose_out)
    with pytest.raises(NoPathError, match=r"driving forward only.*cannot get away from the start") as caught:
        HybridAStarPlanner(motion_model="dubins").plan(ALLEY, nose_in, outside)
    assert caught.value.pose == nose_in.as_tuple()
    assert not planner.plan(ALLEY, outside, nose_in).backward.any()
    assert not planner.plan(ALLEY, nose_out, outside).backward.any()


def test_a_dead_end_is_approached_where_a_partial_path_will_do():
    goal = Pose2D(10.2, 6.0, 0.0)
    path = HybridAStarPlanner(allow_partial=True).plan(niche(0.4), Pose2D(2, 2, 1.0), goal)
    assert path.status == "partial"
    # As near as its middle gets to the door.
    assert path.remaining_m == path.goal.distance_to(goal) < 1.5


def test_where_no_path_keeps_the_padding_one_that_keeps_a_quarter_is_given():
    # 0.52 m wide, for a robot of 0.5 m with a padding of 0.02 m: 0.01 m to each side.
    costmap = costmap_of(room(6, 1, (2, 0, 4, 0.24), (2, 0.76, 4, 1.0), resolution=0.02), resolution=0.02)
    start, goal = Pose2D(1, 0.5, 0.0), Pose2D(5, 0.5, 0.0)
    assert costmap.clearance([start.as_tuple(), goal.as_tuple()]).min() > 0.05
    path = HybridAStarPlanner().plan(costmap, start, goal)
    assert 0.004 <= costmap.clearance(path.poses).min() < 0.02
    assert swept_area_blocked(costmap, path) < 1e-6


def test_no_curve_is_longer_than_the_straight_line_by_more_than_the_search_takes_for_granted():
    rng = np.random.default_rng(0)
    scale = rng.choice([0.01, 0.1, 1.0, 3.0, 8.0], (20_000, 1))
    ends = np.column_stack([scale * rng.normal(size=(20_000, 2)), rng.uniform(-np.pi, np.pi, 20_000)])
    straight = np.hypot(ends[:, 0], ends[:, 1])
    for reverse, most in ((True, np.pi), (False, 2.658 * np.pi)):
        lengths = np.abs(_core.shortest_curves(np.zeros_like(ends), ends, 1.0, reverse)[:, :, 0]).sum(axis=1)
        assert 0.8 * most < (lengths - straight).max() <= most
