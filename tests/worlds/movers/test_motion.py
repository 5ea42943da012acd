from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from trundle.errors import WorldError
from trundle.worlds.movers import AlongPath, Motion, Waypoints

SQUARE = ((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))


def test_waypoints_pass_their_points_at_their_times_at_constant_speed():
    motion = Waypoints(((1.0, 0.0, 0.0), (3.0, 4.0, 0.0), (4.0, 4.0, 2.0)))
    assert motion.at(0.0)[:2] == (0.0, 0.0)
    assert motion.at(0.0)[3:] == (0.0, 0.0, 0.0)
    assert motion.at(2.0)[:5] == pytest.approx((2.0, 0.0, 0.0, 2.0, 0.0))
    assert motion.at(3.5)[:5] == pytest.approx((4.0, 1.0, math.pi / 2.0, 0.0, 2.0))
    assert motion.at(9.0)[:2] == (4.0, 2.0)
    assert motion.at(9.0).yaw == pytest.approx(math.pi / 2.0)
    assert motion.duration == 4.0


@pytest.mark.parametrize("interpolation", ["linear", "catmull_rom"])
@pytest.mark.parametrize("repeat", ["once", "loop", "back_and_forth"])
def test_velocities_are_the_derivatives_of_positions(interpolation, repeat):
    points = ((0.5, 0.0, 0.0, 0.0), (2.0, 3.0, 1.0, 1.0), (3.0, 4.0, 3.0, 2.0), (5.0, 0.0, 0.0, 0.0))
    motion = Waypoints(points, interpolation, repeat)
    for time in np.arange(0.105, 12.0, 0.37):  # at no waypoint
        before, now, after = (np.array(motion.at(time + step)) for step in (-1e-6, 0.0, 1e-6))
        assert (after - before)[:3] / 2e-6 == pytest.approx(now[3:], abs=1e-3)


def test_a_catmull_rom_spline_passes_its_points_with_the_velocity_between_their_neighbours():
    motion = Waypoints(((0.0, 0.0, 0.0), (1.0, 1.0, 2.0), (3.0, 5.0, 2.0)), "catmull_rom")
    state = motion.at(1.0)
    assert state[:2] == pytest.approx((1.0, 2.0))
    assert state[3:5] == pytest.approx((5.0 / 3.0, 2.0 / 3.0))


def test_a_loop_starts_again_and_a_closed_spline_is_smooth_there():
    angles = np.linspace(0.0, math.tau, 9)
    points = tuple((float(time), math.cos(angle), math.sin(angle)) for time, angle in enumerate(angles))
    closed = (*points[:-1], (8.0, *points[0][1:]))
    motion = Waypoints(closed, "catmull_rom", "loop")
    assert motion.at(9.5)[:5] == pytest.approx(motion.at(1.5)[:5])
    before, after = motion.at(8.0 - 1e-7), motion.at(8.0 + 1e-7)
    assert before[:5] == pytest.approx(after[:5], abs=1e-5)


def test_back_and_forth_returns_in_reverse():
    motion = Waypoints(((0.0, 0.0, 0.0), (4.0, 4.0, 0.0)), repeat="back_and_forth")
    there, back = motion.at(3.0), motion.at(5.0)
    assert (back.x, back.yaw, back.vx) == pytest.approx((there.x, there.yaw, -there.vx))
    assert motion.at(11.0).x == pytest.approx(3.0)
    assert motion.duration == 8.0


def test_a_yaw_turns_the_short_way():
    motion = Waypoints(((0.0, 0.0, 0.0, 3.0), (1.0, 0.0, 0.0, -3.0)))
    assert motion.at(0.5).w == pytest.approx(math.tau - 6.0)


@pytest.mark.parametrize("interpolation", ["linear", "catmull_rom"])
def test_the_speed_along_a_path_is_constant(interpolation):
    motion = AlongPath(SQUARE, 1.5, interpolation, "loop", start_s=2.0)
    assert motion.at(1.0)[:5] == pytest.approx((0.0, 0.0, motion.at(1.0).yaw, 0.0, 0.0))
    for time in np.arange(2.01, 30.0, 0.3):
        assert math.hypot(*motion.at(time)[3:5]) == pytest.approx(1.5, rel=1e-9)
    assert motion.at(2.0 + motion.duration - 2.0)[:2] == pytest.approx(SQUARE[0], abs=1e-9)


def test_a_mover_faces_along_its_path_and_turns_at_corners():
    motion = AlongPath(SQUARE, 1.0)
    assert motion.at(2.0).yaw == pytest.approx(0.0)
    assert motion.at(4.0).yaw == pytest.approx(math.pi / 4.0)
    assert motion.at(4.0).w > 1.0
    assert motion.at(6.0).yaw == pytest.approx(math.pi / 2.0)


def test_motions_are_values():
    first, second = (AlongPath(SQUARE, 1.0) for _ in range(2))
    assert first == second
    assert hash(first) == hash(second)
    assert pickle.loads(pickle.dumps(first)).at(3.3) == second.at(3.3)
    assert isinstance(first, Motion)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), "must increase: number 2 is at 0 s"),
        (((0.0, 0.0, 0.0), (2.0, 1.0, 0.0), (1.0, 1.0, 0.0)), "number 3 is at 1 s, and the one before it at 2 s"),
        (((-1.0, 0.0, 0.0), (2.0, 1.0, 0.0)), "the first waypoint is at -1 s"),
        (((0.0, 0.0),), r"\(t, x, y\)"),
        (((0.0, 0.0, math.nan),), "number 1 is not"),
        (((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)), "all alike"),
        ((), "all alike"),
    ],
)
def test_bad_waypoints_are_refused(points, words):
    with pytest.raises(WorldError, match=words):
        Waypoints(points)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"speed": 0.0}, "positive"),
        ({"speed": math.inf}, "positive"),
        ({"speed": 1.0, "points": ((1.0, 1.0), (1.0, 1.0))}, "two points"),
        ({"speed": 1.0, "repeat": "twice"}, "'twice'"),
        ({"speed": 1.0, "interpolation": "cubic"}, "'cubic'"),
        ({"speed": 1.0, "start_s": -1.0}, "start_s"),
    ],
)
def test_bad_paths_are_refused(options, words):
    with pytest.raises(WorldError, match=words):
        AlongPath(**{"points": SQUARE, **options})
