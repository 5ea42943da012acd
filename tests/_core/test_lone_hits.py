"""Hits of single beams: what is one, and what is none."""

import math

import numpy as np
import pytest

from support.lone_hits_oracle import find_lone_hits as find_slowly
from trundle._core import find_lone_hits

ANGLES = np.linspace(-math.pi, math.pi, 720, endpoint=False)
HERE = np.zeros((1, 3))
NOTHING = np.zeros(0)


def lone(ranges, before=None, sensor=HERE, earlier_sensor=HERE):
    earlier = (NOTHING, NOTHING) if before is None else (before, ANGLES)
    return find_lone_hits(ranges, ANGLES, sensor, *earlier, earlier_sensor, 0.1, 12.0).tolist()


def around(**beams):
    ranges = np.full(720, 5.0)
    for beam, value in beams.items():
        ranges[int(beam[1:])] = value
    return ranges


def test_a_hit_that_the_beams_beside_it_saw_past_is_lone():
    assert lone(around(b100=2.0, b0=3.0)) == [0, 100]
    assert lone(around(b100=2.0), around(b100=3.0)) == [100]


def test_beams_beside_it_without_a_return_saw_past_it_too():
    assert lone(around(b99=math.inf, b100=2.0, b101=math.inf)) == [100]
    assert lone(around(b98=math.nan, b99=math.nan, b100=2.0)) == [100]


def test_what_two_beams_side_by_side_or_with_one_between_them_hit_is_there_at_once():
    assert lone(around(b100=2.0, b101=2.05)) == []
    assert lone(around(b100=2.0, b101=math.inf, b102=2.05)) == []


def test_what_the_scan_before_hit_there_is_there():
    assert lone(around(b100=2.0), around(b101=2.02)) == []


def test_what_the_scan_before_hit_is_found_from_where_the_sensor_was():
    ahead = np.array([[0.5, 0.0, math.radians(10.0)]])  # turned by 20 beams
    assert lone(around(b340=1.5), around(b360=2.0), sensor=ahead) == []
    assert lone(around(b360=2.0), around(b360=2.0), sensor=ahead) == [360]


def test_a_hit_closer_than_the_shortest_range_beside_it_is_something():
    assert lone(around(b100=2.0, b101=-math.inf)) == []


def test_noise_of_two_centimetres_makes_no_hit_of_a_wall_lone():
    rng = np.random.default_rng(0)
    for _ in range(100):
        wall = 1.0 / np.maximum(np.cos(ANGLES), 0.1) + rng.normal(0.0, 0.02, 720)
        assert lone(np.where(wall < 9.9, wall, math.inf)) == []


def test_it_agrees_with_plain_python():
    rng = np.random.default_rng(1)
    for _ in range(30):
        scans = [
            np.where(rng.random(720) < 0.02, rng.uniform(0.0, 13.0, 720), rng.normal(6.0, 0.05, 720)) for _ in "ab"
        ]
        for scan in scans:
            scan[rng.random(720) < 0.05] = rng.choice([math.nan, math.inf, -math.inf])
        sensors = rng.uniform(-0.1, 0.1, (2, 1, 3))
        arguments = scans[0], ANGLES, sensors[0], scans[1], ANGLES, sensors[1], 0.1, 12.0
        found = find_lone_hits(*arguments).tolist()
        assert found == find_slowly(*arguments)
        assert found


@pytest.mark.parametrize(
    ("index", "value", "message"),
    [
        (1, np.zeros(3), "as many ranges as angles"),
        (4, np.zeros(3), "as many ranges as angles"),
        (2, np.zeros((2, 3)), "poses"),
        (5, np.zeros((0, 3)), "poses"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(index, value, message):
    arguments = [np.zeros(9), np.zeros(9), HERE, np.zeros(9), np.zeros(9), HERE, 0.1, 12.0]
    arguments[index] = value
    with pytest.raises(ValueError, match=message):
        find_lone_hits(*arguments)
