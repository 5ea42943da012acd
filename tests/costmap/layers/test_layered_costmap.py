"""The costmap of the static map and of what is sensed: extents, corrections, static obstacles, and bad arguments."""

import math

import numpy as np
import pytest

from support.walls import CARTER, Surroundings, estimate
from trundle.costmap import (
    LETHAL,
    Costmap,
    CostmapSettings,
    LayeredCostmap,
    LayersSettings,
    ObstacleLayerSettings,
)
from trundle.errors import InputError, MapError
from trundle.geometry import Pose2D
from trundle.maps import KeepoutMask, OccupancyGrid

BOX = [(2.0, -0.5, 2.0, 0.5)]
"""The face of a box in front of the robot."""
HERE = Pose2D(0.0, 0.0)


def make_map(side=12.0, *, yaw=0.0, edge=0.05, value=0):
    count = round(side / edge)
    corner = Pose2D(0, 0, yaw) @ Pose2D(-side / 2, -side / 2)
    return OccupancyGrid(np.full((count, count), value, np.int8), edge, Pose2D(corner.x, corner.y, yaw))


def see(layered, around, pose=HERE, *, ticks=4, start=0.0, T_map_odom=None, lidars=("front",)):
    """Let a robot that stands see something for some ticks; return the last costmap."""
    true = pose
    for tick in range(ticks):
        time = start + 0.05 * tick
        scans = [around.scan(time, true, lidar) for lidar in lidars]
        layered.update(scans, estimate(time, pose, T_map_odom))
    return layered.costmap


def distances(points, segment=BOX[0]):
    x0, y0, _, y1 = segment
    return np.hypot(points[:, 0] - x0, np.maximum(0, np.maximum(y0 - points[:, 1], points[:, 1] - y1)))


@pytest.mark.parametrize("yaw", [0.0, 0.3, -math.pi / 2])
def test_a_box_that_is_not_on_the_map_becomes_lethal_where_it_is(yaw):
    layered = LayeredCostmap(make_map(yaw=yaw), CARTER)
    costmap = see(layered, Surroundings(BOX))
    rows, cols = np.nonzero(costmap.data == LETHAL)
    x, y = costmap.cell_to_world(rows, cols)
    assert len(x) >= 20
    assert distances(np.column_stack([x, y])).max() < 0.05
    assert (costmap.data[layered.sensed] == LETHAL).all()
    assert distances(layered.obstacles()).max() < 1e-3
    along = costmap.cost_at(np.full(19, 2.0), np.linspace(-0.45, 0.45, 19))
    assert (along >= 253).all(), "the box has a gap"


def test_the_costmap_equals_one_of_the_changed_map():
    layered = LayeredCostmap(make_map(yaw=0.2), CARTER)
    costmap = see(layered, Surroundings(BOX, noise=0.01), ticks=30)
    cells = np.where(layered.sensed, 100, 0).astype(np.int8)
    again = Costmap.from_grid(OccupancyGrid(cells, 0.05, costmap.origin), CARTER)
    assert np.array_equal(costmap.data, again.data)


def test_the_same_costmap_is_returned_if_nothing_changed():
    layered = LayeredCostmap(make_map(), CARTER)
    first = see(layered, Surroundings(BOX))
    assert layered.update([], estimate(1.0, HERE)) is first
    assert layered.changed is None
    assert see(layered, Surroundings(BOX), start=2.0) is first


def test_changed_holds_every_cell_that_became_occupied():
    layered = LayeredCostmap(make_map(yaw=0.4), CARTER)
    before = layered.costmap
    around = Surroundings(BOX)
    for tick in range(4):
        time = 0.05 * tick
        after = layered.update([around.scan(time, HERE)], estimate(time, HERE))
        if layered.changed is not None:
            outside = np.ones(after.shape, bool)
            outside[layered.changed] = False
            assert np.array_equal((after.data == LETHAL)[outside], (before.data == LETHAL)[outside])
            assert after.changes_since(before.version) is not None
        before = after
    assert layered.sensed.any()


def test_a_costmap_that_was_returned_does_not_change():
    layered = LayeredCostmap(make_map(), CARTER)
    first = layered.costmap
    data = first.data.copy()
    see(layered, Surroundings(BOX))
    assert layered.costmap is not first
    assert np.array_equal(first.data, data)


def wall_map(x=2.0):
    cells = np.array(make_map().data)
    cells[:, round((x + 6.0) / 0.05)] = 100
    return OccupancyGrid(cells, 0.05, Pose2D(-6, -6))


@pytest.mark.parametrize(("tolerance", "marked"), [(None, False), (0.0, True), (0.15, False)])
def test_marks_beside_a_static_wall_are_left_out_within_the_tolerance(tolerance, marked):
    settings = LayersSettings(obstacle=ObstacleLayerSettings(static_tolerance=tolerance))
    layered = LayeredCostmap(wall_map(), CARTER, layers=settings)
    see(layered, Surroundings([(1.97, -3.0, 1.97, 3.0)]))  # the robot is 3 cm off
    assert layered.sensed.any() == marked
    assert (len(layered.obstacles()) > 0) == marked


def test_an_obstacle_in_front_of_a_static_wall_is_marked():
    layered = LayeredCostmap(wall_map(), CARTER)
    see(layered, Surroundings([(1.8, -0.5, 1.8, 0.5)]))
    assert layered.sensed.any()


@pytest.mark.parametrize("clear", [False, True])
def test_static_obstacles_are_cleared_only_if_asked_for(clear):
    settings = LayersSettings(obstacle=ObstacleLayerSettings(clear_static=clear))
    layered = LayeredCostmap(wall_map(), CARTER, layers=settings)
    costmap = see(layered, Surroundings([(4.0, -6.0, 4.0, 6.0)]), ticks=8)
    assert (costmap.cost_at(2.025, 0.0) == LETHAL) != clear
    assert (costmap.cost_at(2.025, -5.9) == LETHAL) or clear


def test_unknown_cells_of_the_map_become_free_where_they_are_seen():
    layered = LayeredCostmap(make_map(value=-1), CARTER, costmap=CostmapSettings(unknown="costly"))
    costmap = see(layered, Surroundings(BOX))
    row, col = costmap.world_to_cell([1.0, 2.5], [0.0, 0.0])
    assert costmap.unknown_cells[row, col].tolist() == [False, True]


@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_what_was_sensed_stays_in_the_map_while_the_estimate_is_corrected(yaw):
    layered = LayeredCostmap(make_map(yaw=yaw), CARTER)
    see(layered, Surroundings(BOX))
    before, costmap = layered.obstacles(), layered.costmap
    for tick in range(1, 11):  # odometry drifts by 0.2 m and 20 degrees, and the localizer puts that right
        drift = Pose2D(0.02 * tick, -0.01 * tick, math.radians(2.0 * tick))
        assert layered.update([], estimate(1.0 + 0.05 * tick, HERE, drift)) is costmap
    assert np.array_equal(layered.obstacles(), before)
    assert layered.warnings == {}


def test_drift_of_odometry_that_is_corrected_does_not_smear_a_wall():
    layered = LayeredCostmap(make_map(), CARTER)
    around = Surroundings([(2.0, -3.0, 2.0, 3.0)], noise=0.01)
    for tick in range(100):
        true, time = Pose2D(-0.01 * tick, 0.0), 0.05 * tick
        odom = Pose2D(-0.0105 * tick, 0.003 * tick, 0.005 * tick)
        layered.update([around.scan(time, true)], estimate(time, true, true @ odom.inverse()))
    found = layered.obstacles()
    assert len(found) > 100
    assert np.abs(found[:, 0] - 2.0).max() < 0.04


@pytest.mark.parametrize("drift", [Pose2D(0.0, 0.0), Pose2D(40.0, -7.0, 2.0)])
def test_a_constant_correction_changes_nothing_but_the_rounding(drift):
    layered = LayeredCostmap(make_map(), CARTER)
    costmap = see(layered, Surroundings(BOX), Pose2D(0.1, 0.2, 0.3), T_map_odom=drift)
    expected = see(LayeredCostmap(make_map(), CARTER), Surroundings(BOX), Pose2D(0.1, 0.2, 0.3))
    assert np.array_equal(costmap.data, expected.data)


def test_an_estimate_that_trembles_does_not_make_cells_flicker():
    layered = LayeredCostmap(make_map(), CARTER)
    around, rng = Surroundings([(2.025, -0.525, 2.025, 0.525)], noise=0.01), np.random.default_rng(3)
    odom, changes = Pose2D(1.0, 2.0, 0.5), 0
    for tick in range(200):
        x, y, yaw = (rng.normal(size=3) * (0.004, 0.004, 0.002)).tolist()
        before = layered.costmap
        believed = Pose2D(x, y, yaw)
        scan = around.scan(0.05 * tick, HERE)
        layered.update([scan], estimate(0.05 * tick, believed, believed @ odom.inverse()))
        changes += layered.costmap is not before and tick > 20
    assert layered.sensed.sum() >= 20
    assert changes <= 10  # with marks in odom: 134


def test_a_late_scan_is_placed_by_the_correction_of_now():
    """The odometry knows where the robot was, and the newest estimate is the best that is known of the odometry."""
    layered, around = LayeredCostmap(make_map(), CARTER), Surroundings(BOX)
    drift = Pose2D(0.2, 0.1, 0.05)  # the scan shows it to the localizer
    for tick in range(6):
        time, true = 0.05 * tick, Pose2D(0.04 * tick, 0.0)
        odom = drift.inverse() @ true
        scans = [around.scan(time - 0.1, Pose2D(0.04 * (tick - 2), 0.0))] if tick >= 2 else []
        correction = drift if tick >= 2 else HERE
        layered.update(scans, estimate(time, correction @ odom, correction))
    assert len(layered.obstacles()) > 15
    assert distances(layered.obstacles()).max() < 1e-2


@pytest.mark.parametrize("jump", [Pose2D(0.3, -0.2), Pose2D(0.0, 0.0, 0.2), Pose2D(-0.9, 0.3, 2.0)])
def test_an_estimate_that_jumps_forgets_what_was_sensed_around_the_robot(jump):
    layered = LayeredCostmap(make_map(), CARTER)
    around = Surroundings(BOX)
    see(layered, around)
    assert layered.sensed.any()
    layered.update([], estimate(1.0, jump, jump))
    assert not layered.sensed.any()
    assert np.array_equal(layered.costmap.data, np.zeros((240, 240)))
    for tick in range(3):
        layered.update([around.scan(1.1 + 0.05 * tick, jump)], estimate(1.1 + 0.05 * tick, jump, jump))
    assert len(layered.obstacles()) > 15
    assert distances(layered.obstacles()).max() < 1e-2
    assert layered.warnings == {}


def test_a_slip_that_is_put_right_at_once_forgets_nothing():
    layered = LayeredCostmap(make_map(), CARTER)
    see(layered, Surroundings(BOX))
    before = layered.obstacles()
    slipped = Pose2D(0.6, 0.1, 0.4)  # of the odometry, within one period; the robot has moved by 2 cm
    here = Pose2D(0.02, 0.0)
    layered.update([], estimate(0.2, here, here @ slipped.inverse()))
    assert np.array_equal(layered.obstacles(), before)


def test_an_estimate_that_jumps_keeps_what_was_sensed_far_away():
    layered = LayeredCostmap(make_map(60.0), CARTER)
    see(layered, Surroundings(BOX))
    for tick in range(50):
        layered.update([], estimate(1.0 + 0.5 * tick, Pose2D(0.0, 0.4 * tick)))
    jump = Pose2D(0.5, 0.0)
    layered.update([], estimate(30.0, jump @ Pose2D(0.0, 19.6), jump))
    assert distances(layered.obstacles()).max() < 1e-3
    assert len(layered.obstacles()) > 15


@pytest.mark.parametrize("static", [None, make_map(30.0, yaw=0.3)])
def test_a_rolling_window_moves_with_the_robot_by_whole_cells(static):
    layered = LayeredCostmap(static, CARTER, layers=LayersSettings(rolling_window=True, width=6.0, height=4.0))
    with pytest.raises(InputError, match="before the first update"):
        _ = layered.costmap
    around = Surroundings([(8.0, -1.0, 8.0, 1.0)])
    yaw = 0.0 if static is None else static.origin.yaw
    start = Pose2D(0, 0) if static is None else static.origin
    for tick in range(100):
        pose, time = Pose2D(0.07 * tick, 0.0), 0.05 * tick
        costmap = layered.update([around.scan(time, pose)], estimate(time, pose))
        assert costmap.shape == (80, 120)
        corner = start.inverse().transform_points([(costmap.origin.x, costmap.origin.y)])[0] / 0.05
        assert np.allclose(corner, np.round(corner), atol=1e-6)
        middle = costmap.origin.inverse().transform_points([(pose.x, pose.y)])[0]
        assert np.abs(middle - (3.0, 2.0)).max() < 0.4
    assert costmap.origin.yaw == pytest.approx(yaw)
    assert (costmap.cost_at(8.0, 0.0) >= 253).all()
    assert len(layered.obstacles()) > 20


def test_without_a_map_unknown_space_costs_more_than_what_was_seen():
    layered = LayeredCostmap(None, CARTER)
    costmap = see(layered, Surroundings(BOX))
    assert costmap.unknown == "costly"
    assert costmap.cost_at([1.0, 2.0, 4.5], [0.0, 0.0, 0.0]).tolist()[2] >= costmap.unknown_cost
    assert costmap.cost_at(2.0, 0.0) == LETHAL
    assert costmap.cost_at(-3.0, 3.0) == 0
    assert (
        LayeredCostmap(None, CARTER, costmap=CostmapSettings(unknown="blocked")).update([], estimate(0, HERE)).unknown
        == "blocked"
    )


def test_without_a_map_the_extent_contains_the_goal_and_grows_with_the_robot():
    layered = LayeredCostmap(None, CARTER)
    assert layered.require([(20.0, 3.0)]) is None
    costmap = layered.update([], estimate(0.0, HERE))
    assert costmap.contains(*costmap.world_to_cell([-5.9, 21.0], [0.0, 4.0])).all()
    assert layered.require((20.0, 3.0)) is costmap
    grown = layered.require([(-20.0, 0.0)])
    assert grown is not costmap
    see(layered, Surroundings(BOX), start=1.0)
    for tick in range(40):
        costmap = layered.update([], estimate(2.0 + tick, Pose2D(0.0, 0.5 * tick)))
    assert costmap.contains(*costmap.world_to_cell([0.0, 0.0, -20.0], [25.4, 0.0, 0.0])).all()
    assert costmap.cost_at(2.0, 0.0) == LETHAL


def test_a_goal_that_is_too_far_away_without_a_map_is_refused():
    layered = LayeredCostmap(None, CARTER)
    with pytest.raises(MapError, match="nearer goal"):
        layered.require([(1e5, 1e5), (0.0, 0.0)])
    layered.update([], estimate(0.0, HERE))
    with pytest.raises(MapError, match="nearer goal"):
        layered.require([(1e5, 1e5)])
    with pytest.raises(InputError, match="finite"):
        layered.require([(math.nan, 0.0)])


def test_a_keepout_mask_holds_where_cells_are_marked_and_cleared():
    zone = np.zeros((240, 240), np.int8)
    zone[100:140, 170:180] = 100
    mask = KeepoutMask(OccupancyGrid(zone, 0.05, Pose2D(-6, -6)))
    for static in (make_map(), None):
        layered = LayeredCostmap(static, CARTER, keepout=mask)
        costmap = see(layered, Surroundings([(4.0, -3.0, 4.0, 3.0)]), ticks=8)
        assert costmap.cost_at(2.7, 0.0) == LETHAL
        assert not layered.sensed[costmap.world_to_cell(2.7, 0.0)].any()


def test_a_costmap_may_be_the_static_map():
    static = Costmap.from_grid(wall_map(), CARTER, 0.7)
    layered = LayeredCostmap(static, CARTER)
    assert layered.costmap is static
    costmap = see(layered, Surroundings([(1.0, -0.5, 1.0, 0.5)]))
    assert costmap.inflation_radius == 0.7
    assert costmap.cost_at(1.0, 0.0) == LETHAL
    assert costmap.cost_at(2.025, 4.0) == LETHAL
    with pytest.raises(InputError, match="has its settings"):
        LayeredCostmap(static, CARTER, costmap=CostmapSettings())


def test_reset_forgets_what_was_sensed():
    for static in (make_map(), None):
        layered = LayeredCostmap(static, CARTER)
        first = see(layered, Surroundings(BOX))
        layered.reset()
        assert len(layered.obstacles()) == 0
        again = see(layered, Surroundings(BOX))
        assert np.array_equal(first.data, again.data)


def test_layers_may_be_left_out():
    layered = LayeredCostmap(make_map(), CARTER, layers=LayersSettings(obstacle=None))
    first = layered.costmap
    assert see(layered, Surroundings(BOX)) is first


@pytest.mark.parametrize("arguments", [(make_map(), "nova_carter"), ("map.yaml", CARTER)])
def test_arguments_of_another_kind_are_refused(arguments):
    with pytest.raises(InputError, match="must be of type"):
        LayeredCostmap(*arguments)


def test_times_must_increase():
    for layers in (LayersSettings(), LayersSettings(obstacle=None)):
        layered = LayeredCostmap(make_map(), CARTER, layers=layers)
        layered.update([], estimate(1.0, HERE))
        for time in (1.0, 0.5):
            with pytest.raises(InputError, match="times must increase"):
                layered.update([], estimate(time, HERE))
        layered.update([], estimate(1.1, HERE))
        layered.reset()
        layered.update([], estimate(0.0, HERE))
