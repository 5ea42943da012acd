"""`BatchSimulator` against the kinematic simulator and its lidars, and what it promises of many robots."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest

from trundle.errors import InputError, MissingExtraError, UnknownNameError, WorldWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Cylinder, Solid
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import BatchSimulator, MoverRecording
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World, walls
from trundle.worlds.movers import Mover, Waypoints, forklift_body

CARTER = Robot.load("nova_carter")
PERIOD = 0.05


@pytest.fixture(autouse=True)
def cells_as_one_solid(monkeypatch):
    """Worlds of maps as blocked cells, so that contacts are named by cell."""
    monkeypatch.setattr(walls.extrude, "__kwdefaults__", {**walls.extrude.__kwdefaults__, "most_boxes": 0})


def clutter(seed: int, shape=(160, 220), yaw: float = 0.3) -> OccupancyGrid:
    rng = np.random.default_rng(seed)
    cells = np.zeros(shape, dtype=np.int8)
    for row, col in rng.integers(0, shape, (40, 2)):
        cells[row : row + 4, col : col + 3] = 100
    cells[:2], cells[-2:], cells[:, :2], cells[:, -2:] = 100, 100, 100, 100
    cells[10:14, 10:30] = -1
    return OccupancyGrid(cells, 0.05, Pose2D(-3.0, 2.0, yaw))


GRID = clutter(0)


def starts(count: int, seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    inside = GRID.origin.transform_points(rng.uniform((1.5, 1.5), (9.5, 6.5), (count, 2)))
    return np.column_stack([inside, rng.uniform(-math.pi, math.pi, count)])


def commands(count: int, periods: int, seed: int = 2) -> np.ndarray:
    """Commands that stay for a while, some above the limits."""
    rng = np.random.default_rng(seed)
    return np.repeat(rng.uniform((-0.8, -2.5), (1.8, 2.5), (-(-periods // 12), count, 2)), 12, axis=0)[:periods]


@pytest.mark.parametrize("name", ["nova_carter", "jackal"])
def test_motion_contacts_and_scans_are_those_of_the_kinematic_simulator(name):
    robot = Robot.load(name)
    exact = {"noise": 0.0, "rate": 20.0, "z": 0.3}
    robot = robot.model_copy(
        update={"lidars": {key: each.model_copy(update=exact) for key, each in robot.lidars.items()}}
    )
    poses, given = starts(8), commands(8, 40)
    batch = BatchSimulator(GRID, robot, count=8, lidar=True)
    batch.reset(poses)
    single = [KinematicSimulator(World.from_map(GRID), robot, lidar=True) for _ in poses]
    for simulator, pose in zip(single, poses, strict=True):
        simulator.reset(Pose2D(*pose))
    touched = 0
    for command in given:
        batch.step(command, PERIOD)
        ranges = batch.scan_exactly()
        for robot_index, simulator in enumerate(single):
            state = simulator.step(Twist2D(*command[robot_index]), PERIOD)
            x, y, yaw = batch.poses[robot_index]
            assert (x, y) == pytest.approx((state.pose.x, state.pose.y), abs=1e-12)
            assert math.remainder(yaw - state.pose.yaw, math.tau) == pytest.approx(0.0, abs=1e-12)
            assert tuple(batch.twists[robot_index]) == (state.twist.v, state.twist.w)
            assert tuple(batch.wheels[robot_index]) == pytest.approx(state.wheel_positions, abs=1e-12)
            kind, row, col, _ = batch.contacts[robot_index]
            assert bool(kind) == bool(state.contacts)
            if kind:
                touched += 1
                assert f"map[{row},{col}]" in {contact.other for contact in state.contacts}
            for scan in state.scans:
                mine = ranges[robot_index, batch.columns[scan.lidar]]
                assert np.array_equal(np.isinf(mine), np.isinf(scan.ranges))
                hit = np.isfinite(mine)
                assert mine[hit] == pytest.approx(scan.ranges[hit], abs=1e-9)
    assert 0 < touched < 320


def mover_world() -> World:
    """The map with a person that walks and a forklift that drives, on straight lines."""

    def across(first, last):
        (x, y), (u, v) = GRID.origin.transform_points([first, last])
        return Waypoints(((0.0, x, y), (20.0, u, v)))

    post = (Solid("post", Cylinder(0.4, 1.6), Pose3D((0.0, 0.0, 0.8))),)
    return replace(
        World.from_map(GRID),
        movers=(
            Mover("post", post, across((1.0, 4.0), (10.0, 4.0)), may_cross=True),
            Mover("forklift", forklift_body(), across((9.0, 2.0), (2.0, 6.0)), may_cross=True),
        ),
    )


def test_contacts_with_movers_are_those_of_the_kinematic_simulator():
    world = mover_world()
    recording = MoverRecording.of_world(world, CARTER, duration_s=6.0)
    assert recording.outlines[0] == 0.4
    poses, given = starts(12, seed=5), commands(12, 100, seed=6)
    batch = BatchSimulator(GRID, CARTER, count=12, recordings=[recording])
    batch.reset(poses, recordings=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", WorldWarning)  # a mover may start on a robot
        single = [KinematicSimulator(world, CARTER) for _ in poses]
        for simulator, pose in zip(single, poses, strict=True):
            simulator.reset(Pose2D(*pose))
    by_mover = 0
    for command in given:
        batch.step(command, PERIOD)
        for index, simulator in enumerate(single):
            names = {contact.other for contact in simulator.step(Twist2D(*command[index]), PERIOD).contacts}
            kind, first, _, _ = batch.contacts[index]
            assert bool(kind) == bool(names)
            if kind == 2:
                by_mover += 1
                assert ("post", "forklift")[first] in names
    assert by_mover > 5


def test_beams_meet_movers_as_in_the_kinematic_simulator():
    front = CARTER.lidars["front"].model_copy(update={"noise": 0.0})
    robot = CARTER.model_copy(update={"lidars": {"front": front}})
    world = replace(mover_world(), movers=mover_world().movers[:1])  # a disc; a forklift has a shape at each height
    batch = BatchSimulator(
        GRID, robot, count=5, lidar="front", recordings=[MoverRecording.of_world(world, robot, duration_s=2.0)]
    )
    poses = starts(5, seed=11)
    batch.reset(poses, recordings=0)
    batch.step((0.3, 0.4), 1.0)
    ranges = batch.scan_exactly()
    without = BatchSimulator(GRID, robot, count=5, lidar="front")
    without.reset(batch.poses)
    assert (ranges < without.scan_exactly()).sum() > 20
    for index, pose in enumerate(poses):
        with KinematicSimulator(world, robot, lidar=True) as simulator, warnings.catch_warnings():
            warnings.simplefilter("ignore", WorldWarning)
            simulator.reset(Pose2D(*pose))
            scan = simulator.step(Twist2D(0.3, 0.4), 1.0).scans[0]
        assert np.array_equal(np.isinf(ranges[index]), np.isinf(scan.ranges))
        hit = np.isfinite(scan.ranges)
        assert ranges[index][hit] == pytest.approx(scan.ranges[hit], abs=1e-7)


def test_a_mover_that_is_a_polygon_is_seen_where_its_edges_are():
    square = np.array([(0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5), (0.5, -0.5)])
    grid = OccupancyGrid(np.zeros((200, 200), np.int8), 0.05, Pose2D(-5.0, -5.0))
    recording = MoverRecording((square,), np.array([[(2.0, 0.0, math.pi / 4.0)]]))
    lidar = CARTER.lidars["front"].model_copy(update={"x": 0.0, "y": 0.0, "beams": 4, "fov": math.tau, "yaw": 0.0})
    batch = BatchSimulator(
        grid, CARTER.model_copy(update={"lidars": {"front": lidar}}), count=1, lidar=True, recordings=[recording]
    )
    batch.reset((0.0, 0.0, 0.0), recordings=0)
    assert batch.scan_exactly()[0, 2] == pytest.approx(2.0 - math.sqrt(0.5), abs=1e-12)  # the third beam is ahead
    assert np.isinf(batch.scan_exactly()[0, [0, 1, 3]]).all()


def rollout(count: int, threads: int, robots: slice, order=None) -> tuple[np.ndarray, ...]:
    """Poses, scans and contacts of some of 1024 robots, run among `count` of them."""
    maps = [clutter(seed, shape) for seed, shape in enumerate([(160, 220), (180, 200), (160, 300)])]
    batch = BatchSimulator(maps, CARTER, count=count, lidar="front", threads=threads)
    chosen = np.arange(1024)[robots][:count]
    where = {"maps": chosen % 3, "seeds": chosen, "noise": 0.02, "dropouts": 0.1}
    batch.reset(starts(1024)[chosen], **where)
    if order is not None:  # in parts, in another order
        for part in order:
            inside = {key: value[part] if np.ndim(value) else value for key, value in where.items()}
            batch.reset(starts(1024)[chosen][part], robots=part, **inside)
    for command in commands(1024, 10):
        batch.step(command[chosen], PERIOD)
        scans = batch.scan().copy()
    return batch.poses, scans, batch.contacts


def test_a_robot_has_the_same_bits_alone_and_among_1024_whatever_the_threads():
    every = rollout(1024, 1, slice(None))
    assert np.isinf(every[1]).mean() > 0.05
    for count, threads, robots in ((1024, 4, slice(None)), (1, 2, slice(700, 701)), (7, 3, slice(100, 107))):
        for mine, expected in zip(rollout(count, threads, robots), every, strict=True):
            assert mine.tobytes() == np.ascontiguousarray(expected[robots]).tobytes()


def test_the_order_of_resets_changes_nothing():
    order = [np.array([30, 5, 7]), np.arange(8, 30), np.array([0, 1, 2, 3, 4, 6, 31])]
    for mine, expected in zip(rollout(32, 2, slice(0, 32), order), rollout(32, 1, slice(0, 32)), strict=True):
        assert mine.tobytes() == expected.tobytes()


def test_a_reset_of_some_leaves_the_others_as_they_are():
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3))
    batch.step((0.5, 0.1), 0.5)
    before = batch.poses.copy(), batch.wheels.copy(), batch.contacts.copy()
    batch.reset((0.0, 3.0, 0.0), robots=[1])
    for now, then in zip((batch.poses, batch.wheels, batch.contacts), before, strict=True):
        assert np.array_equal(now[[0, 2]], then[[0, 2]])
    assert batch.times == pytest.approx([0.5, 0.0, 0.5])
    assert batch.poses[1].tolist() == [0.0, 3.0, 0.0]


def test_only_the_robots_asked_for_drive():
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3))
    batch.step((0.5, 0.0), 0.1, robots=[False, True, False])
    assert batch.times == pytest.approx([0.0, 0.1, 0.0])
    assert np.array_equal(batch.poses[[0, 2]], starts(3)[[0, 2]])


@pytest.mark.parametrize("bad", [math.nan, math.inf, -1e300])
def test_a_command_that_is_not_finite_moves_no_robot(bad):
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3))
    with pytest.raises(InputError, match=r"robot 1.*No robot has moved"):
        batch.step([(0.1, 0.0), (bad, 0.0), (0.1, 0.0)], PERIOD)
    assert np.array_equal(batch.poses, starts(3))


def test_a_robot_beyond_its_map_is_off_it():
    batch = BatchSimulator(GRID, CARTER, count=2)
    batch.reset([(0.0, 4.0, 0.0), (-50.0, 0.0, 0.0)])
    assert batch.is_off_map().tolist() == [False, True]
    assert np.isinf(batch.scan()).all()


def test_a_ray_along_a_line_of_the_grid_comes_in_from_beyond_the_map():
    cells = np.zeros((100, 100), dtype=np.int8)
    cells[40, 60] = cells[42, 98] = 100
    centred = {"x": 0.0, "y": 0.0, "yaw": 0.0, "beams": 2, "fov": math.tau, "range_max": 100.0, "noise": 0.0}
    lidar = CARTER.lidars["front"].model_copy(update=centred)
    robot = CARTER.model_copy(update={"lidars": {"front": lidar}})
    batch = BatchSimulator(OccupancyGrid(cells, 1.0), robot, count=2, lidar=True)
    # Its heading is half a turn, rounded: it crosses the line at 41 at once, before it comes in.
    batch.reset([(110.5, 41.0, -math.pi), (99.5, 41.0, -math.pi)])
    ahead = batch.scan_exactly()[:, 1]  # of the beams at -π and at 0
    assert ahead.tolist() == [49.5, 38.5]


SMALL = OccupancyGrid(np.zeros((9, 40), np.int8), 0.05)
COARSE = OccupancyGrid(np.zeros((90, 90), np.int8), 0.1)


@pytest.mark.parametrize(
    ("arguments", "options", "error", "text"),
    [
        ((GRID, CARTER), {"count": 0}, InputError, "count must be an integer from 1"),
        (([], CARTER), {"count": 1}, InputError, "at least one map"),
        (([GRID, COARSE], CARTER), {"count": 1}, InputError, "map 1 has cells of 0.1 m, map 0 of 0.05 m"),
        ((SMALL, CARTER), {"count": 1}, InputError, "larger than the map"),
        ((["office"], CARTER), {"count": 1}, InputError, "must be an OccupancyGrid, got str"),
        ((GRID, "nova_carter"), {"count": 1}, InputError, "Robot.load"),
        ((GRID, CARTER), {"count": 1, "lidar": "fromt"}, UnknownNameError, "Did you mean 'front'"),
        ((GRID, CARTER), {"count": 1, "lidar": 3}, InputError, "lidar must be true, false, or names"),
        ((GRID, CARTER), {"count": 1, "lidar": ["front", "front"]}, InputError, "'front' is chosen twice"),
        ((None, CARTER), {"count": 1}, InputError, "maps must be an OccupancyGrid or a list"),
        ((GRID, CARTER), {"count": 1, "recordings": None}, InputError, "recordings must be a list"),
        ((GRID, CARTER), {"count": 1, "device": "tpu"}, UnknownNameError, "unknown device"),
        ((GRID, CARTER), {"count": 1, "timestep": 0.0}, InputError, "timestep"),
        ((GRID, CARTER), {"count": 1, "threads": 0}, InputError, "threads"),
    ],
)
def test_bad_arguments_are_named(arguments, options, error, text):
    with pytest.raises(error, match=text):
        BatchSimulator(*arguments, **options)


def test_without_warp_a_gpu_is_refused_with_the_install_line(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda _name: None)
    with pytest.raises(MissingExtraError, match=r'device="cuda" needs warp-lang.*\[gpu\]'):
        BatchSimulator(GRID, CARTER, count=1, device="cuda")


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"poses": np.zeros((2, 3))}, "poses need shape"),
        ({"poses": [5.0]}, r"poses need shape \(3, 3\), or shape \(3,\) for all, got \(1,\)"),
        ({"poses": 5.0}, "poses need shape"),
        ({"poses": np.zeros((3, 1))}, "poses need shape"),
        ({"poses": (math.nan, 0.0, 0.0)}, "pose of robot 0 is not finite"),
        ({"maps": 1}, "robot 0 is to be on map 1; there are 1 maps"),
        ({"maps": [0, 0, -1]}, "robot 2"),
        ({"maps": 0.9}, r"maps must be integers \(int64\), got 0.9"),
        ({"maps": [0.0, 0.0, 0.5]}, "maps must be integers"),
        ({"maps": math.nan}, "maps must be"),
        ({"maps": True}, "maps must be integers"),
        ({"maps": [0]}, r"maps need shape \(3,\), or one number for all, got \(1,\)"),
        ({"seeds": 1.9}, r"seeds must be integers \(uint64\)"),
        ({"seeds": np.array([-1, 0, 1])}, "seeds must be integers"),
        ({"seeds": 2**64}, "seeds must be"),
        ({"noise": [0.1, 0.1]}, r"noise need shape \(3,\)"),
        ({"robots": [[0], [1, 2]]}, "robots must be indices"),
        ({"recordings": 0}, "there are 0 recordings"),
        ({"robots": [3]}, "different indices from 0 to 2"),
        ({"robots": [1, 1]}, "different indices"),
        ({"robots": [True]}, "shape"),
        ({"noise": -0.1}, "noise must be"),
        ({"dropouts": 2.0}, "dropouts from 0 to 1"),
    ],
)
def test_a_bad_reset_is_refused_as_a_whole(options, text):
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3))
    with pytest.raises(InputError, match=text):
        batch.reset(**{"poses": (0.0, 4.0, 0.0), **options})
    assert np.array_equal(batch.poses, starts(3))


@pytest.mark.parametrize("commands", [0.2, [0.1], [[0.1], [0.2], [0.3]], [[0.1, 0.2]], np.zeros((2, 2))])
def test_commands_of_another_shape_move_no_robot(commands):
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3))
    with pytest.raises(InputError, match=r"commands need shape \(3, 2\), or shape \(2,\) for all"):
        batch.step(commands, PERIOD)
    assert np.array_equal(batch.poses, starts(3))


def test_integers_may_be_any_that_fit():
    batch = BatchSimulator(GRID, CARTER, count=3)
    batch.reset(starts(3), maps=np.zeros(3, np.float32), recordings=np.int8(-1), seeds=[2**64 - 1, 0, 1])
    batch.reset(starts(3), maps=[0, 0, 0], seeds=range(3))
    assert batch.places.tolist() == [[0, -1]] * 3
