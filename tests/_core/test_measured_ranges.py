"""What a lidar reads of distances along its beams."""

import math

import numpy as np
import pytest

from trundle._core import measure_ranges

NO_NOISE = np.zeros(0)


def test_distances_are_read_as_they_are_within_the_range():
    assert measure_ranges(np.array([0.5, 3.0, 10.0]), NO_NOISE, 0.0, 0.1, 10.0).tolist() == [0.5, 3.0, 10.0]


def test_what_is_too_close_reads_the_shortest_range_and_what_is_too_far_nothing():
    assert measure_ranges(np.array([0.02, 10.1, math.inf]), NO_NOISE, 0.0, 0.1, 10.0).tolist() == [
        0.1,
        math.inf,
        math.inf,
    ]


def test_noise_leads_out_of_no_range_and_hides_no_hit():
    distances, noise = np.array([0.11, 9.99, 5.0, 10.1]), np.array([-1.0, 1.0, 2.0, -9.0])
    assert measure_ranges(distances, noise, 0.1, 0.1, 10.0).tolist() == [0.1, 10.0, 5.0 + 2.0 * 0.1, math.inf]


def test_noise_of_another_length_is_refused():
    with pytest.raises(ValueError, match="each beam"):
        measure_ranges(np.ones(3), np.ones(2), 0.1, 0.1, 10.0)
