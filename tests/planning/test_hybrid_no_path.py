"""Hybrid A* without a path: closed walls, narrow gaps, blocked ends, limits and invalid options."""

import math
from typing import Any

import numpy as np
import pytest

from support.hybrid_queries import KINDS, WALLS
from support.swept import CARTER, costmap_of, room, swept_area_blocked
from trundle import _core
from trundle.errors import (
    BlockedPoseError,
    InputError,
    NoPathError,
    OutsideMapError,
    PlanningStoppedError,
)
from trundle.geometry import Pose2D
from trundle.planning import Cancellation, create_planner
from trundle.planning.hybrid_astar import HybridAStarPlanner


def test_a_goal_behind_a_closed_wall_is_unreachable_at_once():
    costmap = costmap_of(room(10, 6, (4, 0, 4.3, 6)))
    with pytest.raises(NoPathError, match="separated") as caught:
        HybridAStarPlanner().plan(costmap, Pose2D(2, 3), Pose2D(8, 3))
    assert caught.value.pose == (8.0, 3.0, 0.0)


def test_a_wall_thinner_than_the_cells_that_guide_the_search_is_still_a_wall():
    small = ((0.06, 0.06), (-0.06, 0.06), (-0.06, -0.06), (0.06, -0.06))
    for left in (2.0, 2.05, 2.1, 2.15):
        costmap = costmap_of(room(5, 4, (left, 0, left + 0.05, 4)), small)
        with pytest.raises(NoPathError, match="separated"):
            HybridAStarPlanner(minimum_turning_radius=0.2).plan(costmap, Pose2D(1, 2), Pose2D(3.5, 2))


@pytest.mark.parametrize("options", KINDS, ids=str)
@pytest.mark.parametrize("along_x", [True, False])
@pytest.mark.parametrize("cells", range(4))
def test_the_guide_leads_round_the_end_of_a_thin_wall_wherever_its_cells_begin(cells, along_x, options):
    # Cells of the guide are four of the map wide; a wall with its inflation may fill none of them.
    y = 4.0 + 0.05 * cells
    block, start, goal = (0, y, 10, y + 0.05), Pose2D(1.5, 1.5, 0.0), Pose2D(2, 6, 1.57)
    data = room(12, 8, block)
    if not along_x:
        data, start, goal = data.T, Pose2D(start.y, start.x, np.pi / 2), Pose2D(goal.y, goal.x, 0.0)
    costmap = costmap_of(data)
    path = HybridAStarPlanner(max_expansions=2_000, **options).plan(costmap, start, goal)
    assert swept_area_blocked(costmap, path) < 1e-6


def test_a_gap_that_only_the_inscribed_circle_fits_is_closed():
    # 0.4 m wide: the circle needs 0.28, the footprint 0.5.
    costmap = costmap_of(room(4, 2, (2.0, 0, 2.3, 0.8), (2.0, 1.2, 2.3, 2)))
    with pytest.raises(NoPathError, match="footprint") as caught:
        HybridAStarPlanner().plan(costmap, Pose2D(1, 1), Pose2D(3.2, 1))
    assert caught.value.cell == costmap.world_to_cell(3.2, 1)


def test_ends_that_cannot_be_are_named():
    costmap = costmap_of(WALLS)
    planner = HybridAStarPlanner()
    with pytest.raises(OutsideMapError, match="goal"):
        planner.plan(costmap, Pose2D(2, 2), Pose2D(50, 2))
    with pytest.raises(BlockedPoseError, match="start") as caught:
        planner.plan(costmap, Pose2D(4.1, 2), Pose2D(2, 2))
    assert caught.value.pose == (4.1, 2.0, 0.0)
    snapped = planner.plan(costmap, Pose2D(2, 2), Pose2D(8.0, 0.2))
    assert 0.0 < snapped.goal_snapped_m <= 0.25


def test_a_footprint_larger_than_the_map_fits_nowhere():
    costmap = costmap_of(room(4, 4), footprint=((9, 9), (-9, 9), (-9, -9), (9, -9)))
    with pytest.raises(BlockedPoseError, match="nowhere"):
        HybridAStarPlanner().plan(costmap, Pose2D(2, 2), Pose2D(3, 3))


HARD = Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0)


@pytest.mark.parametrize(
    ("options", "why"),
    [({"deadline_s": 1e-9}, "deadline of 1e-09 s"), ({"max_expansions": 3}, "none found within 3 expansions")],
)
def test_it_gives_up_at_its_limits(options, why):
    with pytest.raises(PlanningStoppedError, match=why):
        HybridAStarPlanner(**options).plan(costmap_of(WALLS), *HARD)


def test_a_cancelled_plan_stops():
    cancel = Cancellation()
    assert len(HybridAStarPlanner().plan(costmap_of(WALLS), *HARD, cancel=cancel)) > 2
    cancel.cancel()
    with pytest.raises(PlanningStoppedError, match="cancelled"):
        HybridAStarPlanner().plan(costmap_of(WALLS), *HARD, cancel=cancel)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"motion_model": "ackermann"}, "dubins, reeds_shepp"),
        ({"minimum_turning_radius": 0.0}, "in_place"),
        ({"minimum_turning_radius": math.nan}, "minimum_turning_radius"),
        ({"minimum_turning_radius": 0.001, "in_place": True}, "0.01 or more"),
        ({"in_place": "yes"}, "in_place"),
        ({"reverse_penalty": 0.5}, "reverse_penalty"),
        ({"heuristic_weight": 0.9}, "heuristic_weight"),
        ({"padding": -0.1}, "padding"),
        ({"cost_weight": "2"}, "cost_weight"),
        ({"spacing": 0.0}, "spacing"),
        ({"cell_size": math.inf}, "cell_size"),
        ({"max_expansions": 0}, "max_expansions"),
        ({"deadline_s": 0.0}, "deadline_s"),
        ({"radius": 1.0}, "radius"),
    ],
)
def test_options_out_of_range_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        create_planner("hybrid_astar", **options)


def test_the_kernel_refuses_what_it_cannot_use():
    search = _core.HybridAStar(
        radius=0.4, reverse=True, in_place=False, reverse_penalty=2.0, change_cost=0.3, turn_cost=0.5,
        cost_weight=2.0, heuristic_weight=1.2, cell_size=0.1,
    )  # fmt: skip
    costs = np.zeros((20, 30), np.uint8)
    outline = np.ascontiguousarray(CARTER) * 0.1
    inside = np.array([0.5, 0.5, 0.0])

    def ask(**other: Any):
        usual: dict[str, Any] = {"resolution": 0.05, "outline": outline, "start": inside, "goal": inside, "step": 0.03}
        limits: dict[str, Any] = {"max_expansions": 100, "seconds": None, "cancel": None}
        return search.plan(costs, any_yaw=False, spacing=0.05, **limits, **{**usual, **other})

    assert ask()[0] == 0
    refused: list[dict[str, Any]] = [
        {"outline": outline[:2].copy()},
        {"start": np.array([0.5, 0.5])},
        {"goal": np.array([1.5, 0.5, 0.0])},
        {"goal": np.array([math.nan, 0.5, 0.0])},
        {"start": np.array([0.5, -0.01, 0.0])},
        {"start": np.array([0.5, 0.5, math.inf])},
        {"resolution": 0.0},
        {"step": math.nan},
    ]
    for wrong in refused:
        with pytest.raises(ValueError, match=r"outline|pose|grid|positive"):
            ask(**wrong)
