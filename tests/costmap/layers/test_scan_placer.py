"""Scans are placed once for all that use them: where their sensor was, and without what single beams see."""

import math

import numpy as np
import pytest

from trundle import _core
from trundle.costmap import LayeredCostmap, ObstacleLayer
from trundle.costmap.layers import ScanPlacer
from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D
from trundle.navigation import Navigator
from trundle.observation import Estimate, Scan
from trundle.robots import Robot
from trundle.tracking import Tracker, TrackerSettings

CARTER = Robot.load("nova_carter")
ANGLES = np.linspace(-math.pi, math.pi, 720, endpoint=False)
MOUNT = Pose2D(0.1, 0.0, math.pi / 2.0)


def scan(time, *, lidar="front", increment=0.0, **beams):
    ranges = np.full(720, 5.0)
    for beam, value in beams.items():
        ranges[int(beam[1:])] = value
    return Scan(lidar, time, MOUNT, 0.4, ANGLES, ranges, 0.1, 12.0, increment)


def moving_at(time):
    return Estimate(time, Pose2D(0.5 * time, 0.3 * time, 0.1 * time))


def test_a_scan_is_where_its_sensor_was_at_its_own_time():
    placer = ScanPlacer(CARTER, 1.0)
    placer.place([], moving_at(0.0))
    placed = placer.place([scan(0.05)], moving_at(0.1))
    (one,) = placed.scans
    sensor = moving_at(0.05).pose @ MOUNT
    assert one.poses.shape == (1, 3)
    assert one.poses[0] == pytest.approx(sensor.as_tuple())
    assert (placed.odom_pose, len(placed.arrived)) == (moving_at(0.1).pose, 1)


def test_beams_that_are_measured_one_after_the_other_have_a_pose_each():
    placer = ScanPlacer(CARTER, 1.0)
    placer.place([], moving_at(0.0))
    (one,) = placer.place([scan(0.0, increment=0.1 / 719)], moving_at(0.1)).scans
    assert one.poses.shape == (720, 3)
    assert one.poses[-1] == pytest.approx((moving_at(0.1).pose @ MOUNT).as_tuple(), abs=1e-9)


def test_a_lone_hit_is_no_measurement_and_the_scan_itself_stays():
    placer = ScanPlacer(CARTER, 1.0)
    (first,) = placer.place([scan(0.0, b100=2.0)], Estimate(0.0, Pose2D(0.0, 0.0))).scans
    assert math.isnan(first.ranges[100])
    assert first.scan.ranges[100] == 2.0
    (again,) = placer.place([scan(0.1, b100=2.0)], Estimate(0.1, Pose2D(0.0, 0.0))).scans
    assert again.ranges[100] == 2.0  # seen before at the same place
    (beside,) = placer.place([scan(0.2, b300=2.0)], Estimate(0.2, Pose2D(0.0, 0.0))).scans
    assert math.isnan(beside.ranges[300])


def test_scans_that_cannot_be_used_are_counted_and_have_arrived():
    placer = ScanPlacer(CARTER, 0.5, warn=False)
    placer.place([], moving_at(0.0))
    given = [scan(0.1), scan(0.9), scan(0.9), scan(2.0), scan(0.9, lidar="top")]
    placed = placer.place(given, moving_at(1.0))
    assert [one.scan for one in placed.scans] == [given[1]]
    assert len(placed.arrived) == 5
    assert placer.counts == {"stale": 1, "out of order": 1, "future": 1, "unknown lidar": 1}


@pytest.mark.parametrize("happens", ["a jump", "a time before"])
def test_the_frame_changes_where_what_was_before_is_of_no_more_use(happens):
    placer = ScanPlacer(CARTER, 1.0, warn=False)
    frames = [placer.place([], moving_at(time)).frame for time in (1.0, 1.05, 1.1)]
    assert len(set(frames)) == 1
    then = Estimate(1.15, Pose2D(50.0, 0.0)) if happens == "a jump" else moving_at(0.5)
    assert placer.place([], then).frame != frames[0]


def test_two_users_find_what_each_of_them_finds_alone():
    rng = np.random.default_rng(0)
    placer, layer, tracker = ScanPlacer(CARTER, 1.0), ObstacleLayer(CARTER), Tracker(CARTER)
    own_layer, own_tracker = ObstacleLayer(CARTER), Tracker(CARTER)
    for tick in range(40):
        time = 0.05 * tick
        beams = {f"b{int(first) + i}": 3.0 - 0.02 * tick for first in (200, 500) for i in range(20)}
        dust = {f"b{int(beam)}": 1.5 for beam in rng.integers(0, 180, 3)}
        scans = (scan(time, **beams, **dust), scan(time, lidar="back", **dust))
        placed = placer.place(scans, moving_at(time))
        assert layer.take(placed) == own_layer.update(scans, moving_at(time))
        assert repr(tracker.take(placed)) == repr(own_tracker.update(scans, time, moving_at(time).pose))
    assert np.array_equal(layer.obstacles(), own_layer.obstacles())


def test_a_navigator_looks_for_lone_hits_once_for_each_scan(monkeypatch):
    calls, find = [], _core.find_lone_hits
    monkeypatch.setattr(_core, "find_lone_hits", lambda *arguments: calls.append(1) or find(*arguments))
    navigator = Navigator(None, CARTER)
    for tick in range(10):
        time = 0.05 * tick
        navigator.update(moving_at(time).pose, time=time, scans=[scan(time), scan(time, lidar="back")])
    assert len(calls) == 20


def test_each_user_leaves_out_what_is_too_old_for_it():
    placer = ScanPlacer(CARTER, 1.0)
    tracker = Tracker(CARTER, TrackerSettings(source_timeout=0.1))
    tracker.take(placer.place([], moving_at(0.0)))
    with pytest.warns(SensorWarning, match="is left out: it is"):
        tracker.take(placer.place([scan(0.1)], moving_at(0.5)))


def test_a_costmap_takes_no_time_twice():
    placer, layered = ScanPlacer(CARTER, 1.0), LayeredCostmap(None, CARTER)
    layered.take(placer.place([scan(0.0)], moving_at(0.0)), np.zeros((0, 3)))
    with pytest.raises(InputError, match="times must increase"):
        layered.take(placer.place([scan(0.01)], moving_at(0.0)), np.zeros((0, 3)))


def test_what_is_no_estimate_or_no_scan_is_refused():
    placer = ScanPlacer(CARTER, 1.0)
    with pytest.raises(InputError, match="estimate"):
        placer.place([], Pose2D(0.0, 0.0))
    with pytest.raises(InputError, match="scan"):
        placer.place([Pose2D(0.0, 0.0)], moving_at(0.0))
