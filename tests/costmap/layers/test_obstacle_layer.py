"""Marking and clearing by scans: noise, people who walk by, several lidars, late and broken scans."""

import dataclasses
import math
import threading
import warnings

import numpy as np
import pytest

from support.walls import ANGLES, CARTER, Surroundings, estimate, make_scan
from trundle.costmap import EVERYWHERE, LayeredCostmap, LayersSettings, ObstacleLayer, ObstacleLayerSettings
from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate
from trundle.robots import Lidar, Robot

HERE = Pose2D(0.0, 0.0)
WALL = [(3.0, -4.0, 3.0, 4.0)]


def see(layer, around, pose=HERE, *, ticks=4, start=0.0, lidars=("front",)):
    for tick in range(ticks):
        time = start + 0.05 * tick
        layer.update([around.scan(time, pose, lidar) for lidar in lidars], estimate(time, pose))
    return layer.obstacles()


@pytest.mark.parametrize("offset", [0.0, 0.005, 0.013, 0.025, 0.04])
@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_noise_makes_a_wall_at_most_one_cell_thicker(offset, speed):
    x = 3.0 + offset
    around = Surroundings([(x, -4.0, x, 4.0)], noise=0.01)
    layer = ObstacleLayer(CARTER)
    for tick in range(100):
        pose, time = Pose2D(-speed * 0.05 * tick, 0.0, 0.1), 0.05 * tick
        layer.update([around.scan(time, pose)], estimate(time, pose))
    found = layer.obstacles()
    assert np.abs(found[:, 0] - x).max() < 0.04
    cells = np.unique(np.floor(found / 0.05).astype(int), axis=0)
    assert math.floor(x / 0.05) in cells[:, 0]
    assert np.unique(cells[:, 1], return_counts=True)[1].max() <= 2


def test_noise_far_from_the_border_of_a_cell_does_not_thicken_a_wall_at_all():
    found = see(ObstacleLayer(CARTER), Surroundings([(3.025, -4.0, 3.025, 4.0)], noise=0.01), ticks=100)
    assert (np.floor(found[:, 0] / 0.05) == 60).mean() > 0.98


def test_dust_marks_nothing_even_where_one_hit_is_enough():
    rng, around = np.random.default_rng(0), Surroundings(WALL)
    layer, before = ObstacleLayer(CARTER, ObstacleLayerSettings(hits_to_mark=1)), 0
    for tick in range(40):
        time, scan = 0.05 * tick, around.scan(0.05 * tick, HERE)
        early = np.flatnonzero((rng.random(len(scan.ranges)) < 0.01) & (scan.ranges < 9.0))
        ranges = scan.ranges.copy()
        ranges[early] *= rng.uniform(0.1, 0.9, len(early))
        layer.update([dataclasses.replace(scan, ranges=ranges)], estimate(time, HERE))
        found = layer.obstacles()
        before += int((found[:, 0] < 2.8).sum())
    assert len(found) > 50
    assert before <= 5  # two in a row at one place are seen again; 337 without the rule


def test_a_pole_that_one_beam_meets_is_marked():
    found = see(ObstacleLayer(CARTER), Surroundings(WALL, [(2.5, 0.0, 0.01)]), ticks=4)
    assert (np.hypot(found[:, 0] - 2.5, found[:, 1]) < 0.1).any()


def test_a_person_who_walks_by_leaves_no_ghost():
    layer = ObstacleLayer(CARTER)
    for tick in range(100):
        time, y = 0.05 * tick, -2.5 + 0.06 * tick
        there = [(1.5, y, 0.2)] if tick < 90 else []  # then it goes through a door
        around = Surroundings(WALL, there, noise=0.01, seed=tick)
        layer.update([around.scan(time, HERE)], estimate(time, HERE))
        found = layer.obstacles()
        person = found[found[:, 0] < 2.5]
        if 5 < tick < 70:
            assert len(person) > 5
            assert np.abs(person[:, 1] - y).max() < 0.2 + 8 * 0.06 + 0.1  # the last few scans' places
    assert len(found) > 100
    assert not (found[:, 0] < 2.5).any()


def test_a_person_before_open_space_leaves_no_ghost_where_infinity_is_valid():
    for valid in (True, False):
        lidar = CARTER.lidars["front"].model_copy(update={"inf_is_valid": valid})
        robot = CARTER.model_copy(update={"lidars": {"front": lidar}})
        layer = ObstacleLayer(robot)
        assert len(see(layer, Surroundings(discs=[(1.5, 0.0, 0.2)]))) > 5
        assert (len(see(layer, Surroundings(), start=1.0, ticks=12)) == 0) == valid


def test_marks_that_no_scan_confirms_disappear_after_their_persistence():
    layer = ObstacleLayer(CARTER, ObstacleLayerSettings(observation_persistence=0.5))
    assert len(see(layer, Surroundings(WALL))) > 20
    layer.update([], estimate(0.6, HERE))
    assert len(layer.obstacles()) > 20
    assert layer.update([], estimate(0.7, HERE)) is not None
    assert len(layer.obstacles()) == 0


def test_two_lidars_see_a_wall_in_one_place():
    layer = ObstacleLayer(CARTER)
    found = see(layer, Surroundings(WALL), Pose2D(0.0, 0.5, 0.3), lidars=("front", "back"))
    assert np.abs(found[:, 0] - 3.0).max() < 0.01


def test_a_mount_that_is_turned_and_off_centre_is_applied():
    lidar = Lidar(x=0.3, y=-0.2, z=0.2, yaw=2.0)
    robot = CARTER.model_copy(update={"lidars": {"side": lidar}})
    mount, pose = Pose2D(0.3, -0.2, 2.0), Pose2D(0.4, 0.1, -0.5)
    around, layer = Surroundings(WALL), ObstacleLayer(robot)
    for tick in range(3):
        scan = make_scan(0.05 * tick, around.ranges(pose @ mount), "side", mount)
        layer.update([scan], estimate(0.05 * tick, pose))
    assert np.abs(layer.obstacles()[:, 0] - 3.0).max() < 0.01


def test_a_late_scan_is_placed_where_the_robot_was():
    layer, around = ObstacleLayer(CARTER), Surroundings(WALL)
    for tick in range(10):
        pose = Pose2D(0.1 * tick, 0.0, 0.05 * tick)
        late = tick - 3
        scans = [around.scan(0.05 * late, Pose2D(0.1 * late, 0.0, 0.05 * late))] if late >= 0 else []
        layer.update(scans, estimate(0.05 * tick, pose))
    assert np.abs(layer.obstacles()[:, 0] - 3.0).max() < 0.01


def test_a_scan_is_straightened_while_the_robot_turns():
    around, turn, period = Surroundings(WALL), 2.0, 0.05
    for deskewed in (True, False):
        layer = ObstacleLayer(CARTER)
        for tick in range(8):
            time = period * tick
            layer.update([], estimate(time, Pose2D(0, 0, turn * time)))
            if tick < 2:
                continue
            begin, step = time - period, period / len(ANGLES)
            ranges = np.array(
                [around.ranges(Pose2D(0, 0, turn * (begin + i * step)))[i : i + 8] for i in range(0, len(ANGLES), 8)]
            ).ravel()
            scan = make_scan(begin, ranges, time_increment=step if deskewed else 0.0)
            layer.update([scan], estimate(time + 0.01, Pose2D(0, 0, turn * (time + 0.01))))
        found = layer.obstacles()
        assert (np.abs(found[:, 0] - 3.0).max() < 0.03) == deskewed


def test_the_robot_does_not_mark_its_own_body():
    outline = CARTER.planar.outline
    body = [(*a, *b) for a, b in zip(outline * 0.98, np.roll(outline, -1, axis=0) * 0.98, strict=True)]
    assert len(see(ObstacleLayer(CARTER), Surroundings(body))) == 0


@pytest.mark.parametrize("enabled", [True, False])
def test_what_the_robot_drives_over_is_cleared_if_enabled(enabled):
    layer = ObstacleLayer(CARTER, ObstacleLayerSettings(footprint_clearing_enabled=enabled))
    found = see(layer, Surroundings(discs=[(1.0, 0.0, 0.1)]))
    assert len(found) > 2
    for tick in range(20):
        layer.update([], estimate(1.0 + 0.1 * tick, Pose2D(0.05 * tick, 0.0)))
    assert (len(layer.obstacles()) == 0) == enabled


def test_broken_readings_neither_mark_nor_clear():
    layer = ObstacleLayer(CARTER)
    before = len(see(layer, Surroundings(WALL)))
    readings = np.resize([math.nan, -math.inf, 0.01, 12.5], 720)
    for tick in range(10):
        time = 1.0 + 0.05 * tick
        layer.update([make_scan(time, readings)], estimate(time, HERE))
    assert len(layer.obstacles()) == before
    layer.update([make_scan(2.0, []), make_scan(2.01, [math.nan])], estimate(2.01, HERE))
    assert len(layer.obstacles()) == before
    assert layer.warnings == {}


@pytest.mark.parametrize(
    ("kind", "scan"),
    [
        ("stale", lambda around: around.scan(3.9, HERE)),
        ("future", lambda around: around.scan(5.6, HERE)),
        ("future", lambda around: make_scan(5.0, [2.0] * 10, time_increment=0.1)),
        ("out of order", lambda around: around.scan(4.95, HERE)),
        ("out of order", lambda around: around.scan(4.9, HERE)),
        ("unknown lidar", lambda around: dataclasses.replace(around.scan(5.0, HERE), lidar="left")),
    ],
)
def test_scans_that_cannot_be_used_are_left_out_with_one_warning(kind, scan):
    layer, around = ObstacleLayer(CARTER), Surroundings(discs=[(1.0, 0.0, 0.3)])
    layer.update([], estimate(3.0, HERE))
    if kind != "stale":
        layer.update([Surroundings().scan(4.95, HERE)], estimate(4.99, HERE))
    layer.update([], estimate(5.0, HERE))
    with warnings.catch_warnings(record=True, action="always") as caught:
        for tick in range(5):
            layer.update([scan(around)], estimate(5.0 + 0.01 * (tick + 1), HERE))
    assert [(warning.category, "left out" in str(warning.message)) for warning in caught] == [(SensorWarning, True)]
    assert layer.warnings == {kind: 5}
    assert len(layer.obstacles()) == 0
    layer.reset()
    assert layer.warnings == {}


def test_scans_from_before_the_first_pose_are_left_out_silently():
    layer = ObstacleLayer(CARTER)
    layer.update([Surroundings(WALL).scan(-0.1, HERE)], estimate(0.0, HERE))
    assert layer.warnings == {"before the first pose": 1}


@pytest.mark.parametrize("there", [Pose2D(5.0, 0.0), Pose2D(0.0, 0.0, 2.5)])
def test_a_pose_that_jumps_clears_the_layer_with_a_warning(there):
    layer, around = ObstacleLayer(CARTER), Surroundings(WALL)
    see(layer, around)
    with pytest.warns(SensorWarning, match="jumped by"):
        window = layer.update([around.scan(0.19, HERE)], estimate(0.2, there))
    assert window == EVERYWHERE
    assert len(layer.obstacles()) == 0
    assert layer.warnings["jump"] == 1
    costmap = LayeredCostmap(OccupancyGrid(np.zeros((300, 300), np.int8), 0.05, Pose2D(-7, -7)), CARTER)
    see(costmap, around)
    with pytest.warns(SensorWarning, match="forgotten"):
        costmap.update([], estimate(0.2, there))
    assert not costmap.sensed.any()
    assert costmap.warnings["jump"] == 1


def test_a_correction_of_more_than_a_metre_warns_that_what_was_sensed_is_forgotten():
    costmap = LayeredCostmap(OccupancyGrid(np.zeros((600, 600), np.int8), 0.05, Pose2D(-15, -15)), CARTER)
    see(costmap, Surroundings(WALL))
    shift = Pose2D(5.0, 0.0)
    with pytest.warns(SensorWarning, match=r"corrected by 5\.0 m"):
        costmap.update([], estimate(0.3, shift, shift))
    assert len(costmap.obstacles()) == 0
    assert costmap.warnings == {"correction": 1}


def test_driving_fast_or_after_a_pause_is_no_jump():
    layer = ObstacleLayer(CARTER)
    layer.update([], estimate(0.0, HERE))
    layer.update([], estimate(0.05, Pose2D(0.9, 0.0, 0.5)))
    layer.update([], estimate(60.0, Pose2D(40.0, 0.0, 3.0)))
    assert layer.warnings == {}


def test_other_arguments_are_refused():
    layer = ObstacleLayer(CARTER)
    layer.update([], estimate(1.0, HERE))
    with pytest.raises(InputError, match="times must increase"):
        layer.update([], estimate(1.0, HERE))
    with pytest.raises(InputError, match="scans"):
        layer.update(3, estimate(2.0, HERE))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="a scan must be"):
        layer.update(["scan"], estimate(2.1, HERE))  # type: ignore[list-item]
    with pytest.raises(InputError, match="an estimate must be"):
        layer.update([], HERE)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="a layer's robot"):
        ObstacleLayer("nova_carter")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="resolution"):
        ObstacleLayer(CARTER, resolution=0.0)


@pytest.mark.parametrize(
    "options",
    [
        {"obstacle_max_range": 2.0, "obstacle_min_range": 3.0},
        {"raytrace_max_range": 5000.0},
        {"hits_to_mark": 0},
        {"misses_to_clear": 11},
        {"observation_persistence": -1.0},
        {"static_tolerance": math.inf},
        {"inflation": 3},
    ],
)
def test_settings_out_of_range_are_refused(options):
    with pytest.raises(InputError):
        ObstacleLayerSettings(**options)


def test_an_odometry_far_from_its_origin_is_held():
    layer = ObstacleLayer(CARTER)
    pose = Pose2D(5e8, -5e8, 1.0)
    around = Surroundings([(5e8 + 3.0, -5e8 - 4.0, 5e8 + 3.0, -5e8 + 4.0)])
    assert np.abs(see(layer, around, pose)[:, 0] - 5e8 - 3.0).max() < 0.02


def test_a_layer_that_may_not_grow_further_keeps_what_is_near(monkeypatch):
    monkeypatch.setattr("trundle.costmap.layers.evidence_grid._MOST_CELLS", 1_000_000)
    layer, around = ObstacleLayer(CARTER), Surroundings(WALL)
    see(layer, around)
    windows = [layer.update([], estimate(1.0 + tick, Pose2D(0.0, 1.5 * tick))) for tick in range(40)]
    assert EVERYWHERE in windows
    assert len(layer.obstacles()) == 0


def test_layers_in_several_threads_do_not_disturb_each_other():
    def drive(found, index):
        layered = LayeredCostmap(None, CARTER, layers=LayersSettings(width=8.0, height=8.0))
        around = Surroundings(WALL, [(1.5, 0.0, 0.2)], noise=0.01)
        for tick in range(20):
            time, pose = 0.05 * tick, Pose2D(-0.03 * tick, 0.0, 0.02 * tick)
            layered.update([around.scan(time, pose)], estimate(time, pose))
        found[index] = layered.costmap.data

    found = {}
    drive(found, "alone")
    threads = [threading.Thread(target=drive, args=(found, index)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(found["alone"], found[index]) for index in range(4))


def test_one_layered_costmap_may_be_read_while_another_thread_updates_it():
    layered = LayeredCostmap(OccupancyGrid(np.zeros((240, 240), np.int8), 0.05, Pose2D(-6, -6)), CARTER)
    around, done, problems = Surroundings(WALL, noise=0.01), threading.Event(), []

    def read():
        while not done.is_set():
            points, sensed, costmap = layered.obstacles(), layered.sensed, layered.costmap
            if costmap.shape != sensed.shape or points.shape[1:] != (2,):
                problems.append(costmap)

    reader = threading.Thread(target=read)
    reader.start()
    try:
        for tick in range(60):
            layered.update([around.scan(0.05 * tick, HERE)], estimate(0.05 * tick, HERE))
    finally:
        done.set()
        reader.join()
    assert problems == []
    assert layered.sensed.any()


def test_estimates_without_a_lidar_need_no_scans():
    robot = Robot.load("nova_carter").model_copy(update={"lidars": {}})
    layer = ObstacleLayer(robot)
    assert layer.update([], Estimate(0.0, HERE)) is not None  # what is under the robot is seen
    assert layer.update([], Estimate(0.1, HERE)) is None


def test_what_moved_behind_something_else_is_forgotten_and_what_stands_there_is_not():
    someone, shelf = [(4.0, 1.0, 0.3)], [(4.0, -3.0, 4.0, -1.0)]
    hidden = [(2.0, -0.4, 2.0, 1.0)]  # hides where they were, and not the shelf
    for persistence, left in ((2.0, False), (None, True)):
        layered = LayeredCostmap(
            None, CARTER, layers=LayersSettings(obstacle=ObstacleLayerSettings(mover_persistence=persistence))
        )
        for tick in range(100):
            time = 0.05 * tick
            around = Surroundings(shelf if tick > 20 else [], someone) if tick <= 20 else Surroundings(shelf + hidden)
            moved = [(4.0, 1.0, 0.3), (4.0, -2.0, 0.3)]
            layered.update([around.scan(time, HERE)], estimate(time, HERE), moved=moved)
            if tick == 20:
                assert near(layered, 4.0, 1.0, 0.4)
        assert near(layered, 4.0, 1.0, 0.4) == left
        assert near(layered, 4.0, -2.0, 0.4)


def test_who_was_seen_to_move_and_is_hidden_since_is_forgotten_when_that_is_asked_for():
    someone, shelf, door = [(4.0, 1.0, 0.3)], [(4.0, -3.0, 4.0, -1.0)], [(2.0, -0.4, 2.0, 1.0)]
    layered = LayeredCostmap(None, CARTER)
    places = np.array([(4.0, 1.0, 0.3), (4.0, -2.0, 0.3)])
    for tick in range(100):
        around = Surroundings([], someone) if tick <= 20 else Surroundings(shelf + door)
        moved = places if tick <= 20 else ()
        layered.update([around.scan(0.05 * tick, HERE)], estimate(0.05 * tick, HERE), moved=moved)
    assert near(layered, 4.0, 1.0, 0.4)
    layered.forget_hidden(places)
    assert not near(layered, 4.0, 1.0, 0.4)
    assert near(layered, 4.0, -2.0, 0.4)


def test_what_a_robot_would_turn_into_is_not_forgotten_where_nobody_looks():
    beside = CARTER.planar.circumscribed_radius + 0.2
    around = Surroundings([], [(0.0, beside + 0.1, 0.1), (0.0, -3.0, 0.3)])
    layered = LayeredCostmap(None, CARTER)
    places = np.array([(0.0, beside + 0.1, 0.1), (0.0, -3.0, 0.3)])
    for tick in range(100):
        scans = [around.scan(0.05 * tick, HERE)] if tick <= 20 else []
        layered.update(scans, estimate(0.05 * tick, HERE), moved=places if tick <= 20 else ())
    layered.forget_hidden(places)
    assert near(layered, 0.0, beside, 0.1)
    assert not near(layered, 0.0, -3.0, 0.4)


def near(layered, x, y, within):
    found = layered.obstacles()
    return bool((np.hypot(found[:, 0] - x, found[:, 1] - y) < within).any())
