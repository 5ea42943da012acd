"""The metadata of a policy are those of the environment that it was trained in."""

import math

import gymnasium
import pytest

from support.policies import write_policy
from trundle.errors import InputError
from trundle.gym import NavigationEnv, policy_metadata
from trundle.navigation.policies.policy_file import PolicyFile

OPTIONS = {"world": "office", "worlds": 1, "robot": "jackal", "beams": 24}


def test_they_say_what_the_robot_observes_and_how_actions_are_scaled():
    env = gymnasium.make("trundle/Navigation-v0", period_s=0.1, **OPTIONS)
    found = policy_metadata(env, normalisation={"goal": (0.0, [10.0, 1.0, 1.0])}, states={"h": "h_next"})
    limits = env.unwrapped.episodes.arena.robot.limits
    assert found["trundle.beams"] == "24"
    assert found["trundle.period"] == "0.1"
    assert found["trundle.states"] == "h=h_next"
    assert found["trundle.observations"] == "ranges,goal,velocity"
    assert found["trundle.scale"] == f"{limits.linear_speed!r},{limits.angular_speed!r}"
    assert found["trundle.normalisation"] == '{"goal": [0.0, [10.0, 1.0, 1.0]]}'


def test_an_environment_that_observes_a_path_makes_policies_that_follow_one():
    found = policy_metadata(NavigationEnv(path_points=6, **OPTIONS))
    assert found["trundle.observations"] == "ranges,goal,velocity,path"
    assert found["trundle.path_points"] == "6"
    alone = policy_metadata(NavigationEnv(path_points=6, **OPTIONS), observations=("ranges", "goal"))
    assert "trundle.path_points" not in alone
    with pytest.raises(InputError, match="observes no path: make it with path_points"):
        policy_metadata(NavigationEnv(**OPTIONS), observations=("ranges", "path"))


def test_what_a_robot_cannot_observe_or_do_is_refused():
    env = NavigationEnv(critic=True, **OPTIONS)
    with pytest.raises(InputError, match="cannot observe 'critic'"):
        policy_metadata(env, observations=("ranges", "critic"))
    with pytest.raises(InputError, match=r"environment of trundle\.gym, got object"):
        policy_metadata(object())
    with pytest.raises(InputError, match="scaled_actions=True"):
        policy_metadata(NavigationEnv(scaled_actions=False, **OPTIONS))


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"normalisation": {"ranges": (0, 0)}}, "scale above 0"),
        ({"normalisation": {"ranges": (0.0, math.nan)}}, "must be finite"),
        (
            {"normalisation": {"odour": (0.0, 1.0)}},
            "normalisation has 1 numbers for 'odour'; observations are ranges, goal",
        ),
        ({"normalisation": {"ranges": (0.0, [1.0] * 23)}}, "normalisation has 23 numbers for 'ranges'"),
        ({"normalisation": {"goal": 3.0}}, "normalisation is"),
        ({"normalisation": [1]}, "normalisation is"),
        ({"normalisation": {"ranges": (0.0, 1.0)}, "observations": ("goal",)}, "for 'ranges'; observations are goal,"),
        ({"observations": ("goal", "goal")}, "must be different names"),
        ({"observations": ()}, "must be different names"),
        ({"states": {"h": ""}}, "must be input=output"),
    ],
)
def test_what_the_file_of_a_policy_would_refuse_is_not_written(options, text):
    with pytest.raises(InputError, match=text):
        policy_metadata(NavigationEnv(**OPTIONS), **options)


def test_the_file_of_a_policy_takes_what_is_written(tmp_path):
    pytest.importorskip("onnx", reason="makes policies with onnx, of the development tools")
    pytest.importorskip("onnxruntime", reason="needs onnxruntime, of the extra policy")
    each = {"ranges": (0.0, [12.0] * 36), "goal": ([1.0, 0.0, 0.0], 10.0)}
    metadata = policy_metadata(NavigationEnv(**{**OPTIONS, "beams": 36}), normalisation=each)
    texts = {name.removeprefix("trundle."): text for name, text in metadata.items()}
    file = PolicyFile.load(write_policy(tmp_path / "policy.onnx", texts))
    assert {name: [part.tolist() for part in parts] for name, parts in file.normalisation.items()} == {
        "ranges": [[0.0], [12.0] * 36],
        "goal": [[1.0, 0.0, 0.0], [10.0]],
    }
