"""The localizer amcl, seen from outside: what it says of drives through small worlds."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest

from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.localization import create_localizer
from trundle.maps import OccupancyGrid
from trundle.observation import Observation, Scan
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.testing import check_localizer
from trundle.worlds import World

DT = 0.05
START = Pose2D(-2.0, -1.0, 0.4)


def box(name, size, at):
    return Solid(name, Box((*size, 2.0)), Pose3D((*at, 1.0)))


WALLS = (
    box("north", (8.4, 0.2), (0.0, 3.1)),
    box("south", (8.4, 0.2), (0.0, -3.1)),
    box("west", (0.2, 6.0), (-4.1, 0.0)),
    box("east", (0.2, 6.0), (4.1, 0.0)),
)
ROOM = World("room", (*WALLS, box("cupboard", (1.0, 0.6), (2.5, 2.6)), box("pillar", (0.5, 0.5), (-0.5, -2.0))))
SYMMETRIC = World("symmetric", (*WALLS, box("one", (0.6, 0.6), (1.5, 1.0)), box("two", (0.6, 0.6), (-1.5, -1.0))))


@pytest.fixture(scope="module")
def robot():
    loaded = Robot.load("nova_carter")
    lidars = {name: lidar.model_copy(update={"rate": 10.0, "noise": 0.02}) for name, lidar in loaded.lidars.items()}
    return loaded.model_copy(update={"lidars": lidars})


@pytest.fixture(scope="module")
def grid(robot):
    return OccupancyGrid.from_world(ROOM, resolution=0.05, z_range=robot.z_range)


def drive(world, robot, commands, *, start=START, carried=None):
    """True poses and observations; `carried` is (step, pose): the robot is put there, and its odometry is not told."""
    made = []
    with KinematicSimulator(world, robot, lidar=True) as sim:
        state = sim.reset(start, seed=2)
        for step, command in enumerate(commands):
            made.append((state.pose, state.observation))
            if carried is not None and step == carried[0]:
                sim.place(carried[1])
            state = sim.step(command, DT)
    return made


def with_errors(made, *, scale=0.0, heading=0.0):
    """The drive with an odometry that is wrong by a scale and a turn per metre [rad]."""
    out, odometry, last = [], Pose2D(5.0, 1.0, 1.0), made[0][1].odometry
    for truth, observation in made:
        step = last.inverse() @ observation.odometry
        last = observation.odometry
        odometry = odometry @ Pose2D(step.x * (1.0 + scale), step.y, step.yaw + heading * math.hypot(step.x, step.y))
        out.append((truth, replace(observation, odometry=odometry)))
    return out


ROUND = [Twist2D(0.4, 0.3)] * 400
TURNING = [Twist2D(0.0, 0.5)] * 400


@pytest.fixture(scope="module")
def lap(robot):
    return drive(ROOM, robot, ROUND)


def follow(localizer, made):
    return [(truth, localizer.update(observation)) for truth, observation in made]


def errors_of(found):
    return np.array([truth.distance_to(estimate.pose) for truth, estimate in found])


def test_it_passes_the_check_of_every_localizer():
    check_localizer("amcl")


def test_it_tracks_to_the_centimetre_with_an_odometry_of_one_percent(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    found = follow(localizer, with_errors(lap, scale=0.01, heading=math.radians(1.0)))
    assert np.percentile(errors_of(found), 95) < 0.02
    assert all(estimate.state == "localized" for _, estimate in found)


def test_gates_are_measured_from_the_last_scan_that_was_used(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot, update_min_d=0.25, update_min_a=0.2)
    localizer.reset(START, seed=1)
    assert errors_of(follow(localizer, with_errors(lap, scale=0.05, heading=math.radians(5.0))))[40:].max() < 0.15


@pytest.mark.parametrize("off", [Pose2D(0.7, -0.7, math.radians(20.0)), Pose2D(-1.0, 0.0, math.radians(-20.0))])
def test_it_corrects_a_start_that_is_off_by_a_metre(lap, robot, grid, off):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(Pose2D(START.x + off.x, START.y + off.y, START.yaw + off.yaw))
    found = follow(localizer, with_errors(lap, scale=-0.05, heading=math.radians(5.0)))
    assert np.percentile(errors_of(found)[40:], 95) < 0.03


def test_its_covariance_holds(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    inside = []
    for truth, estimate in follow(localizer, with_errors(lap, scale=0.05, heading=-0.08)):
        off = np.array((estimate.pose.x - truth.x, estimate.pose.y - truth.y))
        inside.append(off @ np.linalg.solve(estimate.covariance[:2, :2], off) < 5.991)
    assert np.mean(inside) > 0.85
    assert math.sqrt(estimate.covariance[0, 0]) < 0.05


def test_a_robot_that_is_carried_away_says_so_and_finds_itself(robot, grid):
    made = drive(ROOM, robot, [*ROUND[:100], *TURNING], carried=(100, Pose2D(2.5, -1.5, -2.0)))
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    found = follow(localizer, with_errors(made, scale=0.01))
    bad = [estimate.state for truth, estimate in found[140:] if truth.distance_to(estimate.pose) > 0.5]
    assert bad.count("localized") <= 0.1 * len(bad)
    assert errors_of(found)[300:].max() < 0.1  # ten seconds after
    assert found[-1][1].state == "localized"


def test_without_a_pose_it_searches_the_whole_map(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(None, seed=1)
    found = follow(localizer, lap)
    assert found[0][1].state != "localized"  # one scan never decides
    assert errors_of(found)[100:].max() < 0.05
    assert found[-1][1].state == "localized"


def test_on_a_symmetric_map_it_stays_ambiguous(robot):
    grid = OccupancyGrid.from_world(SYMMETRIC, resolution=0.05, z_range=robot.z_range)
    made = drive(SYMMETRIC, robot, [Twist2D(0.2, 0.4)] * 300, start=Pose2D(0.5, -1.0, 0.0))
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(None)
    found = follow(localizer, made)
    assert {estimate.state for _, estimate in found} == {"ambiguous"}
    truth, last = found[-1]
    best = sorted(last.hypotheses, key=lambda one: truth.distance_to(one.pose))
    mirrored = Pose2D(-truth.x, -truth.y, truth.yaw + math.pi)
    assert best[0].pose.distance_to(truth) < 0.05
    assert min(one.pose.distance_to(mirrored) for one in last.hypotheses) < 0.05
    assert sum(one.weight for one in last.hypotheses) <= 1.0 + 1e-9


def test_a_global_search_can_be_asked_for_at_any_time(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    follow(localizer, lap[:40])
    localizer.reinitialize_global()
    assert localizer.update(lap[40][1]).state != "localized"
    assert errors_of(follow(localizer, lap[41:]))[150:].max() < 0.05


def test_without_scans_it_follows_the_odometry_and_grows_uncertain(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    blind = [(truth, replace(observation, scans=())) for truth, observation in lap]
    with pytest.warns(SensorWarning, match="has got no scan"):
        found = follow(localizer, blind)
    sizes = [float(np.trace(estimate.covariance[:2, :2])) for _, estimate in found]
    assert errors_of(found).max() < 1e-6
    assert sizes[-1] > 4.0 * sizes[10]


def test_one_seed_gives_the_same_estimates_and_particles(lap, robot, grid):
    runs = []
    for seed in (4, 4, 5):
        localizer = create_localizer("amcl", grid, robot)
        localizer.reset(START, seed=seed)
        runs.append(follow(localizer, lap[:60]))
    one, same, other = (run[-1][1] for run in runs)
    assert one.pose == same.pose
    assert np.array_equal(one.particles, same.particles)
    assert not np.array_equal(one.particles[:50], other.particles[:50])
    assert one.particles.shape[1] == 4
    assert one.particles[:, 3].sum() == pytest.approx(1.0)
    assert not one.particles.flags.writeable


@pytest.mark.parametrize("resolution", [0.025, 0.1])
def test_maps_of_another_resolution_and_with_a_turned_origin_are_used(lap, robot, resolution):
    straight = OccupancyGrid.from_world(ROOM, resolution=resolution, z_range=robot.z_range)
    turned = replace(straight, origin=Pose2D(1.0, -2.0, 0.7) @ straight.origin)
    localizer = create_localizer("amcl", turned, robot)
    localizer.reset(Pose2D(1.0, -2.0, 0.7) @ START)
    off = [
        (Pose2D(1.0, -2.0, 0.7) @ truth).distance_to(localizer.update(observation).pose) for truth, observation in lap
    ]
    assert np.percentile(off, 95) < 0.5 * resolution + 0.01


def test_beams_measured_one_after_the_other_are_placed_by_odometry(robot, grid):
    """A scan that takes a tenth of a second, while the robot turns: each beam is seen from where it then was."""
    turn, seconds, beams = 1.5, 0.1, 360
    mount, angles = Pose2D(0.0, 0.0, 0.0), np.linspace(-math.pi, math.pi, 360, endpoint=False)
    lidar = next(iter(robot.lidars))
    from trundle._core import cast_grid_rays

    blocked = (grid.data >= 65).astype(np.uint8)
    origin = grid.origin
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(Pose2D(0.5, 0.5, 0.0))
    off = []
    for index in range(40):
        now = (index + 1) * seconds
        ranges = np.empty(beams)
        for k in range(beams):
            yaw = turn * (now - seconds + seconds * k / (beams - 1))
            at = ((0.5 - origin.x) / 0.05, (0.5 - origin.y) / 0.05)
            ranges[k] = 0.05 * cast_grid_rays(blocked, *at, np.array([yaw + angles[k]]), 400.0)[0]
        if index == 0:
            localizer.update(Observation(0.0, Twist2D(), Pose2D(0.0, 0.0, 0.0)))
        scan = Scan(lidar, now - seconds, mount, 0.4, angles, ranges, 0.05, 20.0, seconds / (beams - 1))
        estimate = localizer.update(Observation(now, Twist2D(0.0, turn), Pose2D(0.0, 0.0, turn * now), (scan,)))
        off.append(abs(math.remainder(estimate.pose.yaw - turn * now, 2.0 * math.pi)))
    assert max(off[5:]) < math.radians(1.0)


# Bad input ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (None, "needs a map, and the robot has none"),
        (np.full((40, 40), -1, np.int8), "no cell of this one is occupied"),
        (np.zeros((40, 40), np.int8), "no cell of this one is occupied"),
        (np.full((40, 40), 100, np.int8), "no cell of this one is free"),
    ],
)
def test_a_map_that_tells_nothing_is_refused(robot, cells, message):
    grid = None if cells is None else OccupancyGrid(cells, 0.05)
    with pytest.raises(InputError, match=message):
        create_localizer("amcl", grid, robot)


def test_a_start_outside_of_the_map_is_refused(robot, grid):
    with pytest.raises(InputError, match=r"the start \(40, 0\) lies outside of the map"):
        create_localizer("amcl", grid, robot).reset(Pose2D(40.0, 0.0))


def test_a_start_in_a_wall_is_one_warning(robot, grid):
    with pytest.warns(SensorWarning, match="lies in a wall"):
        create_localizer("amcl", grid, robot).reset(Pose2D(-0.5, -2.0))


@pytest.mark.parametrize("covariance", [np.diag((1.0, -1.0, 1.0)), np.eye(2), np.full((3, 3), np.nan), [[1, 2, 3]] * 3])
def test_a_covariance_that_is_none_is_refused(robot, grid, covariance):
    with pytest.raises(InputError, match="covariance"):
        create_localizer("amcl", grid, robot).reset(START, covariance=covariance)


def test_scans_without_a_usable_beam_are_one_warning(robot, grid):
    lidar = next(iter(robot.lidars))
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    values, angles = (math.nan, math.inf, -math.inf, math.nan), np.linspace(-3.0, 3.0, 50)
    scans = [
        Scan(lidar, 0.1 * step, Pose2D(0.0, 0.0), 0.4, angles, np.full(50, value), 0.05, 12.0)
        for step, value in enumerate(values)
    ]
    blind = [(START, Observation(scan.time, Twist2D(), Pose2D(0.0, 0.0), (scan,))) for scan in scans]
    with pytest.warns(SensorWarning, match="no beam") as caught:
        found = follow(localizer, blind)
    assert len(caught) == 1
    assert errors_of(found).max() < 1e-6


def test_times_that_repeat_or_go_back_are_refused_and_do_no_harm(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    follow(localizer, lap[:20])
    for index in (19, 3):
        with pytest.raises(InputError, match="times must increase"):
            localizer.update(lap[index][1])
    assert errors_of(follow(localizer, lap[20:])).max() < 0.05


def test_an_odometry_that_jumps_is_one_warning_and_is_bridged(lap, robot, grid):
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    follow(localizer, lap[:100])
    jumped = [(truth, replace(one, odometry=Pose2D(50.0, 0.0, 2.0) @ one.odometry)) for truth, one in lap[100:]]
    with pytest.warns(SensorWarning, match="the odometry jumped") as caught:
        found = follow(localizer, jumped)
    assert len(caught) == 1
    assert errors_of(found)[40:].max() < 0.05


@pytest.mark.parametrize(
    "options", [{"min_particles": 900, "max_particles": 100}, {"z_rand": 0.0}, {"alpha1": -1.0}, {"max_beam": 3}]
)
def test_settings_out_of_range_are_refused(robot, grid, options):
    with pytest.raises(InputError):
        create_localizer("amcl", grid, robot, **options)


def test_a_mirrored_lidar_is_noticed(lap, robot, grid):
    """A wrong mount, in a room that looks much the same in a mirror."""
    mirrored = [
        (truth, replace(one, scans=tuple(replace(scan, ranges=scan.ranges[::-1]) for scan in one.scans)))
        for truth, one in lap
    ]
    localizer = create_localizer("amcl", grid, robot)
    localizer.reset(START)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = follow(localizer, mirrored)
    assert {estimate.state for _, estimate in found} > {"localized"}
    assert all(np.isfinite(estimate.covariance).all() for _, estimate in found)
