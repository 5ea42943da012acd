"""`NavigationVectorEnv` with `device="cuda"`: tensors that stay there, and the episodes of the processor.

Warp's own CPU device runs the same kernels where there is no GPU.
"""

import gymnasium
import numpy as np
import pytest

import trundle.gym
from trundle.errors import InputError, WorldError
from trundle.gym.episodes import Episodes
from trundle.maps import OccupancyGrid
from trundle.worlds import World

wp = pytest.importorskip("warp", reason="needs Warp, of the extra gpu")
torch = pytest.importorskip("torch", reason="needs PyTorch")

from trundle.sim.batch.warp.engine import WarpEngine  # noqa: E402 - needs Warp

ALL = {"path_points": 3, "costmap_cells": 8, "critic": True}
REWARDS = {"progress": 2.0, "time": -0.5, "smoothness": -0.1, "reverse": -1.0, "contact": -3.0, "success": 5.0}
COUNT = 12


def make(options, where="cuda", **more):
    return gymnasium.make_vec("trundle/Navigation-v0", num_envs=COUNT, device=where, **options, **more)


def actions(steps: int) -> np.ndarray:
    drawn = np.random.default_rng(0).uniform(-1.0, 1.0, (steps, COUNT, 2)).astype(np.float32)
    drawn[:, :, 0] = 0.5 + 0.5 * np.abs(drawn[:, :, 0])
    return drawn


def agree(mine, other) -> None:
    """Check that tensors are the arrays of the processor: all but sines, cosines and square roots has its bits."""
    assert mine.keys() == other.keys()
    for name, values in mine.items():
        if isinstance(values, dict):
            agree(values, other[name])
            continue
        assert isinstance(values, torch.Tensor), name
        found, expected = values.cpu().numpy(), other[name]
        assert found.dtype == expected.dtype, name
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6, err_msg=name)


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
@pytest.mark.parametrize(
    "more",
    [
        {},
        {**ALL, "rewards": REWARDS, "max_time_s": 4.0},
        {"movers": 3, "max_time_s": 4.0, "vary": {"wheel_radius": {"uniform": [0.9, 1.1]}, "lidar_noise": 0.02}},
        {"crowd": 3, "movers": 2, "max_time_s": 4.0},
    ],
    ids=["plain", "all observations", "movers and noise", "people"],
)
def test_episodes_are_those_of_the_processor(quick_options, device, mode, more):
    mine, other = (
        make(quick_options, autoreset_mode=mode, **more),
        make(quick_options, "cpu", autoreset_mode=mode, **more),
    )
    for observed, expected in zip(mine.reset(seed=3), other.reset(seed=3), strict=True):
        agree(observed, expected)
    ends = 0
    for action in actions(60):
        observed, rewards, terminated, truncated, info = mine.step(torch.from_numpy(action).to(device))
        expected, *rest, figures = other.step(action)
        agree(observed, expected)
        agree(
            {"rewards": rewards, "terminated": terminated, "truncated": truncated},
            dict(zip(("rewards", "terminated", "truncated"), rest, strict=True)),
        )
        final, ended = info.pop("final_obs", None), figures.pop("final_obs", None)
        agree(info, figures)
        done = rest[1] | rest[2]
        ends += int(done.sum())
        assert (final is not None) == (ended is not None) == (mode == "same_step" and done.any())
        for robot in np.flatnonzero(done) if final is not None else ():
            agree({name: values[robot] for name, values in final.items()}, ended[robot])
    assert ends > 5


def test_a_start_without_room_for_the_crowd_is_drawn_again_alike(device):
    cells = np.pad(np.zeros((90, 90), np.int8), 2, constant_values=100)
    options = {"world": World.from_map(OccupancyGrid(cells, 0.05)), "robot": "turtlebot3_burger", "beams": 16}
    options |= {"min_distance": 1.0, "crowd": 8, "max_time_s": 1.0, "autoreset_mode": "same_step"}
    mine, other = make(options), make(options, "cpu")
    found = set()
    for observed, expected in zip(mine.reset(seed=0), other.reset(seed=0), strict=True):
        agree(observed, expected)
    for action in actions(25):
        observed, *_ = mine.step(torch.from_numpy(action).to(device))
        expected, *_ = other.step(action)
        agree(observed, expected)
        found.update(other.unwrapped.episodes._episodes.tolist())
    assert len(found) > 4


@pytest.mark.parametrize("mode", ["next_step", "same_step"])
def test_where_one_robot_gets_no_room_the_others_lose_nothing_on_a_device_too(device, mode, monkeypatch):
    start, patched = Episodes._start, []

    def start_but_robot_5(self, robots, keys, maps, recordings, drawn, attempt):
        fits = (robots != 5) | (not patched)
        error = None if fits.all() else WorldError("robot 5: no room. Nothing was reset")
        if fits.any():
            start(self, robots[fits], keys[fits], maps[fits], recordings[fits], drawn, attempt)
        return error

    def refuse(*_):
        raise TypeError("NumPy reads no tensor of a GPU")

    monkeypatch.setattr(Episodes, "_start", start_but_robot_5)
    monkeypatch.setattr(torch.Tensor, "__array__", refuse)  # as a GPU's do
    cells = np.pad(np.zeros((90, 90), np.int8), 2, constant_values=100)
    options = {"world": World.from_map(OccupancyGrid(cells, 0.05)), "robot": "turtlebot3_burger", "beams": 16}
    options |= {"min_distance": 1.0, "crowd": 2, "max_time_s": 0.4, "autoreset_mode": mode}
    both = make(options).unwrapped, make(options, "cpu").unwrapped
    still, only_5 = np.zeros((COUNT, 2), np.float32), np.arange(COUNT) == 5

    def agree_on(call) -> None:
        mine, other = (call(env) for env in both)
        for found, expected in zip(mine, other, strict=True):
            found = found if isinstance(found, dict) else {"values": found}
            expected = expected if isinstance(expected, dict) else {"values": expected}
            agree(*({n: v for n, v in each.items() if n != "final_obs"} for each in (found, expected)))

    def refused(call) -> None:
        for env in both:
            with pytest.raises(WorldError, match=r"robot 5: no room.*reset it with another seed"):
                call(env)

    patched.append(True)
    refused(lambda env: env.reset(seed=0))
    patched.clear()
    agree_on(lambda env: env.reset(seed=0, options={"reset_mask": only_5}))
    agree_on(lambda env: env.step(still))
    patched.append(True)
    agree_on(lambda env: env.step(still))  # the end of all episodes
    for _ in range(2):
        refused(lambda env: env.step(still))
    patched.clear()
    agree_on(lambda env: env.reset(seed=100, options={"reset_mask": only_5}))
    for _ in range(4):
        agree_on(lambda env: env.step(still))


def test_tensors_are_on_the_device_and_numpy_actions_are_taken(quick_options, device):
    env = make(quick_options)
    observed, info = env.reset(seed=0)
    assert all(values.device.type == device for values in (*observed.values(), *info.values()))
    moved = env.step(actions(1)[0])[4]
    assert moved["path_length"].device.type == device


def test_robots_are_reset_by_a_mask_on_the_device(quick_options, device):
    env = make(quick_options, autoreset_mode="disabled", max_time_s=1.0)
    env.reset(seed=0)
    for _ in range(5):
        observed, _, _, truncated, _ = env.step(torch.zeros((COUNT, 2), device=device))
    assert truncated.all()
    with pytest.raises(InputError, match="autoreset is disabled"):
        env.step(torch.zeros((COUNT, 2), device=device))
    mask = torch.arange(COUNT, device=device) % 2 == 0
    fresh, info = env.reset(options={"reset_mask": mask})
    assert torch.equal(fresh["ranges"][~mask], observed["ranges"][~mask])
    assert not torch.equal(fresh["goal"][mask], observed["goal"][mask])
    assert torch.equal(info["_spl"], mask)


@pytest.mark.parametrize("bad", [float("nan"), 1.5])
def test_a_bad_action_is_an_error_that_names_the_robot(quick_options, device, bad):
    env = make(quick_options)
    env.reset(seed=0)
    given = torch.zeros((COUNT, 2), device=device)
    given[7, 1] = bad

    def step_on() -> None:
        for _ in range(3):  # the GPU may find it during a later step
            env.step(given)
            wp.synchronize()

    with pytest.raises(InputError, match=r"robot 7 .*from \[-1.0, -1.0\] to \[1.0, 1.0\]: clip it"):
        step_on()
    env.reset(seed=0)
    env.step(torch.zeros((COUNT, 2), device=device))
    with pytest.raises(InputError, match=r"shape \(12, 2\)"):
        env.step(given[:3])


def test_a_reset_says_that_an_action_before_was_bad(quick_options, device, monkeypatch):
    """As where the GPU is not done with the step when the reset comes."""
    env = make(quick_options)
    env.reset(seed=0)
    given = torch.zeros((COUNT, 2), device=device)
    given[7, 1] = 1.5
    with monkeypatch.context() as patch:
        patch.setattr(WarpEngine, "check", lambda _: None)
        env.step(given)
    with pytest.raises(InputError, match=r"robot 7 .*clip it, and reset all robots"):
        env.reset(seed=0)
    env.reset(seed=0)
    assert (env.step(torch.zeros((COUNT, 2), device=device))[-1]["time_s"] == 0.2).all()


def test_pictures_and_metadata_are_made_of_tensors_too(quick_options, device):
    env = make(quick_options, render_mode="rgb_array", movers=2)
    env.reset(seed=1)
    pictures = env.render()
    other = make(quick_options, "cpu", render_mode="rgb_array", movers=2)
    other.reset(seed=1)
    np.testing.assert_array_equal(pictures[3], other.render()[3])
    assert trundle.gym.policy_metadata(env) == trundle.gym.policy_metadata(other)


def test_stable_baselines_gets_arrays_of_the_host(device):
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3")
    from trundle.gym.sb3 import Sb3VecEnv

    options = {"world": "office", "worlds": 1, "robot": "jackal", "beams": 24, "max_time_s": 4.0}
    mine, other = Sb3VecEnv(3, device="cuda", **options), Sb3VecEnv(3, **options)
    for env in (mine, other):
        env.seed(3)
        env.reset()
    for _ in range(20):
        observed, rewards, dones, infos = mine.step(np.zeros((3, 2), dtype=np.float32))
        expected, _, ends, figures = other.step(np.zeros((3, 2), dtype=np.float32))
    assert all(isinstance(values, np.ndarray) for values in (*observed.values(), rewards, dones))
    np.testing.assert_allclose(observed["ranges"], expected["ranges"])
    assert dones.tolist() == ends.tolist() == [True] * 3
    assert infos[1]["path_length"] == figures[1]["path_length"]
    np.testing.assert_allclose(infos[1]["terminal_observation"]["ranges"], figures[1]["terminal_observation"]["ranges"])


def test_rsl_rls_tensors_stay_on_the_device(device):
    pytest.importorskip("rsl_rl", reason="needs RSL-RL")
    from trundle.gym.rsl_rl import RslRlVecEnv

    options = {"world": "office", "worlds": 1, "robot": "jackal", "beams": 24, "max_time_s": 4.0}
    env = RslRlVecEnv(3, device="cuda", learner_device=device, **options)
    env.episode_length_buf = torch.tensor([18, 0, 0], device=device)
    before = env.episode_length_buf
    for _ in range(2):
        observed, rewards, dones, extras = env.step(torch.full((3, 2), 0.0, device=device))
    assert before.tolist() == [18, 0, 0]  # a copy
    assert {each.device.type for each in (*observed.values(), rewards, dones, extras["time_outs"])} == {device}
    assert dones.tolist() == [True, False, False]  # what was set counts towards the time limit
    assert env.episode_length_buf.tolist() == [0, 2, 2]
    assert extras["log"]["/time_s"] == pytest.approx(0.4)  # what it has driven
