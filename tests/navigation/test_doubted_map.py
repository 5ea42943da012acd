"""Things on the map that no scan has hit, where they close the only path."""

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, grid_of, room
from trundle.costmap import LETHAL, Costmap, LayersSettings, ObstacleLayerSettings
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.navigation.doubted_map import without_unseen
from trundle.navigation.status import FINAL
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
    left = without_unseen(static, np.array([(1.45, 1.1), (50.0, 50.0)]))
    expected = costmap_with(wall, hit, keepout=mask)
    assert np.array_equal(left.data, expected.data)
    assert without_unseen(left, np.array([(1.45, 1.1)])) is None


def test_an_empty_map_has_nothing_to_doubt():
    assert without_unseen(costmap_with(), np.zeros((0, 2))) is None
