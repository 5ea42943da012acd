"""How far the beams of a scan saw through, which tells what has moved in since."""

import math

import numpy as np
import pytest

from trundle.control.sensed_points import _saw_through
from trundle.geometry import Pose2D
from trundle.observation import Scan


@pytest.mark.parametrize("count", [0, 1, 2, 3, 6, 7, 50])
@pytest.mark.parametrize("turns", [1.0, -1.0])
def test_each_beam_saw_as_far_as_the_shortest_of_seven(count, turns):
    rng = np.random.default_rng(count)
    ranges = rng.uniform(0.1, 9.0, count)
    ranges[rng.random(count) < 0.1] = math.nan
    angles = turns * np.linspace(-2.0, 2.0, count)
    scan = Scan("front", 0.0, Pose2D(0.0, 0.0), 0.4, angles, ranges, 0.5, 10.0)
    seen = {
        angle: -math.inf if not far >= 0.5 else far for angle, far in zip(angles.tolist(), ranges.tolist(), strict=True)
    }
    order = sorted(seen)
    found_angles, found = _saw_through(scan)
    assert found_angles.tolist() == order
    assert found.tolist() == [
        min(seen[order[(index + aside) % count]] for aside in range(-3, 4)) for index in range(count)
    ]
