"""The tracker on scans of discs and walls that are computed here."""

import math
from dataclasses import replace

import numpy as np
import pytest

from support.scan_scenes import scan_scene
from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.tracking import Tracker, TrackerSettings

CARTER = Robot.load("nova_carter")
DT = 0.05
ROOM = [(-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6)]


def follow(
    discs=lambda time: (), segments=(), base=lambda time: (0.0, 0.0, 0.0), *, seconds=2.0, settings=None, **scan
):
    """Run a tracker over a scene; return it and what it returned each tick."""
    tracker = Tracker(CARTER, settings)
    seen = []
    for tick in range(round(seconds / DT) + 1):
        time = tick * DT
        scene = scan_scene(discs(time), segments, base=base(time), time=time, noise=0.01, **scan)
        seen.append(tracker.update([scene], time, Pose2D(*base(time))))
    return tracker, seen


def moving(tracks):
    return [track for track in tracks if track.moving]


@pytest.mark.parametrize("speed", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("heading", [0.0, 0.5 * math.pi, math.pi])
def test_a_walker_is_found_within_half_a_second_at_its_speed(speed, heading):
    vx, vy = speed * math.cos(heading), speed * math.sin(heading)
    centre = (3.0 - 0.5 * vx, 1.0 - 0.5 * vy)
    tracker, seen = follow(lambda t: [(centre[0] + vx * t, centre[1] + vy * t, 0.3)], ROOM, seconds=1.0)
    assert moving(seen[10])
    (track,) = moving(tracker.tracks)
    assert (track.x, track.y) == pytest.approx((3.0 + 0.5 * vx, 1.0 + 0.5 * vy), abs=0.1)
    assert (track.vx, track.vy) == pytest.approx((vx, vy), abs=0.15)
    assert track.radius == pytest.approx(0.3, abs=0.06)
    assert track.confirmed


def test_the_errors_fit_the_covariance():
    _, seen = follow(lambda t: [(3.0, 2.0 - 1.0 * t, 0.3)], seconds=3.0)
    shares = []
    for track in (moving(tracks)[0] for tracks in seen[20:]):
        error = np.array([track.x - 3.0, track.y - 2.0 + track.time, track.vx, track.vy + 1.0])
        shares.append(error @ np.linalg.solve(track.covariance, error))
        assert np.linalg.eigvalsh(track.covariance).min() > 0.0
    assert np.mean(shares) < 8.0  # 4 on average, were the errors of a filter's points independent


def test_a_room_seen_while_driving_has_no_movers():
    posts = [(x, y, 0.05) for x in (-3.0, -1.0, 2.0, 4.0) for y in (-2.0, 2.0)]

    def drive(time):
        return (-2.0 + 0.8 * time, 0.3 * math.sin(time), 0.9 * math.sin(1.3 * time))

    plate = [(1.0, -4.0, 1.0, -3.0), (1.05, -4.0, 1.05, -3.0), (1.0, -3.0, 1.05, -3.0)]
    _, seen = follow(lambda t: posts, [*ROOM, (0.0, 3.0, 1.5, 3.0), *plate], drive, seconds=6.0)
    assert not any(moving(tracks) for tracks in seen)


def test_dust_confirms_no_track():
    """5 % of the beams are returned too soon."""
    rng, tracker = np.random.default_rng(0), Tracker(CARTER)
    pillars = [(x, y, 0.15) for x in (-4.0, 0.0, 4.0) for y in (-3.0, 3.0)]
    for tick in range(300):
        base, time = (1.5 * math.sin(0.3 * tick * DT), 0.0, 0.0), tick * DT
        scan = scan_scene(pillars, ROOM, base=base, time=time, noise=0.01)
        early = np.flatnonzero(rng.random(len(scan.ranges)) < 0.05)
        ranges = scan.ranges.copy()
        ranges[early] *= rng.random(len(early))
        assert not moving(tracker.update([replace(scan, ranges=ranges)], time, Pose2D(*base)))


def test_something_that_comes_into_view_stands():
    """A box behind a wall, of which more and more is seen."""

    def drive(time):
        return (-2.0 + time, 0.0, 0.0)

    wall = (0.0, 1.0, 0.05, 1.0, 0.0, 1.0, 0.0, 3.0)
    box = [(1.0, 2.0, 1.8, 2.0), (1.8, 2.0, 1.8, 2.8), (1.0, 2.8, 1.0, 2.0)]
    _, seen = follow(segments=[wall[:4], wall[4:], *box], base=drive, seconds=4.0)
    assert not any(moving(tracks) for tracks in seen)


def test_a_walker_in_front_of_a_wall_is_told_from_it():
    tracker, _ = follow(lambda t: [(-2.0 + t, 5.6, 0.3)], ROOM, seconds=3.0)
    (track,) = moving(tracker.tracks)
    assert (track.x, track.y) == pytest.approx((1.0, 5.6), abs=0.15)
    assert track.vx == pytest.approx(1.0, abs=0.15)


def test_a_walker_that_is_hidden_for_a_while_keeps_its_track():
    screen = (-0.25, 1.0, 0.25, 1.0)
    tracker, seen = follow(lambda t: [(-3.0 + 1.5 * t, 3.0, 0.3)], [screen], seconds=4.0)
    numbers = {track.id for tracks in seen for track in moving(tracks)}
    assert len(numbers) == 1
    assert moving(tracker.tracks)[0].x == pytest.approx(3.0, abs=0.15)


def test_a_walker_that_turns_and_is_hidden_is_forgotten_soon():
    """What its filter makes of the first moments of a turn says little about where it goes."""
    turns_s, hidden_s = 1.0, 1.1

    def scene(time):
        walker = (-1.3 + 1.5 * (turns_s - abs(time - turns_s)), 3.0, 0.3)
        return [walker] if time < hidden_s - 0.01 else [walker, (0.1, 1.3, 0.8)]

    _, seen = follow(scene, seconds=1.6)
    assert any(track.y > 2.0 for track in moving(seen[22]))
    assert not any(track.y > 2.0 for tracks in seen[29:] for track in moving(tracks))


def behind(time):
    """A walker that crosses behind the robot, out of the view of a lidar of 270 degrees from 0.9 to 2.1 s."""
    return [(-1.2, 3.0 - 2.0 * time, 0.3)]


def test_a_walker_behind_the_field_of_view_keeps_its_track():
    _, seen = follow(behind, seconds=3.0, fov=1.5 * math.pi)
    assert {track.id for tracks in seen for track in moving(tracks)} == {1}
    for tick in range(10, 61):
        (track,) = moving(seen[tick])
        assert (track.x, track.y) == pytest.approx(behind(tick * DT)[0][:2], abs=0.25)
    unseen = [float(moving(tracks)[0].covariance[0, 0]) for tracks in seen[24:36]]
    assert (np.diff(unseen) > 0.0).all()


def test_a_walker_behind_the_field_of_view_is_forgotten_in_time():
    _, seen = follow(behind, seconds=1.8, fov=1.5 * math.pi, settings=TrackerSettings(aside_s=0.4))
    assert len(moving(seen[20])) == 1
    assert not seen[-1]


def test_two_that_pass_each_other_keep_their_tracks():
    _, seen = follow(lambda t: [(-2.0 + t, 3.0, 0.3), (2.0 - t, 4.0, 0.3)], seconds=4.0)
    assert sorted({track.id for tracks in seen for track in moving(tracks)}) == [1, 2]
    last = sorted(moving(seen[-1]), key=lambda track: track.y)
    assert [round(track.vx, 1) for track in last] == [1.0, -1.0]


def test_one_that_stops_is_confirmed_and_stands():
    tracker, _ = follow(lambda t: [(3.0, -2.0 + min(t, 1.5), 0.3)], seconds=3.5)
    (track,) = [track for track in tracker.tracks if track.confirmed]
    assert not track.moving
    assert track.speed < 0.1


def test_two_lidars_see_one_mover():
    tracker = Tracker(CARTER)
    for tick in range(30):
        time = tick * DT
        discs = [(2.0 + time, 1.0, 0.3)]
        scans = [
            scan_scene(discs, ROOM, mount=mount, time=time, name=name, noise=0.01)
            for name, mount in (("front", (0.03, 0.0, math.pi)), ("back", (-0.49, 0.0, 0.0)))
        ]
        tracker.update(scans, time, Pose2D(0.0, 0.0))
    (track,) = moving(tracker.tracks)
    assert track.vx == pytest.approx(1.0, abs=0.1)


@pytest.mark.slow
def test_a_scan_measured_beam_by_beam_is_placed_beam_by_beam():
    """A robot that turns fast in a room, with a lidar that takes the whole tick for a turn."""
    tracker = Tracker(CARTER)
    beams, spin = 360, 1.0
    step = DT / beams
    for tick in range(40):
        time = tick * DT
        tracker.update([], time + DT * 0.999, Pose2D(0.0, 0.0, spin * (time + DT * 0.999)))
        angles = np.linspace(-math.pi, math.pi, beams, endpoint=False)
        ranges = [
            scan_scene([], ROOM, base=(0, 0, spin * (time + index * step) + angle), beams=1, fov=1e-9).ranges[0]
            for index, angle in enumerate(angles)
        ]
        scan = Scan("front", time, Pose2D(0, 0), 0.4, angles, np.array(ranges), 0.0, 15.0, step)
        tracks = tracker.update([scan], time + DT * 0.9995, Pose2D(0.0, 0.0, spin * (time + DT * 0.9995)))
        assert not moving(tracks)


def test_nan_and_empty_scans_are_taken():
    tracker = Tracker(CARTER)
    for tick in range(20):
        time = tick * DT
        scan = scan_scene([(3.0, 1.0 - time, 0.3)], ROOM, time=time, noise=0.01)
        ranges = scan.ranges.copy()
        ranges[::7], ranges[3::11], ranges[5::13] = np.nan, np.inf, -np.inf
        holed = Scan("front", time, scan.mount, 0.4, scan.angles, ranges, 0.0, 15.0)
        empty = Scan("back", time, scan.mount, 0.4, np.zeros(0), np.zeros(0), 0.0, 15.0)
        blind = Scan("back", time + 0.01, scan.mount, 0.4, scan.angles, np.full(720, np.nan), 0.0, 15.0)
        tracker.update([holed, empty, blind], time + 0.02, Pose2D(0.0, 0.0))
    assert all(math.isfinite(value) for track in tracker.tracks for value in (track.x, track.y, track.vx, track.radius))
    assert len(moving(tracker.tracks)) == 1


def test_a_jump_of_the_odometry_forgets_all():
    tracker, _ = follow(lambda t: [(3.0, -1.0 + t, 0.3)], ROOM)
    assert moving(tracker.tracks)
    with pytest.warns(SensorWarning, match=r"jumped by 5\.0 m"):
        tracker.update([], 2.05, Pose2D(5.0, 0.0))
    assert tracker.tracks == ()


def test_a_time_that_goes_back_forgets_all():
    tracker, _ = follow(lambda t: [(3.0, -1.0 + t, 0.3)], ROOM)
    with pytest.warns(SensorWarning, match=r"went back from 2 s to 0\.5 s"):
        tracker.update([], 0.5, Pose2D(0.0, 0.0))
    assert tracker.tracks == ()


def test_scans_that_cannot_be_used_are_left_out():
    tracker = Tracker(CARTER)
    with pytest.warns(SensorWarning, match="has no such lidar"):
        tracker.update([scan_scene([(3, 0, 0.3)], name="roof")], 0.0, Pose2D(0, 0))
    assert tracker.tracks == ()


def test_bad_arguments_are_refused():
    tracker = Tracker(CARTER)
    with pytest.raises(InputError, match="time must be a finite number"):
        tracker.update([], math.nan, Pose2D(0, 0))
    with pytest.raises(InputError, match="scans"):
        tracker.update(3, 0.0, Pose2D(0, 0))
    with pytest.raises(InputError, match="robot"):
        Tracker("carter")
    with pytest.raises(InputError, match="settings"):
        Tracker(CARTER, settings=3)
    with pytest.raises(InputError, match="max_size"):
        TrackerSettings(max_size=0.0)


def test_a_track_is_the_same_in_another_frame():
    tracker, _ = follow(lambda t: [(3.0, -1.0 + t, 0.3)])
    (track,) = moving(tracker.tracks)
    turned = track.seen_from(Pose2D(1.0, 2.0, 0.5 * math.pi))
    assert (turned.x, turned.y) == pytest.approx((1.0 - track.y, 2.0 + track.x))
    assert (turned.vx, turned.vy) == pytest.approx((-track.vy, track.vx))
    assert turned.covariance[0, 0] == pytest.approx(track.covariance[1, 1])
    assert turned.covariance[0, 2] == pytest.approx(track.covariance[1, 3])
    assert turned.at(track.time + 1.0) == pytest.approx((turned.x + turned.vx, turned.y + turned.vy))


def test_a_disc_that_leaves_the_field_of_view_keeps_its_size():
    scene = lambda t: [(2.0 - 1.0 * t, 1.5, 0.5)]  # noqa: E731
    _, seen = follow(scene, ROOM, seconds=2.6, fov=math.pi / 2.0 * 1.5)
    sizes = [track.radius for tracks in seen[30:] for track in moving(tracks)]
    assert sizes
    assert min(sizes) > 0.4


def test_noise_does_not_make_corners_move_that_the_robot_passes_closely():
    corners = [(-8.49, 0.33), (-8.18, 0.02), (-7.93, 0.28), (-8.24, 0.58)]
    others = [(-8.16, 0.14), (-8.58, 0.43), (-8.78, 0.13), (-8.37, -0.16)]
    walls = [(-14.0, -8.0), (0.0, -8.0), (0.0, 8.0), (-14.0, 8.0)]
    segments = [(*a, *b) for loop in (corners, others, walls) for a, b in zip(loop, [*loop[1:], loop[0]], strict=True)]
    way = np.array(
        [
            (0.0, -9.21, -0.44, -0.21),
            (0.8, -8.64, -0.56, -0.13),
            (1.2, -8.42, -0.57, 0.01),
            (1.6, -8.2, -0.55, 0.15),
            (2.0, -7.98, -0.51, 0.21),
            (2.8, -7.4, -0.33, 0.37),
        ]
    )
    mounts = {"front": (0.026, 0.0, math.pi), "back": (-0.489, 0.0, 0.0)}
    wrong = 0
    for seed in range(8):
        tracker = Tracker(CARTER)
        for tick in range(57):
            time = tick * DT
            base = tuple(float(np.interp(time, way[:, 0], way[:, k])) for k in (1, 2, 3))
            scans = [
                scan_scene((), segments, base=base, mount=mount, time=time, name=name, noise=0.02, seed=10 * seed + i)
                for i, (name, mount) in enumerate(mounts.items())
            ]
            wrong += len(moving(tracker.update(scans, time, Pose2D(*base)))) > 0
    assert wrong < 0.05 * 8 * 57
