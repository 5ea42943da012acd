"""Things on the map that no scan has hit, where they close the only path."""

import math
from dataclasses import replace

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, grid_of, room
from trundle.costmap import LETHAL, Costmap, CostmapSettings, LayersSettings, ObstacleLayerSettings
from trundle.costmap.doubted_map import without_passed, without_unseen
from trundle.errors import PlanningError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.mission import Session
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.sensing import SensedMap, make_placer
from trundle.navigation.state import FINAL
from trundle.observation import Estimate
from trundle.sim import simulate

WALLS = (block("lower", 5.0, -0.1, 5.4, 2.3), block("upper", 5.0, 3.7, 5.4, 6.1))
THING = block("thing", 4.9, 2.45, 5.5, 3.55)
PATIENT = NavigatorSettings(planning_deadline_s=None)


def doubting(doubts=True):
    return LayersSettings(obstacle=ObstacleLayerSettings(doubt_static=doubts))


def drive(navigator, world, *, goal=GOAL, start=START, seconds=60.0):
    navigator.set_goal(goal)
    touched = False
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(start)
        while navigator.status not in FINAL and state.time < seconds:
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            state = sim.step(command, navigator.dt)
            touched |= bool(state.contacts)
    assert not touched
    return state.pose


@pytest.mark.parametrize("doubts", [False, True])
def test_a_thing_that_is_on_the_map_alone_closes_the_only_path_unless_it_is_doubted(doubts):
    navigator = Navigator(grid_of(room(*WALLS, THING)), ROBOT, layers=doubting(doubts), settings=PATIENT)
    drive(navigator, room(*WALLS))
    assert navigator.status is (NavigationStatus.ARRIVED if doubts else NavigationStatus.NO_PATH)


def test_a_plan_before_the_first_scan_is_made_again_after_it():
    navigator = Navigator(grid_of(room(*WALLS, THING)), ROBOT, layers=doubting(), settings=PATIENT)
    navigator.set_goal(GOAL)
    with pytest.raises(PlanningError):
        navigator.plan(START)
    assert navigator.report().waits_to_plan
    drive(navigator, room(*WALLS))
    assert navigator.status is NavigationStatus.ARRIVED


def test_a_run_whose_first_plan_waits_for_a_scan_has_time_for_a_path():
    navigator = Navigator(grid_of(room(*WALLS, THING)), ROBOT, layers=doubting(), settings=PATIENT)
    with (
        simulate(room(*WALLS), ROBOT, backend="kinematic", lidar=True) as sim,
        Session(sim, navigator, START, GOAL) as run,
    ):
        assert run.info.time_limit_s == pytest.approx(60.0 + 4.0 * 4.0 * START.distance_to(GOAL) / 0.8)
        run.finish()


@pytest.mark.parametrize("began", [0.0, 1.7e9], ids=["from 0", "from an epoch"])
@pytest.mark.parametrize("is_asked", [False, True], ids=["by update alone", "after plan"])
def test_a_robot_without_lidars_waits_two_seconds_for_a_scan_and_doubts_nothing(began, is_asked):
    navigator = Navigator(grid_of(room(*WALLS, THING)), ROBOT, layers=doubting(), settings=PATIENT)
    navigator.set_goal(GOAL)
    if is_asked:  # before the navigator knows the time
        with pytest.raises(PlanningError):
            navigator.plan(START)
    ended = []
    for step in range(80):
        navigator.update(START, Twist2D(), time=began + 0.05 * step)
        if navigator.status in FINAL:
            ended.append(0.05 * step)
    assert navigator.status is NavigationStatus.NO_PATH
    assert 2.0 <= ended[0] <= 2.2


def test_a_thing_that_is_in_the_world_as_well_is_seen_and_not_touched():
    world = room(*WALLS, THING)
    navigator = Navigator(
        grid_of(world), ROBOT, layers=doubting(), settings=PATIENT.model_copy(update={"patience_s": 4.0})
    )
    drive(navigator, world)
    assert navigator.status is NavigationStatus.NO_PATH
    assert navigator.costmap.cost_at(4.92, 3.0) == LETHAL


def test_the_map_is_whole_again_for_the_next_goal():
    navigator = Navigator(grid_of(room(*WALLS, THING)), ROBOT, layers=doubting(), settings=PATIENT)
    before = navigator.static_costmap
    here = drive(navigator, room(*WALLS))
    assert navigator.static_costmap.cost_at(5.2, 3.0) < LETHAL
    navigator.set_goal((here.x - 1.0, here.y))
    assert np.array_equal(navigator.static_costmap.data, before.data)


def test_nothing_is_doubted_while_there_is_a_path():
    navigator = Navigator(grid_of(room(THING)), ROBOT, layers=doubting(), settings=PATIENT)
    drive(navigator, room(THING))
    assert navigator.status is NavigationStatus.ARRIVED
    assert navigator.static_costmap.cost_at(5.2, 3.0) == LETHAL


def costmap_with(*cells, size=(60, 80), **options):
    data = np.zeros(size, np.int8)
    for rows, cols, value in cells:
        data[rows, cols] = value
    return Costmap.from_grid(OccupancyGrid(data, 0.05, Pose2D(0.0, 0.0)), ROBOT, **options)


def test_long_things_what_was_hit_and_what_is_kept_out_stay():
    wall, hit, gone = (slice(0, 60), 5, 100), (slice(20, 26), slice(30, 36), 100), (slice(20, 26), slice(60, 66), 100)
    hole = (slice(22, 24), slice(62, 64), -1)
    mask = KeepoutMask(OccupancyGrid(np.pad([[100]], ((40, 19), (40, 39))).astype(np.int8), 0.05, Pose2D(0.0, 0.0)))
    static = costmap_with(wall, hit, gone, hole, keepout=mask)
    seen = np.zeros(static.shape, np.bool_)
    seen[22, 28] = True
    left = without_unseen(static, seen)
    expected = costmap_with(wall, hit, keepout=mask)
    assert np.array_equal(left.data, expected.data)
    assert without_unseen(left, seen) is None


def test_an_empty_map_has_nothing_to_doubt():
    assert without_unseen(costmap_with(), np.zeros((60, 80), np.bool_)) is None


def test_a_wall_under_a_keepout_zone_is_not_cut_into_small_things():
    wall, gone = (slice(30, 32), slice(10, 130), 100), (slice(20, 26), slice(60, 66), 100)
    zone = np.zeros((60, 160), np.int8)
    zone[28:36, 10:94] = 100
    mask = KeepoutMask(OccupancyGrid(zone, 0.05, Pose2D(0.0, 0.0)))
    left = without_unseen(costmap_with(wall, gone, size=(60, 160), keepout=mask), np.zeros((60, 160), np.bool_))
    assert np.array_equal(left.data, costmap_with(wall, size=(60, 160), keepout=mask).data)


def sensed_with(thing, *, scans):
    """What a robot makes of the map with a thing on it, before which it stands."""
    sensed = SensedMap(
        CostmapSettings().make_costmap(grid_of(room(thing)), ROBOT), ROBOT, costmap=None, layers=doubting()
    )
    sensed.begin()
    placer = make_placer(ROBOT, doubting(), None)
    with simulate(room(thing), ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(scans):
            placed = placer.place(state.scans, Estimate(state.time, state.pose))
            sensed.update(placed, None, np.zeros((0, 3)))
            state = sim.step(Twist2D(), 0.05)
    return sensed


def test_what_was_seen_once_is_not_doubted_after_it_was_forgotten():
    sensed = sensed_with(THING, scans=20)
    sensed.clear_region("around", 30.0)
    assert len(sensed._layered.hits()) == 0
    assert not sensed.doubt_static()
    sensed.begin()
    assert sensed.doubt_static()


def test_nothing_is_doubted_before_the_first_scan():
    assert not sensed_with(THING, scans=0).doubt_static()


def test_nothing_is_doubted_where_what_was_sensed_alone_closes_the_path():
    aside = block("aside", 7.0, 1.0, 7.5, 1.5)
    navigator = Navigator(
        grid_of(room(*WALLS, aside)), ROBOT, layers=doubting(), settings=PATIENT.model_copy(update={"patience_s": 15.0})
    )
    drive(navigator, room(*WALLS, THING))
    assert navigator.status is NavigationStatus.NO_PATH
    assert navigator.static_costmap.cost_at(7.25, 1.25) == LETHAL


def test_nothing_is_doubted_for_a_goal_that_is_occupied():
    aside, on_goal = block("aside", 7.0, 1.0, 7.5, 1.5), block("on goal", 8.0, 2.5, 9.0, 3.5)
    navigator = Navigator(
        grid_of(room(aside, on_goal)), ROBOT, layers=doubting(), settings=PATIENT.model_copy(update={"patience_s": 3.0})
    )
    drive(navigator, room(aside))
    assert navigator.status is NavigationStatus.NO_PATH
    assert navigator.static_costmap.cost_at(7.25, 1.25) == LETHAL


ACROSS = block("across", 4.9, 2.2, 5.5, 3.8)
"""A thing that touches the walls on both sides of the gap."""


def map_with_across():
    grid = grid_of(room(*WALLS))
    data = grid.data.copy()
    low, high = (grid.world_to_cell(*corner) for corner in ((4.9, 2.2), (5.5, 3.8)))
    data[int(low[0]) : int(high[0]), int(low[1]) : int(high[1])] = 100
    return replace(grid, data=data)


def test_a_thing_that_touches_walls_is_taken_off_where_beams_pass_through_it():
    navigator = Navigator(map_with_across(), ROBOT, layers=doubting(), settings=PATIENT)
    drive(navigator, room(*WALLS))
    assert navigator.status is NavigationStatus.ARRIVED
    assert navigator.static_costmap.cost_at(5.2, 2.0) == LETHAL


def test_a_thing_that_touches_walls_and_is_there_stays():
    settings = PATIENT.model_copy(update={"patience_s": 4.0})
    navigator = Navigator(map_with_across(), ROBOT, layers=doubting(), settings=settings)
    drive(navigator, room(*WALLS, ACROSS))
    assert navigator.status is NavigationStatus.NO_PATH
    assert navigator.static_costmap.cost_at(4.92, 3.0) == LETHAL


def test_beams_take_a_thing_off_where_it_closes_the_path_together_with_what_was_sensed():
    """The map alone has a path: through the gap in the north, which a box closes that is not on the map."""
    walls = WALLS[0], block("middle", 5.0, 3.7, 5.4, 4.5)
    navigator = Navigator(grid_of(room(*walls, THING)), ROBOT, layers=doubting(), settings=PATIENT)
    drive(navigator, room(*walls, block("box", 4.9, 4.6, 5.5, 5.9)))
    assert navigator.status is NavigationStatus.ARRIVED


NOWHERE = ROBOT.planar.outline - 100.0


def passed_everywhere(x, y):
    return np.ones(len(x), np.bool_)


def test_cells_that_beams_pass_are_taken_off_beside_a_wall_that_was_hit_and_a_long_kerb_stays():
    wall, kerb = (slice(0, 60), slice(4, 8), 100), (slice(5, 50), 70, 100)
    ghost, strip = (slice(20, 32), slice(8, 20), 100), (slice(20, 32), slice(8, 10), 100)
    static = costmap_with(wall, kerb, ghost)
    hit = np.zeros(static.shape, np.bool_)
    hit[:, 7] = True
    left = without_passed(static, hit, lambda x, _: x > 9 * 0.05, NOWHERE)
    assert np.array_equal(left.data, costmap_with(wall, kerb, strip).data)
    assert without_passed(static, np.zeros_like(hit), passed_everywhere, NOWHERE) is None


def test_a_part_of_a_kerb_stays_of_which_more_was_not_seen():
    static = costmap_with((slice(5, 60), slice(70, 73), 100))
    seen_in_part = without_passed(static, np.zeros(static.shape, np.bool_), lambda _, y: y < 1.0, NOWHERE)
    assert seen_in_part is None


def test_only_cells_that_beams_pass_are_taken_off():
    thing = (slice(20, 30), slice(30, 40), 100)
    static = costmap_with(thing)
    left = without_passed(static, np.zeros(static.shape, np.bool_), lambda x, y: x < 35 * 0.05, NOWHERE)
    assert np.array_equal(left.data, costmap_with((slice(20, 30), slice(35, 40), 100)).data)


def test_what_is_kept_out_stays_where_beams_pass():
    mask = KeepoutMask(OccupancyGrid(np.pad([[100]], ((40, 19), (40, 39))).astype(np.int8), 0.05, Pose2D(0.0, 0.0)))
    static = costmap_with(keepout=mask)
    assert without_passed(static, np.zeros(static.shape, np.bool_), passed_everywhere, NOWHERE) is None


def test_nothing_is_where_the_robot_stands():
    static = costmap_with((slice(20, 30), slice(30, 70), 100))
    outline = Pose2D(2.5, 1.25, 0.3).transform_points(ROBOT.planar.padded(0.05).outline)
    left = without_passed(static, static.data == LETHAL, lambda x, y: np.zeros(len(x), np.bool_), outline)
    assert not left.footprint_collides((2.5, 1.25, 0.3))[0]
    assert left.cost_at(1.6, 1.25) == left.cost_at(3.4, 1.25) == LETHAL


def low_kerb_navigator():
    """A navigator that has driven beside a kerb across the room, which no lidar sees and which is 5 cm thick."""
    grid = grid_of(room())
    data = grid.data.copy()
    data[:, int(grid.world_to_cell(5.0, 3.0)[1])] = 100
    navigator = Navigator(replace(grid, data=data), ROBOT, layers=doubting(), settings=PATIENT)
    left = float(grid.cell_to_world(0, int(grid.world_to_cell(5.0, 3.0)[1]))[0]) - 0.025
    start = Pose2D(left - 0.01 - float(ROBOT.planar.outline[:, 1].max()), 3.0, math.pi / 2.0)
    return navigator, start


def test_a_robot_that_stands_beside_a_low_kerb_does_not_drive_over_it():
    navigator, start = low_kerb_navigator()
    before = navigator.static_costmap.data
    drive(navigator, room(), start=start)
    assert navigator.status is NavigationStatus.NO_PATH
    assert np.array_equal(navigator.static_costmap.data, before)


def test_a_plan_that_is_asked_for_after_a_new_goal_takes_nothing_off_elsewhere():
    navigator = Navigator(grid_of(room(*WALLS)), ROBOT, layers=doubting(), settings=PATIENT)
    here = drive(navigator, room(*WALLS), goal=(START.x + 1.0, START.y))
    before = navigator.static_costmap.data
    navigator.set_goal(15.0, 3.0)
    with pytest.raises(PlanningError):
        navigator.plan(here)
    assert np.array_equal(navigator.static_costmap.data, before)
