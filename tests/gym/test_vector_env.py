"""`NavigationVectorEnv`: a true vector environment with three autoreset modes, and the bits of single environments."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, VectorEnv

from trundle.errors import InputError, UnknownNameError, WorldError
from trundle.gym import NavigationEnv, NavigationVectorEnv
from trundle.maps import OccupancyGrid
from trundle.sim.batch.cpu import RobotCrowds
from trundle.worlds import World


def actions(steps: int, count: int, seed: int = 0) -> np.ndarray:
    rng = np.random.default_rng(seed)
    drawn = rng.uniform(-1.0, 1.0, (steps, count, 2)).astype(np.float32)
    drawn[:, :, 0] = 0.5 + 0.5 * np.abs(drawn[:, :, 0])
    return drawn


def same(mine, other) -> bool:
    return all(np.array_equal(mine[name], other[name]) for name in other)


def make(options, count=6, **more) -> NavigationVectorEnv:
    env = gymnasium.make_vec("trundle/Navigation-v0", num_envs=count, **options, **more)
    assert isinstance(env, NavigationVectorEnv)
    return env


def test_make_vec_gives_a_vector_env_whose_observations_lie_in_its_space(quick_options):
    env = make(quick_options, path_points=3, costmap_cells=8, critic=True)
    assert isinstance(env.unwrapped, VectorEnv)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observed, info = env.reset(seed=0)
    assert observed in env.observation_space
    for action in actions(40, 6):
        observed, rewards, terminated, truncated, info = env.step(action)
        assert observed in env.observation_space
    assert rewards.shape == terminated.shape == truncated.shape == info["spl"].shape == (6,)
    assert {name for name in info if not name.startswith("_")} == {name[1:] for name in info if name.startswith("_")}


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
def test_each_robot_has_the_bits_of_a_single_environment(quick_options, mode):
    vary = {"wheel_radius": {"uniform": [0.9, 1.1]}, "lidar_noise": 0.02}
    env = make(quick_options, count=5, autoreset_mode=mode, vary=vary, max_time_s=6.0)
    singles = [NavigationEnv(**quick_options, vary=vary, max_time_s=6.0) for _ in range(5)]
    observed, _ = env.reset(seed=70)
    for index, single in enumerate(singles):
        assert same({name: values[index] for name, values in observed.items()}, single.reset(seed=70 + index)[0])
    ended, ends = [False] * 5, 0
    for action in actions(80, 5):
        observed, rewards, terminated, truncated, info = env.step(action)
        for index, single in enumerate(singles):
            mine = {name: values[index] for name, values in observed.items()}
            if mode == "next_step" and ended[index]:
                ended[index] = False
                assert same(mine, single.reset()[0])
                assert (rewards[index], terminated[index], truncated[index]) == (0.0, False, False)
                continue
            expected, reward, done, late, figures = single.step(action[index])
            assert (rewards[index], terminated[index], truncated[index]) == (reward, done, late)
            ended[index] = done or late
            ends += ended[index]
            if mode == "same_step" and ended[index]:
                assert same(info["final_obs"][index], expected)
                assert info["final_info"]["path_length"][index] == figures["path_length"]
                assert info["_final_obs"][index]
                assert info["_final_info"][index]
                expected, figures = single.reset()
                assert info["path_length"][index] == 0.0
            assert same(mine, expected)
    assert ends > 5


def test_with_autoreset_disabled_robots_are_reset_by_a_mask(quick_options):
    env = make(quick_options, autoreset_mode="disabled", max_time_s=1.0)
    env.reset(seed=0)
    for action in actions(20, 6) * 0.0:
        observed, _, _, truncated, _ = env.step(action)
        if truncated.any():
            break
    assert truncated.all()
    with pytest.raises(InputError, match="autoreset is disabled"):
        env.step(action)
    mask = np.array([True, False] * 3)
    fresh, info = env.reset(options={"reset_mask": mask})
    assert same({name: values[~mask] for name, values in fresh.items()}, {n: v[~mask] for n, v in observed.items()})
    assert not np.array_equal(fresh["goal"][mask], observed["goal"][mask])
    assert info["_spl"].tolist() == mask.tolist()
    env.reset(options={"reset_mask": ~mask})
    env.step(action)


def test_the_number_of_threads_changes_nothing(quick_options):
    seen = []
    for threads in (1, 4):
        env = make(quick_options, count=70, threads=threads)
        env.reset(seed=1)
        seen.append([env.step(action) for action in actions(10, 70)][-1])
    assert same(seen[0][0], seen[1][0])
    assert np.array_equal(seen[0][1], seen[1][1])


def test_a_bad_action_of_one_moves_none(quick_options):
    env = make(quick_options)
    env.reset(seed=0)
    before = env.episodes.sim.poses.copy()
    bad = actions(1, 6)[0]
    bad[4, 1] = np.nan
    with pytest.raises(InputError, match="action of robot 4"):
        env.step(bad)
    with pytest.raises(InputError, match=r"shape \(6, 2\)"):
        env.step(bad[:3])
    assert np.array_equal(env.episodes.sim.poses, before)
    env.step(np.zeros((6, 2), np.float32))


def in_a_room(size: float, crowd: int, **more) -> NavigationVectorEnv:
    cells = np.pad(np.zeros((round(size / 0.05),) * 2, np.int8), 2, constant_values=100)
    world = World.from_map(OccupancyGrid(cells, 0.05))
    robot = {"robot": "turtlebot3_burger", "beams": 16, "min_distance": 1.0}
    return make({"world": world, **robot}, count=16, crowd=crowd, max_time_s=1.0, **more)  # 5 steps


def test_a_start_without_room_for_the_crowd_is_drawn_again():
    env = in_a_room(4.5, 8, autoreset_mode="same_step")
    env.reset(seed=0)
    for action in actions(25, 16):
        env.step(action)


@pytest.fixture
def no_room_for_robot_5(monkeypatch):
    """A seed has no room for the crowd of robot 5."""
    place = RobotCrowds.place

    def place_but_robot_5(self, chosen, recordings, poses, seeds):
        robots = np.arange(16) if chosen is None else np.asarray(chosen)
        if 5 in robots and patched:
            raise WorldError("robot 5: no room. Nothing was reset")
        place(self, chosen, recordings, poses, seeds)

    patched = [True]
    monkeypatch.setattr(RobotCrowds, "place", place_but_robot_5)
    return patched


STILL = np.zeros((16, 2), np.float32)
NO_ROOM = r"robot 5: no room\. None of 16 starts has room; the robot was not reset: reset it with another seed"


def step_until_the_end(env):
    """Step until all episodes are over; return the numbers of the episodes and the goals."""
    numbers, goals = env.episodes._episodes.copy(), env.episodes.goals.copy()
    for _ in range(4):
        env.step(STILL)
    return numbers, goals


def test_next_step_begins_no_episode_of_the_others_twice_where_one_gets_no_room(no_room_for_robot_5):
    no_room_for_robot_5.clear()
    env, unharmed = (in_a_room(4.5, 8, autoreset_mode="next_step") for _ in range(2))
    for each in (env, unharmed):
        each.reset(seed=0)
        numbers, goals = step_until_the_end(each)
        assert each.step(STILL)[3].all()
    no_room_for_robot_5.append(True)
    for _ in range(2):
        with pytest.raises(WorldError, match=NO_ROOM):
            env.step(STILL)
    others, episodes = np.arange(16) != 5, env.episodes
    assert np.array_equal(episodes.goals[5], goals[5])
    assert (episodes._episodes - numbers).tolist() == others.astype(int).tolist()
    assert (episodes.elapsed[others] == 0).all()
    no_room_for_robot_5.clear()
    for _ in range(6):
        mine, expected = env.step(STILL), unharmed.step(STILL)
        assert same(mine[0], expected[0])
        assert np.array_equal(mine[1], expected[1])


def test_same_step_ends_the_step_in_which_a_robot_gets_no_room_and_waits_for_another_seed(no_room_for_robot_5):
    no_room_for_robot_5.clear()
    env, unharmed = (in_a_room(4.5, 8, autoreset_mode="same_step") for _ in range(2))
    for each in (env, unharmed):
        each.reset(seed=0)
        step_until_the_end(each)
    expected = unharmed.step(STILL)
    no_room_for_robot_5.append(True)
    others, places = np.arange(16) != 5, env.episodes.sim.poses.copy()
    observed, rewards, _, truncated, info = env.step(STILL)
    assert truncated.all()
    assert np.array_equal(rewards, expected[1])
    assert same(
        {name: values[others] for name, values in observed.items()}, {n: v[others] for n, v in expected[0].items()}
    )
    assert same({name: values[5] for name, values in observed.items()}, info["final_obs"][5])
    assert info["time_s"].tolist() == np.where(others, 0.0, 1.0).tolist()
    assert np.array_equal(env.episodes.sim.poses[5], places[5])
    for _ in range(2):
        with pytest.raises(WorldError, match=NO_ROOM):
            env.step(STILL)
    assert (env.episodes.elapsed[others] == 0).all()
    no_room_for_robot_5.clear()
    env.reset(seed=100, options={"reset_mask": ~others})
    mine, expected = env.step(STILL), unharmed.step(STILL)
    assert same(
        {name: values[others] for name, values in mine[0].items()}, {n: v[others] for n, v in expected[0].items()}
    )


def test_a_reset_in_which_a_robot_gets_no_room_begins_the_episodes_of_the_others(no_room_for_robot_5):
    env, unharmed = (in_a_room(4.5, 8) for _ in range(2))
    with pytest.raises(WorldError, match=NO_ROOM):
        env.reset(seed=0)
    with pytest.raises(InputError, match="robot 5 has no episode"):
        env.step(STILL)
    no_room_for_robot_5.clear()
    mine, _ = env.reset(seed=0, options={"reset_mask": np.arange(16) == 5})
    assert same(mine, unharmed.reset(seed=0)[0])
    assert same(env.step(STILL)[0], unharmed.step(STILL)[0])


def test_masks_of_an_info_are_not_shared(quick_options):
    env = make(quick_options)
    env.reset(seed=0)
    info = env.step(np.zeros((6, 2), np.float32))[-1]
    info["_spl"][:] = False
    assert info["_contact"].all()


def test_seeds_may_be_a_list(quick_options):
    env = make(quick_options, count=3)
    listed, _ = env.reset(seed=[9, None, 7])
    assert same({name: values[0] for name, values in listed.items()}, NavigationEnv(**quick_options).reset(seed=9)[0])
    with pytest.raises(InputError, match="one for each of 3"):
        env.reset(seed=[1, 2])


def test_the_largest_seeds_are_those_of_a_single_environment(quick_options):
    env, single = make(quick_options, count=2), NavigationEnv(**quick_options)
    many, _ = env.reset(seed=2**64 - 2)
    assert same({name: values[1] for name, values in many.items()}, single.reset(seed=2**64 - 1)[0])
    listed, _ = env.reset(seed=np.array([2**64 - 1, 0], dtype=np.uint64))
    assert np.array_equal(listed["goal"][0], many["goal"][1])


@pytest.mark.parametrize(
    "seed", [-1, 2**64, 2**64 - 1, 1.5, True, "7", [0, 2**64], [0, 1.5], np.array(1.5), [[0], [1]]]
)
def test_a_bad_seed_is_named_and_resets_nothing(quick_options, seed):
    env = make(quick_options, count=2)
    env.reset(seed=0)
    goals = env.episodes.goals.copy()
    with pytest.raises(InputError, match="seed"):
        env.reset(seed=seed)
    assert np.array_equal(env.episodes.goals, goals)


def test_nothing_is_drawn_before_all_robots_have_an_episode(quick_options):
    env = make(quick_options, count=2, render_mode="rgb_array")
    assert env.render() is None
    env.reset(seed=0)
    assert len(env.render()) == 2


@pytest.mark.parametrize(
    ("more", "error", "text"),
    [
        ({"count": 0}, InputError, "num_envs"),
        ({"autoreset_mode": "later"}, UnknownNameError, "same_step"),
        ({"render_mode": "human"}, InputError, "rgb_array"),
    ],
)
def test_bad_arguments_are_named(quick_options, more, error, text):
    with pytest.raises(error, match=text):
        make(quick_options, **more)


@pytest.mark.parametrize("mask", [[True] * 3, np.ones(6), np.ones(5, dtype=bool)])
def test_a_bad_reset_mask_is_named(quick_options, mask):
    env = make(quick_options)
    env.reset(seed=0)
    with pytest.raises(InputError, match="reset_mask"):
        env.reset(options={"reset_mask": mask})


def test_a_misspelt_option_of_reset_resets_nothing(quick_options):
    env = make(quick_options)
    env.reset(seed=0)
    poses = env.unwrapped.episodes.sim.poses.copy()
    with pytest.raises(InputError, match="Did you mean 'reset_mask'"):
        env.reset(options={"reset_maks": np.ones(5, dtype=bool)})
    assert np.array_equal(env.unwrapped.episodes.sim.poses, poses)


def test_options_of_reset_that_are_no_mapping_are_named(quick_options):
    with pytest.raises(InputError, match="options of reset must be a mapping, got 3"):
        make(quick_options).reset(options=3)


def test_a_step_needs_a_reset_of_every_robot(quick_options):
    env = make(quick_options, count=2)
    with pytest.raises(InputError, match="robot 0 has no episode"):
        env.step(np.zeros((2, 2), np.float32))
    env.reset(options={"reset_mask": np.array([True, False])})
    with pytest.raises(InputError, match="robot 1 has no episode"):
        env.step(np.zeros((2, 2), np.float32))
