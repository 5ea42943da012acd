"""The kernel against the tracker in NumPy, scene by scene; nonsense is in tests/fuzz."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.scan_scenes import scan_scene
from support.tracking_oracle import SlowTracker
from trundle._core import ScanTracker
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.tracking import Tracker, TrackerSettings

CARTER = Robot.load("nova_carter")
DT = 0.05
ROOM = [(-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6)]
LIDARS = (("front", (0.026, 0.0, math.pi)), ("back", (-0.4894, 0.0, 0.0)))
SETTINGS, BODY = (
    np.array([15.0, 3.0, 3.0, 0.07, 0.6, 0.2, 2.0, 0.8, 1.5]),
    np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]),
)
TURN = (np.ones(4), np.arange(4.0), np.zeros((1, 3)), np.array([0.0, 0.0, 0.0, 0.1, 9.0]))

walkers = st.lists(
    st.tuples(st.floats(2.0, 5.0), st.floats(-5.0, 5.0), *[st.floats(-2.0, 2.0)] * 2, st.floats(0.1, 0.6)),
    min_size=1,
    max_size=8,
)


def same(one, other):
    """Whether two lists of tracks agree; the kernel adds up in another order."""
    assert [(a.id, a.confirmed, a.moving) for a in one] == [(b.id, b.confirmed, b.moving) for b in other]
    for a, b in zip(one, other, strict=True):
        assert (a.x, a.y, a.vx, a.vy, a.radius) == pytest.approx((b.x, b.y, b.vx, b.vy, b.radius), abs=1e-9)
        assert np.allclose(a.covariance, b.covariance, rtol=0.0, atol=1e-9)


@settings(max_examples=15)
@given(
    movers=walkers,
    drive=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.5, 1.5)),
    fov=st.sampled_from([math.tau, 1.5 * math.pi, 2.0]),
    seed=st.integers(0, 1000),
)
def test_the_kernel_follows_as_numpy_does(movers, drive, fov, seed):
    fast, slow = Tracker(CARTER), SlowTracker(CARTER)
    followed = 0
    for tick in range(30):
        time = tick * DT
        base = (drive[0] * time, 0.0, drive[1] * time)
        discs = [(x + vx * time, y + vy * time, radius) for x, y, vx, vy, radius in movers]
        scans = [
            scan_scene(
                discs, ROOM, base=base, mount=mount, time=time, name=name, beams=360, noise=0.01, seed=seed, fov=fov
            )
            for name, mount in LIDARS
        ]
        tracks = fast.update(scans, time, Pose2D(*base))
        same(tracks, slow.update(scans, time, Pose2D(*base)))
        followed += len(tracks)
    assert followed


def test_more_things_than_can_be_followed_are_left_out():
    """Every third beam meets a different thing."""
    rng = np.random.default_rng(1)
    scans = [scan_scene(time=tick * DT, beams=6000) for tick in range(8)]
    settings = TrackerSettings(min_points=2)
    fast, slow = Tracker(CARTER, settings), SlowTracker(CARTER, settings)
    for scan in scans:
        ranges = np.repeat(rng.uniform(1.0, 14.0, 2000), 3)
        wild = type(scan)("front", scan.time, scan.mount, 0.4, scan.angles, ranges, 0.0, 15.0)
        tracks = fast.update([wild], scan.time, Pose2D(0.0, 0.0))
        same(tracks, slow.update([wild], scan.time, Pose2D(0.0, 0.0)))
        assert sum(not track.confirmed for track in tracks) <= 64


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((SETTINGS[:8], BODY), "9 settings"),
        ((np.append(SETTINGS[:8], math.nan), BODY), "settings must be finite"),
        ((np.append(SETTINGS[:8], -1.0), BODY), "at least 0"),
        ((np.array([15.0, 3.0, 0.0, 0.07, 0.6, 0.2, 2.0, 0.8, 1.5]), BODY), "min_points"),
        ((SETTINGS, np.zeros((3, 3))), r"shape \(N, 2\)"),
        ((SETTINGS, np.full((3, 2), math.inf)), "body must be finite"),
    ],
)
def test_settings_that_make_no_tracker_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        ScanTracker(*arguments)


@pytest.mark.parametrize(
    ("index", "value", "message"),
    [
        (0, np.ones(3), "as many ranges as angles"),
        (1, np.full(4, math.nan), "angles must be finite"),
        (2, np.zeros((2, 3)), "one pose"),
        (2, np.full((1, 3), math.inf), "poses must be finite"),
        (3, np.zeros(4), "5 numbers"),
        (3, np.full(5, math.nan), "sensor's numbers must be finite"),
    ],
)
def test_scans_that_are_none_are_refused(index, value, message):
    arguments = [value if number == index else given for number, given in enumerate(TURN)]
    with pytest.raises(ValueError, match=message):
        ScanTracker(SETTINGS, BODY).see(0, 0.0, *arguments)


def test_a_time_that_is_no_number_is_refused():
    with pytest.raises(ValueError, match="time must be finite"):
        ScanTracker(SETTINGS, BODY).see(0, math.nan, *TURN)
    with pytest.raises(ValueError, match="time must be finite"):
        ScanTracker(SETTINGS, BODY).tracks(math.inf)
