"""`NavigationVectorEnv`: a true vector environment with three autoreset modes, and the bits of single environments."""

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, VectorEnv

from trundle.errors import InputError, UnknownNameError, WorldError
from trundle.gym import NavigationEnv, NavigationVectorEnv
from trundle.maps import OccupancyGrid
from trundle.sim.batch.crowds import RobotCrowds
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


@pytest.mark.parametrize("mode", ["same_step", "next_step"])
def test_robots_that_get_no_room_keep_their_episodes(mode):
    env = in_a_room(4.5, 8, autoreset_mode=mode)
    env.reset(seed=0)
    episodes, place = env.episodes, RobotCrowds.place
    places, goals, drawn = episodes.sim.poses.copy(), episodes.goals.copy(), episodes._episodes.copy()

    def place_but_robot_5(self, chosen, *given):
        if 5 in (np.arange(16) if chosen is None else chosen):
            raise WorldError("robot 5: no room. Nothing was reset")
        place(self, chosen, *given)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RobotCrowds, "place", place_but_robot_5)
        for _ in range(4 if mode == "same_step" else 5):
            env.step(np.zeros((16, 2), np.float32))
        with pytest.raises(WorldError, match=r"robot 5: no room\. None of 16 starts has room; the robot was not reset"):
            env.step(np.zeros((16, 2), np.float32))
    others = np.arange(16) != 5
    assert np.array_equal(episodes.goals[5], goals[5])
    assert np.array_equal(episodes.sim.poses[5], places[5])
    assert episodes._episodes[5] == drawn[5]
    assert (episodes.elapsed[others] == 0).all()
    assert (episodes._episodes[others] == drawn[others] + 1).all()
    assert (episodes.distances[others] == episodes.shortest[others]).all()
    env.step(np.zeros((16, 2), np.float32))


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


@pytest.mark.parametrize(
    ("more", "error", "text"),
    [
        ({"count": 0}, InputError, "num_envs"),
        ({"crowd": 8, "device": "cuda"}, InputError, "crowd is computed on the CPU.*device='cpu', or movers=8"),
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


def test_a_step_needs_a_reset_of_every_robot(quick_options):
    env = make(quick_options, count=2)
    with pytest.raises(InputError, match="robot 0 has no episode"):
        env.step(np.zeros((2, 2), np.float32))
    env.reset(options={"reset_mask": np.array([True, False])})
    with pytest.raises(InputError, match="robot 1 has no episode"):
        env.step(np.zeros((2, 2), np.float32))
