"""The adapters for Stable-Baselines3 and RSL-RL."""

import subprocess
import sys

import numpy as np
import pytest

from trundle.errors import InputError

OPTIONS = {"world": "office", "worlds": 1, "robot": "jackal", "beams": 24, "max_time_s": 4.0, "threads": 1}


@pytest.mark.parametrize(("adapter", "library"), [("sb3", "stable_baselines3"), ("rsl_rl", "rsl_rl")])
def test_without_the_library_the_import_says_how_to_install_it(adapter, library):
    code = f"import sys; sys.modules[{library!r}] = None; import trundle.gym.{adapter}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "MissingExtraError" in done.stderr.strip().splitlines()[-1]
    assert "Install it with: pip install" in done.stderr


def test_stable_baselines_learns_on_it():
    pytest.importorskip("stable_baselines3", reason="needs Stable-Baselines3")
    from stable_baselines3 import PPO

    from trundle.gym.sb3 import Sb3VecEnv

    env = Sb3VecEnv(4, **OPTIONS)
    env.seed(3)
    first = env.reset()
    ends = []
    for _ in range(21):  # episodes are 20 steps long at most
        observed, rewards, dones, infos = env.step(np.zeros((4, 2), dtype=np.float32))
        ends += [info for info, done in zip(infos, dones, strict=True) if done]
    assert observed["ranges"].shape == (4, 24)
    assert rewards.dtype == np.float32
    assert [info["episode"]["l"] for info in ends] == [20] * 4
    assert all(info["TimeLimit.truncated"] and "ranges" in info["terminal_observation"] for info in ends)
    env.seed(3)
    np.testing.assert_array_equal(env.reset()["ranges"], first["ranges"])
    with pytest.raises(InputError, match="share one environment"):
        env.set_attr("period_s", 0.1)
    PPO("MultiInputPolicy", env, n_steps=8, batch_size=16, n_epochs=1, device="cpu").learn(32)


def test_rsl_rl_learns_on_it():
    pytest.importorskip("rsl_rl", reason="needs RSL-RL")
    torch = pytest.importorskip("torch", reason="needs PyTorch")
    from trundle.gym.rsl_rl import RslRlVecEnv

    env = RslRlVecEnv(4, **OPTIONS)
    observed = env.get_observations()
    assert {name: tuple(values.shape) for name, values in observed.items()} == {"actor": (4, 29), "critic": (4, 32)}
    for step in range(1, 21):
        observed, rewards, dones, extras = env.step(torch.full((4, 2), 0.0))
        assert env.episode_length_buf.tolist() == [step % 20] * 4
    assert extras["time_outs"].tolist() == dones.tolist() == [True] * 4
    assert extras["log"]["/is_success"] == 0.0
    assert rewards.shape == (4,)
    observed, _, _, extras = env.step(torch.full((4, 2), 50.0))  # cut off at the bounds
    assert extras["log"] == {}
    seeded = RslRlVecEnv(4, reset_seed=9, **OPTIONS).get_observations()["actor"]
    assert not torch.equal(seeded, RslRlVecEnv(4, **OPTIONS).get_observations()["actor"])
    assert torch.equal(seeded[0], RslRlVecEnv(1, reset_seed=9, **OPTIONS).get_observations()["actor"][0])
