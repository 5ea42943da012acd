"""`trundle/Barn-v0` and `trundle/DynaBarn-v0` on small files of their formats."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import trundle.gym  # noqa: F401 - registers
from support.public_worlds import write_barn, write_dynabarn
from trundle.errors import InputError


@pytest.fixture
def barn(tmp_path):
    for number in (0, 7):
        write_barn(tmp_path / "BARN", number)
    return tmp_path / "BARN"


@pytest.fixture
def dynabarn(tmp_path):
    write_dynabarn(tmp_path / "worlds.json")
    return tmp_path / "worlds.json"


def test_barn_has_the_start_and_the_goal_of_the_challenge(barn):
    env = gymnasium.make("trundle/Barn-v0", folder=barn, beams=24)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped, skip_render_check=True)
    _, info = env.reset(seed=0)
    episodes = env.unwrapped.episodes
    assert episodes.sim.poses[0] == pytest.approx([-2.25, 3.0, np.pi / 2.0])
    assert episodes.goals[0].tolist() == [-2.25, 13.0]
    assert info["shortest_length"] == pytest.approx(10.0, abs=0.2)
    for _ in range(60):
        _, _, terminated, _, info = env.step(np.array([0.8, 0.0], dtype=np.float32))
        if terminated:
            break
    assert info["is_success"]
    assert info["spl"] == 1.0


def test_many_robots_drive_in_the_worlds_that_are_chosen(barn):
    env = gymnasium.make_vec("trundle/Barn-v0", num_envs=8, folder=barn, beams=24, autoreset_mode="same_step")
    env.reset(seed=0)
    assert set(env.step(np.zeros((8, 2), np.float32))[4]["map"]) == {0, 1}
    one = gymnasium.make_vec("trundle/Barn-v0", num_envs=2, folder=barn, numbers=[7])
    assert one.episodes.arena.names == ("world_7",)


def test_dynabarn_has_movers_that_move(dynabarn):
    env = gymnasium.make("trundle/DynaBarn-v0", file=dynabarn, levels=["hard"], beams=48, max_time_s=20.0)
    observed, _ = env.reset(seed=0)
    assert len(env.unwrapped.episodes.arena.recordings[0].outlines) == 2
    following = env.step(np.zeros(2, dtype=np.float32))[0]
    assert observed["ranges"].shape == (48,)
    assert following in env.observation_space
    many = gymnasium.make_vec("trundle/DynaBarn-v0", num_envs=3, file=dynabarn, beams=12, max_time_s=5.0)
    many.reset(seed=0)
    assert many.step(np.zeros((3, 2), np.float32))[0] in many.observation_space


@pytest.mark.parametrize(
    ("name", "options", "text"),
    [
        ("Barn", {"folder": "nowhere"}, "no such folder"),
        ("Barn", {"folder": "BARN", "numbers": [3]}, "no world_3"),
        ("Barn", {"folder": "BARN", "world": "maze"}, "for trundle/Navigation-v0"),
        ("DynaBarn", {"file": "worlds.json", "numbers": [5]}, "no world world_5"),
        ("DynaBarn", {"file": "worlds.json", "numbers": [0], "levels": ["hard"]}, "none of the worlds is hard"),
        ("DynaBarn", {"file": "worlds.json", "levels": ["herd"]}, "hard"),
    ],
)
def test_wrong_files_are_named(name, options, text, barn, dynabarn, monkeypatch):
    monkeypatch.chdir(barn.parent)
    with pytest.raises(InputError, match=text):
        gymnasium.make(f"trundle/{name}-v0", **options)
