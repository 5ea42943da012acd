"""What holds for a tracker in any scene: Hypothesis draws scenes, motions of the robot and noise."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from support.scan_scenes import scan_scene
from trundle.errors import SensorWarning
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.tracking import Tracker

CARTER = Robot.load("nova_carter")
DT = 0.05
ROOM = [(-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6)]
STANDING = Pose2D(0.0, 0.0)
FRONT, BACK = (("front", (0.026, 0.0, math.pi)), ("back", (-0.4894, 0.0, 0.0)))

speeds = st.floats(-CARTER.limits.linear_speed, CARTER.limits.linear_speed)
turns = st.floats(-CARTER.limits.angular_speed, CARTER.limits.angular_speed)
headings = st.floats(-math.pi, math.pi)


@st.composite
def posts(draw):
    """Something round that stands where the robot does not come, 6 cm wide or more."""
    distance, bearing = draw(st.floats(2.8, 5.4)), draw(headings)
    return (distance * math.cos(bearing), distance * math.sin(bearing), draw(st.floats(0.03, 0.5)))


@st.composite
def boxes(draw):
    """The four sides of a box, 0.1 to 2 m."""
    distance, bearing, yaw = draw(st.floats(3.2, 4.5)), draw(headings), draw(headings)
    length, width = draw(st.floats(0.2, 2.0)), draw(st.floats(0.1, 0.6))
    pose = Pose2D(distance * math.cos(bearing), distance * math.sin(bearing), yaw)
    corners = pose.transform_points(np.array([(0, 0), (length, 0), (length, width), (0, width)])).tolist()
    return [(*corners[side - 1], *corners[side]) for side in range(4)]


@st.composite
def movers(draw):
    """A disc (x, y, vx, vy, radius) of constant velocity: where it is after half a second."""
    distance, bearing = draw(st.floats(2.0, 4.0)), draw(headings)
    speed, heading = draw(st.floats(0.5, 2.0)), draw(headings)
    x, y = distance * math.cos(bearing), distance * math.sin(bearing)
    return (x, y, speed * math.cos(heading), speed * math.sin(heading), draw(st.floats(0.15, 0.5)))


def place(mover, time):
    x, y, vx, vy, radius = mover
    return (x + (time - 0.5) * vx, y + (time - 0.5) * vy, radius)


def scans_at(time, mover, seed=0, base=(0.0, 0.0, 0.0)):
    """One scan of each lidar."""
    return [
        scan_scene([place(mover, time)], ROOM, base=base, mount=mount, time=time, name=name, noise=0.01, seed=seed)
        for name, mount in (FRONT, BACK)
    ]


def told(tracks):
    """All that tracks say, to be compared."""
    return [
        (track.id, track.x, track.y, track.vx, track.vy, track.radius, track.confirmed, track.covariance.tolist())
        for track in tracks
    ]


@settings(max_examples=25)
@given(
    discs=st.lists(posts(), max_size=5),
    standing=st.lists(boxes(), max_size=3),
    twists=st.lists(st.tuples(speeds, turns), min_size=2, max_size=2),
    noise=st.sampled_from([0.0, 0.005, 0.01]),
    seed=st.integers(0, 1000),
)
def test_what_stands_has_no_confirmed_tracks_however_the_robot_drives(discs, standing, twists, noise, seed):
    tracker, base = Tracker(CARTER), (0.0, 0.0, 0.0)
    segments = [side for box in standing for side in box]
    for tick in range(40):
        time, (v, w) = tick * DT, twists[tick // 20]
        scan = scan_scene(discs, [*ROOM, *segments], base=base, time=time, noise=noise, seed=seed)
        tracks = tracker.update([scan], time, Pose2D(*base))
        assert not [track for track in tracks if track.confirmed]
        yaw = base[2] + 0.5 * w * DT
        base = (base[0] + v * DT * math.cos(yaw), base[1] + v * DT * math.sin(yaw), base[2] + w * DT)


@settings(max_examples=25)
@given(mover=movers(), turn=turns, seed=st.integers(0, 1000))
def test_a_disc_in_sight_is_confirmed_within_half_a_second_and_its_speed_is_right(mover, turn, seed):
    path = [place(mover, tick * DT) for tick in range(21)]
    assume(all(math.hypot(x, y) > radius + 1.0 and max(abs(x), abs(y)) < 5.9 - radius for x, y, radius in path))
    tracker = Tracker(CARTER)
    for tick in range(21):
        time, base = tick * DT, (0.0, 0.0, turn * tick * DT)
        tracks = tracker.update(scans_at(time, mover, seed, base), time, Pose2D(*base))
        if tick == 10:
            near = [track for track in tracks if track.confirmed]
            assert min((math.dist((track.x, track.y), path[10][:2]) for track in near), default=math.inf) < 0.5
    (track,) = [track for track in tracker.tracks if track.moving]
    assert math.hypot(track.vx - mover[2], track.vy - mover[3]) < 0.3
    assert math.dist((track.x, track.y), path[20][:2]) < 0.2


@settings(max_examples=8)
@given(mover=movers(), swapped=st.lists(st.booleans(), min_size=12, max_size=12), seed=st.integers(0, 1000))
@example(mover=(2.5, 0.0, 0.0, 1.0, 0.3), swapped=[True] * 12, seed=0)
def test_the_order_of_the_lidars_makes_no_difference_and_runs_repeat(mover, swapped, seed):
    one, same, other = Tracker(CARTER), Tracker(CARTER), Tracker(CARTER)
    for tick, swaps in enumerate(swapped):
        time = tick * DT
        scans = scans_at(time, mover, seed)
        tracks = told(one.update(scans, time, STANDING))
        assert told(same.update(scans, time, STANDING)) == tracks
        assert told(other.update(scans[::-1] if swaps else scans, time, STANDING)) == tracks


@settings(max_examples=8)
@given(mover=movers(), repeated=st.integers(0, 10), seed=st.integers(0, 1000))
def test_a_scan_that_comes_twice_is_left_out(mover, repeated, seed):
    one, other = Tracker(CARTER), Tracker(CARTER)
    for tick in range(12):
        time = tick * DT
        scans = scans_at(time, mover, seed)
        one.update(scans, time, STANDING)
        other.update(scans, time, STANDING)
        if tick == repeated:
            with pytest.warns(SensorWarning, match="has already been used"):
                other.update(scans, time, STANDING)
    assert told(one.tracks) == told(other.tracks)


@settings(max_examples=8)
@given(mover=movers(), back_s=st.floats(0.01, 20.0), seed=st.integers(0, 1000))
def test_after_the_time_went_back_it_is_as_new(mover, back_s, seed):
    used, new = Tracker(CARTER), Tracker(CARTER)
    for tick in range(12):
        used.update(scans_at(back_s + tick * DT, mover, seed + 1), back_s + 11 * DT + tick * DT, STANDING)
    for tick in range(12):
        time = tick * DT
        scans = scans_at(time, mover, seed)
        with warnings.catch_warnings():
            warnings.simplefilter("error" if tick else "ignore", SensorWarning)
            tracks = used.update(scans, time, STANDING)
        assert told(tracks) == told(new.update(scans, time, STANDING))
