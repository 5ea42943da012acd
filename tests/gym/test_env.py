"""`NavigationEnv`: Gymnasium's conformance check, episodes, rewards and refused arguments."""

import warnings
from concurrent.futures import ThreadPoolExecutor

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import trundle.gym
from trundle.errors import InputError, ScenarioError, UnknownNameError, WorldError
from trundle.gym import NavigationEnv, arena
from trundle.maps import OccupancyGrid
from trundle.worlds import World

GRID = OccupancyGrid(np.pad(np.zeros((80, 80), np.int8), 2, constant_values=100), 0.05)
AHEAD = np.array([0.6, 0.1], dtype=np.float32)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"path_points": 4, "costmap_cells": 16, "critic": True},
        {
            "robot": "nova_carter",
            "world_options": {"rows": 5, "columns": 5},
            "movers": 2,
            "max_time_s": 10.0,
            "lidar": True,
        },
    ],
    ids=["plain", "all observations", "movers"],
)
def test_gymnasiums_check_passes_without_a_warning(quick_options, options):
    env = gymnasium.make("trundle/Navigation-v0", render_mode="rgb_array", **{**quick_options, **options})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)
    env.close()


def test_actions_may_be_speeds(quick_options):
    env = NavigationEnv(**quick_options, scaled_actions=False)
    env.reset(seed=0)
    assert env.action_space.high.tolist() == pytest.approx([0.22, 2.84])
    for _ in range(2):
        env.step(np.array([0.1, 0.2], dtype=np.float32))
    assert env.episodes.sim.twists[0] == pytest.approx([0.1, 0.2], abs=1e-6)


def test_pictures_show_the_robot_and_its_goal(quick_options):
    env = gymnasium.make("trundle/Navigation-v0", render_mode="rgb_array", **quick_options)
    env.reset(seed=1)
    picture = env.render()
    assert picture.dtype == np.uint8
    assert max(picture.shape) == 480
    for color in ((33, 108, 196), (34, 150, 92)):
        assert (picture == color).all(axis=2).sum() > 5


def test_the_same_seed_gives_the_same_episodes_and_the_next_reset_another(quick_options):
    runs = []
    for _ in range(2):
        env = NavigationEnv(**quick_options)
        first, _ = env.reset(seed=5)
        following = [env.step(AHEAD)[0] for _ in range(4)]
        runs.append([first, *following, env.reset()[0], env.reset(seed=5)[0]])
    for mine, other in zip(*runs, strict=True):
        assert all(np.array_equal(mine[name], other[name]) for name in mine)
    assert np.array_equal(runs[0][0]["ranges"], runs[0][-1]["ranges"])
    assert not np.array_equal(runs[0][0]["ranges"], runs[0][-2]["ranges"])


def test_rewards_are_the_sum_of_their_terms_and_progress_adds_up_to_the_distance(quick_options):
    weights = {"progress": 2.0, "time": -0.5, "smoothness": -0.1, "reverse": -1.0, "contact": -3.0, "success": 5.0}
    env = NavigationEnv(**quick_options, rewards=weights)
    _, info = env.reset(seed=2)
    left, progress = info["distance_to_goal"], 0.0
    for action in ((0.3, 0.9), (0.3, 0.9), (-0.3, 0.2), (0.1, -0.4)):
        _, reward, terminated, _, info = env.step(np.array(action, dtype=np.float32))
        assert reward == pytest.approx(sum(info[f"reward/{name}"] for name in weights))
        progress += info["reward/progress"] / 2.0
        assert (info["reward/reverse"] < 0.0) == (action[0] < 0.0 and not terminated) or terminated
        if terminated:
            break
    assert progress == pytest.approx(left - info["distance_to_goal"], abs=1e-9)


def near_the_goal(env: NavigationEnv) -> None:
    """Put the robot just before its goal, headed for it."""
    env.reset(seed=3)
    episodes = env.episodes
    episodes.sim.reset((*(episodes.goals[0] - (0.5, 0.0)), 0.0), maps=episodes.sim.places[:, 0])


def test_arrival_terminates_with_success_and_spl(quick_options):
    env = NavigationEnv(**quick_options)
    near_the_goal(env)
    for _ in range(20):
        _, reward, terminated, truncated, info = env.step(np.array([1.0, 0.0], dtype=np.float32))
        if terminated:
            break
    assert (terminated, truncated, info["is_success"], info["contact"]) == (True, False, True, False)
    assert reward > 9.0
    assert 0.0 < info["spl"] <= 1.0
    assert info["path_length"] == pytest.approx(0.2, abs=0.06)


def test_contact_terminates_without_success(quick_options):
    env = NavigationEnv(**quick_options)
    env.reset(seed=4)
    for _ in range(300):
        _, reward, terminated, _, info = env.step(np.array([1.0, 0.0], dtype=np.float32))
        if terminated:
            break
    assert (terminated, info["is_success"], info["contact"], info["spl"]) == (True, False, True, 0.0)
    assert reward < -9.0


def test_time_truncates(quick_options):
    env = NavigationEnv(**quick_options, max_time_s=1.0)
    env.reset(seed=4)
    ends = [env.step(np.zeros(2, dtype=np.float32))[2:4] for _ in range(5)]
    assert ends == [(False, False)] * 4 + [(False, True)]


def test_a_robot_that_leaves_its_map_has_failed():
    grid = OccupancyGrid(np.zeros((60, 60), np.int8), 0.05)  # without walls
    env = NavigationEnv(world=grid, robot="turtlebot3_burger", min_distance=1.0)
    env.reset(seed=0)
    for _ in range(200):
        _, _, terminated, _, info = env.step(np.array([1.0, 0.0], dtype=np.float32))
        if terminated:
            break
    assert info["off_map"] != info["is_success"]


def test_worlds_of_training_validation_and_test_differ(quick_options):
    names = [
        NavigationEnv(**quick_options, split=split).episodes.arena.names for split in ("train", "validation", "test")
    ]
    assert len({name for each in names for name in each}) == 6
    again = NavigationEnv(**quick_options, split="test").episodes.arena.names
    assert again == names[2]
    assert NavigationEnv(**quick_options, seed=1).episodes.arena.names != names[0]


def test_varied_wheels_drive_farther_and_lidars_miss_beams(quick_options):
    open_grid = OccupancyGrid(np.pad(np.zeros((100, 100), np.int8), 2, constant_values=100), 0.05)
    options = {"world": open_grid, "robot": "turtlebot3_burger", "min_distance": 1.0}

    def drive(**vary):
        env = NavigationEnv(**options, vary=vary)
        observed, _ = env.reset(seed=0)
        for _ in range(2):
            _, _, _, _, info = env.step(np.array([0.5, 0.0], dtype=np.float32))
        return info["path_length"], float((observed["ranges"] >= 3.5).mean())

    length, missed = drive()
    assert drive(wheel_radius=1.2)[0] == pytest.approx(1.2 * length, rel=0.05)
    assert drive(lidar_dropout={"uniform": [0.5, 0.6]})[1] > missed + 0.3
    assert drive(wheel_radius={"normal": [1.1, 0.02]})[0] == drive(wheel_radius={"normal": [1.1, 0.02]})[0]


@pytest.mark.parametrize("action", [(np.nan, 0.0), (2.0, 0.0), (0.0, -np.inf)])
def test_a_bad_action_is_refused_and_the_robot_stays(quick_options, action):
    env = NavigationEnv(**quick_options)
    env.reset(seed=0)
    before = env.episodes.sim.poses.copy()
    with pytest.raises(InputError, match="action of robot 0"):
        env.step(np.array(action, dtype=np.float32))
    assert np.array_equal(env.episodes.sim.poses, before)
    env.step(AHEAD)


def test_a_step_needs_a_reset(quick_options):
    with pytest.raises(InputError, match="call reset"):
        NavigationEnv(**quick_options).step(AHEAD)


@pytest.mark.parametrize(
    ("options", "error", "text"),
    [
        ({"beems": 3}, InputError, r"no option beems \(did you mean beams"),
        ({"rewards": {"progres": 1.0}}, UnknownNameError, "Did you mean 'progress'"),
        ({"rewards": {"time": np.nan}}, InputError, "weight of the reward time"),
        ({"vary": {"friction": 0.5}}, InputError, "friction cannot be varied.*mujoco"),
        ({"vary": {"odometry_slip": 0.1}}, InputError, "true pose"),
        ({"vary": {"wheel_radus": 1.0}}, UnknownNameError, "wheel_radius"),
        ({"vary": {"track": {"uniform": [0.1, 1.0]}}}, InputError, "out of range"),
        ({"vary": {"track": {"gauss": [1.0, 1.0]}}}, InputError, "vary: track"),
        ({"split": "eval"}, UnknownNameError, "split"),
        ({"world": "mase"}, UnknownNameError, "maze"),
        ({"world": []}, InputError, "at least one world"),
        ({"world": 3}, InputError, "world"),
        ({"robot": "nova_crater"}, UnknownNameError, "nova_carter"),
        ({"period_s": 0.0123}, InputError, "multiple"),
        ({"beams": 0}, InputError, "beams"),
        ({"lidar": False}, InputError, "no lidar"),
        ({"lidar": 3}, InputError, "lidar must be true, false, or names"),
        ({"lidar": ["front", 3]}, UnknownNameError, "unknown lidar of nova_carter '3'"),
        ({"lidar": ["front", "front"]}, InputError, "'front' is chosen twice"),
        ({"world_options": 3}, InputError, "world_options must be a mapping"),
        ({"world_options": {3: 1}}, InputError, "world_options must be a mapping"),
        ({"world_options": {"seed": 1}}, InputError, "the options seed and split"),
        ({"world": GRID, "worlds": 2}, InputError, "worlds has no effect where world is a map"),
        ({"world": [GRID], "world_options": {}}, InputError, "world_options has no effect"),
        ({"world": GRID, "resolution": 0.1}, InputError, "resolution has no effect where world is a map: leave"),
        ({"world": "site.yaml", "resolution": 0.1}, InputError, "resolution has no effect"),
        (
            {"world": World.from_map(GRID), "worlds": 2},
            InputError,
            "worlds has no effect where world is a map or a world",
        ),
        ({"world": ["maze", "office"], "worlds": [3]}, InputError, "worlds has 1 numbers for 2 of world"),
        ({"world": ["maze", "office"], "worlds": [3, 0]}, InputError, r"worlds\[1\] must be an integer from 1"),
        ({"world": "maze", "worlds": "3"}, InputError, "worlds must be an integer or a list"),
        ({"world": ["maze", "office"], "worlds": b"13"}, InputError, "worlds must be an integer or a list"),
        ({"world": ["maze", "office"], "worlds": (one for one in (1, 2))}, InputError, "an integer or a list"),
        ({"world": ["maze", "office"], "worlds": np.ones((2, 2), int)}, InputError, r"worlds\[0\] must be"),
        ({"world": ["maze", GRID], "worlds": [3, 2]}, InputError, r"worlds\[1\] must be 1, as world\[1\] is one world"),
        ({"world": "maze", "worlds": 1.0}, InputError, "worlds must be an integer or a list"),
        ({"device": "cuda"}, InputError, "cpu"),
        ({"render_mode": "ansi"}, UnknownNameError, "rgb_array"),
    ],
)
def test_bad_options_are_named(options, error, text):
    with pytest.raises(error, match=text):
        NavigationEnv(**options)


def test_a_world_without_room_is_named():
    cells = np.full((40, 40), 100, np.int8)
    cells[18:22, 18:22] = 0
    with pytest.raises(ScenarioError, match="no start and goal"):
        NavigationEnv(world=OccupancyGrid(cells, 0.05), robot="nova_carter")


def test_several_worlds_of_several_kinds(quick_options):
    env = NavigationEnv(**{**quick_options, "world": ["maze", GRID, World.from_map(GRID)]})
    assert len(env.episodes.arena.names) == 4
    coarse = NavigationEnv(world=World.from_map(GRID), robot="turtlebot3_burger", resolution=0.1)
    assert coarse.episodes.arena.resolution == 0.1


@pytest.mark.parametrize("kind", [list, tuple, np.array])
def test_each_kind_of_world_has_its_own_number(kind):
    env = NavigationEnv(world=["maze", "office"], worlds=kind([2, 1]), robot="turtlebot3_burger", beams=36)
    assert [name.split("/")[0] for name in env.episodes.arena.names] == ["maze", "maze", "office"]


def test_a_world_without_room_for_its_movers_is_named():
    world = World.from_map(GRID)
    with pytest.raises(WorldError, match=r"office/0: the crowd 'people': found no place"):
        NavigationEnv(world=["office", world], movers=400, max_time_s=1.0, robot="turtlebot3_burger")


@pytest.mark.parametrize("given", [{"threads": 2}, {}])
def test_an_arena_is_made_by_as_many_threads_as_are_given(quick_options, monkeypatch, given):
    found = set()

    class Watched(ThreadPoolExecutor):
        def __init__(self, workers=None):
            found.add(workers)
            super().__init__(workers)

    monkeypatch.setattr(arena, "ThreadPoolExecutor", Watched)
    monkeypatch.setenv("TRUNDLE_THREADS", "2")
    NavigationEnv(**quick_options, path_points=2, **given).reset(seed=0)
    assert found == {2}


def test_the_environments_are_registered():
    assert {f"trundle/{name}-v0" for name in ("Navigation", "Barn", "DynaBarn")} <= set(gymnasium.registry)
    assert trundle.gym.REWARD_TERMS


def test_a_crowd_sees_the_robot_and_is_another_in_each_episode():
    options = {"world": "office", "worlds": 1, "crowd": 6, "beams": 24, "max_time_s": 20.0}
    with gymnasium.make("trundle/Navigation-v0", **options) as env:
        episodes = env.unwrapped.episodes  # type: ignore[attr-defined]
        places = []
        for seed in (1, 1, 2):
            env.reset(seed=seed)
            for _ in range(10):
                env.step(np.zeros(2, np.float32))
            places.append(episodes.sim.movers(0))
    assert len(places[0]) == 6
    assert np.array_equal(places[0], places[1])
    assert not np.array_equal(places[0], places[2])


@pytest.mark.parametrize("seed", [2**64, -1, 1.5, True])
def test_a_bad_seed_is_named_and_the_episode_goes_on(quick_options, seed):
    env = NavigationEnv(**quick_options)
    env.reset(seed=2**64 - 1)
    with pytest.raises(InputError, match="seed must be an integer from 0 to 18446744073709551615"):
        env.reset(seed=seed)
    assert env.step(AHEAD)[-1]["time_s"] == pytest.approx(0.2)
