"""`policy_metadata`: what a policy's ONNX file has to say, from the environment that it was trained in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from trundle.errors import InputError
from trundle.gym.episodes import Episodes
from trundle.navigation.policies.policy_file import OBSERVATIONS, metadata_for


def policy_metadata(
    env: Any,
    *,
    observations: Sequence[str] | None = None,
    normalisation: Mapping[str, tuple[object, object]] | None = None,
    states: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """Return the metadata of a policy that was trained in an environment, for its ONNX file.

    `onnx.helper.set_model_props(model, policy_metadata(env))` writes them; see `trundle.navigation.PolicyFile`.

    Args:
        env: The `NavigationEnv` or `NavigationVectorEnv`, or a wrapper of one.
        observations: The network's inputs that are observations. If None, `ranges`, `goal` and `velocity`, and `path`
            where the environment observes it.
        normalisation: (mean, scale) by observation, where the network gets (value − mean) / scale.
        states: Recurrent inputs, and the outputs that they become.

    Raises:
        InputError: If the environment is none of trundle's, or observes otherwise than a robot on its own can; or if
            `PolicyFile` would refuse the metadata.
    """
    episodes: Any = getattr(getattr(env, "unwrapped", env), "episodes", None)
    if not isinstance(episodes, Episodes):
        raise InputError(f"policy_metadata needs an environment of trundle.gym, got {type(env).__name__}")
    points = episodes.settings.path_points
    possible = tuple(name for name in OBSERVATIONS if points or name != "path")
    if observations is None:
        observations = possible
    for name in observations:
        if name == "path" and not points:
            raise InputError("the environment observes no path: make it with path_points")
        if name not in OBSERVATIONS:
            raise InputError(f"a policy cannot observe {name!r} on a robot; it may observe: {', '.join(OBSERVATIONS)}")
    if not episodes.settings.scaled_actions:
        raise InputError("a policy's actions are from -1 to 1: train it with scaled_actions=True")
    lidars = episodes.arena.robot.lidars
    kinds = {(lidar.beams, lidar.range_max) for lidar in lidars.values()}
    if len(kinds) > 1:
        raise InputError("the lidars of a policy need the same beams and range_max: give beams, or one lidar")
    beams, reach = next(iter(kinds))
    return metadata_for(
        observations=observations,
        beams=beams,
        reach=reach,
        lidars=tuple(lidars),
        path_points=points if "path" in observations else 0,
        period=episodes.settings.period_s,
        scale=episodes.command_scale.tolist(),
        offset=episodes.command_offset.tolist(),
        normalisation=normalisation or {},
        states=states or {},
    )
