"""What a navigator does with scans, observations and tracks, and with times and poses that jump."""

import math
import warnings

import numpy as np
import pytest

from support.sensed_rooms import GOAL, ROBOT, START, block, grid_of, room
from trundle.costmap import LETHAL, Costmap, CostmapSettings
from trundle.costmap.layers import LayersSettings
from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator, NavigatorSettings
from trundle.observation import Estimate, Observation, Scan
from trundle.sim import simulate
from trundle.worlds import World
from trundle.worlds.movers import Mover, Waypoints, person_body

# In a simulator -------------------------------------------------------------------------------------------------------


def test_unseen_space_is_entered_no_faster_than_allows_a_stop():
    """A lidar that sees 1 m: the robot can stop within that."""
    near = ROBOT.lidars["front"].model_copy(update={"range_max": 1.0})
    short = ROBOT.model_copy(update={"lidars": {"front": near}})
    slow = short.model_copy(update={"limits": ROBOT.limits.model_copy(update={"linear_acceleration": 0.2})})
    navigator = Navigator(None, slow)
    navigator.set_goal(9.0, 3.0)
    speeds = []
    with simulate(room(), slow, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(200):
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            speeds.append(state.twist.v)
            state = sim.step(command, navigator.dt)
    # 0.9 m of what is seen are in front of the footprint at most: v² / 2a is less.
    assert 0.2 < max(speeds) < math.sqrt(2.0 * 0.2 * 0.95)
    assert np.median(speeds[100:]) > 0.1


def test_observations_and_poses_drive_alike():
    world = room(block("box", 4.6, 2.5, 5.4, 3.5))
    commands = []
    for whole in (True, False):
        navigator = Navigator(grid_of(room()), ROBOT)
        navigator.set_goal(GOAL)
        driven = []
        with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
            state = sim.reset(START)
            for _ in range(100):
                if whole:
                    command = navigator.update(state.observation, Estimate(state.time, state.pose))
                else:
                    command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
                driven.append(command)
                state = sim.step(command, navigator.dt)
        commands.append(driven)
    assert commands[0] == commands[1]


def test_a_navigator_tracks_what_moves_and_gives_it_to_its_controller():
    given = []

    class Watching:
        def set_path(self, path):
            pass

        def set_tracks(self, tracks):
            given.append(tracks)

        def compute_velocity(self, pose, twist, costmap, dt):
            return Twist2D()

    walker = Mover("walker", person_body(), Waypoints(((0.0, 5.0, 1.0), (4.0, 5.0, 5.0))))
    world = World("room", room().solids, movers=(walker,))
    navigator = Navigator(None, ROBOT, controller=Watching())
    navigator.set_goal(GOAL)
    to_map = Pose2D(1.0, 0.0, 0.5 * math.pi)
    with simulate(world, ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(40):
            seen = Observation(state.time, state.twist, state.pose, state.scans)
            navigator.update(seen, Estimate(state.time, to_map @ state.pose, None, to_map))
            state = sim.step(Twist2D(), 0.05)
    (track,) = [track for track in navigator.tracks if track.moving]
    truth = to_map @ Pose2D(5.0, 1.0 + 1.95)
    assert (track.x, track.y) == pytest.approx((truth.x, truth.y), abs=0.1)
    assert (track.vx, track.vy) == pytest.approx((-1.0, 0.0), abs=0.15)
    assert given[-1] == navigator.tracks
    navigator.reset()
    assert navigator.tracks == ()


def test_a_navigator_may_track_nothing():
    navigator = Navigator(None, ROBOT, tracking=False)
    navigator.set_goal(GOAL)
    with simulate(room(), ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
    assert navigator.tracks == ()
    with pytest.raises(InputError, match="tracking"):
        Navigator(None, ROBOT, tracking=True)


def test_a_robot_that_is_held_back_for_a_while_is_not_stuck():
    navigator = Navigator(None, ROBOT, settings=NavigatorSettings(movement_time_allowance=1.0))
    navigator.set_goal(GOAL)
    with simulate(room(), ROBOT, backend="kinematic", lidar=True) as sim:
        state = sim.reset(START)
        for _ in range(60):
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            if command != Twist2D():
                navigator.set_sent_command(Twist2D())
            state = sim.step(Twist2D(), navigator.dt)
            assert navigator.status is not NavigationStatus.STUCK


# Scans that are made up -----------------------------------------------------------------------------------------------


def scan_ahead(distance, time=0.0, lidar="front"):
    angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
    mount = ROBOT.lidars["front"]
    ranges = np.where(np.abs(angles - math.pi) % (2 * math.pi) < 0.2, distance, np.inf)
    return Scan(lidar, time, Pose2D(mount.x, mount.y, mount.yaw), mount.z, angles, ranges, 0.05, 30.0)


def open_floor(**options):
    navigator = Navigator(OccupancyGrid(np.zeros((120, 200), np.int8), 0.05), ROBOT, **options)
    navigator.set_goal(8.5, 3.0)
    return navigator


def look(navigator, time, pose=START, scans=None):
    navigator.update(pose, Twist2D(), time=time, scans=[scan_ahead(3.0, time)] if scans is None else scans)


def test_scans_can_be_left_out():
    navigator = open_floor(layers=False)
    before = navigator.costmap
    for tick in range(5):
        look(navigator, tick * 0.05)
    assert navigator.costmap is before


def test_reset_forgets_what_was_sensed_and_keeps_the_map():
    navigator = open_floor()
    before = navigator.costmap
    for tick in range(5):
        look(navigator, tick * 0.05)
    assert navigator.costmap is not before
    navigator.reset()
    assert navigator.costmap is before


def test_a_costmap_that_is_put_there_stays_under_what_is_sensed():
    navigator = open_floor()
    for tick in range(5):
        look(navigator, tick * 0.05)
    changed = navigator.costmap.update(slice(100, 110), slice(100, 110), 100)
    navigator.static_costmap = changed
    look(navigator, 0.25)
    assert (navigator.costmap.data[100:110, 100:110] == 254).all()
    navigator.reset()
    assert navigator.costmap is changed


def test_a_pose_that_jumps_is_planned_from_again():
    navigator = open_floor()
    for tick in range(5):
        look(navigator, tick * 0.05)
    before = navigator.path
    with pytest.warns(SensorWarning):
        look(navigator, 0.25, pose=Pose2D(6.5, 0.5))
    assert navigator.message == "the pose jumped by 5.6 m: planning a new path"
    assert navigator.path is not before
    assert navigator.path.start.distance_to(Pose2D(6.5, 0.5)) < 0.3
    assert navigator.status is not NavigationStatus.STUCK


@pytest.mark.parametrize(("correction_m", "plans_again"), [(0.1, False), (0.3, False), (0.7, True)])
def test_a_localizer_that_corrects_the_pose_by_half_a_metre_is_planned_from_again(correction_m, plans_again):
    navigator = open_floor()
    shift = Pose2D(0.0, 0.0)
    for tick in range(8):
        if tick == 5:
            before, shift = navigator.path, Pose2D(0.0, correction_m)
        observation = Observation(tick * 0.05, Twist2D(), START, (scan_ahead(3.0, tick * 0.05),))
        navigator.update(observation, Estimate(tick * 0.05, shift @ START, None, shift))
    assert (navigator.path is not before) == plans_again
    if plans_again:
        assert navigator.path.start.distance_to(shift @ START) < 0.3


def test_an_odometry_that_starts_over_is_no_jump_of_the_pose():
    navigator = open_floor()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SensorWarning)  # the layer and the tracker say that the odometry jumped
        for tick in range(8):
            odometry = START if tick < 5 else Pose2D(0.0, 0.0)
            if tick == 5:
                before = navigator.path
            observation = Observation(tick * 0.05, Twist2D(), odometry, (scan_ahead(3.0, tick * 0.05),))
            navigator.update(observation, Estimate(tick * 0.05, START, None, START @ odometry.inverse()))
    assert navigator.path is before


def test_scans_of_one_time_wait_for_the_next():
    navigator = open_floor()
    look(navigator, 0.0)
    look(navigator, 0.05, scans=[])
    before = navigator.costmap
    look(navigator, 0.05)
    assert navigator.costmap is before
    look(navigator, 0.1, scans=[])
    assert (navigator.costmap.data == 254).any()


def test_a_time_that_goes_back_is_warned_about_and_a_new_goal_may_start_over():
    navigator = open_floor()
    for tick in range(20):
        look(navigator, 10.0 + tick * 0.05)
    with pytest.warns(SensorWarning, match="the time went back"):
        look(navigator, 5.0)
    navigator.set_goal(8.5, 3.0)
    look(navigator, 0.0)
    look(navigator, 0.05)


def test_scans_of_another_kind_are_refused():
    navigator = open_floor()
    with pytest.raises(InputError):
        navigator.update(START, Twist2D(), time=0.0, scans=[1.0])
    with pytest.raises(InputError):
        Navigator(None, ROBOT, layers="obstacle")
    with pytest.raises(InputError, match="keep-out"):
        Navigator(None, ROBOT, keepout="zones.yaml")


def test_without_a_map_unknown_space_is_driven_as_the_settings_say():
    navigator = Navigator(None, ROBOT, costmap=CostmapSettings(unknown="free"), layers=LayersSettings(width=20.0))
    navigator.set_goal(30.0, -3.0)
    path = navigator.plan((0.0, 0.0, 0.0))
    assert path.goal.distance_to(Pose2D(30.0, -3.0)) < 0.1
    assert navigator.costmap.unknown == "free"
    assert isinstance(navigator.costmap, Costmap)


def test_an_observation_needs_an_estimate():
    navigator = open_floor()
    with pytest.raises(InputError):
        navigator.update(Observation(0.0, Twist2D(), START, ()))


# The static costmap ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("layers", [None, LayersSettings(rolling_window=True, width=9.0, height=5.0)])
def test_what_was_seen_stays_as_the_static_costmap_is_replaced_and_is_not_put_into_it(layers):
    navigator = open_floor(layers=layers)
    for tick in range(5):
        look(navigator, tick * 0.05)
    x, y = 4.47, 3.02
    cells = lambda costmap, x, y: costmap.data[costmap.world_to_cell(x, y)]  # noqa: E731
    seen = [x + 0.05 * k for k in range(-4, 5)]
    assert any(cells(navigator.costmap, each, y) == LETHAL for each in seen)
    navigator.static_costmap = navigator.static_costmap.update(slice(80, 84), slice(60, 64), 100)
    for tick in (5, 6):
        assert cells(navigator.costmap, 3.1, 4.1) == LETHAL
        assert any(cells(navigator.costmap, each, y) == LETHAL for each in seen)
        look(navigator, tick * 0.05)
    navigator.clear_obstacles()
    assert cells(navigator.costmap, 3.1, 4.1) == LETHAL
    assert not any(cells(navigator.costmap, each, y) == LETHAL for each in seen)


def test_the_costmap_that_it_drives_on_cannot_be_replaced():
    navigator = open_floor()
    with pytest.raises(InputError, match="static_costmap"):
        navigator.costmap = navigator.costmap.update(slice(0, 5), slice(0, 5), 100)


@pytest.mark.parametrize("given", [None, "map.yaml", np.zeros((3, 3))])
def test_a_static_costmap_that_is_none_is_refused(given):
    navigator = open_floor()
    with pytest.raises(InputError, match="static costmap"):
        navigator.static_costmap = given


def test_a_static_costmap_with_other_cells_is_taken_without_what_was_seen():
    navigator = open_floor()
    for tick in range(5):
        look(navigator, tick * 0.05)
    coarse = CostmapSettings().make_costmap(OccupancyGrid(np.zeros((70, 110), np.int8), 0.1), ROBOT)
    navigator.static_costmap = coarse
    assert navigator.costmap is coarse
    look(navigator, 0.3)
    assert navigator.costmap.shape == (70, 110)


def test_without_a_map_there_is_no_static_costmap_until_one_is_given():
    navigator = Navigator(None, ROBOT)
    navigator.set_goal(8.5, 3.0)
    for tick in range(5):
        look(navigator, tick * 0.05)
    assert navigator.static_costmap is None
    static = CostmapSettings().make_costmap(OccupancyGrid(np.zeros((120, 200), np.int8), 0.05), ROBOT)
    navigator.static_costmap = static
    assert (navigator.static_costmap is static, navigator.has_map) == (True, True)
    assert navigator.costmap.shape == (120, 200)
    assert (navigator.costmap.data == LETHAL).any()


def see_wall(navigator, time, pose, box=False):
    """Stand before a wall across the room, 2 m ahead, and perhaps see a box beside the robot."""
    angles = np.linspace(-1.5, 1.5, 301)
    ranges = np.minimum(2.0 / np.maximum(np.cos(angles), 1e-3), 20.0)
    if box:
        angles, ranges = np.append(angles, 1.7 + np.linspace(0.0, 0.2, 21)), np.append(ranges, np.full(21, 1.5))
    scan = Scan("front", time, Pose2D(0.0, 0.0), ROBOT.lidars["front"].z, angles, ranges, 0.1, 25.0)
    look(navigator, time, pose, [scan])


def test_what_was_seen_elsewhere_is_forgotten_in_each_stop_nearer_to_the_goal():
    navigator = open_floor(settings=NavigatorSettings(patience_s=3.0))
    kept = []
    for number, pose in enumerate((START, Pose2D(START.x + 2.0, START.y))):
        row, col = navigator.costmap.world_to_cell(pose.x + 1.5 * math.cos(1.8), pose.y + 1.5 * math.sin(1.8))
        kept.append([])
        for tick in range(140):
            see_wall(navigator, 10.0 * number + tick * 0.05, pose, box=tick < 5)
            area = navigator.costmap.data[row - 3 : row + 4, col - 3 : col + 4]
            kept[-1].append(bool((area == LETHAL).any()))
    assert [stop[10] for stop in kept] == [True, True]
    assert [stop[-1] for stop in kept] == [False, False]
