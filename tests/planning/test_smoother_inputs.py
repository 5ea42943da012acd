"""Smoothers and their inputs: unusual paths, errors, and memory that is kept between calls."""

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from support.smoothing import SMALL, assert_contract, point_curvatures, polyline, stops, tightest_bend, turning, wrapped
from support.swept import CARTER, costmap_of, room
from trundle import _core
from trundle.errors import BlockedPoseError, InputError, OutsideMapError, UnknownNameError
from trundle.geometry import Pose2D
from trundle.path import Path
from trundle.planning import Smoother, create_planner, create_smoother, smoother_names
from trundle.planning.constrained_smoother import ConstrainedSmoother, SmoothingSettings


def test_yaws_that_do_not_lead_along_the_path_become_turns_in_place():
    costmap = costmap_of(room(8, 8))
    corner = polyline((2, 2), (6, 2), (6, 6))
    poses = corner.poses.copy()
    poses[:, 2] = -2.0  # as a message has them that says nothing of yaws
    done = ConstrainedSmoother().explain(Path(poses), costmap)
    assert (done.path.poses[[0, -1]] == poses[[0, -1]]).all()
    assert stops(done.path)[0] <= 2
    assert tightest_bend(done.path) <= 2.5 + 1e-6
    assert done.path.length < corner.length


@pytest.mark.parametrize(
    "poses",
    [[(2, 2, 0.5)], [(2, 2, 0.5), (2, 2, 0.5)], [(2, 2, 0.5), (2, 2, 2.0), (2, 2, -2.0)]],
    ids=["one pose", "one pose twice", "turns alone"],
)
def test_a_path_that_stays_at_one_place_stays_as_it_is(poses):
    path = Path(np.array(poses, dtype=float), cost=3.0)
    smooth = ConstrainedSmoother().smooth(path, costmap_of(room(4, 4)))
    assert np.array_equal(smooth.poses, path.poses)
    assert smooth.cost == 3.0


def test_it_is_the_same_in_every_frame_and_whenever_it_is_asked():
    data = room(10, 6, (4, 0, 4.3, 4.4), (6.5, 1.4, 6.8, 6))
    costmap, turned = costmap_of(data), costmap_of(data, origin=Pose2D(-3.0, 7.0, 0.7))
    path = create_planner("astar").plan(costmap, Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0))
    move = turned.origin @ costmap.origin.inverse()
    moved = Path(np.column_stack([move.transform_points(path.poses[:, :2]), wrapped(path.poses[:, 2] + move.yaw)]))
    smoother = ConstrainedSmoother()
    once, again = smoother.explain(path, costmap), smoother.explain(path, costmap)
    assert np.array_equal(once.path.poses, again.path.poses)
    there = smoother.explain(moved, turned)
    assert there.cost_after == pytest.approx(once.cost_after, rel=1e-3)
    assert_contract(turned, moved, there, smoother.settings)


def test_one_smoother_on_maps_and_robots_in_turn_answers_as_new_ones_do():
    smoother = ConstrainedSmoother()
    costmaps = costmap_of(room(10, 6, (4, 0, 4.3, 4.4)), CARTER), costmap_of(room(10, 12, (4, 2, 4.3, 9)), SMALL)
    goals = Pose2D(8.5, 4.5, -2.0), Pose2D(8.0, 1.5, 0.0)
    planner, start = create_planner("astar"), Pose2D(2, 1.5, 1.0)
    asked = [(planner.plan(costmap, start, goal), costmap) for costmap in costmaps for goal in goals]
    expected = [ConstrainedSmoother().smooth(*each).poses for each in asked]
    assert not any(np.array_equal(poses, path.poses) for poses, (path, _) in zip(expected, asked, strict=True))
    order = [0, 2, 1, 3] * 10
    with ThreadPoolExecutor(2) as threads:
        smoothed = list(threads.map(lambda k: smoother.smooth(*asked[k]).poses, order))
    assert all(np.array_equal(poses, expected[k]) for poses, k in zip(smoothed, order, strict=True))


def test_what_the_path_says_beside_its_poses_is_kept():
    costmap = costmap_of(room(8, 8))
    corner = polyline((2, 2), (6, 2), (6, 6))
    named = Path(corner.poses, cost=10.0, planner="mine", replans=2, goal_snapped_m=0.1)
    done = ConstrainedSmoother().explain(named, costmap)
    smooth = done.path
    assert (smooth.planner, smooth.replans, smooth.goal_snapped_m) == ("mine", 2, 0.1)
    assert smooth.cost == pytest.approx(10.0 * done.price_after / done.price_before)
    assert smooth.cost < 10.0


def test_hybrid_a_star_smooths_what_it_had_to_search_for():
    costmap = costmap_of(room(10, 6, (4, 0, 4.3, 4.4), (6.5, 1.4, 6.8, 6)))
    start, goal = Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0)
    rough = create_planner("hybrid_astar", smooth=False).plan(costmap, start, goal)
    smooth = create_planner("hybrid_astar").plan(costmap, start, goal)
    assert turning(smooth) < 0.8 * turning(rough)
    assert smooth.cost < rough.cost
    near = Pose2D(2.5, 3.0, 1.2)
    direct = [create_planner("hybrid_astar", smooth=each).plan(costmap, start, near).poses for each in (True, False)]
    assert np.array_equal(*direct)


def test_dubins_paths_stay_forward():
    costmap = costmap_of(room(10, 6, (4, 0, 4.3, 4.4), (6.5, 1.4, 6.8, 6)))
    path = create_planner("hybrid_astar", motion_model="dubins").plan(
        costmap, Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0)
    )
    assert not path.backward.any()


# Bad input ---------------------------------------------------------------------------------------------------------


def test_a_path_through_a_wall_is_refused_with_the_pose():
    costmap = costmap_of(room(8, 4, (4, 0, 4.3, 4)))
    with pytest.raises(BlockedPoseError, match=r"the path's pose \d+ collides") as caught:
        ConstrainedSmoother().smooth(polyline((1, 2), (7, 2)), costmap)
    assert caught.value.pose is not None
    assert 3.0 < caught.value.pose[0] < 4.0
    assert caught.value.cell == tuple(int(i) for i in costmap.world_to_cell(*caught.value.pose[:2]))


def test_a_path_that_leaves_the_map_is_refused_with_the_pose():
    with pytest.raises(OutsideMapError, match="pose 31 ") as caught:
        ConstrainedSmoother().smooth(polyline((1, 2), (9, 2)), costmap_of(room(4, 4)))
    assert caught.value.pose == (pytest.approx(4.1), 2.0, 0.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"minimum_turning_radius": 0.0}, "minimum_turning_radius must be a number from 0.01"),
        ({"minimum_turning_radius": math.nan}, "minimum_turning_radius"),
        ({"reverse_penalty": 0.5}, "reverse_penalty must be a number from 1 to"),
        ({"w_cost": -1.0}, "w_cost"),
        ({"w_smooth": "much"}, "w_smooth"),
        ({"cost_tolerance": math.inf}, "cost_tolerance"),
        ({"padding": True}, "padding"),
        ({"spacing": 0.0}, "spacing"),
        ({"w_dist": 1.0}, "smoother 'constrained'.*w_dist"),
    ],
)
def test_options_out_of_range_are_refused(options, message):
    with pytest.raises(InputError, match=message):
        create_smoother("constrained", **options)


def test_smoothers_are_known_by_name():
    assert smoother_names() == ["constrained"]
    smoother = create_smoother("constrained", w_cost=1.0)
    assert isinstance(smoother, Smoother)
    assert create_smoother(smoother) is smoother
    with pytest.raises(UnknownNameError, match=r"unknown smoother 'constraint'\. Did you mean 'constrained'"):
        create_smoother("constraint")


def test_the_kernel_refuses_what_it_cannot_use():
    costs = np.zeros((20, 30), np.uint8)
    numbers = {
        "radius": 0.4, "reverse_penalty": 2.0, "change_cost": 0.3, "turn_cost": 0.5, "cost_weight": 4.0,
        "curve_weight": 0.1, "cost_tolerance": 0.02, "step": 0.03, "spacing": 0.05,
    }  # fmt: skip
    line = np.array([[0.2, 0.5, 0.0], [0.7, 0.5, 0.0]])
    forward = np.zeros(1, np.uint8)

    def ask(*, resolution=0.05, outline=CARTER * 0.1, poses=line, backward=forward, **other: Any):
        return _core.PathSmoother().smooth(
            costs, resolution, np.ascontiguousarray(outline), poses, backward, **{**numbers, **other}
        )

    assert len(ask()[0]) == 2
    # Outside the grid nothing new is laid, and nothing is read.
    assert ask(poses=line + 100.0)[3].all()
    refused: list[dict[str, Any]] = [
        {"outline": CARTER[:2]},
        {"poses": line[:, :2].copy()},
        {"poses": line[:0]},
        {"backward": np.zeros(2, np.uint8)},
        {"poses": line * math.nan},
        {"resolution": 0.0},
        *({name: math.nan} for name in numbers),
        *({name: -1.0} for name in numbers),
    ]
    for wrong in refused:
        with pytest.raises(ValueError, match=r"outline|poses|positive|range"):
            ask(**wrong)


def test_three_points_tell_the_curvature():
    angles = np.linspace(0, 1, 20)
    assert point_curvatures(2.0 * np.column_stack([np.cos(angles), np.sin(angles)])) == pytest.approx(0.5)
    assert SmoothingSettings().minimum_turning_radius == 0.4
