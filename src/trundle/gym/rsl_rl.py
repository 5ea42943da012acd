"""`RslRlVecEnv`: many robots as a `VecEnv` of RSL-RL, with observations in a TensorDict."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.errors import MissingExtraError
from trundle.gym.vector_env import NavigationVectorEnv

try:
    import torch  # pyright: ignore[reportMissingImports]
    from rsl_rl.env import VecEnv  # pyright: ignore[reportMissingImports]
    from tensordict import TensorDict  # pyright: ignore[reportMissingImports]
except ModuleNotFoundError as error:
    raise MissingExtraError("trundle.gym.rsl_rl", str(error.name), "pip install rsl-rl-lib tensordict torch") from None


class RslRlVecEnv(VecEnv):
    """Robots as RSL-RL's `VecEnv`: `OnPolicyRunner(RslRlVecEnv(4096, device="cuda"), config, device="cuda")`.

    The group `actor` is what a robot observes, the group `critic` the same and the length of the shortest path and its
    direction. An action of the network is cut off at the bounds. With `device="cuda"` all tensors stay on the GPU.

    Args:
        num_envs: Number of robots.
        reset_seed: Seed s of the robots' episodes: they have the seeds s, s + 1, …. The option `seed` is of the worlds.
        learner_device: Where the tensors are to be; where the environment computes if None.
        options: As for `NavigationVectorEnv`, with actions scaled; `autoreset_mode` and `critic` are set here.
    """

    def __init__(
        self, num_envs: int = 1, *, reset_seed: int = 0, learner_device: str | None = None, **options: Any
    ) -> None:
        self.inner = NavigationVectorEnv(
            num_envs, **{**options, "autoreset_mode": "same_step", "critic": True, "scaled_actions": True}
        )
        self.num_envs, self.num_actions = num_envs, 2
        self.device = learner_device or self.inner.episodes.settings.device
        self.max_episode_length = self.inner.episodes.settings.max_steps
        self.cfg = {"reset_seed": reset_seed, **options}
        self._observed, _ = self.inner.reset(seed=reset_seed)

    @property
    def episode_length_buf(self) -> torch.Tensor:
        """Steps since each episode began, a copy; what is set counts towards its time limit, not in `time_s`."""
        return self._tensor(self.inner.episodes.arrays.copy(self.inner.episodes.elapsed))

    @episode_length_buf.setter
    def episode_length_buf(self, steps: torch.Tensor) -> None:
        episodes = self.inner.episodes
        episodes.elapsed[:] = episodes.arrays.put(steps.cpu() if episodes.arrays.on_host else steps)

    def get_observations(self) -> TensorDict:
        """Return what is observed now, in the groups `actor` and `critic`, each of shape (num_envs, size)."""
        parts = {name: self._tensor(values) for name, values in self._observed.items()}
        actor = torch.cat([values.flatten(1).float() for name, values in parts.items() if name != "critic"], dim=1)
        groups = {"actor": actor, "critic": torch.cat([actor, parts["critic"].float()], dim=1)}
        return TensorDict(groups, batch_size=[self.num_envs], device=self.device)

    def step(self, actions: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, dict[str, Any]]:
        """Drive one period.

        Returns:
            Observations, rewards and ends, and `time_outs` and `log`: figures of the episodes that have ended.
        """
        given = actions.detach().clamp(-1.0, 1.0)
        if self.inner.episodes.arrays.on_host:
            given = given.cpu().numpy()
        self._observed, rewards, terminated, truncated, info = self.inner.step(given)
        done = terminated | truncated
        extras: dict[str, Any] = {"time_outs": self._tensor(truncated), "log": {}}
        if "final_info" in info:
            names = ("is_success", "contact", "spl", "path_length", "time_s")
            ends = {name: self._tensor(info["final_info"][name][done]) for name in names}
            extras["log"] = {f"/{name}": values.float().mean() for name, values in ends.items()}
        return self.get_observations(), self._tensor(rewards).float(), self._tensor(done), extras

    def close(self) -> None:
        """Close the environment."""
        self.inner.close()

    def _tensor(self, values: Any) -> torch.Tensor:
        if isinstance(values, torch.Tensor):
            return values.to(self.device)
        # A copy: the environment's state changes with the next step.
        return torch.from_numpy(np.array(values)).to(self.device)
