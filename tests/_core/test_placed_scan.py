"""What one scan shows: where it hit something, and how far its beams saw through."""

import math

import numpy as np
import pytest

from support.placed_scan_oracle import place_scan as place_slowly
from trundle._core import place_scan

MOUNT, BASE, SENSOR = np.array([0.2, 0.1, 0.3]), np.array([4.0, -2.0, 2.0]), np.array([3.8, -1.9, 2.3])
BODY = np.array([(1.0, 0.0, 0.5), (0.0, 1.0, 0.4), (-1.0, 0.0, 0.5), (0.0, -1.0, 0.4)])
NOTHING = np.zeros(0)


def place(ranges, angles, earlier=NOTHING, earlier_angles=NOTHING):
    return MOUNT, BASE, BODY, 0.5, 10.0, SENSOR, earlier, earlier_angles, SENSOR + 0.01


@pytest.mark.parametrize("count", [0, 1, 2, 3, 6, 7, 50])
@pytest.mark.parametrize("turns", [1.0, -1.0])
def test_each_beam_saw_as_far_as_the_shortest_of_seven(count, turns):
    rng = np.random.default_rng(count)
    ranges = rng.uniform(0.1, 9.0, count)
    ranges[rng.random(count) < 0.1] = math.nan
    angles = turns * np.linspace(-2.0, 2.0, count)
    # No hit is lone, as the scan before has seen it.
    _, found_angles, found = place_scan(ranges, angles, *place(ranges, angles, ranges, angles)[:-1], SENSOR)
    seen = {
        angle: -math.inf if not far >= 0.5 else far for angle, far in zip(angles.tolist(), ranges.tolist(), strict=True)
    }
    order = sorted(seen)
    assert found_angles.tolist() == order
    assert found.tolist() == [
        min(seen[order[(index + aside) % count]] for aside in range(-3, 4)) for index in range(count)
    ]


def test_it_agrees_with_numpy():
    rng = np.random.default_rng(1)
    for _ in range(20):
        scans = [np.where(rng.random(360) < 0.1, rng.uniform(0.0, 11.0, 360), rng.normal(5.0, 0.05, 360)) for _ in "ab"]
        for scan in scans:
            scan[rng.random(360) < 0.05] = rng.choice([math.nan, math.inf, -math.inf])
        angles = np.linspace(-math.pi, math.pi, 360, endpoint=False)
        arguments = scans[0], angles, *place(scans[0], angles, scans[1], angles)
        found, expected = place_scan(*arguments), place_slowly(*arguments)
        assert 200 < len(found[0]) < 360
        for one, other in zip(found, expected, strict=True):
            assert one == pytest.approx(other, abs=1e-12)


def test_a_hit_of_the_robots_own_body_is_left_out():
    points, *_ = place_scan(np.array([0.6, 3.0]), np.array([math.pi, 0.1]), *place(None, None))
    assert len(points) == 1


@pytest.mark.parametrize(
    ("index", "value", "message"),
    [
        (1, np.zeros(3), "as many ranges as angles"),
        (9, np.zeros(3), "as many ranges as angles"),
        (2, np.zeros(2), "poses"),
        (10, np.zeros(4), "poses"),
        (4, np.zeros((4, 2)), "body"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(index, value, message):
    arguments = [np.ones(9), np.zeros(9), *place(None, None)]
    arguments[index] = value
    with pytest.raises(ValueError, match=message):
        place_scan(*arguments)
