"""The metadata of a policy are those of the environment that it was trained in."""

import gymnasium
import pytest

from trundle.errors import InputError
from trundle.gym import NavigationEnv, policy_metadata

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
