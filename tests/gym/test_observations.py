"""What is observed, against the robot's state and map."""

import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.gym import NavigationEnv
from trundle.maps import OccupancyGrid
from trundle.sim.batch import NOTHING


def room() -> OccupancyGrid:
    """A room of 10 m with a wall across, open at its upper end, and its map turned."""
    from trundle.geometry import Pose2D

    cells = np.pad(np.zeros((200, 200), np.int8), 2, constant_values=100)
    cells[:150, 100:104] = 100
    return OccupancyGrid(cells, 0.05, Pose2D(3.0, -2.0, 0.7))


def test_goal_and_velocity_are_in_base_link():
    env = NavigationEnv(world=room(), robot="turtlebot3_burger")
    env.reset(seed=1)
    observed = env.step(np.array([0.5, 0.5], dtype=np.float32))[0]
    x, y, yaw = env.episodes.sim.poses[0]
    dx, dy = env.episodes.goals[0] - (x, y)
    direction = math.atan2(dy, dx) - yaw
    assert observed["goal"] == pytest.approx([math.hypot(dx, dy), math.cos(direction), math.sin(direction)], abs=1e-5)
    assert observed["velocity"] == pytest.approx(env.episodes.sim.twists[0], abs=1e-6)


def test_beams_without_a_return_read_range_max():
    env = NavigationEnv(world=room(), robot="turtlebot3_burger")
    observed, _ = env.reset(seed=1)
    scan = env.episodes.sim.scan_exactly()[0]
    assert np.isinf(scan).any()
    assert observed["ranges"] == pytest.approx(np.where(np.isinf(scan), 3.5, scan), abs=1e-6)


def test_the_path_leads_to_the_goal_around_the_wall_and_the_critic_knows_its_length():
    env = NavigationEnv(world=room(), robot="turtlebot3_burger", path_points=50, critic=True)
    seen = 0
    for seed in range(8):
        observed, info = env.reset(seed=seed)
        x, y, yaw = env.episodes.sim.poses[0]
        cos, sin = math.cos(yaw), math.sin(yaw)
        path = observed["path"] @ np.array([(cos, sin), (-sin, cos)]) + (x, y)
        steps = np.diff(np.vstack([(x, y), path]), axis=0)
        assert np.hypot(*steps.T).sum() == pytest.approx(info["distance_to_goal"], rel=0.35, abs=0.5)
        local = env.episodes.arena.grids[0].origin.inverse().transform_points(path)
        assert (np.abs(local[local[:, 1] < 7.0, 0] - 5.2) > 0.25).all()  # it keeps away from the wall
        assert path[-1] == pytest.approx(env.episodes.goals[0], abs=0.05)
        straight = math.hypot(*(env.episodes.goals[0] - (x, y)))
        seen += info["distance_to_goal"] > 1.3 * straight
        assert observed["critic"][0] == pytest.approx(info["distance_to_goal"], abs=1e-4)
    assert seen > 0


def test_the_costmap_is_that_of_the_map_around_the_robot():
    grid = room()
    env = NavigationEnv(world=grid, robot="turtlebot3_burger", costmap_cells=21)
    observed, _ = env.reset(seed=3)
    costmap = Costmap.from_grid(grid, env.episodes.arena.robot)
    x, y, yaw = env.episodes.sim.poses[0]
    for row, col in ((10, 10), (10, 20), (0, 3)):
        ahead, left = (col - 10) * 0.05, (row - 10) * 0.05
        at = x + math.cos(yaw) * ahead - math.sin(yaw) * left, y + math.sin(yaw) * ahead + math.cos(yaw) * left
        inside = costmap.contains(*(int(index) for index in costmap.world_to_cell(*at)))
        assert observed["costmap"][row, col] == (costmap.cost_at(*at) if inside else 255)


def test_noise_stays_within_the_bounds():
    env = NavigationEnv(world=room(), robot="turtlebot3_burger", vary={"lidar_noise": 1.0})
    observed, _ = env.reset(seed=1)
    assert observed in env.observation_space
    assert not np.array_equal(observed["ranges"], env.step(np.zeros(2, np.float32))[0]["ranges"])


def test_path_and_costmap_lack_the_unmapped_boxes_and_all_else_has_them():
    options = {"world": "office", "worlds": 2, "path_points": 1, "costmap_cells": 60, "critic": True}
    plain, boxed = NavigationEnv(**options), NavigationEnv(unmapped_boxes=20, **options)
    arena = boxed.episodes.arena
    for known, true, same in zip(arena.known, arena.grids, plain.episodes.arena.grids, strict=True):
        np.testing.assert_array_equal(known.data, same.data)
        assert (known.origin, known.shape) == (true.origin, true.shape)
        differ = known.data != true.data
        assert 500 < differ.sum() < 20 * 16**2 * 4
        assert not Costmap.from_grid(known, arena.robot).data[(true.data == 100) & differ].max() >= 254
    np.testing.assert_array_equal(arena.costs(), plain.episodes.arena.costs())
    # The path leads through a box somewhere; what the critic knows never does.
    ahead = [arena.cells_ahead(0.5, grids, 1) for grids in (arena.known, arena.grids)]
    assert (ahead[0] != ahead[1]).any()
    boxed.reset(seed=3)
    assert boxed.episodes.sim.contacts[0, 0] == NOTHING


def test_boxes_are_the_same_for_a_seed_and_other_ones_in_each_split():
    grids = [
        NavigationEnv(world="office", worlds=1, unmapped_boxes=5, **more).episodes.arena.grids[0].data
        for more in ({}, {}, {"split": "test"})
    ]
    np.testing.assert_array_equal(grids[0], grids[1])
    assert (grids[0] != grids[2]).any()


def test_a_map_has_no_unmapped_boxes():
    with pytest.raises(InputError, match=r"World\.from_map"):
        NavigationEnv(world=room(), robot="turtlebot3_burger", unmapped_boxes=3)
