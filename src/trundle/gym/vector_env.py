"""`NavigationVectorEnv`: many robots in one step, as a Gymnasium `VectorEnv`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from trundle.errors import InputError, UnknownNameError
from trundle.gym.arena import Arena, make_arena
from trundle.gym.env import RENDER_MODES, action_space, check_render_mode
from trundle.gym.episodes import Bools, Episodes
from trundle.gym.observations import Observations, Observer
from trundle.gym.render import draw_robot
from trundle.gym.settings import NavigationSettings
from trundle.values import check_count, check_seed

_MODES = {
    "next_step": AutoresetMode.NEXT_STEP,
    "same_step": AutoresetMode.SAME_STEP,
    "disabled": AutoresetMode.DISABLED,
}


class NavigationVectorEnv(VectorEnv[Any, Any, Any]):
    """Robots that each have to reach a goal of their own, stepped together by one kernel.

    Robot i of a reset with the seed s has the episodes of a `NavigationEnv` with the seed s + i, bit for bit.

    Args:
        num_envs: Number of robots.
        autoreset_mode: "next_step" (the step after the end of an episode begins the next one; its action is not used),
            "same_step" (the step that ends an episode begins the next one, and `final_obs` and `final_info` are of the
            end) or "disabled" (reset with the option `reset_mask`); or Gymnasium's `AutoresetMode`.
        render_mode: "rgb_array", or None.
        arena: Maps and missions, made of the settings if None.
        options: The settings by name; see `NavigationSettings`.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        autoreset_mode: str | AutoresetMode = "next_step",
        render_mode: str | None = None,
        arena: Arena | None = None,
        **options: Any,
    ) -> None:
        settings = NavigationSettings.of(options)
        self.num_envs = check_count("num_envs", num_envs, 1, 10_000_000)
        self._mode = _read_mode(autoreset_mode)
        self.render_mode = check_render_mode(render_mode)
        if render_mode == "human":
            raise InputError("many robots have no page: use render_mode='rgb_array', or one NavigationEnv")
        self.metadata = {
            "autoreset_mode": self._mode,
            "render_modes": list(RENDER_MODES[:1]),
            "render_fps": max(1, round(1.0 / settings.period_s)),
        }
        arena = make_arena(settings, settings.load_robot()) if arena is None else arena
        self.episodes = Episodes(settings, arena, num_envs)
        self._observer = Observer(self.episodes)
        self.single_observation_space = self._observer.space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.single_action_space = action_space(self.episodes)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._ended = np.zeros(num_envs, dtype=bool)
        self._ready = np.zeros(num_envs, dtype=bool)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin episodes of all robots, or of those of the option `reset_mask`, bools of shape (num_envs,).

        Args:
            seed: An integer s, for the seeds s, s + 1, …; one for each robot; or None, for the next episodes.
            options: May hold `reset_mask`.
        """
        mask = self._read_mask(options)
        robots = np.flatnonzero(mask)
        self._seed(seed, robots)
        self.episodes.reset(robots)
        self._ended[robots], self._ready[robots] = False, True
        self._observer.scan(robots)
        return self._observer.observe(), _masked(self.episodes.start_figures(), mask)

    def step(
        self, actions: npt.NDArray[np.float32]
    ) -> tuple[Observations, npt.NDArray[Any], npt.NDArray[Any], npt.NDArray[Any], dict[str, Any]]:
        """Drive one period with an action for each robot.

        Raises:
            InputError: If an action is not finite or out of bounds, or a robot was not reset; nothing has moved then.
        """
        if not self._ready.all():
            raise InputError(f"call reset before step: robot {int(np.argmin(self._ready))} has no episode")
        if self._mode is AutoresetMode.DISABLED and self._ended.any():
            first = int(np.argmax(self._ended))
            raise InputError(
                f"the episode of robot {first} has ended, and autoreset is disabled: reset it, "
                "reset(options={'reset_mask': terminated | truncated})"
            )
        begun = self._ended if self._mode is AutoresetMode.NEXT_STEP else np.zeros(self.num_envs, dtype=bool)
        active = ~begun
        outcome = self.episodes.step(actions, active if begun.any() else None)
        info = outcome.info
        if begun.any():
            self.episodes.reset(np.flatnonzero(begun))
            fresh = self.episodes.start_figures()
            info = {name: _select(begun, fresh.get(name), values) for name, values in info.items()}
        self._observer.scan()
        ended = outcome.terminated | outcome.truncated
        info = _masked(info, np.ones(self.num_envs, dtype=bool))
        observations = self._observer.observe()
        if self._mode is AutoresetMode.SAME_STEP and ended.any():
            observations, info = self._begin_again(ended, observations, info)
            self._ended = np.zeros(self.num_envs, dtype=bool)
        else:
            self._ended = ended
        return observations, outcome.rewards, outcome.terminated, outcome.truncated, info

    def render(self) -> tuple[Any, ...] | None:
        """Return a picture of each robot, uint8, shape (rows, cols, 3)."""
        if self.render_mode is None:
            return None
        return tuple(draw_robot(self.episodes, robot) for robot in range(self.num_envs))

    def _begin_again(
        self, ended: Bools, observations: Observations, info: dict[str, Any]
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin the next episodes where one has ended, scan there again, and keep what the ends were like."""
        final = np.full(self.num_envs, None, dtype=object)
        robots = np.flatnonzero(ended)
        for robot in robots:
            final[robot] = {name: values[robot].copy() for name, values in observations.items()}
        final_info = {name: values for name, values in info.items() if not name.startswith("_")}
        self.episodes.reset(robots)
        self._observer.scan(robots)
        fresh = self.episodes.start_figures()
        info = {
            name: values if name.startswith("_") else _select(ended, fresh.get(name), values)
            for name, values in info.items()
        }
        info |= {"final_obs": final, "_final_obs": ended.copy()}
        info |= {"final_info": _masked(final_info, ended), "_final_info": ended.copy()}
        return self._observer.observe(), info

    def _read_mask(self, options: dict[str, Any] | None) -> Bools:
        if not options or "reset_mask" not in options:
            return np.ones(self.num_envs, dtype=bool)
        mask = np.asarray(options["reset_mask"])
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_:
            raise InputError(f"reset_mask must be bools of shape ({self.num_envs},), got {mask.dtype} of {mask.shape}")
        return mask

    def _seed(self, seed: int | Sequence[int | None] | None, robots: npt.NDArray[np.int64]) -> None:
        if seed is None:
            fresh = robots[~self._ready[robots]]
            if len(fresh):
                self.episodes.seed(self.np_random.integers(2**62, size=self.num_envs)[fresh], fresh)
            return
        if isinstance(seed, int | np.integer):
            self.episodes.seed(check_seed(seed) + robots, robots)
            return
        seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise InputError(f"a list of seeds needs one for each of {self.num_envs} robots, got {len(seeds)}")
        for robot in robots:
            if seeds[robot] is not None:
                self.episodes.seed([check_seed(seeds[robot])], np.array([robot]))
            elif not self._ready[robot]:
                self.episodes.seed([int(self.np_random.integers(2**62))], np.array([robot]))


def _read_mode(mode: str | AutoresetMode) -> AutoresetMode:
    if isinstance(mode, AutoresetMode):
        return mode
    if str(mode).lower() not in _MODES:
        raise UnknownNameError("autoreset mode", str(mode), _MODES)
    return _MODES[str(mode).lower()]


def _masked(info: dict[str, Any], mask: Bools) -> dict[str, Any]:
    """Return an info as Gymnasium has it for many: beside every array, which robots it is of."""
    return info | {f"_{name}": mask.copy() for name in info}


def _select(mask: Bools, fresh: Any, values: Any) -> Any:
    """Take the figures of a new episode where one has begun: those that it has not are 0."""
    return np.where(mask, np.zeros_like(values) if fresh is None else fresh, values)
