"""What the footprint sweeps over on a motion, not only where it stands."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot

CARTER = Robot.load("nova_carter").outline
TENTH = math.radians(0.1)
TAIL = math.hypot(0.607, 0.25)


def with_cells(*cells, shape=(120, 120), outline=CARTER, origin=None):
    """Costs of nothing but these lethal cells of 5 cm."""
    costs = np.zeros(shape, np.uint8)
    for row, col in cells:
        costs[row, col] = 254
    return Costmap(costs, 0.05, origin or Pose2D(0.0, 0.0), outline, 1.0)


def dense(first, last, step_m=1e-3, step_rad=TENTH):
    first, last = np.asarray(first), np.asarray(last)
    steps = max(math.dist(first[:2], last[:2]) / step_m, abs(last[2] - first[2]) / step_rad)
    return first + np.linspace(0.0, 1.0, 2 + math.ceil(steps))[:, None] * (last - first)


def test_a_line_is_free_up_to_where_the_front_touches():
    costmap = with_cells((60, 100))
    share = costmap.footprint_sweeps((2.0, 3.0, 0.0), (6.0 - 0.2, 3.0, 0.0))[0]
    assert share == pytest.approx((5.0 - 0.14 - 2.0) / 3.8, abs=1e-5)
    assert costmap.footprint_sweeps((2.0, 3.0, 0.0), (5.0 - 0.14, 3.0, 0.0))[0] == math.inf


def test_a_line_past_a_corner_is_tested_exactly():
    costmap = with_cells((60, 60))
    yaw = math.radians(37)
    # The cell's corner at (3, 3.05) is the nearest to the right of the line, whose side is 0.25 m from its middle.
    for apart, free in ((0.25 + 1e-8, True), (0.25 - 1e-8, False)):
        x, y = 3.0 - apart * math.sin(yaw), 3.05 + apart * math.cos(yaw)
        line = [(x + s * math.cos(yaw), y + s * math.sin(yaw), yaw) for s in (-1.0, 1.0)]
        assert (costmap.footprint_sweeps(*line)[0] == math.inf) == free


def test_a_robot_slides_along_what_it_touches():
    costmap = with_cells(*((60, col) for col in range(120)))
    assert costmap.footprint_sweeps((1.0, 2.75, 0.0), (5.0, 2.75, 0.0))[0] == math.inf
    assert costmap.footprint_sweeps((1.0, 2.75 + 1e-6, 0.0), (5.0, 2.75 + 1e-6, 0.0))[0] == 0.0


@pytest.mark.parametrize("turn", [2 * math.pi, -2 * math.pi])
def test_a_turn_all_round_needs_the_circumscribed_circle(turn):
    angle = math.radians(33)
    for apart, free in ((TAIL + 1e-5, True), (TAIL - 1e-5, False)):
        x, y = 3.0 - apart * math.cos(angle), 3.0 - apart * math.sin(angle)
        costmap = with_cells((60, 60))
        assert (costmap.footprint_sweeps((x, y, 0.4), (x, y, 0.4 + turn))[0] == math.inf) == free


def test_a_turn_between_two_samples_is_found():
    costmap, corner = with_cells((60, 60)), math.atan2(0.25, -0.607)
    place = 3.0 - (TAIL - 1e-4) * math.sqrt(0.5)
    begin = math.pi / 4 - corner - math.radians(1)
    assert not costmap.footprint_collides([(place, place, begin + k * math.radians(2)) for k in range(2)]).any()
    share = costmap.footprint_sweeps((place, place, begin), (place, place, begin + math.radians(2)))[0]
    assert 0.3 < share < 0.5


@settings(max_examples=60, deadline=None, derandomize=True)
@given(seed=st.integers(0, 2**32 - 1), burger=st.booleans())
def test_a_motion_called_free_touches_nothing_and_others_do(seed, burger):
    rng = np.random.default_rng(seed)
    outline = Robot.load("turtlebot3_burger").outline if burger else CARTER
    origin = Pose2D(*rng.uniform(-9, 9, 2), rng.uniform(-3, 3))
    costmap = with_cells(
        *rng.integers(30, 90, (2 if burger else 6, 2)), shape=(121, 119), outline=outline, origin=origin
    )
    x, y = origin.transform_points(rng.uniform(2.0, 4.0, (40, 2))).T
    first = np.column_stack([x, y, rng.uniform(-7, 7, 40)])
    last = first + rng.uniform(-1, 1, (40, 3)) * rng.choice([0.0, 0.1, 1.0, 3.0], (40, 3))
    for a, b, share in zip(first, last, costmap.footprint_sweeps(first, last).tolist(), strict=True):
        if share > 0.0:
            poses = dense(a, a + min(share, 1.0) * (b - a))
            assert not costmap.footprint_collides(poses, outline=outline * (1.0 - 1e-9)).any()
        if share < math.inf:
            # It touches something soon after, or passes by less than 0.02 mm.
            ahead = a + min(1.0, share + 1e-3) * (b - a)
            poses = dense(a + share * (b - a), ahead, 1e-6, 1e-6)
            wider = outline * (1.0 + 2e-5 / costmap.inscribed_radius)
            assert costmap.footprint_collides(poses, outline=wider).any()


def test_quarter_turns_past_planted_cells_touch_none():
    rng, accepted = np.random.default_rng(5), 0
    for _ in range(400):
        x, y = 3.0 + rng.uniform(0.0, 0.05, 2)
        yaw, angle = rng.uniform(-math.pi, math.pi, 2)
        apart = TAIL + rng.uniform(-0.005, 0.04)
        costmap = with_cells((int((y + apart * math.sin(angle)) / 0.05), int((x + apart * math.cos(angle)) / 0.05)))
        turn = (x, y, yaw), (x, y, yaw + math.pi / 2)
        if costmap.footprint_sweeps(*turn)[0] == math.inf:
            accepted += 1
            assert not costmap.footprint_collides(dense(*turn)).any()
    assert accepted > 150


def test_what_is_no_motion_on_the_map_is_not_free():
    costmap = with_cells()
    for number in (math.nan, math.inf, -1e300, 1e300):
        for place in range(3):
            pose = [3.0, 3.0, 0.0]
            pose[place] = number
            assert costmap.footprint_sweeps((3.0, 3.0, 0.0), pose)[0] < math.inf
            assert costmap.footprint_sweeps(pose, (3.0, 3.0, 0.0))[0] == 0.0
    assert costmap.footprint_sweeps((3.0, 3.0, 0.0), (7.0, 3.0, 0.0))[0] == pytest.approx((3.0 - 0.14) / 4.0, abs=1e-5)
    assert costmap.footprint_sweeps(np.empty((0, 3)), np.empty((0, 3))).shape == (0,)


def test_bad_arguments_are_refused():
    costmap = with_cells()
    with pytest.raises(InputError, match="2 first and 1 last"):
        costmap.footprint_sweeps([(1, 1, 0), (1, 1, 0)], [(1, 1, 0)])
    with pytest.raises(InputError, match="convex"):
        costmap.footprint_sweeps((1, 1, 0), (1, 1, 1), outline=CARTER[::-1])
    with pytest.raises(InputError, match="convex"):
        costmap.footprint_sweeps((1, 1, 0), (1, 1, 1), outline=CARTER[[0, 0, 1, 2]])
    with pytest.raises(ValueError, match="resolution"):
        _core.footprint_sweep(costmap.data, 0.0, 0.0, 0.0, 0.0, CARTER, np.zeros((1, 3)), np.zeros((1, 3)))


def test_a_map_is_free_up_to_its_edge():
    costmap = Costmap.from_grid(OccupancyGrid(np.zeros((40, 40), np.int8), 0.05), CARTER)
    assert costmap.footprint_sweeps((1.0, 1.0, 0.0), (1.0, 1.0, 2 * math.pi))[0] == math.inf
    assert costmap.footprint_sweeps((0.65, 1.0, 0.0), (0.65, 1.0, 2 * math.pi))[0] < math.inf
