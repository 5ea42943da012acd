import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError, ScenarioError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import sample_mission


@pytest.fixture(scope="module")
def costmap(room, carter):
    return Costmap.from_grid(room, carter.outline)


def costmap_with_a_block(costmap):
    costs = costmap.data.copy()
    costs[:, costs.shape[1] // 2 :] = 254
    return Costmap(
        costs, costmap.resolution, costmap.origin, costmap.footprint, inflation_radius=costmap.inflation_radius
    )


def closed(rows, cols):
    data = np.zeros((rows, cols), dtype=np.int8)
    data[[0, -1], :] = 100
    data[:, [0, -1]] = 100
    return data


@pytest.mark.parametrize("seed", range(8))
def test_both_ends_have_room_to_turn_and_are_apart(costmap, seed):
    start, goal = sample_mission(costmap, seed, min_distance=3.0)
    assert start.distance_to(goal) >= 3.0
    for pose in (start, goal):
        turn = [(pose.x, pose.y, math.radians(degree)) for degree in range(360)]
        assert not costmap.footprint_collides(turn).any()


def test_a_seed_gives_one_mission_and_another_seed_another(costmap):
    assert sample_mission(costmap, 3) == sample_mission(costmap, 3)
    assert sample_mission(costmap, 3) != sample_mission(costmap, 4)
    assert sample_mission(costmap, seed=3) == sample_mission(costmap, 3)


def test_without_a_seed_it_is_0_as_elsewhere(costmap):
    assert sample_mission(costmap) == sample_mission(costmap, seed=0)


def test_ends_lie_in_one_area(carter):
    data = closed(120, 200)
    data[:, 100] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), carter.outline)
    for seed in range(10):
        start, goal = sample_mission(costmap, seed, min_distance=2.0)
        assert (start.x < 5.0) == (goal.x < 5.0)


def test_a_gap_narrower_than_the_robot_parts_two_areas(carter):
    data = closed(120, 200)
    data[:, 100] = 100
    data[60:69, 100] = 0  # 0.45 m; the robot is 0.5 m wide, its inscribed radius is 0.14 m
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), carter.outline)
    for seed in range(10):
        start, goal = sample_mission(costmap, seed, min_distance=2.0)
        assert (start.x < 5.0) == (goal.x < 5.0)


def test_a_small_map_gives_what_it_has(carter):
    costmap = Costmap.from_grid(OccupancyGrid(closed(60, 60), 0.05), carter.outline)
    start, goal = sample_mission(costmap, 0)
    assert 0.5 <= start.distance_to(goal) < 3.0


def test_a_map_without_room_says_so(carter):
    costmap = Costmap.from_grid(OccupancyGrid(closed(24, 24), 0.05), carter.outline)
    with pytest.raises(ScenarioError, match="swing radius"):
        sample_mission(costmap, 0)
    full = Costmap.from_grid(OccupancyGrid(np.full((10, 10), 100, dtype=np.int8), 0.05), carter.outline)
    with pytest.raises(ScenarioError):
        sample_mission(full, 0)


def test_a_given_end_is_kept(costmap):
    given_start = Pose2D(1.5, 1.5, 0.3)
    start, goal = sample_mission(costmap, 0, start=given_start)
    assert start == given_start
    assert goal.distance_to(start) >= 5.0
    start, goal = sample_mission(costmap, 0, goal=(1.5, 1.5))
    assert goal == Pose2D(1.5, 1.5)
    assert start.distance_to(goal) >= 5.0


def test_a_given_end_close_to_a_wall_is_accepted_and_one_inside_refused(costmap):
    start, _ = sample_mission(costmap, 0, start=(7.75, 4.5, 0.0))  # 0.2 m before the east wall, nose to it
    assert start.x == 7.75
    with pytest.raises(ScenarioError, match=r"\(20, 4.5\) lies outside the map, which covers x 0 to 8"):
        sample_mission(costmap, 0, start=(20.0, 4.5))
    with pytest.raises(ScenarioError, match="cannot stand"):
        sample_mission(costmap_with_a_block(costmap), 0, start=(5.0, 2.5))
    with pytest.raises(InputError, match="both given"):
        sample_mission(costmap, 0, start=(1.0, 1.0), goal=(2.0, 2.0))
    with pytest.raises(InputError, match="min_distance"):
        sample_mission(costmap, 0, min_distance=-1.0)
