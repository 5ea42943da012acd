import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
SQUARE = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))


def room(rows=200, cols=200):
    return OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), 0.05)


def straight(x0=1.0, x1=9.0, y=5.0):
    return Path(np.array([[x0, y, 0.0], [x1, y, 0.0]]))


def test_a_free_path_has_no_collision():
    assert PathCheck(straight()).first_hit(Costmap.from_grid(room(), CARTER)) is None


def test_the_collision_is_where_the_front_first_touches():
    costmap = Costmap.from_grid(room(), SQUARE).update(slice(96, 104), slice(120, 124), 100)
    check = PathCheck(straight())
    hit = check.first_hit(costmap)
    # The obstacle begins at x 6.0, and the front is 0.2 m ahead.
    assert hit is not None
    assert 5.8 < hit.pose[0] <= 5.826
    assert hit.along == pytest.approx(hit.pose[0] - 1.0)
    assert hit.pose == tuple(check.poses[hit.index])
    past = int(np.searchsorted(check.along, 5.6))
    assert check.first_hit(costmap, past) is None


def test_a_turn_in_place_is_swept():
    # Carter's tail is long: a turn on the spot needs room behind it.
    path = Path(np.array([[5.0, 5.0, 0.0], [5.0, 5.0, math.pi / 2], [5.0, 6.0, math.pi / 2]]))
    costmap = Costmap.from_grid(room(), CARTER)
    assert PathCheck(path).first_hit(costmap) is None
    hit = PathCheck(path).first_hit(costmap.update(slice(91, 92), slice(92, 93), 100))
    assert hit is not None
    assert hit.along == 0.0
    assert 0.0 < hit.pose[2] < math.pi / 2


def test_what_is_between_two_checked_poses_of_a_turn_is_found():
    # The tail's corner passes 0.1 mm inside the cell's corner, between two poses 2° apart.
    radius, free = math.hypot(0.607, 0.25), Costmap.from_grid(room(), CARTER)
    costmap = free.update(slice(100, 101), slice(100, 101), 100)
    corner = math.atan2(0.25, -0.607)
    place = np.array([5.0, 5.0]) - (radius - 1e-4) * np.array([math.cos(0.7), math.sin(0.7)])
    # It points to the cell after 13°, half of a step.
    path = Path(np.array([[*place, 0.7 - corner - math.radians(13)], [*place, 0.7 - corner + math.radians(77)]]))
    check = PathCheck(path)
    samples = np.column_stack([np.tile(place, (46, 1)), path.poses[0, 2] + np.radians(np.arange(0, 91, 2))])
    assert not costmap.footprint_collides(samples).any()
    hit = check.first_hit(costmap)
    assert hit is not None
    assert hit.pose[2] == pytest.approx(0.7 - corner, abs=math.radians(1.01))


def test_beyond_the_map_a_path_is_blocked():
    costmap = Costmap.from_grid(room(), CARTER)
    hit = PathCheck(straight(1.0, 12.0)).first_hit(costmap)
    assert hit is not None
    assert 9.8 < hit.pose[0] < 9.9


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), radius=st.sampled_from([0.0, 0.7, None]), factor=st.sampled_from([1.0, 3.0, 10.0])
)
def test_it_finds_what_the_footprint_at_every_pose_finds(seed, radius, factor):
    rng = np.random.default_rng(seed)
    data = np.where(rng.random((60, 60)) < 0.003, 100, 0).astype(np.int8)
    data[rng.random((60, 60)) < 0.001] = -1
    grid = OccupancyGrid(data, 0.1, Pose2D(*rng.uniform(-1, 1, 2), rng.uniform(-3, 3)))
    costmap = Costmap.from_grid(grid, CARTER, radius, factor)
    ends = grid.origin.transform_points(rng.uniform(0.5, 5.5, (4, 2)))
    check = PathCheck(Path(np.column_stack([ends, rng.uniform(-3, 3, 4)])))
    begin = int(rng.integers(len(check.poses)))
    hits = np.flatnonzero(costmap.footprint_collides(check.poses[begin:]))
    hit = check.first_hit(costmap, begin)
    index = None if hit is None else hit.index
    if index != (begin + hits[0] if len(hits) else None):
        # Something is touched between two poses that are free.
        assert index is not None
        assert index > begin
        assert not len(hits) or index < begin + hits[0]
        between = np.linspace(check.poses[index - 1], check.poses[index], 2001)
        assert costmap.footprint_collides(between, outline=costmap.footprint * 1.0001).any()


def test_the_cost_is_the_length_where_nothing_costs_and_more_near_obstacles():
    check, free = PathCheck(straight()), Costmap.from_grid(room(), SQUARE)
    assert check.cost_from(free) == pytest.approx(8.0)
    assert check.cost_from(free, int(np.searchsorted(check.along, 6.0))) == pytest.approx(2.0, abs=0.03)
    costly = Costmap(np.full((200, 200), 100, np.uint8), 0.05, Pose2D(0, 0), free.footprint, 0.5)
    assert check.cost_from(costly) == pytest.approx(8.0 * 2.6)
    assert check.cost_from(free.update(slice(98, 102), slice(100, 102), 100)) == math.inf


def test_a_path_of_one_pose_is_checked_and_costs_nothing():
    check = PathCheck(Path(np.array([[5.0, 5.0, 0.0]])))
    costmap = Costmap.from_grid(room(), CARTER)
    assert check.first_hit(costmap) is None
    assert check.cost_from(costmap) == 0.0
    assert check.first_hit(costmap.update(slice(99, 101), slice(99, 101), 100)) is not None
