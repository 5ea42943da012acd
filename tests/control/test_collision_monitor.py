"""The monitor on scans that are computed here, and behind a simulator."""

import math
from dataclasses import replace

import numpy as np
import pytest

from support.scan_scenes import scan_scene
from trundle.control import CollisionMonitor, MonitorSettings
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Scan
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
FRONT = CARTER.outline[:, 0].max()
DT = 0.05


def scan_of(*segments, reach=12.0, **scene):
    """What a lidar at base_link sees of line segments (x0, y0, x1, y1) in the odom frame."""
    return scan_scene((), segments, reach=reach, **scene)


def wall_ahead(distance):
    """A wall so far in front of the robot's front edge [m]."""
    x = FRONT + distance
    return (x, -2.0, x, 2.0)


def box(x, y, half=0.2):
    corners = [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]
    return [(*a, *b) for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]


def check(command, *segments, settings=None, twist=None):
    monitor = CollisionMonitor(CARTER, settings)
    return monitor.check(command, twist or command, [scan_of(*segments)], 0.0, Pose2D(0, 0))


def test_a_command_into_the_open_passes():
    report = check(Twist2D(0.8, 0.2), wall_ahead(5.0))
    assert (report.action, report.command, report.time_to_contact) == ("none", Twist2D(0.8, 0.2), math.inf)


def test_it_approaches_by_the_time_to_contact():
    report = check(Twist2D(0.8, 0.2), wall_ahead(0.6))
    assert report.action == "approach"
    assert report.source == "front"
    assert report.point[0] == pytest.approx(FRONT + 0.6, abs=0.05)
    share = report.time_to_contact / 1.2
    assert 0.0 < share < 1.0
    assert (report.command.v, report.command.w) == pytest.approx((0.8 * share, 0.2 * share))


def test_it_stops_where_braking_would_end_in_the_stop_polygon():
    report = check(Twist2D(0.8, 0.0), wall_ahead(0.1))
    assert (report.action, report.command) == ("stop", Twist2D())


def test_it_slows_down_in_the_slowdown_polygon():
    settings = MonitorSettings(slowdown_padding=0.3, time_before_collision=0.0, slowdown_ratio=0.4)
    report = check(Twist2D(0.2, 0.1), wall_ahead(0.2), settings=settings)
    assert report.action == "slow"
    assert (report.command.v, report.command.w) == pytest.approx((0.08, 0.04))


@pytest.mark.parametrize("distance", [0.005, 0.015])
def test_it_lets_the_robot_drive_away_from_what_it_nearly_touches(distance):
    away = check(Twist2D(-0.3, 0.0), wall_ahead(distance))
    assert (away.action, away.command) == ("none", Twist2D(-0.3, 0.0))
    assert check(Twist2D(0.1, 0.0), wall_ahead(distance)).action == "stop"


def test_it_lets_the_robot_drive_along_a_wall_close_by():
    y = CARTER.outline[:, 1].max() + 0.01
    report = check(Twist2D(0.5, 0.0), (-3.0, y, 4.0, y))
    assert report.action == "none"


def test_it_does_not_creep_into_what_it_approaches():
    slow = Twist2D(0.1, 0.0)
    near = check(slow, wall_ahead(0.05))
    assert near.action == "approach"
    assert 0.02 <= near.command.v < 0.1
    assert check(slow, wall_ahead(0.021)).command == Twist2D()


def test_fewer_points_than_min_points_are_nothing():
    angles = np.array([-0.1, 0.0, 0.1, 1.0])
    two = Scan("front", 0.0, Pose2D(0, 0), 0.4, angles, np.array([9.0, 0.3, 0.3, 9.0]), 0.0, 12.0)
    monitor = CollisionMonitor(CARTER, MonitorSettings(min_points=3))
    assert monitor.check(Twist2D(0.5, 0.0), Twist2D(), [two], 0.0, Pose2D(0, 0)).action == "none"
    monitor = CollisionMonitor(CARTER, MonitorSettings(min_points=2))
    assert monitor.check(Twist2D(0.5, 0.0), Twist2D(), [two], 0.0, Pose2D(0, 0)).action != "none"


def with_dust(scan, rng, share=0.01, noise=0.0):
    """The scan with noise [m], and a share of its beams returned too soon."""
    ranges = np.maximum(scan.ranges + rng.normal(0.0, noise, len(scan.ranges)), 0.0) if noise else scan.ranges.copy()
    early = np.flatnonzero(rng.random(len(ranges)) < share)
    ranges[early] = rng.uniform(0.0, np.minimum(ranges[early], scan.range_max))
    return replace(scan, ranges=ranges)


def test_three_single_beams_that_are_returned_too_soon_are_nothing():
    scan = scan_of(wall_ahead(5.0))
    ranges = scan.ranges.copy()
    ranges[[354, 360, 366]] = FRONT + 0.1
    monitor, command = CollisionMonitor(CARTER), Twist2D(0.8, 0.0)
    assert monitor.check(command, command, [replace(scan, ranges=ranges)], 0.0, Pose2D(0, 0)).action == "none"


def test_dust_and_noise_neither_stop_the_robot_nor_make_walls_move():
    rng = np.random.default_rng(0)
    walls = [(-4.0, -1.2, 30.0, -1.2), (-4.0, 1.2, 30.0, 1.2), *box(6.0, 0.95), *box(11.0, -0.95), *box(16.0, 0.95)]
    monitor, command = CollisionMonitor(CARTER), Twist2D(0.8, 0.0)
    actions = set()
    for step in range(400):
        time, x = step * DT, 0.8 * step * DT
        scan = with_dust(scan_of(*walls, base=(x, 0.0, 0.0), time=time), rng, noise=0.02)
        actions.add(monitor.check(command, command, [scan], time, Pose2D(x, 0)).action)
    assert actions == {"none"}


def test_a_pole_that_one_beam_meets_counts_from_its_second_scan_on():
    monitor, command = CollisionMonitor(CARTER, MonitorSettings(min_points=1)), Twist2D(0.8, 0.0)
    actions = []
    for step in range(4):
        x = 0.8 * step * DT
        scan = scan_scene([(FRONT + 0.6, 0.0, 0.025)], beams=90, base=(x, 0.0, 0.0), time=step * DT)
        assert np.isfinite(scan.ranges).sum() == 1
        actions.append(monitor.check(command, command, [scan], step * DT, Pose2D(x, 0)).action)
    assert actions == ["none", "approach", "approach", "approach"]


@pytest.mark.parametrize("beams", [360, 720])
def test_it_never_drives_into_a_thin_pole_among_dust_and_noise(beams):
    rng = np.random.default_rng(beams)
    monitor, x, twist = CollisionMonitor(CARTER), 0.0, Twist2D()
    pole = FRONT + 2.0
    for step in range(120):
        scan = scan_scene([(pole, 0.01, 0.025)], [wall_ahead(6.0)], beams=beams, base=(x, 0.0, 0.0), time=step * DT)
        scan = with_dust(scan, rng, noise=0.02)
        twist = monitor.check(Twist2D(0.8, 0.0), twist, [scan], step * DT, Pose2D(x, 0)).command
        x += twist.v * DT
    assert 0.0 < pole - 0.025 - x - FRONT < 0.15


def test_points_on_the_robot_itself_are_its_body():
    body = [(-0.5, -0.2, 0.1, -0.2), (0.1, -0.2, 0.1, 0.2)]
    report = check(Twist2D(0.8, 0.3), *body)
    assert report.action == "none"


def test_a_silent_lidar_stops_the_robot_until_it_speaks_again():
    monitor = CollisionMonitor(CARTER, MonitorSettings(source_timeout=0.5))
    command = Twist2D(0.5, 0.0)
    assert monitor.check(command, command, [scan_of()], 0.0, Pose2D(0, 0)).action == "none"
    assert monitor.check(command, command, [], 0.5, Pose2D(0.2, 0)).action == "none"
    report = monitor.check(command, command, [], 0.6, Pose2D(0.3, 0))
    assert (report.action, report.source, report.point, report.command) == ("stop", "front", None, Twist2D())
    later = monitor.check(command, command, [scan_of(time=0.65)], 0.65, Pose2D(0.3, 0))
    assert later.action == "none"


def test_a_lidar_that_must_send_scans_and_never_did_stops_the_robot():
    monitor = CollisionMonitor(CARTER, MonitorSettings(sources=("back",)))
    for time in np.arange(0.0, 1.01, 0.25):
        scan = scan_of(time=float(time))
        assert monitor.check(Twist2D(0.5, 0), Twist2D(), [scan], float(time), Pose2D(0, 0)).action == "none"
    report = monitor.check(Twist2D(0.5, 0), Twist2D(), [scan_of(time=1.1)], 1.1, Pose2D(0, 0))
    assert (report.action, report.source) == ("stop", "back")


def test_no_scan_at_all_stops_the_robot():
    monitor = CollisionMonitor(CARTER)
    assert monitor.check(Twist2D(0.5, 0), Twist2D(), [], 3.0, Pose2D(0, 0)).action == "none"
    report = monitor.check(Twist2D(0.5, 0), Twist2D(), [], 4.1, Pose2D(0, 0))
    assert (report.action, report.source) == ("stop", None)


def test_a_scan_is_moved_by_what_the_robot_has_driven_since():
    monitor = CollisionMonitor(CARTER)
    command = Twist2D(0.8, 0.0)
    first = monitor.check(command, command, [scan_of(wall_ahead(2.0))], 0.0, Pose2D(5, 5, 1.0))
    assert first.action == "none"
    driven = Pose2D(5, 5, 1.0) @ Pose2D(1.5, 0.0)
    report = monitor.check(command, command, [], 0.5, driven)
    assert report.action == "approach"
    assert report.point[0] == pytest.approx(FRONT + 0.5, abs=0.05)


def watch_mover(start, velocity, *, command, seconds=1.0, settings=None):
    """Reports of a standing robot that is about to send `command`, while a box moves."""
    monitor = CollisionMonitor(CARTER, settings)
    reports = []
    for tick in range(round(seconds / DT)):
        time = tick * DT
        x, y = start[0] + velocity[0] * time, start[1] + velocity[1] * time
        scan = scan_of(*box(x, y), (8.0, -5.0, 8.0, 5.0), time=time)
        reports.append(monitor.check(command, Twist2D(), [scan], time, Pose2D(0, 0)))
    return reports


def test_what_comes_towards_the_robot_counts_with_its_speed():
    alone = MonitorSettings(moving_padding=0.0)
    standing = watch_mover((2.3, 0.0), (0.0, 0.0), command=Twist2D(0.5, 0.0), settings=alone)
    assert {report.action for report in standing} == {"none"}
    coming = watch_mover((3.2, 0.0), (-1.2, 0.0), command=Twist2D(0.5, 0.0), settings=alone)
    gap = 3.2 - 1.2 * 0.95 - 0.2 - FRONT
    assert coming[-1].action == "approach"
    assert coming[-1].time_to_contact == pytest.approx(gap / 1.7, abs=0.06)


def test_after_a_scan_without_beams_the_next_ones_are_taken():
    monitor = CollisionMonitor(CARTER)
    for time in (0.0, 0.3):
        full = scan_of(wall_ahead(2.0), time=time)
        scan = full if time else Scan(full.lidar, 0.0, full.mount, 0.4, np.zeros(0), np.zeros(0), 0.0, 12.0)
        report = monitor.check(Twist2D(0.5, 0.0), Twist2D(0.5, 0.0), [scan], time, Pose2D(0.0, 0.0))
    assert report.action == "none"


def test_something_that_moves_close_by_stops_the_robot():
    beside = watch_mover((-1.0, 0.7), (0.6, 0.0), command=Twist2D(0.5, 0.0))
    assert beside[-1].action == "stop"
    assert beside[-1].command == Twist2D()
    farther = watch_mover((-1.0, 1.1), (0.6, 0.0), command=Twist2D(0.5, 0.0))
    assert farther[-1].action == "none"
    still = watch_mover((-0.4, 0.7), (0.0, 0.0), command=Twist2D(0.5, 0.0))
    assert still[-1].action == "none"


@pytest.mark.parametrize(("hold", "held_s"), [(0.5, 0.5), (0.0, 0.0)])
def test_it_stands_on_for_a_while_after_what_moved_close_by(hold, held_s):
    stops = [k for k, report in enumerate(stopping_box(MonitorSettings(moving_hold=hold))) if report.action == "stop"]
    without = [k for k, report in enumerate(stopping_box(MonitorSettings(moving_hold=0.0))) if report.action == "stop"]
    assert (stops[-1] - without[-1]) * DT == pytest.approx(held_s, abs=0.051)
    assert stops[-1] < 49


def stopping_box(settings):
    """Reports while a box passes along the robot's side, and stops there after a second."""
    monitor = CollisionMonitor(CARTER, settings)
    for tick in range(50):
        time = tick * DT
        scan = scan_of(*box(-1.0 + 0.6 * min(time, 1.0), 0.7), (8.0, -5.0, 8.0, 5.0), time=time)
        yield monitor.check(Twist2D(0.5, 0.0), Twist2D(), [scan], time, Pose2D(0, 0))


def test_the_robot_may_drive_away_from_something_that_moves_close_by():
    behind = watch_mover((-1.7, 0.0), (0.6, 0.0), command=Twist2D(0.8, 0.0))
    assert behind[-1].action == "none"
    towards = watch_mover((-1.7, 0.0), (0.6, 0.0), command=Twist2D(-0.3, 0.0))
    assert towards[-1].action == "stop"


def test_what_crosses_in_front_of_the_robot_is_waited_for():
    crossing = watch_mover((1.0, -2.2), (0.0, 1.2), command=Twist2D(0.7, 0.0))
    assert crossing[-1].time_to_contact < 1.2
    leaving = watch_mover((1.4, 0.3), (0.0, 1.2), command=Twist2D(0.7, 0.0))
    assert leaving[-1].action == "none"


def test_runs_do_not_share_what_they_saw():
    monitor = CollisionMonitor(CARTER)
    command = Twist2D(0.8, 0.0)
    assert monitor.check(command, command, [scan_of(wall_ahead(0.3), time=9.0)], 9.0, Pose2D(0, 0)).action != "none"
    monitor.reset()
    assert monitor.check(command, command, [], 0.0, Pose2D(0, 0)).action == "none"


def test_driving_into_a_wall_never_touches_it():
    x, speed, monitor = 0.0, 0.0, CollisionMonitor(CARTER)
    wall, rng = wall_ahead(1.5), np.random.default_rng(1)
    for tick in range(200):
        scan = scan_of(wall, time=tick * DT, base=(x, 0.0, 0.0))
        noisy = scan.ranges + rng.normal(0.0, 0.01, len(scan.ranges))
        scan = Scan("front", scan.time, scan.mount, 0.4, scan.angles, np.maximum(noisy, 0.0), 0.0, 12.0)
        command = monitor.check(Twist2D(0.8, 0.0), Twist2D(speed, 0.0), [scan], tick * DT, Pose2D(x, 0.0)).command
        for _ in range(10):
            speed = CARTER.limits.approach(Twist2D(speed, 0.0), command, DT / 10).v
            x += speed * DT / 10
    assert 1.4 < x < 1.5
    assert speed == 0.0


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_a_time_that_is_no_number_is_refused(time):
    with pytest.raises(InputError):
        CollisionMonitor(CARTER).check(Twist2D(), Twist2D(), [], time, Pose2D(0, 0))


def test_scans_of_a_wrong_time_are_left_out():
    monitor = CollisionMonitor(CARTER)
    command = Twist2D(0.5, 0.0)
    for time in (-1.0, 5.0):
        report = monitor.check(command, command, [scan_of(wall_ahead(0.1), time=time)], 0.0, Pose2D(0, 0))
        assert report.action == "none"


def test_bad_settings_are_refused():
    with pytest.raises(InputError, match="lacks"):
        CollisionMonitor(CARTER, MonitorSettings(sources=("roof",)))
    with pytest.raises(InputError):
        MonitorSettings(min_points=0)
    with pytest.raises(InputError):
        MonitorSettings(slowdown_ratio=1.5)
    with pytest.raises(InputError):
        CollisionMonitor("nova_carter")


def swinging(time):
    """A bar that turns about its far end, towards the robot's front right corner from the right."""
    angle = 1.2 * time
    return (FRONT - 0.3, -1.9, FRONT - 0.3 + 1.4 * math.cos(angle), -1.9 + 1.4 * math.sin(angle))


@pytest.mark.parametrize("command", [Twist2D(0.0, 0.5), Twist2D(0.3, 0.0)])
def test_it_stops_before_the_end_of_what_turns_on_the_spot(command):
    monitor = CollisionMonitor(CARTER)
    for tick in range(12):
        time = tick * DT
        report = monitor.check(command, Twist2D(), [scan_of(swinging(time), time=time)], time, Pose2D(0, 0))
    assert (report.action, report.command) == ("stop", Twist2D())


def test_it_lets_the_robot_escape_only_where_that_succeeds():
    def check_behind(speed, gap):
        monitor = CollisionMonitor(CARTER)
        for tick in range(12):
            time = tick * DT
            x = FRONT + gap + speed * (0.55 - time)
            scan, back = scan_of(*box(x + 0.2, 0.0), time=time), Twist2D(-0.6, 0.0)
            report = monitor.check(back, back, [scan], time, Pose2D(0, 0))
        return report.action

    assert check_behind(0.4, 0.3) == "none"
    assert check_behind(2.0, 0.3) == "stop"
