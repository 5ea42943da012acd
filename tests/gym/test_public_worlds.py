"""`trundle/Barn-v0` and `trundle/DynaBarn-v0` on small files of their formats."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import trundle.gym  # noqa: F401 - registers
from support.public_worlds import write_barn, write_dynabarn
from trundle.errors import InputError
from trundle.gym.public_worlds import split_worlds


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
    env = gymnasium.make("trundle/Barn-v0", folder=barn, numbers=[0], beams=24)
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
    options = {"folder": barn, "numbers": [0, 7], "beams": 24}
    env = gymnasium.make_vec("trundle/Barn-v0", num_envs=8, autoreset_mode="same_step", **options)
    env.reset(seed=0)
    assert set(env.step(np.zeros((8, 2), np.float32))[4]["map"]) == {0, 1}
    one = gymnasium.make_vec("trundle/Barn-v0", num_envs=2, folder=barn, numbers=[7])
    assert one.episodes.arena.names == ("world_7",)


def test_splits_are_disjoint_and_the_test_is_that_of_the_challenge():
    of = {split: split_worlds(range(300), split, "BARN") for split in ("train", "validation", "test")}
    assert of["test"] == list(range(0, 300, 6))
    assert len(of["validation"]) == 50
    assert sorted(number for numbers in of.values() for number in numbers) == list(range(300))


@pytest.mark.parametrize(("split", "name"), [("train", "world_7"), ("test", "world_0")])
def test_worlds_are_those_of_the_split_where_no_numbers_are_given(barn, split, name):
    assert gymnasium.make("trundle/Barn-v0", folder=barn, split=split).unwrapped.episodes.arena.names == (name,)
    many = gymnasium.make_vec("trundle/Barn-v0", num_envs=2, folder=barn, split=split)
    assert many.episodes.arena.names == (name,)


@pytest.mark.parametrize(("split", "name"), [("validation", "world_3"), ("test", "world_0")])
def test_dynabarn_has_splits_too(dynabarn, split, name):
    env = gymnasium.make("trundle/DynaBarn-v0", file=dynabarn, split=split, max_time_s=5.0)
    assert env.unwrapped.episodes.arena.names == (name,)


def test_dynabarn_has_movers_that_move(dynabarn):
    options = {"file": dynabarn, "numbers": [0, 3]}
    env = gymnasium.make("trundle/DynaBarn-v0", **options, levels=["hard"], beams=48, max_time_s=20.0)
    observed, _ = env.reset(seed=0)
    assert len(env.unwrapped.episodes.arena.recordings[0].outlines) == 2
    following = env.step(np.zeros(2, dtype=np.float32))[0]
    assert observed["ranges"].shape == (48,)
    assert following in env.observation_space
    many = gymnasium.make_vec("trundle/DynaBarn-v0", num_envs=3, **options, beams=12, max_time_s=5.0)
    many.reset(seed=0)
    assert many.step(np.zeros((3, 2), np.float32))[0] in many.observation_space


@pytest.mark.parametrize(
    ("name", "options", "text"),
    [
        ("Barn", {"folder": "nowhere"}, "no such folder"),
        ("Barn", {"folder": "BARN", "numbers": [3]}, "no world_3"),
        ("Barn", {"folder": "BARN", "world": "maze"}, "for trundle/Navigation-v0"),
        ("Barn", {"folder": "BARN", "min_distance": 3.0}, "min_distance is for trundle/Navigation-v0; start and goal"),
        ("Barn", {"folder": "BARN", "seed": 1}, "the seed of reset draws one"),
        ("Barn", {"folder": "BARN", "numbers": [0], "split": "test"}, "give split or numbers"),
        (
            "Barn",
            {"folder": "BARN", "split": "validation"},
            r"none of its worlds \(0, 7\) is of the split 'validation'",
        ),
        ("Barn", {"folder": "BARN", "numbers": []}, "numbers must be a list"),
        ("Barn", {"folder": "BARN", "numbers": 3}, "numbers must be a list"),
        ("Barn", {}, "needs folder"),
        ("Barn", {"folder": 3}, "folder must be a path"),
        ("DynaBarn", {}, "needs file"),
        ("DynaBarn", {"file": "worlds.json", "numbers": ["0"]}, "number of a world must be an integer"),
        ("DynaBarn", {"file": "worlds.json", "min_distance": 3.0}, "min_distance is for"),
        ("DynaBarn", {"file": "worlds.json"}, r"none of its worlds \(0, 3\) is of the split 'train'"),
        ("DynaBarn", {"file": "worlds.json", "numbers": [5]}, "no world world_5"),
        ("DynaBarn", {"file": "worlds.json", "numbers": [0], "levels": ["hard"]}, "none of the worlds is hard"),
        ("DynaBarn", {"file": "worlds.json", "numbers": [0], "levels": ["herd"]}, "hard"),
    ],
)
def test_wrong_files_are_named(name, options, text, barn, dynabarn, monkeypatch):
    monkeypatch.chdir(barn.parent)
    with pytest.raises(InputError, match=text):
        gymnasium.make(f"trundle/{name}-v0", **options)
