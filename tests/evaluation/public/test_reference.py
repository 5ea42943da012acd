import math

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.evaluation.public.reference import ReferencePath, load_reference
from trundle.geometry import Goal, Pose2D
from trundle.robots import Limits

START, GOAL = Pose2D(-2.25, 3.0, 1.57), Goal.of((-2.25, 13.0))


def limits(speed=2.0, acceleration=3.0):
    return Limits(linear_speed=speed, angular_speed=4.0, linear_acceleration=acceleration, angular_acceleration=8.0)


def path(*points):
    return ReferencePath(np.array(points, dtype=float))


def test_cells_become_metres_and_the_ends_of_the_mission_are_added(tmp_path):
    np.save(tmp_path / "p.npy", np.array([[0, 0], [0, 10], [10, 20]]))
    found = load_reference(tmp_path / "p.npy")
    np.testing.assert_allclose(found.points, [(-4.575, 5.075), (-4.575, 6.575), (-3.075, 8.075)])
    whole = found.between(START, GOAL)
    np.testing.assert_allclose(whole.points[[0, -1]], [(-2.25, 3.0), (-2.25, 13.0)])
    inner = 1.5 + math.hypot(1.5, 1.5)
    outer = math.hypot(2.325, 2.075) + math.hypot(0.825, 4.925)
    assert whole.length == pytest.approx(inner + outer)


@pytest.mark.parametrize(
    ("time", "score"),
    [(0.1, 0.5), (10.0, 0.5), (12.5, 0.4), (20.0, 0.25), (40.0, 0.125), (99.0, 0.125)],
)
def test_the_score_is_clipped_at_two_and_at_eight_optimal_times(time, score):
    assert path((0, 0), (10, 0)).score(time) == pytest.approx(score)  # the optimal time is 5 s


def test_the_shortest_time_is_that_of_a_ramp_and_the_largest_speed():
    ramp = 2.0 / 3.0
    assert path((0, 0), (10, 0)).shortest_time(limits(), 1.0) == pytest.approx(ramp + (9.0 - ramp) / 2.0)


def test_a_short_path_ends_on_the_ramp():
    assert path((0, 0), (1.3, 0)).shortest_time(limits(), 1.0) == pytest.approx(math.sqrt(2.0 * 0.3 / 3.0))


def test_it_ends_where_the_path_first_comes_near_its_end():
    # Past the end at a distance of 0.6 m, and back: the first passage counts.
    bent = path((0, 0), (10, 0), (10, 0.6), (5, 0.6))
    at = 5.0 - math.sqrt(1.0 - 0.36)
    assert bent.shortest_time(limits(acceleration=1e4), 1.0) == pytest.approx(at / 2.0, abs=1e-3)


def test_a_start_within_the_radius_takes_no_time():
    assert path((0, 0), (0.5, 0)).shortest_time(limits(), 1.0) == 0.0


def test_repeated_points_do_not_matter():
    once, twice = path((0, 0), (4, 0), (9, 0)), path((0, 0), (0, 0), (4, 0), (4, 0), (9, 0), (9, 0))
    assert twice.shortest_time(limits(), 1.0) == pytest.approx(once.shortest_time(limits(), 1.0))


@pytest.mark.parametrize(
    "cells",
    [np.zeros((4, 3), int), np.zeros(5, int), np.zeros((1, 2), int), np.full((3, 2), np.nan), np.full((3, 2), "a")],
)
def test_what_is_no_path_is_refused(tmp_path, cells):
    np.save(tmp_path / "p.npy", cells)
    with pytest.raises(InputError, match=r"p\.npy: "):
        load_reference(tmp_path / "p.npy")


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00v\x00{'descr': '<i8'", b"text"])
def test_a_damaged_file_is_refused(tmp_path, content):
    (tmp_path / "p.npy").write_bytes(content)
    with pytest.raises(InputError, match=r"p\.npy: no path of BARN's"):
        load_reference(tmp_path / "p.npy")


def test_objects_are_not_unpickled(tmp_path):
    np.save(tmp_path / "p.npy", np.array([[0, 1], [None, 2]], dtype=object), allow_pickle=True)
    with pytest.raises(InputError, match="no path of BARN's"):
        load_reference(tmp_path / "p.npy")
