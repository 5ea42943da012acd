"""`Sb3VecEnv`: many robots as a `VecEnv` of Stable-Baselines3, stepped by one kernel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from trundle.errors import InputError, MissingExtraError
from trundle.gym.vector_env import NavigationVectorEnv

try:
    from stable_baselines3.common.vec_env import VecEnv  # pyright: ignore[reportMissingImports]
except ModuleNotFoundError as error:
    raise MissingExtraError("trundle.gym.sb3", str(error.name), "pip install stable-baselines3") from None


class Sb3VecEnv(VecEnv):
    """Robots as a `VecEnv`: `PPO("MultiInputPolicy", Sb3VecEnv(64, world="office"))`.

    Each robot's `infos` has the figures of `NavigationEnv`, and at the end of an episode `terminal_observation`,
    `TimeLimit.truncated` and `episode` (return and length), as Stable-Baselines3 wants them. It keeps all in NumPy's
    arrays: with `device="cuda"` each step is copied to the host once.

    Args:
        num_envs: Number of robots.
        options: As for `NavigationVectorEnv`; `autoreset_mode` is always "same_step".
    """

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.inner = NavigationVectorEnv(num_envs, **{**options, "autoreset_mode": "same_step"})
        self.render_mode = self.inner.render_mode
        super().__init__(num_envs, self.inner.single_observation_space, self.inner.single_action_space)
        self._actions = np.zeros((num_envs, 2), dtype=np.float32)
        self._returns, self._lengths = np.zeros(num_envs), np.zeros(num_envs, dtype=np.int64)

    def reset(self) -> Any:
        """Begin an episode of each robot, by the seed that `seed` was given."""
        seed = None if self._seeds[0] is None else int(self._seeds[0])
        observed, _ = self._host(self.inner.reset(seed=seed))
        self._returns[:], self._lengths[:] = 0.0, 0
        self._reset_seeds()
        return observed

    def step_async(self, actions: Any) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = np.asarray(actions)

    def step_wait(self) -> Any:
        """Drive one period; see `NavigationVectorEnv.step`."""
        observed, rewards, terminated, truncated, info = self._host(self.inner.step(self._actions))
        done = terminated | truncated
        self._returns += rewards
        self._lengths += 1
        ends = info.get("final_info", {})
        infos: list[dict[str, Any]] = []
        for robot in range(self.num_envs):
            figures = ends if done[robot] else info
            one = {
                name: values[robot].item()
                for name, values in figures.items()
                if not name.startswith(("_", "final_")) and isinstance(values, np.ndarray)
            }
            if done[robot]:
                final = info["final_obs"]
                one["terminal_observation"] = (
                    {name: values[robot] for name, values in final.items()} if isinstance(final, dict) else final[robot]
                )
                one["TimeLimit.truncated"] = bool(truncated[robot])
                one["episode"] = {"r": float(self._returns[robot]), "l": int(self._lengths[robot]), "t": one["time_s"]}
            infos.append(one)
        self._returns[done], self._lengths[done] = 0.0, 0
        return observed, rewards.astype(np.float32), done, infos

    def close(self) -> None:
        """Close the environment."""
        self.inner.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the environment, for each robot that is asked for."""
        return [getattr(self.inner, attr_name)] * len(self._robots(indices))

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: robots share one environment."""
        raise InputError(f"{attr_name} cannot be set for some robots: they share one environment; make another one")

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Call a method of the environment once; each robot that is asked for has its result."""
        result = getattr(self.inner, method_name)(*method_args, **method_kwargs)
        return [result] * len(self._robots(indices))

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Any = None) -> list[bool]:
        """Say that no robot's environment is wrapped."""
        return [False] * len(self._robots(indices))

    def get_images(self) -> Sequence[Any]:
        """Return a picture of each robot; needs `render_mode="rgb_array"`."""
        return self.inner.render() or [None] * self.num_envs

    def _host(self, values: Any) -> Any:
        """Return arrays of the host in place of those of the environment's device, also in dictionaries."""
        if isinstance(values, dict):
            return {name: self._host(each) for name, each in values.items()}
        if isinstance(values, tuple):
            return tuple(self._host(each) for each in values)
        return self.inner.episodes.arrays.host(values)

    def _robots(self, indices: Any) -> Sequence[int]:
        return list(self._get_indices(indices))
