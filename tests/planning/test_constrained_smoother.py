import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.smoothing import SMALL, assert_contract, polyline, price, stops, tightest_bend, turning
from support.swept import along_legs, costmap_of, room, swept_area_blocked
from trundle.errors import PlanningError
from trundle.geometry import Pose2D, wrap_angle
from trundle.path import Path
from trundle.planning import create_planner
from trundle.planning.constrained_smoother import ConstrainedSmoother

LONG = ((0.49, 0.49), (-0.14, 0.49), (-0.14, -0.49), (0.49, -0.49))


PLANNERS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("hybrid_astar", {"smooth": False, "max_expansions": 2000}),
    ("hybrid_astar", {"smooth": False, "max_expansions": 2000, "in_place": True}),
    ("hybrid_astar", {"smooth": False, "max_expansions": 2000, "motion_model": "dubins"}),
    ("least_cost", {}),
    ("astar", {}),
    ("any_angle", {}),
)


def test_a_corner_becomes_an_arc():
    costmap = costmap_of(room(8, 8))
    corner = polyline((2, 2), (6, 2), (6, 6))
    smoother = ConstrainedSmoother(minimum_turning_radius=0.5)
    done = smoother.explain(corner, costmap)
    assert_contract(costmap, corner, done, smoother.settings)
    assert stops(corner) == (1, 0)
    assert stops(done.path) == (0, 0)
    assert turning(done.path) < 1.2 * math.pi / 2
    assert tightest_bend(done.path) <= 2.0 + 1e-6
    assert done.path.length < corner.length
    assert swept_area_blocked(costmap, done.path) == 0.0


def test_a_straight_path_stays_as_it_is():
    costmap = costmap_of(room(8, 4))
    straight = polyline((1, 2), (7, 2))
    done = ConstrainedSmoother().explain(straight, costmap)
    assert done.kept.all()
    assert np.array_equal(done.path.poses, straight.poses)


def test_a_zigzag_in_the_open_becomes_nearly_straight():
    costmap = costmap_of(room(14, 6))
    zigzag = polyline(*((1 + k, 3 + 0.3 * (k % 2)) for k in range(12)))
    smooth = ConstrainedSmoother().smooth(zigzag, costmap)
    assert turning(zigzag) > 5.0
    assert turning(smooth) < 0.8
    assert stops(smooth) == (0, 0)


@pytest.mark.parametrize("backward", [False, True])
def test_a_path_along_a_wall_is_pushed_off_it(backward):
    costmap = costmap_of(room(12, 6))
    # Into the inflated cells in the middle, from where nothing costs.
    near = polyline((1.2, 3), (3, 0.7), (9, 0.7), (10.8, 3), backward=backward)
    smoother = ConstrainedSmoother()
    done = smoother.explain(near, costmap)
    assert_contract(costmap, near, done, smoother.settings)
    assert done.cost_after < 0.8 * done.cost_before
    assert price(costmap, done.path, 4.0) == pytest.approx(done.cost_after, rel=0.02)
    assert costmap.clearance(done.path.poses).min() > costmap.clearance(near.poses).min() + 0.2
    assert done.path.backward.all() == backward


def test_where_no_curve_fits_the_corner_stays_and_the_rest_is_smoothed():
    # An L of aisles 0.9 m wide, in which a small robot can turn in place and cannot drive an arc of 1.5 m.
    footprint = ((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3))
    costmap = costmap_of(room(8, 8, (0.9, 0.9, 8, 8)), footprint)
    corner = polyline((7, 0.45), (5, 0.4), (3, 0.5), (0.45, 0.45), (0.45, 7))
    smoother = ConstrainedSmoother(minimum_turning_radius=1.5)
    done = smoother.explain(corner, costmap)
    assert_contract(costmap, corner, done, smoother.settings)
    assert stops(corner) == (3, 0)
    assert stops(done.path) == (1, 0)
    assert done.kept.any()
    assert not done.kept.all()
    assert swept_area_blocked(costmap, done.path) == 0.0


def test_changes_of_direction_stay_where_they_have_to():
    costmap = costmap_of(room(6, 2.2))
    planner = create_planner("hybrid_astar", smooth=False)
    parked = planner.plan(costmap, Pose2D(3, 0.5, 0.0), Pose2D(3, 1.6, 0.0))
    smoother = ConstrainedSmoother(w_cost=2.0)
    done = smoother.explain(parked, costmap)
    assert stops(parked)[1] > 0
    assert 0 < stops(done.path)[1] <= stops(parked)[1]
    assert_contract(costmap, parked, done, smoother.settings)
    assert swept_area_blocked(costmap, done.path) == 0.0


def test_needless_changes_of_direction_are_taken_out():
    costmap = costmap_of(room(8, 4))
    there = polyline((2, 2), (5, 2))
    back = there.poses[::-1][: len(there) // 2]
    again = back[::-1]
    poses = np.concatenate([there.poses, back[1:], again[1:]])
    backward = np.repeat([False, True, False], [len(there) - 1, len(back) - 1, len(again) - 1])
    shuttle = Path(poses, backward=backward)
    smooth = ConstrainedSmoother().smooth(shuttle, costmap)
    assert stops(shuttle) == (0, 2)
    assert stops(smooth) == (0, 0)
    assert smooth.length == pytest.approx(3.0)


def test_a_start_that_touches_a_wall_is_left_as_planned():
    costmap = costmap_of(room(8, 6))
    start, goal = Pose2D(0.607 + 0.0005, 2.0, 0.0), Pose2D(6.5, 4.5, 1.0)
    assert costmap.clearance([start.as_tuple()])[0] < 0.001
    for name in ("least_cost", "hybrid_astar"):
        path = create_planner(name).plan(costmap, start, goal)
        smoother = ConstrainedSmoother()
        done = smoother.explain(path, costmap)
        assert_contract(costmap, path, done, smoother.settings)
        assert swept_area_blocked(costmap, done.path) == 0.0


def test_no_curve_begins_or_ends_where_the_padding_has_no_room():
    costmap = costmap_of(room(8, 6))
    there = polyline((0.607 + 0.01, 2), (1.5, 2), (2.5, 2.5), (4, 2.5))
    back = Path(there.poses[::-1].copy(), backward=np.ones(len(there) - 1, dtype=bool))
    for path, end in ((there, 0), (back, -1)):
        assert 0 < costmap.clearance([path.poses[end]])[0] < 0.02
        done = ConstrainedSmoother(padding=0.02).explain(path, costmap)
        assert not done.kept.all()
        assert done.kept[end]
        assert costmap.clearance(done.path.poses[1:-1]).min() > 0.009


def test_new_curves_keep_the_padding():
    costmap = costmap_of(room(10, 6, (4, 0, 4.3, 4.4), (6.5, 1.4, 6.8, 6)))
    path = create_planner("astar").plan(costmap, Pose2D(2, 1.5, 1.0), Pose2D(8.5, 4.5, -2.0))
    done = ConstrainedSmoother(padding=0.08).explain(path, costmap)
    new = along_legs(done.path.poses[:-1][~done.kept], done.path.poses[1:][~done.kept], 0.01)
    assert costmap.clearance(new).min() >= 0.08 * (1 - 0.9) - 1e-9
    assert costmap.clearance(done.path.poses[1:][~done.kept]).min() > 0.05


@pytest.mark.parametrize(("wall", "y"), [((0, 0, 8, 0.3), 0.75), ((0, 1.7, 8, 2), 1.25)], ids=["below", "above"])
def test_on_the_border_of_two_cells_the_higher_cost_counts(wall, y):
    costmap = costmap_of(room(8, 2, wall), SMALL)
    line = polyline((1, y), (7, y))
    low, high = (float(costmap.cost_at(4.01, y + side)) for side in (-0.01, 0.01))
    assert abs(high - low) > 10
    done = ConstrainedSmoother().explain(line, costmap)
    assert done.cost_before == pytest.approx(6 * (1 + 4 * max(low, high) / 252))


def test_corners_of_costly_cells_that_a_curve_cuts_count():
    # Cells of 0.7 m, some with a hundred times the cost of others: a corner of centimetres costs more than metres.
    smoother = ConstrainedSmoother(w_cost=100.0, w_smooth=10.0, padding=0.0)
    changed = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        data = room(35, 35, resolution=0.7)
        data[rng.random(data.shape) < 0.05] = 100
        costmap = costmap_of(data, LONG, resolution=0.7)
        ends = [Pose2D(*rng.uniform((1, 1, -3), (34, 34, 3))) for _ in range(2)]
        try:
            path = create_planner("least_cost").plan(costmap, *ends)
        except PlanningError:
            continue
        done = smoother.explain(path, costmap)
        assert_contract(costmap, path, done, smoother.settings, depth=0.005)
        changed += not done.kept.all()
    assert changed > 15


# Random paths ------------------------------------------------------------------------------------------------------


def random_query(seed: int, density: float, yaw: float):
    rng = np.random.default_rng(seed)
    data = room(5, 5)
    data[rng.random(data.shape) < density] = 100
    costmap = costmap_of(data, SMALL, origin=Pose2D(3.0, -2.0, yaw))
    ends = [costmap.origin @ Pose2D(*rng.uniform((0.5, 0.5, -3), (4.5, 4.5, 3))) for _ in range(2)]
    return costmap, ends


@pytest.mark.slow
@given(
    seed=st.integers(0, 10_000),
    density=st.floats(0.0, 0.02),
    planner=st.sampled_from(PLANNERS),
    yaw=st.floats(-3.0, 3.0),
    radius=st.sampled_from([0.1, 0.4, 0.4, 1.0]),
)
@settings(deadline=None, max_examples=60)
def test_the_sweep_of_any_smoothed_path_is_free_and_its_curves_drivable(seed, density, planner, yaw, radius):
    costmap, ends = random_query(seed, density, yaw)
    try:
        path = create_planner(planner[0], **planner[1]).plan(costmap, *ends)
    except PlanningError:
        return
    smoother = ConstrainedSmoother(minimum_turning_radius=radius)
    done = smoother.explain(path, costmap)
    assert_contract(costmap, path, done, smoother.settings)
    # A planner looks every 2.5 cm, and a corner may poke into the footprint by less between: then what is kept has it.
    assert swept_area_blocked(costmap, done.path) <= swept_area_blocked(costmap, path) + 1e-12  # rounding


# In parts, so that some of it runs every day; 2,000 paths in all.
@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 700, 50))
def test_the_contract_holds_on_thousands_of_paths(first):
    smoother = ConstrainedSmoother()
    checked = changed = 0
    for seed in range(first, first + 50):
        costmap, ends = random_query(seed, (seed % 8) * 0.0025, wrap_angle(0.1 * seed))
        for name, options in PLANNERS:
            try:
                path = create_planner(name, **options).plan(costmap, *ends)
            except PlanningError:
                continue
            done = smoother.explain(path, costmap)
            assert_contract(costmap, path, done, smoother.settings)
            checked += 1
            changed += not done.kept.all()
    assert checked > 110
    assert changed > 0.7 * checked  # the others are straight


@given(st.lists(st.tuples(st.floats(0.5, 7.5), st.floats(0.5, 7.5)), min_size=2, max_size=12), st.floats(-3, 3))
@settings(deadline=None, max_examples=100)
def test_any_polyline_in_the_open_keeps_the_contract(corners, yaw):
    costmap = costmap_of(room(8, 8), SMALL)
    path = polyline(*corners, start_yaw=yaw, goal_yaw=-yaw)
    smoother = ConstrainedSmoother()
    assert_contract(costmap, path, smoother.explain(path, costmap), smoother.settings)
